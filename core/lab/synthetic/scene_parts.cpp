#include "core/lab/synthetic/scene_parts.hpp"

#include <algorithm>

#include "core/lab/synthetic/rotation.hpp"

namespace planescope::lab {

std::vector<Vec3d> level(const Range& x, const Range& y, double z) {
  return {{x.low, y.low, z}, {x.high, y.low, z}, {x.high, y.high, z}, {x.low, y.high, z}};
}

std::vector<Vec3d> upright(const Vec2d& a, const Vec2d& b, const Range& z) {
  return {
      {a.x(), a.y(), z.low}, {b.x(), b.y(), z.low}, {b.x(), b.y(), z.high}, {a.x(), a.y(), z.high}};
}

void add_ground(Scene& scene, const Footprint& whole, std::span<const Footprint> holes) {
  std::vector<double> cuts = {whole.x.low, whole.x.high};
  for (const Footprint& hole : holes) cuts.insert(cuts.end(), {hole.x.low, hole.x.high});
  std::sort(cuts.begin(), cuts.end());
  int plane = 0;
  // Strips between the cuts, each with what is left of it beside the holes.
  for (std::size_t i = 0; i + 1 < cuts.size(); ++i) {
    const Range x{cuts[i], cuts[i + 1]};
    if (x.size() <= 0) continue;
    std::vector<Range> gaps;
    for (const Footprint& hole : holes)
      if (hole.x.low <= x.low && hole.x.high >= x.high) gaps.push_back(hole.y);
    std::sort(gaps.begin(), gaps.end(),
              [](const Range& a, const Range& b) { return a.low < b.low; });
    gaps.push_back({whole.y.high, whole.y.high});
    double y = whole.y.low;
    for (const Range& gap : gaps) {
      if (gap.low > y) plane = add_polygon(scene, level(x, {y, gap.low}, 0), {}, plane);
      y = gap.high;
    }
  }
}

void add_steps(Scene& scene, const Steps& steps) {
  for (int i = 0; i < steps.count; ++i) {
    const double x = steps.x + i * steps.length_m, z = i * steps.height_m;
    const Vec2d left(x, steps.y.high), right(x, steps.y.low);
    add_polygon(scene, upright(left, right, {z, z + steps.height_m}), {});
    add_polygon(scene, level({x, x + steps.length_m}, steps.y, z + steps.height_m), {});
  }
}

void add_flanks(Scene& scene, const Steps& steps) {
  int right = 0, left = 0;
  for (int i = 0; i < steps.count; ++i) {
    const double x = steps.x + i * steps.length_m, end = x + steps.length_m;
    const Range z{0, (i + 1) * steps.height_m};
    right = add_polygon(scene, upright({x, steps.y.low}, {end, steps.y.low}, z), {}, right);
    left = add_polygon(scene, upright({end, steps.y.high}, {x, steps.y.high}, z), {}, left);
  }
}

void add_ramp(Scene& scene, const Ramp& ramp) {
  const double x = ramp.x, top = ramp.top(), end = ramp.end(), z = ramp.rise_m;
  const double right = ramp.y.low, left = ramp.y.high;
  add_polygon(scene, {{x, right, 0}, {top, right, z}, {top, left, z}, {x, left, 0}}, {});
  std::vector<Vec3d> right_side = {{x, right, 0}, {end, right, 0}, {end, right, z}};
  std::vector<Vec3d> left_side = {{end, left, z}, {end, left, 0}, {x, left, 0}};
  if (ramp.landing_m > 0) {
    add_polygon(scene, level({top, end}, ramp.y, z), {});
    right_side.emplace_back(top, right, z);
    left_side.emplace_back(top, left, z);
  }
  add_polygon(scene, right_side, {});
  add_polygon(scene, left_side, {});
  add_polygon(scene, upright({end, right}, {end, left}, {0, z}), {});
}

void turn(Scene& scene, const Vec3d& center, double angle_deg) {
  const Mat3d turned = rotation(Vec3d::UnitZ(), angle_deg);
  for (Surface& surface : scene.surfaces) {
    for (Vec3d& corner : surface.corners) corner = center + turned * (corner - center);
    surface.normal = turned * surface.normal;
  }
}

}  // namespace planescope::lab
