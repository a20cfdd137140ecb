// Other tools' formats: round trips, and damaged or hostile files.

#include "core/labels/exchange/exchange.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/labels/exchange/formats.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/cloud/cloud.hpp"
#include "exchange_fixture.hpp"
#include "support/label_readers.hpp"

namespace planescope::labels {
namespace {

void expect_same_pixels(const FrameLabels& back, const FrameLabels& labels) {
  ASSERT_EQ(back.plane.data, labels.plane.data);
  ASSERT_EQ(back.hv.data, labels.hv.data);
  ASSERT_EQ(back.planes.size(), labels.planes.size());
  for (std::size_t k = 0; k < back.planes.size(); ++k) {
    EXPECT_EQ(back.planes[k].id, labels.planes[k].id);
    EXPECT_EQ(back.planes[k].normal, labels.planes[k].normal);
    EXPECT_EQ(back.planes[k].offset_m, labels.planes[k].offset_m);
    EXPECT_EQ(back.planes[k].fragments, labels.planes[k].fragments);
  }
}

TEST_F(Exchange, ExportThenImportIsTheIdentity) {
  for (const LabelFormat format : {LabelFormat::ply, LabelFormat::pcd, LabelFormat::kitti,
                                   LabelFormat::npz, LabelFormat::coco}) {
    for (std::uint64_t seed = 1; seed <= 12; ++seed) {
      SCOPED_TRACE(std::string(to_string(format)) + " " + std::to_string(seed));
      make(seed);
      expect_same_pixels(there_and_back(format), labels);
      if (HasFatalFailure()) return;
    }
  }
}

TEST_F(Exchange, AFrameWithoutLabelsComesBackWithoutLabels) {
  labels = empty_labels(grid, kHash);
  for (const LabelFormat format : label_formats(true)) {
    SCOPED_TRACE(to_string(format));
    expect_same_pixels(there_and_back(format), labels);
  }
}

TEST_F(Exchange, EvopsRestoresPlanesWithoutAClassIfGravityIsUnknown) {
  grid.gravity.source = GravitySource::none;
  const FrameLabels back = there_and_back(LabelFormat::evops);
  ASSERT_FALSE(back.planes.empty());
  for (const LabelPlane& plane : back.planes) EXPECT_EQ(plane.label, Label::unknown);
  for (const std::uint8_t hv : back.hv.data) EXPECT_TRUE(hv == 0 || hv == kHvIgnore);
}

TEST_F(Exchange, EvopsRestoresPlanesAndTheirClassByTilt) {
  for (std::uint64_t seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    make(seed);
    const FrameLabels back = there_and_back(LabelFormat::evops);
    std::vector<std::uint16_t> without_ignored = labels.plane.data;
    for (std::uint16_t& id : without_ignored)
      if (id == kPlaneIgnore) id = 0;
    ASSERT_EQ(back.plane.data, without_ignored);
    for (const LabelPlane& plane : back.planes) {
      const double up = std::abs(plane.normal.dot(grid.gravity.direction));
      EXPECT_EQ(plane.label, up > std::sqrt(0.5) ? Label::h : Label::v);
    }
  }
}

TEST_F(Exchange, TheSameLabelsMakeTheSameBytes) {
  for (const LabelFormat format : label_formats(false)) {
    const LabeledPoints points = points_of_labels(labels, grid);
    std::filesystem::create_directories(dir / "again");
    const auto first = write_labeled(dir / "frame", format, points);
    const auto again = write_labeled(dir / "again/frame", format, points);
    ASSERT_EQ(first.size(), again.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      EXPECT_EQ(test::file_text(first[i]), test::file_text(again[i])) << first[i];
    EXPECT_FALSE(std::filesystem::exists(first[0].string() + ".part"));
  }
}

TEST_F(Exchange, SemanticKittiIsReadableByItsOwnTools) {
  const auto paths =
      write_labeled(dir / "000007", LabelFormat::kitti, points_of_labels(labels, grid));
  const test::SemanticKitti scan =
      test::read_semantic_kitti(dir / "000007.bin", dir / "000007.label");
  EXPECT_EQ(paths.size(), 2u);
  ASSERT_EQ(scan.semantic.size(), grid.measured_count);
  ASSERT_EQ(scan.points.size(), 4 * grid.measured_count);
  std::size_t at = 0;
  for (std::size_t i = 0; i < grid.pixels(); ++i) {
    if (!grid.measured[i]) continue;
    EXPECT_EQ(scan.semantic[at], labels.hv.data[i]);
    EXPECT_EQ(scan.instance[at], labels.plane.data[i]);
    EXPECT_EQ(scan.points[4 * at + 2], grid.points[i].z());
    EXPECT_EQ(scan.points[4 * at + 3], 0);
    ++at;
  }
}

TEST_F(Exchange, EvopsIsOneWholeNumberPerPoint) {
  write_labeled(dir / "labels", LabelFormat::evops, points_of_labels(labels, grid));
  const auto ids = test::load_npy_int32(dir / "labels.npy");
  ASSERT_EQ(ids.size(), grid.measured_count);
  std::size_t at = 0;
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (grid.measured[i]) {
      EXPECT_EQ(ids[at++], labels.plane.data[i] == kPlaneIgnore ? 0 : labels.plane.data[i]);
    }
}

TEST_F(Exchange, CocoHasAMaskABoxAndThePlaneOfEachAnnotation) {
  write_labeled(dir / "000001", LabelFormat::coco, points_of_labels(labels, grid));
  const auto json = nlohmann::json::parse(test::file_text(dir / "000001.json"));
  EXPECT_EQ(json["images"][0]["width"], grid.width);
  std::vector<int> seen(grid.pixels(), 0);
  for (const auto& annotation : json["annotations"]) {
    EXPECT_EQ(annotation["iscrowd"], annotation["category_id"] == 4 ? 1 : 0) << "scored, or not";
    EXPECT_EQ(annotation["segmentation"]["size"], nlohmann::json({grid.height, grid.width}));
    const auto mask =
        test::decode_rle(annotation["segmentation"]["counts"], grid.width, grid.height);
    const int id = annotation["plane"]["id"];
    int left = grid.width, top = grid.height, right = 0, bottom = 0, area = 0;
    for (int y = 0; y < grid.height; ++y) {
      for (int x = 0; x < grid.width; ++x) {
        if (!mask.at(y * grid.width + x)) continue;
        EXPECT_EQ(labels.plane.at(x, y), id);
        ++seen[y * grid.width + x];
        ++area;
        left = std::min(left, x);
        right = std::max(right, x);
        top = std::min(top, y);
        bottom = std::max(bottom, y);
      }
    }
    EXPECT_EQ(annotation["area"], area);
    EXPECT_EQ(annotation["bbox"], nlohmann::json({left, top, right - left + 1, bottom - top + 1}));
    for (const LabelPlane& plane : labels.planes)
      if (plane.id == id) {
        EXPECT_EQ(annotation["plane"]["offset_m"], plane.offset_m);
      }
  }
  for (std::size_t i = 0; i < seen.size(); ++i)
    EXPECT_EQ(seen[i], labels.plane.data[i] || labels.hv.data[i] ? 1 : 0);
}

TEST_F(Exchange, VoxelsAreUprightAndHaveTheMajorityLabelOfTheirPoints) {
  labels = empty_labels(grid, kHash);
  for (std::size_t i = 0; i < grid.pixels(); ++i) {
    if (!grid.measured[i]) continue;
    const bool right = grid.points[i].x() > 0;
    labels.plane.data[i] = right ? 2 : 1;
    labels.hv.data[i] = right ? 2 : 1;
  }
  const auto paths =
      write_labeled(dir / "frame", LabelFormat::voxels, points_of_labels(labels, grid), 0.05);
  const PointSet voxels = io::read_cloud_file(paths.at(0));
  EXPECT_LT(voxels.points.size(), grid.measured_count);
  const Pose T_sensor_world = planes::world_from_gravity(grid.gravity.direction, true).inverse();
  for (std::size_t i = 0; i < voxels.points.size(); ++i) {
    const double x = (T_sensor_world * voxels.points[i].cast<double>()).x();
    EXPECT_EQ(voxels.instance[i], voxels.label[i]);
    if (std::abs(x) > 0.1) {
      EXPECT_EQ(voxels.label[i], x > 0 ? 2 : 1);
    }
  }
  expect_refused([&] { read_labeled(paths[0], LabelFormat::voxels); }, "but not read");
}

TEST_F(Exchange, LabelsOfAnotherFrameAreRejected) {
  const LabelGrid other = random_grid(random);
  const LabelGrid larger = random_grid(random, 40, 30);
  const LabeledPoints points = points_of_labels(labels, grid);
  const auto onto = [&](const LabeledPoints& p, const LabelGrid& g) {
    return [&p, &g] { labels_of_points(p, g, kHash, "x.ply"); };
  };
  expect_refused(onto(points, larger),
                 "x.ply: labels for 31x22 pixels, but the frame's depth image is 40x30");
  expect_refused(onto(points, other), "these labels are for a different frame");
  LabeledPoints bare = points;
  bare.pixel.clear();
  bare.points.clear();
  bare.width = bare.height = 0;
  expect_refused(onto(bare, larger), "points; expected");
  LabeledPoints twice = points;
  twice.pixel[5] = twice.pixel[4];
  expect_refused(onto(twice, grid), "appears twice");
  LabeledPoints outside = points;
  outside.width = 0;
  outside.pixel[5] = {31, 2};
  expect_refused(onto(outside, grid), "pixel (31, 2) is outside the frame's 31x22 depth image");
}

TEST_F(Exchange, RotatedPointsKeepTheirLabels) {
  LabeledPoints points = points_of_labels(labels, grid);
  for (Vec3f& point : points.points) point = points.T_world_sensor.cast<float>() * point;
  points.pixel.clear();
  expect_same_pixels(labels_of_points(points, grid, kHash, "x"), labels);
}

TEST_F(Exchange, ListsOfAllPixelsAreAccepted) {
  LabeledPoints points;
  points.instance.assign(labels.plane.data.begin(), labels.plane.data.end());
  points.label = labels.hv.data;
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (!grid.measured[i]) points.instance[i] = 3;  // pixels without depth have no label
  expect_same_pixels(labels_of_points(points, grid, kHash, "x"), labels);
}

TEST_F(Exchange, AFormatReportsMissingData) {
  LabeledPoints points;
  points.instance = {1, 2, 2};
  expect_refused([&] { write_labeled(dir / "a", LabelFormat::ply, points); },
                 "ply requires coordinates");
  expect_refused([&] { write_labeled(dir / "a", LabelFormat::coco, points); },
                 "coco requires pixels and the depth image's size");
  expect_refused([&] { parse_label_format("kiti"); }, "expected one of evops, ply, pcd, kitti");
  expect_refused([&] { label_format_of("a.txt"); },
                 "a.txt: unknown extension; expected a name that ends in .npy");
  expect_refused([&] { write_labeled(dir / "none/a", LabelFormat::evops, points); },
                 "none/a.npy: cannot be written");
}

using Files = std::vector<std::pair<std::string, std::string>>;  // name, bytes

void write_text(const std::filesystem::path& path, const std::string& text) {
  write_file_bytes(path,
                   std::span(reinterpret_cast<const unsigned char*>(text.data()), text.size()));
}

std::string npy(const std::string& header, const std::string& data, char major = 1) {
  const auto length = static_cast<unsigned>(header.size());
  std::string text = "\x93NUMPY";
  text += major;
  text += '\0';
  for (int i = 0; i < (major == 1 ? 2 : 4); ++i) text += static_cast<char>(length >> (8 * i) & 255);
  return text + header + data;
}

std::string npy_of(const std::string& type, const std::string& shape, const std::string& data) {
  return npy("{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + shape + "), }\n",
             data);
}

template <typename T>
std::string raw(std::initializer_list<T> values) {
  std::string bytes;
  for (const T value : values) bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
  return bytes;
}

struct ExchangeDamage : Exchange {
  std::vector<std::int32_t> ids(const std::string& file) {
    write_text(dir / "x.npy", file);
    return read_labeled(dir / "x.npy", LabelFormat::evops).instance;
  }
  void expect_bad(const std::string& name, const std::string& file, const std::string& part) {
    write_text(dir / name, file);
    const auto read = [&] { read_labeled(dir / name, label_format_of(dir / name)); };
    expect_refused(read, part);
    expect_refused(read, (dir / name).stem().string());
  }
};

TEST_F(ExchangeDamage, ArraysOfAnyIntegerTypeAreRead) {
  const std::vector<std::int32_t> expected = {1, 0, 7};
  EXPECT_EQ(ids(npy_of("<f8", "3,", raw<double>({1, 0, 7}))), expected);
  EXPECT_EQ(ids(npy_of("<f4", "3", raw<float>({1, 0, 7}))), expected);
  EXPECT_EQ(ids(npy_of("|u1", "3L,", raw<char>({1, 0, 7}))), expected);
  EXPECT_EQ(ids(npy_of("<i8", "3,", raw<std::int64_t>({1, 0, 7}))), expected);
  EXPECT_EQ(ids(npy_of(">u2", "3,", std::string("\0\1\0\0\0\7", 6))), expected);
  EXPECT_EQ(ids(npy("{\"shape\":(3,),\"descr\":\"=i2\",\"fortran_order\":True}",
                    raw<short>({1, 0, 7}), 2)),
            expected);
}

TEST_F(ExchangeDamage, ArraysThatAreNotPlaneIdsAreRejected) {
  expect_bad("a.npy", "", "truncated within its header");
  expect_bad("a.npy", "not NumPy at all", "not an NPY file");
  expect_bad("a.npy", npy("{}", "", 3), "NPY version 3.0; expected 1.0 or 2.0");
  expect_bad("a.npy", npy("{'descr': '<i4'", ""), "its header is damaged");
  expect_bad("a.npy", npy("{'descr': '<i4', }", ""), "lacks descr, fortran_order, or shape");
  expect_bad("a.npy", npy("{'descr': [('x', '<f4')], }", ""), "expected a string");
  expect_bad("a.npy", npy_of("<c8", "1,", "12345678"), "\"<c8\"; expected whole numbers");
  expect_bad("a.npy", npy_of("<i4", "3,", "12345678"), "declares 12 bytes of values, but 8 follow");
  expect_bad("a.npy", npy_of("<i4", "4611686018427387904,", ""), "declares too many bytes");
  expect_bad("a.npy", npy_of("<i4", "99999999999999999999999,", ""), "damaged shape");
  expect_bad("a.npy", npy_of("<i4", "2, 1", "12345678"), "2 dimensions; expected one plane id");
  expect_bad("a.npy", npy_of("<f8", "2,", raw<double>({1, 1.5})), "1.5 at index 1");
  expect_bad("a.npy", npy_of("<f8", "1,", raw<double>({NAN})), "nan at index 0");
  expect_bad("a.npy", npy_of("<i4", "1,", raw<int>({-1})),
             "-1 at index 0; expected a whole number");
  expect_bad("a.npy", npy_of("<i4", "1,", raw<int>({65536})), "65536 at index 0");
  expect_bad("a.npy", npy_of("|u1", "33554433,", std::string(33554433, '\0')),
             "33554433 points; expected at most 33554432");
}

TEST_F(ExchangeDamage, InconsistentKittiFilesAreRejected) {
  write_text(dir / "k.bin", std::string(32, '\0'));
  expect_bad("k.label", std::string(7, '\0'), "k.label: 7 bytes; expected a multiple of 4");
  expect_bad("k.label", std::string(4, '\0'), "labels for 1 points");
  expect_bad("k.label", raw<unsigned>({1, 40}), "class 40 at index 1; expected 0 (unknown)");
  write_text(dir / "k.bin", std::string(30, '\0'));
  expect_bad("k.label", std::string(8, '\0'), "k.bin: 30 bytes");
  write_text(dir / "k.bin", "");
  expect_bad("k.label", std::string(8, '\0'), "k.bin: is empty; expected 16 bytes for each of 2");
  std::filesystem::remove(dir / "k.bin");
  write_text(dir / "k.label", raw<unsigned>({7 << 16 | 2}));
  EXPECT_EQ(read_labeled(dir / "k.label", LabelFormat::kitti).instance.at(0), 7);
  expect_refused([&] { read_labeled(dir / "none.bin", LabelFormat::kitti); }, "none.label");
}

TEST_F(ExchangeDamage, CloudsWithoutPlaneIdsAreRejected) {
  const auto ply = [](const std::string& type, const std::string& value) {
    return "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
           "property float z\nproperty " +
           type + "\nend_header\n1 2 3 " + value + "\n";
  };
  expect_bad("c.ply", ply("float intensity", "1"), "no \"instance\" field");
  expect_bad("c.ply", ply("float instance", "0.5"), "plane id: 0.5 at index 0");
  expect_bad("c.ply", ply("int instance", "70000"), "70000 at index 0");
  expect_bad("c.ply", "ply\n", "c.ply");
}

TEST_F(ExchangeDamage, InconsistentCocoFilesAreRejected) {
  const auto coco = [](const std::string& segmentation, const std::string& rest = "") {
    return R"({"images":[{"id":1,"width":4,"height":3}],"categories":[{"id":1,"name":"h"}],)"
           R"("annotations":[{"image_id":1,"category_id":1,"segmentation":)" +
           segmentation + rest + "}]}";
  };
  expect_bad("c.json", "{", "not a COCO file");
  expect_bad("c.json", "{}", "has no \"images\"");
  expect_bad("c.json", R"({"images":[]})", "0 images; expected one");
  expect_bad("c.json", R"({"images":[{"id":1,"width":-4,"height":3}]})",
             "images[0].width is -4; expected a whole number from 1");
  expect_bad("c.json", R"({"images":[{"id":1,"width":60000,"height":60000}]})",
             "3600000000 points");
  expect_bad("c.json",
             R"({"images":[{"id":1,"width":4,"height":3}],"categories":[{"name":"cat"}]})",
             "categories[0].name is \"cat\"; expected one of h, v, unknown, ignore");
  expect_bad("c.json", coco(R"({"size":[4,3],"counts":[12]})"),
             "annotations[0].segmentation.size is [4,3]; expected [3,4]");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":[2,99]})"),
             "counts is [2,99]; expected runs that cover 12 pixels");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":[2,3]})"), "12 pixels (found 5)");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":[-2]})"), "annotations[0]");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":[4294967308]})"), "counts[0] is 4294967308");
  expect_bad("c.json", coco("[[0,0,1e300,0,1,1]]"), "segmentation[0] is [0,0,1e+300");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":"o"})"),
             "counts is \"o\"; expected a compressed mask");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":[12]})", R"(,"plane":{"id":70000})"),
             "plane.id is 70000; expected a whole number from 0 to 65535");
}

