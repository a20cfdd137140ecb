// Labels on the points of a cloud: its geometry, the tools, files and exchange.

#include <gtest/gtest.h>

#include <array>
#include <fstream>

#include "core/io/image/png.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/edit/selection.hpp"
#include "core/labels/exchange/exchange.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/labels/model/pixel_sets.hpp"
#include "core/labels/review/audit.hpp"
#include "core/labels/review/review.hpp"
#include "core/labels/store/store.hpp"
#include "core/labels/wand/wand.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "small_frames.hpp"
#include "support/label_drafts.hpp"
#include "support/refusal.hpp"
#include "support/small_clouds.hpp"
#include "support/temp_dir.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;
using test::stair_cloud;
using test::TrueCloud;

constexpr const char* kHash = "0123456789abcdef0123456789abcdef0123456789abcdef0123456789abcdef";

fs::path fresh(const std::string& name) {
  const fs::path dir = temp_dir() / "planescope_cloud_labels" / name;
  fs::remove_all(dir);
  return dir;
}

FrameLabels truth_of(const TrueCloud& cloud) {
  FrameLabels labels = empty_labels(cloud.grid, kHash);
  for (const int plane : {1, 2, 3, 4, 5})
    labels = painted(labels, cloud.grid, cloud.on(plane), {.plane = plane}, PaintMode::over);
  return labels;
}

/// Labels with only plane P1, on these points.
FrameLabels one_plane(const TrueCloud& cloud, const PixelSet& points) {
  return painted(empty_labels(cloud.grid, kHash), cloud.grid, points, {.plane = 1},
                 PaintMode::over);
}

std::optional<WandResult> wand(const TrueCloud& cloud,
                               const FrameLabels* labels,
                               const Vec3f& at,
                               const WandOptions& options = {}) {
  const std::uint32_t seeds[] = {cloud.at(at)};
  return grow_plane(cloud.grid, labels, seeds, options);
}

TEST(CloudGrid, MeasuresSpacingNoiseNormalsAndAreas) {
  const TrueCloud cloud = stair_cloud();
  const LabelGrid& grid = cloud.grid;
  EXPECT_TRUE(grid.is_cloud());
  EXPECT_EQ(grid.pixels(), cloud.plane_of.size());
  EXPECT_NEAR(grid.spacing_m, 0.02, 0.002);
  EXPECT_LT(grid.sigma_m[0], 0.002f);
  EXPECT_GT(std::abs(grid.normals[cloud.at({0.5f, 0.5f, 0})].z()), 0.98f);
  EXPECT_GT(std::abs(grid.normals[cloud.at({0.5f, 1, 0.1f})].y()), 0.95f);
  EXPECT_NEAR(grid.area_m2(cloud.on(1)), 1, 0.1);
}

TEST(CloudGrid, CoincidentPointsAreNeighborsAndShareTheirArea) {
  TrueCloud cloud = stair_cloud();
  PointSet& set = *cloud.frame.cloud;
  const std::size_t before = set.points.size();
  const auto once = set.points;  // a mesh contains each corner several times
  for (int times = 0; times < 5; ++times)
    set.points.insert(set.points.end(), once.begin(), once.end());
  const LabelGrid grid = make_label_grid(cloud.frame, test::down());
  EXPECT_NEAR(grid.spacing_m, 0.02, 0.002);
  PixelSet floor;
  for (std::uint32_t i = 0; i < grid.pixels(); ++i)
    if (cloud.plane_of[i % before] == 1) floor.push_back(i);
  EXPECT_NEAR(grid.area_m2(floor), 1, 0.1);
  const std::uint32_t seeds[] = {cloud.at({0.5f, 0.5f, 0})};
  const auto found = grow_plane(grid, nullptr, seeds, {});
  ASSERT_TRUE(found);
  EXPECT_GT(test::iou(found->pixels, floor), 0.97);
}

