// Nothing that a damaged or hostile file says is trusted: each ends in one line that names it.

#include "core/labels/exchange/formats.hpp"
#include "core/model/file_bytes.hpp"
#include "exchange_fixture.hpp"
#include "support/label_readers.hpp"

namespace planescope::labels {
namespace {

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

class ExchangeDamage : public Exchange {
 protected:
  std::vector<std::int32_t> ids(const std::string& file) {
    write_text(dir_ / "x.npy", file);
    return read_labelled(dir_ / "x.npy", LabelFormat::evops).instance;
  }
  void expect_bad(const std::string& name, const std::string& file, const std::string& part) {
    write_text(dir_ / name, file);
    const auto read = [&] { read_labelled(dir_ / name, label_format_of(dir_ / name)); };
    expect_refused(read, part);
    expect_refused(read, (dir_ / name).stem().string());
  }
};

TEST_F(ExchangeDamage, ArraysOfAnyKindOfWholeNumberAreRead) {
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

TEST_F(ExchangeDamage, ArraysThatAreNoPlaneIdsAreRefused) {
  expect_bad("a.npy", "", "cut within its header");
  expect_bad("a.npy", "not NumPy at all", "not an NPY file");
  expect_bad("a.npy", npy("{}", "", 3), "NPY version 3.0, expected 1.0 or 2.0");
  expect_bad("a.npy", npy("{'descr': '<i4'", ""), "its header is damaged");
  expect_bad("a.npy", npy("{'descr': '<i4', }", ""), "lacks descr, fortran_order or shape");
  expect_bad("a.npy", npy("{'descr': [('x', '<f4')], }", ""), "expected a string");
  expect_bad("a.npy", npy_of("<c8", "1,", "12345678"), "\"<c8\", expected whole numbers");
  expect_bad("a.npy", npy_of("<i4", "3,", "12345678"), "promises 12 bytes of values, 8 follow");
  expect_bad("a.npy", npy_of("<i4", "4611686018427387904,", ""),
             "more bytes than there are numbers");
  expect_bad("a.npy", npy_of("<i4", "99999999999999999999999,", ""), "damaged shape");
  expect_bad("a.npy", npy_of("<i4", "2, 1", "12345678"), "2 dimensions, expected one plane id");
  expect_bad("a.npy", npy_of("<f8", "2,", raw<double>({1, 1.5})), "1.5 at place 1");
  expect_bad("a.npy", npy_of("<f8", "1,", raw<double>({NAN})), "nan at place 0");
  expect_bad("a.npy", npy_of("<i4", "1,", raw<int>({-1})),
             "-1 at place 0, expected a whole number");
  expect_bad("a.npy", npy_of("<i4", "1,", raw<int>({65536})), "65536 at place 0");
  expect_bad("a.npy", npy_of("|u1", "33554433,", std::string(33554433, '\0')),
             "33554433 points, expected at most 33554432");
}

TEST_F(ExchangeDamage, KittiFilesThatDoNotGoTogetherAreRefused) {
  write_text(dir_ / "k.bin", std::string(32, '\0'));
  expect_bad("k.label", std::string(7, '\0'), "k.label: 7 bytes, expected a multiple of 4");
  expect_bad("k.label", std::string(4, '\0'), "labels of 1 points");
  expect_bad("k.label", raw<unsigned>({1, 40}), "class 40 at place 1, expected 0 (unknown)");
  write_text(dir_ / "k.bin", std::string(30, '\0'));
  expect_bad("k.label", std::string(8, '\0'), "k.bin: 30 bytes");
  std::filesystem::remove(dir_ / "k.bin");
  write_text(dir_ / "k.label", raw<unsigned>({7 << 16 | 2}));
  EXPECT_EQ(read_labelled(dir_ / "k.label", LabelFormat::kitti).instance.at(0), 7);
  expect_refused([&] { read_labelled(dir_ / "none.bin", LabelFormat::kitti); }, "none.label");
}

TEST_F(ExchangeDamage, CloudsWithoutPlaneIdsAreRefused) {
  const auto ply = [](const std::string& type, const std::string& value) {
    return "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
           "property float z\nproperty " +
           type + "\nend_header\n1 2 3 " + value + "\n";
  };
  expect_bad("c.ply", ply("float intensity", "1"), "no field \"instance\"");
  expect_bad("c.ply", ply("float instance", "0.5"), "plane id: 0.5 at place 0");
  expect_bad("c.ply", ply("int instance", "70000"), "70000 at place 0");
  expect_bad("c.ply", "ply\n", "c.ply");
}

TEST_F(ExchangeDamage, CocoFilesThatContradictThemselvesAreRefused) {
  const auto coco = [](const std::string& segmentation, const std::string& rest = "") {
    return R"({"images":[{"id":1,"width":4,"height":3}],"categories":[{"id":1,"name":"h"}],)"
           R"("annotations":[{"image_id":1,"category_id":1,"segmentation":)" +
           segmentation + rest + "}]}";
  };
  expect_bad("c.json", "{", "not a COCO file");
  expect_bad("c.json", "{}", "not a COCO file");
  expect_bad("c.json", R"({"images":[]})", "0 images, expected one");
  expect_bad("c.json", R"({"images":[{"id":1,"width":-4,"height":3}]})", "width: -4 at place 0");
  expect_bad("c.json", R"({"images":[{"id":1,"width":60000,"height":60000}]})",
             "3600000000 points");
  expect_bad("c.json",
             R"({"images":[{"id":1,"width":4,"height":3}],"categories":[{"name":"cat"}]})",
             "category \"cat\", expected h, v, unknown or ignore");
  expect_bad("c.json", coco(R"({"size":[4,3],"counts":[12]})"), "annotation 0: a mask of 3x4");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":[2,99]})"), "runs past the 12 pixels");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":[2,3]})"), "covers 5 pixels");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":[-2]})"), "annotation 0");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":[4294967308]})"), "annotation 0: counts");
  expect_bad("c.json", coco("[[0,0,1e300,0,1,1]]"), "runs far out of the image");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":"o"})"), "compressed mask is damaged");
  expect_bad("c.json", coco(R"({"size":[3,4],"counts":[12]})", R"(,"plane":{"id":70000})"),
             "plane id: 70000");
}

