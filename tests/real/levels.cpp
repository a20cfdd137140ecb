#include "tests/real/levels.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

namespace planescope {
namespace {

constexpr double kSliceHalfWidth = 0.03;  // [m]
// Horizontal: within 30 degrees. What is steeper is a riser, which leads from one level to the
// next.
constexpr double kMinNormalZ = 0.866;
constexpr std::size_t kMinPoints = 20;  // fewer in the slice are a crumb at an edge

// A horizontal plane where it crosses the slice.
struct Crossing {
  int id = 0;
  double z = 0;                    // of the plane itself, below the middle of its points
  double lowest = 0, highest = 0;  // 5th and 95th percentile of its points
};

double percentile(std::vector<double> values, double share) {
  const auto at =
      values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

std::vector<Crossing> crossings(const FrameOutput& output, double y_m) {
  std::map<int, std::vector<Vec3d>> slices;
  for (std::size_t i = 0; i < output.cloud.points.size(); ++i) {
    const Vec3d p = output.cloud.points[i].cast<double>() + output.cloud.origin;
    if (output.cloud.instance[i] != 0 && std::abs(p.y() - y_m) < kSliceHalfWidth)
      slices[output.cloud.instance[i]].push_back(p);
  }
  std::vector<Crossing> found;
  for (const auto& [id, points] : slices) {
    const OutputPlane* plane = plane_of_id(output, id);
    if (plane == nullptr || std::abs(plane->normal.z()) < kMinNormalZ || points.size() < kMinPoints)
      continue;
    std::vector<double> x, z;
    for (const Vec3d& p : points) {
      x.push_back(p.x());
      z.push_back(p.z());
    }
    const Vec3d& n = plane->normal;
    Crossing crossing;
    crossing.id = id;
    crossing.z = (plane->offset_m - n.x() * percentile(x, 0.5) - n.y() * y_m) / n.z();
    crossing.lowest = percentile(z, 0.05);
    crossing.highest = percentile(z, 0.95);
    found.push_back(crossing);
  }
  return found;
}

}  // namespace

std::vector<std::string> check_levels(const FrameOutput& output,
                                      double y_m,
                                      const std::vector<double>& levels_m,
                                      double tolerance_m) {
  const std::vector<Crossing> found = crossings(output, y_m);
  std::string seen;
  for (const Crossing& c : found)
    seen += fmt::format(" {}: {:.3f} ({:.3f}..{:.3f})", c.id, c.z, c.lowest, c.highest);
  std::vector<std::string> problems;
  for (const double level : levels_m) {
    const auto near = std::count_if(found.begin(), found.end(), [&](const Crossing& c) {
      return std::abs(c.z - level) <= tolerance_m;
    });
    if (near == 0)
      problems.push_back(
          fmt::format("no horizontal plane at z = {:.2f}; there are{}", level, seen));
  }
  for (const Crossing& c : found) {
    const auto spanned = std::count_if(levels_m.begin(), levels_m.end(), [&](double level) {
      return c.lowest - tolerance_m <= level && level <= c.highest + tolerance_m;
    });
    if (spanned > 1)
      problems.push_back(fmt::format("plane {} spans {} levels, from z = {:.3f} to {:.3f}", c.id,
                                     spanned, c.lowest, c.highest));
  }
  return problems;
}

}  // namespace planescope