TEST(CloudGrid, InvalidPointsHaveNoNeighbors) {
  TrueCloud cloud = stair_cloud();
  cloud.frame.cloud->points[5] = Vec3f(0, 0, 0);
  cloud.frame.cloud->points[9] = Vec3f::Constant(std::nanf(""));
  const LabelGrid grid = make_label_grid(cloud.frame, test::down());
  EXPECT_EQ(grid.measured_count, grid.pixels() - 2);
  EXPECT_TRUE(grid.graph.around(5).empty());
  EXPECT_TRUE(grid.graph.around(9).empty());
}

TEST(CloudWand, FindsEachPlaneOfAStair) {
  const TrueCloud cloud = stair_cloud();
  const std::array<Vec3f, 5> clicks = {Vec3f(0.5f, 0.5f, 0), Vec3f(0.5f, 1, 0.1f),
                                       Vec3f(0.5f, 1.15f, 0.2f), Vec3f(0.5f, 1.3f, 0.3f),
                                       Vec3f(0.5f, 1.45f, 0.4f)};
  for (int plane = 1; plane <= 5; ++plane) {
    const auto found = wand(cloud, nullptr, clicks[plane - 1]);
    ASSERT_TRUE(found) << plane;
    EXPECT_GT(test::iou(found->pixels, cloud.on(plane)), plane % 2 == 1 ? 0.95 : 0.85) << plane;
    EXPECT_EQ(found->label, plane % 2 == 1 ? Label::h : Label::v) << plane;
  }
}

TEST(CloudWand, AllowsForTheNoiseOfTheCloud) {
  const TrueCloud cloud = stair_cloud(0.02);
  const auto found = wand(cloud, nullptr, {0.5f, 0.5f, 0});
  ASSERT_TRUE(found);
  EXPECT_GT(test::iou(found->pixels, cloud.on(1)), 0.9);
}

TEST(CloudWand, KeepsLabeledPointsAndStaysWithinTheLasso) {
  const TrueCloud cloud = stair_cloud();
  PixelSet left;
  for (const std::uint32_t i : cloud.on(1))
    if (cloud.grid.points[i].x() < 0.5f) left.push_back(i);
  const FrameLabels labels = one_plane(cloud, left);
  const auto found = wand(cloud, &labels, {0.8f, 0.5f, 0});
  ASSERT_TRUE(found);
  EXPECT_EQ(test::iou(found->pixels, left), 0);
  std::vector<std::uint8_t> within(cloud.grid.pixels(), 0);
  for (const std::uint32_t i : left) within[i] = 1;
  WandOptions bounded;
  bounded.within = within;
  const auto inside = wand(cloud, nullptr, {0.2f, 0.5f, 0}, bounded);
  ASSERT_TRUE(inside);
  EXPECT_GT(test::iou(inside->pixels, left), 0.97);
}

TEST(CloudWand, AnotherClickAddsASeparatePartOfThePlane) {
  const TrueCloud cloud =
      stair_cloud(0.001, [](const Vec3f& p) { return std::abs(p.x() - 0.5f) < 0.1f; });
  const std::uint32_t first = cloud.at({0.2f, 0.5f, 0}), second = cloud.at({0.8f, 0.5f, 0});
  const std::uint32_t one[] = {first}, both[] = {first, second};
  const auto half = grow_plane(cloud.grid, nullptr, one, {});
  const auto whole = grow_plane(cloud.grid, nullptr, both, {});
  ASSERT_TRUE(half && whole);
  EXPECT_LT(test::iou(half->pixels, cloud.on(1)), 0.6);
  EXPECT_GT(test::iou(whole->pixels, cloud.on(1)), 0.95);
  EXPECT_GT(whole->fragment_pixels[1], 100u);
}

TEST(CloudWand, ReportsWhyThereIsNoPlane) {
  TrueCloud cloud;
  Random random(3);
  cloud.frame.cloud.emplace();
  for (int i = 0; i < 2000; ++i)
    cloud.frame.cloud->points.emplace_back(static_cast<float>(random.uniform()),
                                           static_cast<float>(random.uniform()),
                                           static_cast<float>(random.uniform()));
  cloud.grid = make_label_grid(cloud.frame, test::down());
  std::string why;
  const std::uint32_t seeds[] = {10};
  EXPECT_FALSE(grow_plane(cloud.grid, nullptr, seeds, WandOptions{.tolerance_m = 0.002}, &why));
  EXPECT_EQ(why, "no plane there");
}