TEST_F(ExchangeDamage, CocoMasksOfOtherToolsAreRead) {
  // Two annotations without planes: a polygon over the upper left 2x2 pixels, and the lower right
  // pixel in pycocotools' compressed form of the counts 11, 1.
  write_text(dir / "c.json",
             R"({"images":[{"id":"a","width":4,"height":3}],)"
             R"("categories":[{"id":7,"name":"h"},{"id":9,"name":"v"}],"annotations":[)"
             R"({"image_id":"a","category_id":7,"segmentation":[[0,0,2,0,2,2,0,2]]},)"
             R"({"image_id":"a","category_id":9,"segmentation":{"size":[3,4],"counts":";1"}}]})");
  const LabeledPoints points = read_labeled(dir / "c.json", LabelFormat::coco);
  EXPECT_EQ(points.instance, (std::vector<std::int32_t>{1, 1, 1, 1, 2}));
  EXPECT_EQ(points.label, (std::vector<std::uint8_t>{1, 1, 1, 1, 2}));
  EXPECT_EQ(points.pixel, (std::vector<DepthPixel>{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {3, 2}}));
}

TEST(CocoMask, CompressedCountsFollowTheirPublishedDefinition) {
  // A copy of rleToString of pycocotools.
  const auto compress = [](const std::vector<std::uint64_t>& counts) {
    std::string text;
    for (std::size_t i = 0; i < counts.size(); ++i) {
      auto x = static_cast<long>(counts[i]);
      if (i > 2) x -= static_cast<long>(counts[i - 2]);
      for (bool more = true; more;) {
        char c = static_cast<char>(x & 0x1f);
        x >>= 5;
        more = (c & 0x10) ? x != -1 : x != 0;
        if (more) c = static_cast<char>(c | 0x20);
        text += static_cast<char>(c + 48);
      }
    }
    return text;
  };
  Random random(1);
  for (int round = 0; round < 200; ++round) {
    std::vector<std::uint64_t> counts(random.integer(1, 30));
    for (auto& count : counts) count = random.integer(0, random.integer(0, 1) ? 20 : 300000);
    EXPECT_EQ(counts_of_text(compress(counts)), counts);
  }
}

