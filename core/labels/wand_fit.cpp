#include <algorithm>
#include <array>
#include <cmath>

#include "core/base/random.hpp"
#include "core/geometry/plane.hpp"
#include "core/labels/wand_field.hpp"

namespace planescope {
namespace {

constexpr int kSamples = 64;
constexpr int kMostPixels = 256;  // of a box are looked at, evenly spread
constexpr int kRefits = 3;
constexpr double kLine = 1e-6;  // eigenvalues, the second against the third

struct Weighted {
  std::uint32_t pixel = 0;
  float weight = 0;
};

std::optional<Sheet> sheet_through(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3f normal = (b - a).cross(c - a);
  const float length = normal.norm();
  if (!(length > 0.05f * (b - a).norm() * (c - a).norm())) return std::nullopt;
  return Sheet{normal / length, normal.dot(a) / length};
}

/// Weights of what lies on the sheet, less the farther from it.
float score(const WandField& field, const std::vector<Weighted>& all, const Sheet& sheet) {
  float sum = 0;
  for (const auto& [pixel, weight] : all) {
    const float d = sheet.distance_m(field.grid.points[pixel]) / field.tolerance_m(sheet, pixel);
    sum += weight * std::max(0.0f, 1 - d * d);
  }
  return sum;
}

}  // namespace

std::optional<Sheet> sheet_through(const Moments& moments) {
  if (moments.count < 3) return std::nullopt;
  const PlaneFit fit = fit_plane(moments);
  if (!(fit.eigenvalues[1] > kLine * fit.eigenvalues[2])) return std::nullopt;
  const double sign = fit.offset_m() > 0 ? -1 : 1;  // towards the sensor
  return Sheet{(sign * fit.normal).cast<float>(), static_cast<float>(sign * fit.offset_m())};
}

WandField make_wand_field(const LabelGrid& grid,
                          const FrameLabels* labels,
                          const WandOptions& options) {
  WandField field{grid, options, {}, grid.measured};
  field.noise.resize(grid.pixels(), 0);
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (grid.measured[i]) field.noise[i] = grid.sigma_m[i] / grid.points[i].norm();
  if (!labels) return field;
  std::vector<std::uint8_t> keeps(kPlaneIgnore + 1, options.take_labelled ? 0 : 1);
  keeps[0] = 0;
  for (const LabelPlane& plane : labels->planes)
    if (plane.locked || plane.hidden) keeps[plane.id] = 1;
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (keeps[labels->plane.data[i]]) field.allowed[i] = 0;
  return field;
}

std::optional<LocalFit> fit_around(const WandField& field,
                                   const std::vector<std::uint8_t>& usable,
                                   const PixelBox& box,
                                   std::uint32_t at,
                                   double half_px) {
  const LabelGrid& grid = field.grid;
  const int width = box.u1 - box.u0, height = box.v1 - box.v0;
  const int step =
      std::max(1, static_cast<int>(std::ceil(std::sqrt(width * height / double{kMostPixels}))));
  const int at_u = static_cast<int>(at) % grid.width, at_v = static_cast<int>(at) / grid.width;
  std::vector<Weighted> all;
  float weights = 0;
  for (int v = box.v0 + (at_v - box.v0) % step; v < box.v1; v += step)
    for (int u = box.u0 + (at_u - box.u0) % step; u < box.u1; u += step) {
      const auto pixel = static_cast<std::uint32_t>(v * grid.width + u);
      if (!usable[pixel]) continue;
      const double du = (u - at_u) / half_px, dv = (v - at_v) / half_px;
      all.push_back({pixel, static_cast<float>(1 / (1 + du * du + dv * dv))});
      weights += all.back().weight;
    }
  if (all.size() < 6) return std::nullopt;

  Random random(1);
  const int last = static_cast<int>(all.size()) - 1;
  std::optional<Sheet> best;
  float best_score = 0;
  for (int k = 0; k < kSamples; ++k) {
    const std::array<int, 3> pick{random.integer(0, last), random.integer(0, last),
                                  random.integer(0, last)};
    const auto sheet =
        sheet_through(grid.points[all[pick[0]].pixel], grid.points[all[pick[1]].pixel],
                      grid.points[all[pick[2]].pixel]);
    if (!sheet) continue;
    if (const float s = score(field, all, *sheet); s > best_score) {
      best_score = s;
      best = sheet;
    }
  }
  for (int k = 0; k < kRefits && best; ++k) {
    Moments moments;
    for (const auto& [pixel, weight] : all)
      if (std::abs(best->distance_m(grid.points[pixel])) <= field.tolerance_m(*best, pixel))
        moments.add(grid.points[pixel].cast<double>());
    const auto refitted = sheet_through(moments);
    if (!refitted) break;
    best = refitted;
  }
  if (!best) return std::nullopt;
  LocalFit result{*best, 0, static_cast<int>(all.size())};
  for (const auto& [pixel, weight] : all)
    if (std::abs(best->distance_m(grid.points[pixel])) <= field.tolerance_m(*best, pixel))
      result.share += weight;
  result.share /= weights;
  return result;
}

}  // namespace planescope
