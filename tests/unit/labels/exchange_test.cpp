#include "core/labels/exchange/exchange.hpp"

#include <nlohmann/json.hpp>

#include "core/io/cloud_files/cloud_file.hpp"
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
    for (int seed = 1; seed <= 12; ++seed) {
      SCOPED_TRACE(std::string(to_string(format)) + " " + std::to_string(seed));
      Random random(seed);
      const LabelGrid grid = random_grid(random);
      const FrameLabels labels = random_labels(grid, random);
      expect_same_pixels(there_and_back(labels, grid, format), labels);
      if (HasFatalFailure()) return;
    }
  }
}

TEST_F(Exchange, AFrameWithoutLabelsComesBackWithoutLabels) {
  Random random(2);
  const LabelGrid grid = random_grid(random);
  const FrameLabels labels = empty_labels(grid, kHash);
  for (const LabelFormat format : {LabelFormat::evops, LabelFormat::ply, LabelFormat::pcd,
                                   LabelFormat::kitti, LabelFormat::npz, LabelFormat::coco}) {
    SCOPED_TRACE(to_string(format));
    expect_same_pixels(there_and_back(labels, grid, format), labels);
  }
}

TEST_F(Exchange, EvopsBringsBackPlanesWithoutAClassWhereNobodyKnowsGravity) {
  Random random(3);
  LabelGrid grid = random_grid(random);
  grid.gravity.source = GravitySource::none;
  const FrameLabels back = there_and_back(random_labels(grid, random), grid, LabelFormat::evops);
  ASSERT_FALSE(back.planes.empty());
  for (const LabelPlane& plane : back.planes) EXPECT_EQ(plane.label, Label::unknown);
  for (const std::uint8_t hv : back.hv.data) EXPECT_TRUE(hv == 0 || hv == kHvIgnore);
}

