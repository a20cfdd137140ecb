#include "render/region_image.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "render/paint.hpp"

namespace planescope::render {

Image8 shaded_depth(const Frame& frame) {
  const int width = frame.depth.width, height = frame.depth.height;
  Image8 image(width, height, 3);
  const auto point = [&](int x, int y) {
    const double z = frame.depth.at(x, y) * frame.depth_unit_m;
    return Vec3d((x - frame.intrinsics.cx) / frame.intrinsics.fx * z,
                 (y - frame.intrinsics.cy) / frame.intrinsics.fy * z, z);
  };
  const auto measured = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width && y < height && frame.depth.at(x, y) != 0 &&
           frame.depth.at(x, y) != 65535;
  };
  constexpr int kReach = 4;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double grey = on_hatch(x, y, 8) ? 196 : 214;
      if (measured(x, y)) {
        grey = 150;
        const int x0 = measured(x - kReach, y) ? x - kReach : x;
        const int x1 = measured(x + kReach, y) ? x + kReach : x;
        const int y0 = measured(x, y - kReach) ? y - kReach : y;
        const int y1 = measured(x, y + kReach) ? y + kReach : y;
        const Vec3d normal = (point(x1, y) - point(x0, y)).cross(point(x, y1) - point(x, y0));
        if (normal.norm() > 0) {
          const Vec3d light = (-point(x, y).normalized() + Vec3d(-0.25, -0.35, 0)).normalized();
          grey = 70 + 165 * std::abs(normal.normalized().dot(light));
        }
      }
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<std::uint8_t>(grey);
    }
  }
  return image;
}

namespace {

/// Distorts normalised coordinates as OpenCV does (Brown-Conrady).
Vec2d distorted(const Intrinsics& camera, const Vec2d& p) {
  if (camera.distortion != Distortion::brown_conrady) return p;
  const auto& [k1, k2, p1, p2, k3] = camera.coefficients;
  const double x = p.x(), y = p.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

}  // namespace

RegionImage regions_on_depth(const Frame& frame, const planes::FrameResult& result) {
  RegionImage regions(frame.depth.width, frame.depth.height);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    regions.data[result.cloud.source[i]] = result.plane_of[i];
  return regions;
}

RegionImage regions_on_color(const Frame& frame, const planes::FrameResult& result) {
  const Intrinsics& camera = frame.color_intrinsics;
  RegionImage regions(frame.color.width, frame.color.height);
  Image<float> nearest(frame.color.width, frame.color.height, 1,
                       std::numeric_limits<float>::infinity());
  const Pose T_depth_world = result.cloud.T_world_sensor.inverse();
  const Pose T_color_world = frame.T_color_depth * T_depth_world;
  // Colour pixels per depth pixel, each way.
  const double grow = std::max(1.0, camera.fx / std::max(1.0, frame.intrinsics.fx));
  for (std::size_t i = 0; i < result.plane_of.size(); ++i) {
    const Vec3d p = T_color_world * (result.cloud.origin + result.cloud.points[i].cast<double>());
    if (p.z() < 0.05) continue;
    const Vec2d n = distorted(camera, Vec2d(p.x() / p.z(), p.y() / p.z()));
    const double u = camera.fx * n.x() + camera.cx, v = camera.fy * n.y() + camera.cy;
    const double half = 0.5 * grow + 0.25;
    const auto depth = static_cast<float>(p.z());
    const int first_x = std::max(0, static_cast<int>(std::lround(u - half)));
    const int last_x = std::min(regions.width - 1, static_cast<int>(std::lround(u + half)));
    const int first_y = std::max(0, static_cast<int>(std::lround(v - half)));
    const int last_y = std::min(regions.height - 1, static_cast<int>(std::lround(v + half)));
    for (int y = first_y; y <= last_y; ++y) {
      for (int x = first_x; x <= last_x; ++x) {
        if (depth >= nearest.at(x, y)) continue;
        nearest.at(x, y) = depth;
        regions.at(x, y) = result.plane_of[i];
      }
    }
  }
  return regions;
}

RegionImage smooth_regions(const RegionImage& regions) {
  constexpr int kReach = 2;
  constexpr int kMajority = 13;  // of 25
  RegionImage smooth = regions;
  for (int y = kReach; y < regions.height - kReach; ++y) {
    for (int x = kReach; x < regions.width - kReach; ++x) {
      // Boyer-Moore majority vote: the only id that can hold more than half of the window.
      std::int32_t winner = 0;
      int lead = 0;
      const auto window = [&](auto&& each) {
        for (int dy = -kReach; dy <= kReach; ++dy)
          for (int dx = -kReach; dx <= kReach; ++dx) each(regions.at(x + dx, y + dy));
      };
      window([&](std::int32_t id) {
        if (lead == 0) winner = id;
        lead += id == winner ? 1 : -1;
      });
      int votes = 0;
      window([&](std::int32_t id) { votes += id == winner; });
      if (votes >= kMajority) smooth.at(x, y) = winner;
    }
  }
  return smooth;
}

std::vector<InteriorPoint> interior_points(const RegionImage& regions, std::size_t plane_count) {
  // Chamfer distance to the nearest pixel of another id, with the picture's edge as another id.
  const int width = regions.width, height = regions.height;
  Image<float> distance(width, height, 1, 1e9F);
  const auto relax = [&](int x, int y, int dx, int dy, float step) {
    const int nx = x + dx, ny = y + dy;
    const bool same =
        nx >= 0 && ny >= 0 && nx < width && ny < height && regions.at(nx, ny) == regions.at(x, y);
    const float through = same ? distance.at(nx, ny) + step : step;
    distance.at(x, y) = std::min(distance.at(x, y), through);
  };
  constexpr float kDiagonal = 1.4142F;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      relax(x, y, -1, 0, 1);
      relax(x, y, 0, -1, 1);
      relax(x, y, -1, -1, kDiagonal);
      relax(x, y, 1, -1, kDiagonal);
    }
  }
  std::vector<InteriorPoint> points(plane_count);
  for (int y = height - 1; y >= 0; --y) {
    for (int x = width - 1; x >= 0; --x) {
      relax(x, y, 1, 0, 1);
      relax(x, y, 0, 1, 1);
      relax(x, y, 1, 1, kDiagonal);
      relax(x, y, -1, 1, kDiagonal);
      const std::int32_t id = regions.at(x, y);
      if (id <= 0 || static_cast<std::size_t>(id) > plane_count) continue;
      InteriorPoint& best = points[static_cast<std::size_t>(id) - 1];
      if (distance.at(x, y) > best.depth_px) best = {x, y, distance.at(x, y)};
    }
  }
  return points;
}

}  // namespace planescope::render
