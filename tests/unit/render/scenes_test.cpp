// Tests of the draw lists of a frame's result.

#include "render/scenes.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "render/palette.hpp"
#include "render/scenes.hpp"
#include "support/image_octree.hpp"

namespace planescope::render {
namespace {

// A floor and a wall behind it, seen by a level depth camera half a meter above the floor.
Frame make_frame() {
  Frame frame;
  frame.depth = Image16(160, 120);
  frame.depth_unit_m = 0.001;
  frame.intrinsics = {160, 120, 100, 100, 80, 60};
  for (int v = 0; v < 120; ++v) {
    const double down = (v - 60) / 100.0;
    const double wall_m = 1.4, floor_m = down > 0 ? 0.5 / down : 1e9;
    for (int u = 0; u < 160; ++u)
      frame.depth.at(u, v) =
          static_cast<std::uint16_t>(std::lround(1000 * std::min(wall_m, floor_m)));
  }
  for (int v = 0; v < 10; ++v)
    for (int u = 0; u < 10; ++u) frame.depth.at(u, v) = 0;
  frame.depth.at(40, 20) = 3000;  // beyond the range
  return frame;
}

planes::FrameResult run_corner(const Frame& frame, planes::Profile profile) {
  planes::PipelineOptions options;
  options.gravity.mode = planes::GravityMode::fixed;
  options.gravity.direction = frame.is_cloud() ? Vec3d(0, 0, -1) : Vec3d(0, 1, 0);
  options.segment = planes::profile_options(profile);
  return planes::run_frame(frame, options, planes::make_pca_classifier().get());
}

const planes::FrameResult& corner() {
  static const planes::FrameResult result = run_corner(make_frame(), planes::Profile::refined);
  return result;
}

// Divided until nodes are pure, so that there are nodes of several cases.
const planes::FrameResult& divided_corner() {
  static const planes::FrameResult result = run_corner(make_frame(), planes::Profile::paper);
  return result;
}

bool same_hue(Rgba a, Rgba b) { return a.r == b.r && a.g == b.g && a.b == b.b; }

std::size_t boxes_of(const DrawList& list, planes::Case c, BoxStyle style) {
  std::size_t count = 0;
  for (const DrawBox& box : list.boxes)
    count += box.style == style && same_hue(box.color, case_color(c));
  return count;
}

TEST(SceneCases, EverySettledNodeHasABoxInItsCasesColor) {
  const DrawList list = scene_cases(divided_corner());
  const planes::SegmentCounts& counts = divided_corner().segmentation.counts;
  EXPECT_EQ(list.boxes.size(), counts.nodes_visited);
  EXPECT_GT(counts.nodes_per_case[4], 0u);
  EXPECT_EQ(boxes_of(list, planes::Case::IV, BoxStyle::outline), counts.nodes_per_case[4]);
}

TEST(SceneCases, ANodeFittedLabelByLabelIsMarked) {
  Frame cloud;
  PointSet& set = cloud.cloud.emplace();
  for (const Vec3f& p : divided_corner().cloud.points) set.points.push_back(p);
  const planes::FrameResult result = run_corner(cloud, planes::Profile::refined);
  ASSERT_TRUE(std::ranges::any_of(result.segmentation.octree.nodes, &planes::OctreeNode::by_label));
  EXPECT_GT(std::ranges::count(scene_cases(result).labels, "I*", &DrawLabel::text), 0);
}

/// For nodes and boxes in the coordinates that the octree divides.
void expect_boxes_hold_points_in_cells(const planes::Octree& octree, const DrawList& list) {
  ASSERT_EQ(list.boxes.size(), octree.nodes.size());
  for (std::size_t i = 0; i < octree.nodes.size(); ++i) {
    const planes::OctreeNode& node = octree.nodes[i];
    const auto limits = [&](auto begin, auto end) {
      Bounds bounds;
      for (auto p = begin; p != end; ++p) {
        const Vec3d at = p->template cast<double>();
        bounds.add(octree.image ? octree.image->from_local(at) : at);
      }
      return bounds;
    };
    const auto cell = planes::cell_corners(octree, node);
    const Bounds whole = limits(cell.begin(), cell.end());
    const Bounds drawn = limits(list.boxes[i].corners.begin(), list.boxes[i].corners.end());
    const Bounds own = limits(octree.points.begin() + node.begin, octree.points.begin() + node.end);
    const double rounding = octree.image ? 1e-4 : 1e-5;
    EXPECT_GE((drawn.min - whole.min).minCoeff(), -rounding);
    EXPECT_LE((drawn.max - whole.max).maxCoeff(), rounding);
    EXPECT_GE((own.min - drawn.min).minCoeff(), -rounding);
    EXPECT_LE((own.max - drawn.max).maxCoeff(), rounding);
  }
}

TEST(SceneCases, BoxesContainTheirPointsAndStayInTheirCells) {
  expect_boxes_hold_points_in_cells(divided_corner().segmentation.octree,
                                    scene_cases(divided_corner()));
}

TEST(SceneCases, NodesOfAnImageAreFrustumsThatContainTheirPoints) {
  planes::FrameResult result;
  result.segmentation.octree = test::image_octree();
  result.voxels.points = test::measured_points(result.segmentation.octree);
  const DrawList list = scene_cases(result);
  expect_boxes_hold_points_in_cells(result.segmentation.octree, list);
  const auto numerals = std::ranges::count(list.labels, "IV", &DrawLabel::text);
  EXPECT_GT(numerals, 3) << "on the large ones";
  EXPECT_LE(numerals, static_cast<std::ptrdiff_t>(kMostNumerals));
}

TEST(SceneCases, NodesAtFullDepthAreHatchedAndDividedOnesFaint) {
  planes::FrameResult result = divided_corner();
  for (planes::OctreeNode& node : result.segmentation.octree.nodes) {
    if (node.first_child >= 0 || node.at_max_depth) continue;
    node.decided = planes::Case::III;
    node.at_max_depth = true;
    node.by_label = false;
    break;
  }
  const DrawList list = scene_cases(result);
  EXPECT_GE(boxes_of(list, planes::Case::III, BoxStyle::hatched), 1u);
  const auto hatched = LegendEntry::Symbol::hatched_box;
  EXPECT_GT(std::ranges::count(list.legend, hatched, &LegendEntry::symbol), 0);
  EXPECT_LT(list.boxes[0].color.a, 100);  // the root
  EXPECT_EQ(list.boxes[0].style, BoxStyle::outline);
}

TEST(SceneCases, LargeNodesHaveNumeralsAndTheLegendHasCounts) {
  const DrawList list = scene_cases(divided_corner());
  std::size_t numerals = 0;
  for (const DrawLabel& label : list.labels) numerals += label.text.substr(0, 2) == "IV";
  EXPECT_GT(numerals, 0u);
  ASSERT_GE(list.legend.size(), 4u);
  for (int c = 1; c <= 4; ++c) {
    const std::string& text = list.legend[static_cast<std::size_t>(c - 1)].text;
    EXPECT_EQ(text.substr(0, text.find(' ')), planes::to_string(static_cast<planes::Case>(c)));
    const std::string count =
        std::to_string(divided_corner().segmentation.counts.nodes_per_case[c]);
    EXPECT_EQ(text.substr(text.rfind(' ') + 1), count);
  }
}

TEST(SceneLabels, EveryVoxelHasTheColorOfItsLabel) {
  const DrawList list = scene_labels(corner());
  ASSERT_EQ(list.points.size(), 1u);
  ASSERT_EQ(list.points[0].colors.size(), corner().classification.labels.size());
  for (std::size_t i = 0; i < list.points[0].colors.size(); ++i)
    EXPECT_EQ(list.points[0].colors[i], label_color(corner().classification.labels[i]));
}

TEST(ScenePlanes, OutlinesAreOnTheirPlanesAndArrowsFollowTheNormals) {
  const DrawList list = scene_planes(make_frame(), corner(), {});
  const auto& planes = corner().segmentation.planes;
  ASSERT_EQ(planes.size(), 2u);
  ASSERT_EQ(list.polygons.size(), 2u);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(list.polygons[k].id, static_cast<std::uint32_t>(planes[k].id));
    EXPECT_TRUE(same_hue(list.polygons[k].fill, plane_color(planes[k].id)));
    for (const Vec3f& outline : list.polygons[k].corners)
      EXPECT_NEAR(planes[k].fit.distance_m(outline.cast<double>()), 0, 1e-4);
    const Vec3d arrow = (list.arrows[k].to - list.arrows[k].from).cast<double>().normalized();
    EXPECT_NEAR(arrow.dot(planes[k].fit.normal), 1, 1e-4);
    EXPECT_EQ(list.labels[k].text, std::to_string(planes[k].id));
  }
}

TEST(ScenePlanes, ColorsAreTheRequestedOnes) {
  const int colors[] = {7, 4};
  const DrawList list = scene_planes(make_frame(), corner(), colors);
  for (std::size_t i = 0; i < list.points[0].colors.size(); ++i) {
    const std::int32_t id = corner().segmentation.plane_of[i];
    EXPECT_EQ(list.points[0].ids[i], static_cast<std::uint32_t>(std::max(id, 0)));
    if (id > 0) {
      EXPECT_EQ(list.points[0].colors[i], plane_color(colors[id - 1]));
    }
  }
}

TEST(SceneLeftovers, ShowsExactlyTheVoxelsWithoutAPlane) {
  planes::FrameResult result = corner();
  for (std::size_t i = 0; i < 5; ++i) result.segmentation.plane_of[10 * i] = 0;
  const DrawList list = scene_leftovers(result, {});
  const Rgba mark = list.legend[0].color;
  std::size_t marked = 0, expected = 0;
  for (std::size_t i = 0; i < result.segmentation.plane_of.size(); ++i) {
    marked += list.points[0].colors[i] == mark;
    expected += result.segmentation.plane_of[i] == 0;
  }
  EXPECT_EQ(marked, expected);
  EXPECT_GE(expected, 5u);
}

TEST(SceneMargins, VoxelColorsShowLabelAndMargin) {
  planes::FrameResult result = corner();
  planes::Classification& classified = result.classification;
  const std::size_t n = classified.labels.size();
  for (std::size_t i = 0; i < n; ++i) {
    classified.margins[i] = static_cast<float>(i) / static_cast<float>(n - 1);
    classified.labels[i] = i % 2 ? Label::h : Label::v;
  }
  classified.labels[0] = Label::unknown;
  const DrawList list = scene_margins(result);
  ASSERT_EQ(list.points[0].colors.size(), n);
  for (std::size_t i = 0; i < n; ++i)
    EXPECT_EQ(list.points[0].colors[i], margin_color(classified.labels[i], classified.margins[i]));
  EXPECT_EQ(list.points[0].colors[n - 1], label_color(classified.labels[n - 1]));
  EXPECT_NE(list.subtitle.find(std::to_string((n - 2) / 2) + " of " + std::to_string(n)),
            std::string::npos)
      << list.subtitle;
  EXPECT_EQ(list.legend.front().color, label_color(Label::h));
  EXPECT_EQ(list.legend.back().text, "unknown  1");
}

TEST(Scenes, GravityArrowPointsDownAndReportsEstimates) {
  planes::FrameResult result = corner();
  for (const GravitySource source : {GravitySource::option, GravitySource::estimate}) {
    result.gravity.source = source;
    const DrawList list = scene_labels(result);
    ASSERT_EQ(list.arrows.size(), 1u);
    const Vec3f arrow = list.arrows[0].to - list.arrows[0].from;
    EXPECT_NEAR(arrow.normalized().z(), -1, 1e-5);
    EXPECT_EQ(list.labels.back().text.find("estimate") != std::string::npos,
              source == GravitySource::estimate);
  }
  result.gravity.source = GravitySource::none;
  const DrawList list = scene_leftovers(result, {});
  EXPECT_TRUE(list.arrows.empty());
  ASSERT_FALSE(list.labels.empty());
  EXPECT_EQ(list.labels.back().text, "gravity unknown");
}

TEST(Scenes, EmptyFramesGiveEmptyPictures) {
  const planes::FrameResult nothing;
  EXPECT_TRUE(scene_labels(nothing).points[0].positions.empty());
  EXPECT_TRUE(scene_margins(nothing).points[0].positions.empty());
  EXPECT_TRUE(scene_cases(nothing).boxes.empty());
  EXPECT_TRUE(scene_planes({}, nothing, {}).polygons.empty());
  EXPECT_TRUE(scene_leftovers(nothing, {}).points[0].positions.empty());
  EXPECT_TRUE(scene_heights(nothing).points[0].positions.empty());
  EXPECT_TRUE(std::isfinite(frame_camera(nothing, 1.5).eye.norm()));
}

TEST(FrameCamera, ContainsTheKeptPointsAndHasTheSensorsDirection) {
  const double aspect = 4.0 / 3;
  const Camera camera = frame_camera(corner(), aspect);
  const Vec3d forward = (camera.target - camera.eye).normalized();
  const Vec3d right = forward.cross(camera.up).normalized();
  const Vec3d up = right.cross(forward);
  const double slope = std::tan(camera.fov_y_deg * M_PI / 360);
  double widest = 0;
  std::size_t outside = 0;
  for (const Vec3f& point : corner().voxels.points) {
    const Vec3d d = point.cast<double>() - camera.eye;
    const double depth = d.dot(forward);
    const double x = d.dot(right) / (depth * slope * aspect), y = d.dot(up) / (depth * slope);
    outside += depth < camera.near_m || std::abs(x) > 1 || std::abs(y) > 1;
    widest = std::max({widest, std::abs(x), std::abs(y)});
  }
  EXPECT_LE(outside, corner().voxels.points.size() / 50);
  EXPECT_GT(widest, 0.7);       // and they fill the picture
  EXPECT_GT(forward.x(), 0.5);  // the sensor looks along world x
  EXPECT_LT(forward.z(), -0.3);
}

TEST(SceneCloud, CroppedPointsAreNotDrawn) {
  Frame frame;
  frame.cloud.emplace();
  for (int i = 0; i < 40; ++i) {
    for (int j = 0; j < 40; ++j) {
      frame.cloud->points.emplace_back(0.5F + 0.02F * static_cast<float>(i),
                                       0.02F * static_cast<float>(j), 0.1F);
      frame.cloud->rgb.insert(frame.cloud->rgb.end(), {10, 20, 30});
    }
  }
  planes::PipelineOptions options;
  options.cloud.range_for_clouds = true;
  options.cloud.max_range_m = 1;
  const planes::FrameResult result =
      planes::run_frame(frame, options, planes::make_pca_classifier().get());
  ASSERT_LT(result.cloud.counts.kept, 1600u);
  EXPECT_EQ(scene_overlay(frame, result, {}).points[0].positions.size(), result.cloud.counts.kept);
  EXPECT_EQ(scene_heights(result).points[0].positions.size(), result.cloud.counts.kept);
}

TEST(PlaceOnPlane, IsTheCentroidOrADensePartOfThePlane) {
  std::vector<Vec3f> whole, ring;
  for (int x = -30; x <= 30; ++x)
    for (int y = -30; y <= 30; ++y) {
      const Vec3f p(0.02F * static_cast<float>(x), 0.02F * static_cast<float>(y), 0);
      whole.push_back(p);
      if (std::max(std::abs(x), std::abs(y)) > 20) ring.push_back(p);
    }
  const Vec3d centroid = Vec3d::Zero();
  EXPECT_EQ(place_on_plane(centroid, whole, 0.02F), Vec3f(0, 0, 0));
  const Vec3f beside = place_on_plane(centroid, ring, 0.02F);
  EXPECT_EQ(std::ranges::count(ring, beside), 1);
  const float off = beside.cwiseAbs().maxCoeff();
  EXPECT_GT(off, 0.02F * 22) << "at the edge of the hole";
  EXPECT_LT(off, 0.02F * 29) << "at its border";
}

}  // namespace
}  // namespace planescope::render