TEST_F(ExchangeDamage, AnInvalidOrIncompleteArchiveIsRejected) {
  expect_bad("a.npz", "PK no zip", "not a readable NPZ");
  expect_bad("a.npz", "", "no \"instance\" array");
}

TEST_F(ExchangeDamage, DamagedFilesGiveAnErrorOfOneLineOrConsistentLabels) {
  for (const LabelFormat format : label_formats(true)) {
    const auto path = write_labeled(dir / "frame", format, points_of_labels(labels, grid)).back();
    const std::string whole = test::file_text(path);
    for (int round = 0; round < 100; ++round) {
      SCOPED_TRACE(std::string(to_string(format)) + " " + std::to_string(round));
      std::string bytes = whole;
      if (round % 3 == 0) bytes.resize(random.integer(0, static_cast<int>(bytes.size())));
      for (int change = random.integer(0, 6); change > 0 && !bytes.empty(); --change) {
        // Headers and directories are at the ends.
        const int near = random.integer(0, std::min<int>(400, static_cast<int>(bytes.size()) - 1));
        const std::size_t at = random.integer(0, 1) ? near : bytes.size() - 1 - near;
        bytes[at] = static_cast<char>(random.integer(0, 255));
      }
      write_text(path, bytes);
      const std::string message = message_of([&] {
        const FrameLabels back = labels_of_points(read_labeled(path, format), grid, kHash, "x");
        EXPECT_EQ(back.plane.pixels(), grid.pixels());
      });
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
}

}  // namespace
}  // namespace planescope::labels
