// Labels of points back onto the pixels of a frame.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

#include "core/labels/exchange/exchange.hpp"
#include "core/model/error.hpp"

namespace planescope::labels {
namespace {

// Coordinates that went through another tool are this close to what they were. Only the distance
// from the sensor is compared: a tool may well have turned the points, upright for example.
constexpr double kSameDistance_m = 0.001;

std::string name_of(DepthPixel pixel) {
  return "pixel (" + std::to_string(pixel.u) + ", " + std::to_string(pixel.v) + ")";
}

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

std::vector<std::uint32_t> pixels_by_name(const LabelledPoints& points,
                                          const LabelGrid& grid,
                                          const std::string& where) {
  std::vector<std::uint32_t> indices(points.size());
  std::vector<bool> taken(grid.pixels(), false);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const DepthPixel pixel = points.pixel[i];
    if (pixel.u >= grid.width || pixel.v >= grid.height)
      throw Error(where + ": " + name_of(pixel) + ", the frame's depth is " +
                  size_text(grid.width, grid.height));
    const auto index = static_cast<std::uint32_t>(pixel.v * grid.width + pixel.u);
    if (taken[index]) throw Error(where + ": " + name_of(pixel) + " is there twice");
    taken[index] = true;
    indices[i] = index;
  }
  return indices;
}

std::vector<std::uint32_t> pixels_in_raster_order(const LabelledPoints& points,
                                                  const LabelGrid& grid,
                                                  const std::string& where) {
  const bool all = points.size() == grid.pixels();
  if (!all && points.size() != grid.measured_count)
    throw Error(where + ": " + std::to_string(points.size()) + " points, expected " +
                std::to_string(grid.measured_count) + ", one per pixel with depth, or " +
                std::to_string(grid.pixels()) + ", one per pixel");
  std::vector<std::uint32_t> indices;
  indices.reserve(points.size());
  for (std::uint32_t i = 0; i < grid.pixels(); ++i)
    if (all || grid.measured[i]) indices.push_back(i);
  return indices;
}

/// Labels of another frame would fit the image just as well; their points would not.
void check_points(const LabelledPoints& points,
                  const LabelGrid& grid,
                  std::span<const std::uint32_t> indices,
                  const std::string& where) {
  if (points.points.size() != indices.size()) return;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (!grid.measured[indices[i]]) continue;
    const double found = points.points[i].cast<double>().norm();
    const double expected = grid.points[indices[i]].cast<double>().norm();
    if (std::abs(found - expected) <= kSameDistance_m) continue;
    char text[160];
    std::snprintf(text, sizeof(text),
                  ": point %zu is %.3f m from the sensor, the frame has %.3f m there: these are "
                  "labels of another frame",
                  i, found, expected);
    throw Error(where + text);
  }
}

/// The planes that the image names, with the class that most of their pixels have.
std::vector<LabelPlane> planes_of(const FrameLabels& labels) {
  std::vector<std::array<std::size_t, 3>> votes(kPlaneIgnore);
  std::vector<bool> named(kPlaneIgnore, false);
  for (std::size_t i = 0; i < labels.plane.pixels(); ++i) {
    const std::uint16_t id = labels.plane.data[i];
    if (id == 0 || id == kPlaneIgnore) continue;
    named[id] = true;
    if (const std::uint8_t hv = labels.hv.data[i]; hv <= 2) ++votes[id][hv];
  }
  std::vector<LabelPlane> planes;
  for (int id = 1; id < kPlaneIgnore; ++id) {
    if (!named[id]) continue;
    const auto most = std::max_element(votes[id].begin(), votes[id].end());
    LabelPlane plane;
    plane.id = id;
    plane.label = static_cast<Label>(most - votes[id].begin());
    plane.origin = LabelOrigin::imported;
    planes.push_back(plane);
  }
  return planes;
}

/// Where the format tells planes only, each takes the class of its tilt, and none where nobody
/// knows gravity.
void classify_by_tilt(FrameLabels& labels) {
  std::vector<std::uint8_t> class_of(kPlaneIgnore + 1, 0);
  class_of[kPlaneIgnore] = kHvIgnore;
  for (LabelPlane& plane : labels.planes) {
    plane.label = class_of_tilt(tilt_of(plane.normal, labels.gravity));
    class_of[plane.id] = static_cast<std::uint8_t>(plane.label);
  }
  for (std::size_t i = 0; i < labels.plane.pixels(); ++i)
    labels.hv.data[i] = class_of[labels.plane.data[i]];
}

}  // namespace

FrameLabels labels_of_points(const LabelledPoints& points,
                             const LabelGrid& grid,
                             const std::string& depth_sha256,
                             const std::string& where) {
  if (points.width > 0 && (points.width != grid.width || points.height != grid.height))
    throw Error(where + ": labels of a depth image of " + size_text(points.width, points.height) +
                ", the frame's is " + size_text(grid.width, grid.height));
  // A format that lists labelled pixels alone may list none: that is not raster order.
  const bool by_name =
      points.pixel.size() == points.size() && (points.size() > 0 || points.width > 0);
  const std::vector<std::uint32_t> indices =
      by_name ? pixels_by_name(points, grid, where) : pixels_in_raster_order(points, grid, where);
  check_points(points, grid, indices, where);

  FrameLabels labels = empty_labels(grid, depth_sha256);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (!grid.measured[indices[i]]) continue;
    labels.plane.data[indices[i]] = static_cast<std::uint16_t>(points.instance[i]);
    if (!points.label.empty()) labels.hv.data[indices[i]] = points.label[i];
  }
  labels.planes = planes_of(labels);
  refit_planes(labels, grid);
  if (points.label.empty()) classify_by_tilt(labels);
  return labels;
}

}  // namespace planescope::labels
