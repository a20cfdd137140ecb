// The points of a frame: by h / v, by margin, left over, by height.

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "render/palette.hpp"
#include "render/scene_parts.hpp"
#include "render/scenes.hpp"

namespace planescope::render {
namespace {

constexpr float kUnsure = 0.5F;              // margins below this are told as unsure
constexpr Rgba kLeftOver{213, 60, 20, 255};  // where left over is what the picture is about

}  // namespace

DrawList scene_labels(const planes::FrameResult& result) {
  using Mark = LegendEntry::Mark;
  DrawList list;
  DrawPoints points = voxel_points(result.voxels);
  std::size_t count[3] = {};
  for (const Label label : result.classification.labels) {
    points.colors.push_back(label_color(label));
    ++count[static_cast<int>(label)];
  }
  const std::size_t n = points.positions.size();
  list.points.push_back(std::move(points));
  add_gravity(result, list);
  list.title = "Pointwise classification";
  list.subtitle = std::to_string(n) + " voxels by the tilt of the surface around them";
  const auto entry = [&](Label label, const std::string& name) {
    const std::size_t k = count[static_cast<int>(label)];
    list.legend.push_back({Mark::dot, label_color(label),
                           name + "  " + std::to_string(k) + "  (" + percent(k, n) + ")"});
  };
  entry(Label::h, "h  level, up to 45\u00b0");
  entry(Label::v, "v  upright");
  if (count[0] > 0) entry(Label::unknown, "unknown");
  return list;
}

DrawList scene_margins(const planes::FrameResult& result) {
  using Mark = LegendEntry::Mark;
  const planes::Classification& classified = result.classification;
  DrawList list;
  DrawPoints points = voxel_points(result.voxels);
  std::size_t unsure = 0, unknown = 0;
  for (std::size_t i = 0; i < points.positions.size(); ++i) {
    points.colors.push_back(margin_color(classified.labels[i], classified.margins[i]));
    if (classified.labels[i] == Label::unknown)
      ++unknown;
    else
      unsure += classified.margins[i] < kUnsure;
  }
  const std::size_t n = points.positions.size();
  list.points.push_back(std::move(points));
  add_gravity(result, list);
  list.title = "Sureness of the classification";
  list.subtitle = std::to_string(unsure) + " of " + std::to_string(n) +
                  " voxels have a margin below 0.5 (" + percent(unsure, n) + ")";
  const auto entry = [&](Label label, double margin, const std::string& text) {
    list.legend.push_back({Mark::dot, margin_color(label, margin), text});
  };
  entry(Label::h, 1, "h  sure (margin 1)");
  entry(Label::h, 0.5, "h  margin 0.5");
  entry(Label::h, 0, "on the boundary (margin 0)");
  entry(Label::v, 0.5, "v  margin 0.5");
  entry(Label::v, 1, "v  sure (margin 1)");
  if (unknown > 0) entry(Label::unknown, 0, "unknown  " + std::to_string(unknown));
  return list;
}

DrawList scene_leftovers(const planes::FrameResult& result, std::span<const int> color_of_plane) {
  using Mark = LegendEntry::Mark;
  DrawList list;
  DrawPoints points = voxel_points(result.voxels);
  std::size_t left = 0;
  for (const std::int32_t id : result.segmentation.plane_of) {
    const Rgba faded = id > 0 ? mix(color_of(id, color_of_plane), kSceneFaded, 0.75) : kLeftOver;
    points.colors.push_back(faded);
    left += id <= 0;
  }
  const std::size_t n = points.positions.size();
  list.points.push_back(std::move(points));
  add_gravity(result, list);
  list.title = "Points left over";
  list.subtitle = std::to_string(left) + " of " + std::to_string(n) + " voxels are in no plane (" +
                  percent(left, n) + ")";
  list.legend.push_back({Mark::dot, kLeftOver, "in no plane  " + std::to_string(left)});
  list.legend.push_back({Mark::dot, kSceneFaded, "in a plane  " + std::to_string(n - left)});
  return list;
}

DrawList scene_heights(const planes::FrameResult& result) {
  using Mark = LegendEntry::Mark;
  DrawList list;
  const RobustBounds bounds = robust_bounds(result.voxels.points);
  const double low = bounds.low.z(), high = std::max(bounds.high.z(), bounds.low.z() + 1e-3F);
  const auto color_at = [&](double z) {
    // The ramp keeps its own grey for 0, which means "not measured" there.
    return depth_color(std::clamp((z - low) / (high - low), 0.001, 1.0), 1);
  };
  DrawPoints points;
  points.size_m = 0.012F;
  points.min_px = 2.5F;
  for (std::size_t i = 0; i < result.cloud.points.size(); ++i) {
    if (!result.cloud.kept[i]) continue;
    points.positions.push_back(result.cloud.points[i]);
    points.colors.push_back(color_at(result.cloud.points[i].z()));
  }
  list.title = "Measured points by height";
  list.subtitle = std::to_string(points.positions.size()) + " points";
  list.points.push_back(std::move(points));
  for (int k = 4; k >= 0; --k) {
    const double z = low + (high - low) * k / 4;
    const double world = z + result.cloud.origin.z();
    char text[32];
    std::snprintf(text, sizeof text, "z = %.2f m", world);
    list.legend.push_back({Mark::dot, color_at(z), text});
  }
  add_gravity(result, list);
  return list;
}

}  // namespace planescope::render