TEST(CloudFinish, AHoleIsFilledAndTheOutsideIsNot) {
  const TrueCloud cloud = stair_cloud();
  PixelSet ring;
  for (const std::uint32_t i : cloud.on(1)) {
    const Vec3f& p = cloud.grid.points[i];
    const float out = std::max(std::abs(p.x() - 0.5f), std::abs(p.y() - 0.5f));
    if (out < 0.4f && out > 0.1f) ring.push_back(i);
  }
  const FrameLabels labels = one_plane(cloud, ring);
  const Finish finish = fill_holes(labels, cloud.grid, 1, {});
  EXPECT_NEAR(static_cast<double>(finish.adds.size()), 100, 25);
  for (const std::uint32_t i : finish.adds) {
    const Vec3f& p = cloud.grid.points[i];
    EXPECT_LT(std::max(std::abs(p.x() - 0.5f), std::abs(p.y() - 0.5f)), 0.12f);
  }
}

TEST(CloudFinish, GrowsToTheBorderSmoothsAndDropsSpecks) {
  const TrueCloud cloud = stair_cloud();
  PixelSet start;
  for (const std::uint32_t i : cloud.on(1))
    if ((cloud.grid.points[i] - Vec3f(0.5f, 0.5f, 0)).norm() < 0.2f) start.push_back(i);
  FrameLabels labels = one_plane(cloud, start);
  labels = edited(labels, cloud.grid, finish_plane, cloud.grid, 1,
                  grow_to_border(labels, cloud.grid, 1, {}));
  EXPECT_GT(test::iou(pixels_of_plane(labels, 1), cloud.on(1)), 0.95);

  const std::uint32_t bite = cloud.at({0.5f, 0.3f, 0});
  const std::uint32_t bitten[] = {bite};
  labels = painted(labels, cloud.grid, bitten, {.plane = 1}, PaintMode::subtract);
  const Finish smooth = smooth_border(labels, cloud.grid, 1, {});
  EXPECT_TRUE(std::ranges::binary_search(smooth.adds, bite));

  const std::uint32_t speck[] = {cloud.at({0.5f, 1.45f, 0.4f})};
  labels = painted(labels, cloud.grid, speck, {.plane = 1}, PaintMode::over);
  const Finish specks = drop_specks(labels, cloud.grid, 1, 0.002);
  EXPECT_EQ(specks.takes, PixelSet(std::begin(speck), std::end(speck)));
}

TEST(CloudOperations, PartsBecomePlanesAndFragmentsAreCounted) {
  const TrueCloud cloud = stair_cloud();
  PixelSet both = cloud.on(3);
  const PixelSet upper = cloud.on(5);
  both.insert(both.end(), upper.begin(), upper.end());
  std::ranges::sort(both);
  const FrameLabels labels = one_plane(cloud, both);
  EXPECT_EQ(labels.planes[0].fragments, 2);
  const FrameLabels split = edited(labels, cloud.grid, split_by_parts, cloud.grid, 1, 0.01, 2);
  ASSERT_EQ(split.planes.size(), 2u);
  EXPECT_EQ(pixels_of_plane(split, 1).size() + pixels_of_plane(split, 2).size(), both.size());
  EXPECT_GT(split.planes[0].normal.z(), 0.99) << "normals of a cloud are on the upper side";
}

