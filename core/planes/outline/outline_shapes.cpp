// Converts outlines to triangles, and to the pixels that they cover.

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "core/planes/cloud/camera.hpp"
#include "core/planes/outline/outline.hpp"

namespace planescope::planes {

Mesh mesh_of(const Outline& outline) {
  Mesh mesh;
  if (outline.parts.empty()) return mesh;
  std::map<std::pair<double, double>, int> numbers;
  for (const Triangle& triangle : triangulated(polygons_of(outline))) {
    std::array<int, 3>& corners = mesh.triangles.emplace_back();
    for (std::size_t i = 0; i < 3; ++i) {
      const auto [at, is_new] = numbers.try_emplace({triangle[i].x(), triangle[i].y()},
                                                    static_cast<int>(mesh.vertices.size()));
      if (is_new) mesh.vertices.push_back(outline.world(triangle[i]));
      corners[i] = at->second;
    }
  }
  return mesh;
}

namespace {

/// Crossing of an edge with a row of pixel centers.
struct EdgeCrossing {
  int y = 0;
  double x = 0;
  auto operator<=>(const EdgeCrossing&) const = default;
};

/// Integers in [low, high), clamped to 0 .. count - 1; the second is past the end.
std::pair<int, int> between(double low, double high, int count) {
  const auto clamped = [&](double at) {
    return static_cast<int>(std::clamp(std::ceil(at), 0.0, static_cast<double>(count)));
  };
  return {clamped(low), clamped(high)};
}

/// Returns false if a corner is not in front of the camera.
bool add_crossings(const Outline& outline,
                   const PolygonRing& ring,
                   const Intrinsics& camera,
                   const Pose& T_sensor_world,
                   std::vector<EdgeCrossing>& crossings) {
  constexpr double kAhead_m = 1e-3;
  std::vector<Vec2d> pixels;
  for (const Vec2d& corner : ring) {
    const Vec3d at = T_sensor_world * outline.world(corner);
    if (!(at.z() > kAhead_m)) return false;
    pixels.push_back(ray_to_pixel(camera, at.head<2>() / at.z()));
  }
  for (std::size_t i = 0; i < pixels.size(); ++i) {
    const Vec2d &a = pixels[i], &b = pixels[(i + 1) % pixels.size()];
    const auto [first, end] =
        between(std::min(a.y(), b.y()), std::max(a.y(), b.y()), camera.height);
    for (int y = first; y < end; ++y)
      crossings.push_back({y, a.x() + (b.x() - a.x()) * (y - a.y()) / (b.y() - a.y())});
  }
  return true;
}

}  // namespace

std::optional<std::vector<PixelRun>> pixels_within(const Outline& outline,
                                                   const Intrinsics& camera,
                                                   const Pose& T_sensor_world,
                                                   bool with_unknown) {
  std::vector<EdgeCrossing> crossings;
  const auto add = [&](const PolygonRing& ring) {
    return add_crossings(outline, ring, camera, T_sensor_world, crossings);
  };
  for (const Outline::Part& part : outline.parts)
    if (!add(part.outer) || !std::ranges::all_of(part.holes, add) ||
        !(with_unknown || std::ranges::all_of(part.unknown, add)))
      return std::nullopt;
  std::ranges::sort(crossings);
  std::vector<PixelRun> runs;
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    const auto [first, end] = between(crossings[i].x, crossings[i + 1].x, camera.width);
    if (first < end) runs.push_back({crossings[i].y, first, end});
  }
  return runs;
}

}  // namespace planescope::planes