TEST_F(Exchange, EvopsBringsBackPlanesAndTheirClassByTilt) {
  for (int seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(seed);
    Random random(seed);
    const LabelGrid grid = random_grid(random);
    const FrameLabels labels = random_labels(grid, random);
    const FrameLabels back = there_and_back(labels, grid, LabelFormat::evops);
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
  for (int f = 0; f <= static_cast<int>(LabelFormat::voxels); ++f) {
    const auto format = static_cast<LabelFormat>(f);
    Random random(3);
    const LabelGrid grid = random_grid(random);
    const LabelledPoints points = points_of_labels(random_labels(grid, random), grid);
    std::filesystem::create_directories(dir_ / "again");
    const auto first = write_labelled(dir_ / "frame", format, points);
    const auto again = write_labelled(dir_ / "again/frame", format, points);
    ASSERT_EQ(first.size(), again.size());
    for (std::size_t i = 0; i < first.size(); ++i)
      EXPECT_EQ(test::file_text(first[i]), test::file_text(again[i])) << first[i];
    EXPECT_FALSE(std::filesystem::exists(first[0].string() + ".part"));
  }
}

TEST_F(Exchange, SemanticKittiIsAsItsOwnToolsReadIt) {
  Random random(4);
  const LabelGrid grid = random_grid(random);
  const FrameLabels labels = random_labels(grid, random);
  const auto paths =
      write_labelled(dir_ / "000007", LabelFormat::kitti, points_of_labels(labels, grid));
  const test::SemanticKitti scan =
      test::read_semantic_kitti(dir_ / "000007.bin", dir_ / "000007.label");
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
  Random random(5);
  const LabelGrid grid = random_grid(random);
  const FrameLabels labels = random_labels(grid, random);
  write_labelled(dir_ / "labels", LabelFormat::evops, points_of_labels(labels, grid));
  const auto ids = test::load_npy_int32(dir_ / "labels.npy");
  ASSERT_EQ(ids.size(), grid.measured_count);
  std::size_t at = 0;
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (grid.measured[i]) {
      EXPECT_EQ(ids[at++], labels.plane.data[i] == kPlaneIgnore ? 0 : labels.plane.data[i]);
    }
}

TEST_F(Exchange, CocoHasAMaskABoxAndThePlaneOfEachAnnotation) {
  Random random(6);
  const LabelGrid grid = random_grid(random);
  const FrameLabels labels = random_labels(grid, random);
  write_labelled(dir_ / "000001", LabelFormat::coco, points_of_labels(labels, grid));
  const auto json = nlohmann::json::parse(test::file_text(dir_ / "000001.json"));
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

TEST_F(Exchange, VoxelsAreUprightAndHaveTheMajorityOfTheirPoints) {
  Random random(7);
  const LabelGrid grid = random_grid(random);
  FrameLabels labels = empty_labels(grid, kHash);
  for (std::size_t i = 0; i < grid.pixels(); ++i) {
    if (!grid.measured[i]) continue;
    const bool right = grid.points[i].x() > 0;
    labels.plane.data[i] = right ? 2 : 1;
    labels.hv.data[i] = right ? 2 : 1;
  }
  const auto paths =
      write_labelled(dir_ / "frame", LabelFormat::voxels, points_of_labels(labels, grid), 0.05);
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
  expect_refused([&] { read_labelled(paths[0], LabelFormat::voxels); }, "not read back");
}

TEST_F(Exchange, LabelsOfAnotherFrameAreRefused) {
  Random random(8);
  const LabelGrid grid = random_grid(random), other = random_grid(random);
  const LabelGrid larger = random_grid(random, 40, 30);
  const LabelledPoints points = points_of_labels(random_labels(grid, random), grid);
  const auto onto = [&](const LabelledPoints& p, const LabelGrid& g) {
    return [&p, &g] { labels_of_points(p, g, kHash, "x.ply"); };
  };
  expect_refused(onto(points, larger),
                 "x.ply: labels of a depth image of 31x22, the frame's is 40x30");
  expect_refused(onto(points, other), "labels of another frame");
  LabelledPoints bare = points;
  bare.pixel.clear();
  bare.points.clear();
  bare.width = bare.height = 0;
  expect_refused(onto(bare, larger), "points, expected");
  LabelledPoints twice = points;
  twice.pixel[5] = twice.pixel[4];
  expect_refused(onto(twice, grid), "is there twice");
  LabelledPoints outside = points;
  outside.width = 0;
  outside.pixel[5] = {31, 2};
  expect_refused(onto(outside, grid), "pixel (31, 2), the frame's depth is 31x22");
}

TEST_F(Exchange, PointsThatATurnSetUprightKeepTheirLabels) {
  Random random(9);
  const LabelGrid grid = random_grid(random);
  const FrameLabels labels = random_labels(grid, random);
  LabelledPoints points = points_of_labels(labels, grid);
  for (Vec3f& point : points.points) point = points.T_world_sensor.cast<float>() * point;
  points.pixel.clear();
  expect_same_pixels(labels_of_points(points, grid, kHash, "x"), labels);
}

TEST_F(Exchange, ListsOfAllPixelsAreTakenToo) {
  Random random(10);
  const LabelGrid grid = random_grid(random);
  const FrameLabels labels = random_labels(grid, random);
  LabelledPoints points;
  points.instance.assign(labels.plane.data.begin(), labels.plane.data.end());
  points.label = labels.hv.data;
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (!grid.measured[i]) points.instance[i] = 3;  // what has no depth keeps no label
  expect_same_pixels(labels_of_points(points, grid, kHash, "x"), labels);
}

TEST_F(Exchange, AFormatThatNeedsMoreThanThereIsSaysWhat) {
  LabelledPoints points;
  points.instance = {1, 2, 2};
  expect_refused([&] { write_labelled(dir_ / "a", LabelFormat::ply, points); },
                 "ply needs coordinates");
  expect_refused([&] { write_labelled(dir_ / "a", LabelFormat::coco, points); },
                 "coco needs pixels and the size");
  expect_refused([&] { parse_label_format("kiti"); }, "expected one of evops, ply, pcd, kitti");
  expect_refused([&] { label_format_of("a.txt"); }, "a.txt: expected a name that ends in .npy");
  expect_refused([&] { write_labelled(dir_ / "none/a", LabelFormat::evops, points); },
                 "none/a.npy: cannot be written");
}

}  // namespace
}  // namespace planescope::labels