TEST_F(ExchangeDamage, CocoMasksOfOtherToolsAreRead) {
  // Two annotations without planes: a polygon over the upper left 2x2 pixels, and the lower right
  // pixel as pycocotools compresses the counts 11, 1.
  write_text(dir_ / "c.json",
             R"({"images":[{"id":"a","width":4,"height":3}],)"
             R"("categories":[{"id":7,"name":"h"},{"id":9,"name":"v"}],"annotations":[)"
             R"({"image_id":"a","category_id":7,"segmentation":[[0,0,2,0,2,2,0,2]]},)"
             R"({"image_id":"a","category_id":9,"segmentation":{"size":[3,4],"counts":";1"}}]})");
  const LabelledPoints points = read_labelled(dir_ / "c.json", LabelFormat::coco);
  EXPECT_EQ(points.instance, (std::vector<std::int32_t>{1, 1, 1, 1, 2}));
  EXPECT_EQ(points.label, (std::vector<std::uint8_t>{1, 1, 1, 1, 2}));
  EXPECT_EQ(points.pixel, (std::vector<DepthPixel>{{0, 0}, {1, 0}, {0, 1}, {1, 1}, {3, 2}}));
}

TEST(CocoMask, CompressedCountsAreThoseOfTheirPublishedDefinition) {
  // rleToString of pycocotools, written out again.
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
    EXPECT_EQ(counts_of_text(compress(counts), "x"), counts);
  }
}

TEST_F(ExchangeDamage, AnArchiveThatIsNoneOrLacksItsIdsIsRefused) {
  expect_bad("a.npz", "PK no zip", "not a readable NPZ");
  expect_bad("a.npz", "", "has no array \"instance\"");
}

TEST_F(ExchangeDamage, CutAndChangedFilesEndInOneLineOrInLabelsThatHoldTogether) {
  Random random(11);
  const LabelGrid grid = random_grid(random);
  const FrameLabels labels = random_labels(grid, random);
  for (int f = 0; f < static_cast<int>(LabelFormat::voxels); ++f) {
    const auto format = static_cast<LabelFormat>(f);
    const auto path = write_labelled(dir_ / "frame", format, points_of_labels(labels, grid)).back();
    const std::string whole = test::file_text(path);
    for (int round = 0; round < 100; ++round) {
      SCOPED_TRACE(std::string(to_string(format)) + " " + std::to_string(round));
      std::string bytes = whole;
      if (round % 3 == 0) bytes.resize(random.integer(0, static_cast<int>(bytes.size())));
      for (int change = random.integer(0, 6); change > 0 && !bytes.empty(); --change) {
        // Headers and directories stand at the ends.
        const int near = random.integer(0, std::min<int>(400, static_cast<int>(bytes.size()) - 1));
        const std::size_t at = random.integer(0, 1) ? near : bytes.size() - 1 - near;
        bytes[at] = static_cast<char>(random.integer(0, 255));
      }
      write_text(path, bytes);
      const std::string message = message_of([&] {
        const FrameLabels back = labels_of_points(read_labelled(path, format), grid, kHash, "x");
        EXPECT_EQ(back.plane.pixels(), grid.pixels());
      });
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  }
}

}  // namespace
}  // namespace planescope::labels