TEST(CloudSelection, VisibleOnlyExcludesPointsBelowTheSurface) {
  TrueCloud cloud = stair_cloud();
  const std::size_t floor = cloud.on(1).size();
  for (const std::uint32_t i : cloud.on(1))  // a ceiling below the floor
    cloud.frame.cloud->points.push_back(cloud.grid.points[i] - Vec3f(0, 0, 0.5f));
  const LabelGrid grid = make_label_grid(cloud.frame, test::down());
  SpaceView view = view_of_points(grid);  // from above: x, y in the picture, larger z is nearer
  view.clip_from_sensor << 1.6f, 0, 0, -0.8f, 0, 1.2f, 0, -0.95f, 0, 0, -0.5f, 0, 0, 0, 0, 1;
  view.width = view.height = 400;
  view.orthographic = true;
  view.px_per_m = 300;
  const SeenPoints seen = see(grid, view);
  DrawnShape all;
  all.kind = DrawnShape::Kind::area;
  all.path = {{0, 0}, {400, 0}, {400, 400}, {0, 400}};
  const SpaceSelection visible = points_in_space(seen, all, false);
  const SpaceSelection through = points_in_space(seen, all, true);
  EXPECT_EQ(through.pixels.size(), grid.pixels());
  EXPECT_GE(visible.hidden, floor * 95 / 100);
}

TEST(CloudReview, RegionsAreFoundAndThinOnesAreBoundaries) {
  const TrueCloud cloud = stair_cloud();
  const FrameLabels labels = truth_of(cloud);
  OtherLabels other = other_of(labels);
  for (const std::uint32_t i : cloud.on(3)) other.plane[i] = 0;
  for (const std::uint32_t i : cloud.on(1))
    if (cloud.grid.points[i].x() > 0.97f) other.plane[i] = 0;
  const auto found = find_disagreements(labels, other, cloud.grid);
  ASSERT_EQ(found.size(), 2u);
  EXPECT_EQ(found[0].kind, DisagreementKind::missed);
  EXPECT_EQ(found[0].label_plane, 3);
  EXPECT_NEAR(found[0].area_m2, 0.3, 0.06);
  EXPECT_EQ(found[1].kind, DisagreementKind::boundary);
}

TEST(CloudAudit, GoodLabelsHaveNoFindingsAndAnUnlabeledTreadIsReported) {
  const TrueCloud cloud = stair_cloud();
  FrameLabels labels = truth_of(cloud);
  EXPECT_TRUE(audit_labels(labels, cloud.grid).empty());
  labels = edited(labels, cloud.grid, remove_plane, 3);
  const auto findings = audit_labels(labels, cloud.grid);
  ASSERT_EQ(findings.size(), 1u);
  EXPECT_EQ(findings[0].kind, FindingKind::unlabeled);
}

TEST(CloudFiles, LabelsAreReadBackWithTheirOrigin) {
  TrueCloud cloud = stair_cloud();
  cloud.frame.cloud->origin = Vec3d(500000, 200000, 50);
  cloud.grid = make_label_grid(cloud.frame, test::down());
  const FrameLabels labels = truth_of(cloud);
  const fs::path dir = fresh("files");
  write_frame_labels(dir, 0, labels);
  const auto read = read_frame_labels(dir, 0, {kHash, cloud.grid.pixels()});
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->is_cloud());
  EXPECT_EQ(read->origin, cloud.frame.cloud->origin);
  EXPECT_EQ(read->plane.data, labels.plane.data);
  EXPECT_EQ(read->hv.data, labels.hv.data);
  EXPECT_EQ(read->planes, labels.planes);
  const io::PngInfo image = io::png_info(dir / "000000.plane.png");
  EXPECT_EQ(image.width, kPointsInRow);
  const auto truth = frame_truth(cloud.frame, dir, kHash);
  ASSERT_TRUE(truth);
  EXPECT_EQ(truth->values.instance[cloud.on(1)[0]], 1);
  LabelStore store(dir, {"ann", {}});
  EXPECT_EQ(store.open(0, empty_labels(cloud.grid, kHash))->origin, cloud.frame.cloud->origin);
}

