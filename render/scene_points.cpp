// The points of a frame: by h / v, left over, by height.

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>

#include "render/palette.hpp"
#include "render/scene_parts.hpp"
#include "render/scenes.hpp"

namespace planescope {

DrawList scene_labels(const FrameResult& result) {
  using Mark = LegendEntry::Mark;
  DrawList list;
  DrawPoints points = voxel_points(result);
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

DrawList scene_leftovers(const FrameResult& result) {
  using Mark = LegendEntry::Mark;
  DrawList list;
  DrawPoints planes, left;
  planes.size_m = left.size_m = voxel_points(result).size_m;
  for (std::size_t i = 0; i < result.voxels.points.size(); ++i)
    (result.segmentation.plane_of[i] > 0 ? planes : left)
        .positions.push_back(result.voxels.points[i]);
  planes.colors.assign(planes.positions.size(), kSceneFaded);
  left.colors.assign(left.positions.size(), leftover_color());
  const std::size_t n = result.voxels.points.size(), k = left.positions.size();
  list.points.push_back(std::move(planes));
  list.points.push_back(std::move(left));
  add_gravity(result, list);
  list.title = "Points left over";
  list.subtitle = std::to_string(k) + " of " + std::to_string(n) + " voxels are in no plane (" +
                  percent(k, n) + ")";
  list.legend.push_back({Mark::dot, leftover_color(), "in no plane  " + std::to_string(k)});
  list.legend.push_back({Mark::dot, kSceneFaded, "in a plane  " + std::to_string(n - k)});
  return list;
}

DrawList scene_heights(const FrameResult& result) {
  using Mark = LegendEntry::Mark;
  DrawList list;
  const RobustBounds bounds = robust_bounds(result.voxels.points);
  const double low = bounds.low.z(), high = std::max(bounds.high.z(), bounds.low.z() + 1e-3F);
  const auto color_at = [&](double z) {
    // The ramp keeps its own grey for 0, which means "not measured" there.
    return depth_color(std::clamp((z - low) / (high - low), 0.001, 1.0), 1);
  };
  DrawPoints points;
  points.size_m = 0.01F;
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

}  // namespace planescope
