// Plane numbering shared by rival methods, and the hook for Open3D's RANSAC.

#include "core/planes/rivals/rivals.hpp"

#include <algorithm>
#include <cassert>

#include "core/model/error.hpp"

namespace planescope::planes {

FoundPlanes found_planes(std::span<const Vec3f> points,
                         std::span<const std::int32_t> group,
                         int min_points) {
  assert(points.size() == group.size());
  const std::int32_t highest = group.empty() ? 0 : std::ranges::max(group);
  std::vector<Moments> moments(static_cast<std::size_t>(std::max(highest, 0)) + 1);
  for (std::size_t i = 0; i < points.size(); ++i) {
    if (group[i] > 0) moments[group[i]].add(points[i].cast<double>());
  }
  std::vector<std::int32_t> order;
  for (std::int32_t g = 1; g <= highest; ++g) {
    if (moments[g].count >= std::max(min_points, 1)) order.push_back(g);
  }
  std::ranges::stable_sort(
      order, [&](std::int32_t a, std::int32_t b) { return moments[a].count > moments[b].count; });

  FoundPlanes found;
  std::vector<std::int32_t> id(moments.size(), 0);
  for (const std::int32_t g : order) {
    found.planes.push_back(fit_plane(moments[g]));
    id[g] = static_cast<std::int32_t>(found.planes.size());
  }
  found.plane_of.reserve(points.size());
  for (const std::int32_t g : group) found.plane_of.push_back(g > 0 ? id[g] : 0);
  return found;
}

void refuse_absent_rival(const char* name, const char* option) {
  throw Error(std::string("method ") + name + " is not part of this build; configure it with -D" +
              option + "=ON");
}

namespace {

RansacFunction* ransac = nullptr;

}  // namespace

FoundPlanes find_planes_ransac(std::span<const Vec3f> points, const RansacOptions& options) {
  if (!ransac) refuse_absent_rival("ransac", "PLANESCOPE_OPEN3D");
  return ransac(points, options);
}

void set_ransac(RansacFunction* function) { ransac = function; }
bool has_ransac() { return ransac != nullptr; }

}  // namespace planescope::planes