TEST(CloudFiles, LabelsOfAnotherCloudAreRejectedWithBothNumbersOfPoints) {
  const TrueCloud cloud = stair_cloud();
  const fs::path dir = fresh("other");
  write_frame_labels(dir, 0, truth_of(cloud));
  TrueCloud other = stair_cloud();
  other.frame.cloud->points.pop_back();
  const std::size_t had = cloud.grid.pixels();
  const std::string expected = "000000.json: created for a cloud with " + std::to_string(had) +
                               " points, but this recording's frame has " + std::to_string(had - 1);
  expect_refused([&] { frame_truth(other.frame, dir, kHash); }, expected);
  const LabelGrid grid = make_label_grid(other.frame, test::down());
  LabelStore store(dir, {"ann", {}});
  expect_refused([&] { store.open(0, empty_labels(grid, kHash)); }, expected);
  expect_refused([&] { read_frame_labels(dir, 0, std::string(64, 'b')); },
                 "a cloud with " + std::to_string(had) + " points with SHA-256");
  const Frame depth = test::frame_of(40, 30, [](int, int) { return 1.0; });
  expect_refused([&] { frame_truth(depth, dir, kHash); },
                 "are for a cloud, but the frame is a depth");
}

TEST(CloudFiles, ImagesOfTheWrongSizeOrWithLabelsBeyondTheLastPointAreRejected) {
  const TrueCloud cloud = stair_cloud();
  const fs::path dir = fresh("damaged");
  const FrameLabels labels = truth_of(cloud);
  write_frame_labels(dir, 0, labels);
  Image16 image = io::read_png_16(dir / "000000.plane.png");
  image.data.back() = 1;
  io::write_png(dir / "000000.plane.png", image);
  expect_refused([&] { read_frame_labels(dir, 0, kHash); }, "after the last of");
  io::write_png(dir / "000000.plane.png", Image16(17, 4));
  expect_refused([&] { read_frame_labels(dir, 0, kHash); }, "17x4 pixels, but its frame has 1024x");
}

TEST(CloudExchange, EveryPointHasItsLabelInTheOrderOfTheCloud) {
  TrueCloud cloud = stair_cloud();
  cloud.frame.cloud->points[7] = Vec3f::Constant(std::nanf(""));
  cloud.grid = make_label_grid(cloud.frame, test::down());
  const FrameLabels labels = truth_of(cloud);
  const fs::path dir = fresh("exchange");
  fs::create_directories(dir);
  for (const LabelFormat format : {LabelFormat::evops, LabelFormat::ply, LabelFormat::pcd,
                                   LabelFormat::kitti, LabelFormat::npz}) {
    SCOPED_TRACE(to_string(format));
    const LabeledPoints points = points_of_labels(labels, cloud.grid);
    EXPECT_EQ(points.size(), cloud.grid.pixels());
    const auto paths = write_labeled(dir / to_string(format), format, points);
    const FrameLabels back = labels_of_points(read_labeled(paths.back(), format), cloud.grid, kHash,
                                              paths.back().string());
    EXPECT_EQ(back.plane.data, labels.plane.data);
    EXPECT_EQ(back.hv.data, labels.hv.data);
  }
  EXPECT_EQ(fs::file_size(dir / "kitti.label"), 4 * cloud.grid.pixels());
  expect_refused(
      [&] { write_labeled(dir / "coco", LabelFormat::coco, points_of_labels(labels, cloud.grid)); },
      "coco requires pixels");
}

TEST(CloudExchange, LabelsOfAnotherNumberOfPointsOrPixelsAreRejected) {
  const TrueCloud cloud = stair_cloud();
  LabeledPoints fewer;
  fewer.instance.assign(12, 1);
  expect_refused([&] { labels_of_points(fewer, cloud.grid, kHash, "a.label"); },
                 "a.label: labels for 12 points, but the frame's cloud has " +
                     std::to_string(cloud.grid.pixels()));
  const LabelGrid depth = test::wall_grid();
  const LabeledPoints pixels = points_of_labels(empty_labels(depth, kHash), depth);
  expect_refused([&] { labels_of_points(pixels, cloud.grid, kHash, "a.ply"); },
                 "labels for a depth image, but the frame is a cloud");
}

}  // namespace
}  // namespace planescope::labels
