#include "core/labels/wand/wand_field.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/model/plane.hpp"
#include "core/model/random.hpp"

namespace planescope::labels {
namespace {

constexpr std::size_t kLeastFitPixels = 6;
constexpr int kRefits = 3;
constexpr double kHintShare = 0.7;

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

/// Weights of what lies on the sheet, falling with the distance from it.
float score(const WandField& field, const std::vector<Weighted>& all, const Sheet& sheet) {
  float sum = 0;
  for (const auto& [pixel, weight] : all) {
    const float d = sheet.distance_m(field.grid.points[pixel]) / field.tolerance_m(sheet, pixel);
    sum += weight * std::max(0.0f, 1 - d * d);
  }
  return sum;
}

std::optional<Sheet> best_of_samples(const WandField& field,
                                     const std::vector<Weighted>& all,
                                     int samples) {
  Random random(1);
  const int last = static_cast<int>(all.size()) - 1;
  std::optional<Sheet> best;
  float best_score = 0;
  for (int k = 0; k < samples; ++k) {
    std::array<Vec3f, 3> points;
    for (Vec3f& point : points) point = field.grid.points[all[random.integer(0, last)].pixel];
    const auto sheet = sheet_through(points[0], points[1], points[2]);
    if (!sheet) continue;
    if (const float s = score(field, all, *sheet); s > best_score) {
      best_score = s;
      best = sheet;
    }
  }
  return best;
}

std::optional<LocalFit> fit_weighted(const WandField& field,
                                     const std::vector<Weighted>& all,
                                     double weights,
                                     const LocalFitOptions& options) {
  const LabelGrid& grid = field.grid;
  if (all.size() < kLeastFitPixels) return std::nullopt;

  const auto share_of = [&](const Sheet& sheet) {
    double share = 0;
    for (const auto& [pixel, weight] : all)
      if (field.lies_on(sheet, pixel)) share += weight;
    return share / weights;
  };
  for (const Sheet& hint : options.hints)
    if (const double share = share_of(hint); share >= kHintShare) return LocalFit{hint, share};

  std::optional<Sheet> best = best_of_samples(field, all, options.samples);
  for (int k = 0; k < kRefits && best; ++k) {
    Moments moments;
    for (const auto& [pixel, weight] : all)
      if (field.lies_on(*best, pixel)) moments.add(grid.points[pixel].cast<double>());
    const auto refitted = labels::sheet_through(moments);
    if (!refitted) break;
    best = refitted;
  }
  if (!best) return std::nullopt;
  return LocalFit{*best, share_of(*best)};
}

}  // namespace

std::optional<Sheet> sheet_through(const Moments& moments) {
  const auto fit = facing_sensor(fit_plane(moments));
  if (!fit) return std::nullopt;
  return Sheet{fit->normal.cast<float>(), static_cast<float>(fit->offset_m())};
}

WandField make_wand_field(const LabelGrid& grid,
                          const FrameLabels* labels,
                          const WandOptions& options) {
  const double max_angle = options.max_angle_deg * std::numbers::pi / 180;
  WandField field{grid, options, {}, grid.measured, static_cast<float>(std::cos(max_angle))};
  field.noise.resize(grid.pixels(), 0);
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    field.noise[i] = grid.is_cloud()
                         ? grid.sigma_m[i]
                         : grid.sigma_m[i] / grid.points[i].norm();  // NaN where not measured
  for (std::size_t i = 0; i < options.within.size(); ++i)
    if (!options.within[i]) field.allowed[i] = 0;
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
                                   std::uint32_t middle,
                                   const LocalFitOptions& options) {
  const LabelGrid& grid = field.grid;
  const double area = static_cast<double>(box.u1 - box.u0) * (box.v1 - box.v0);
  const int step = std::max(1, static_cast<int>(std::ceil(std::sqrt(area / options.most_pixels))));
  const int middle_u = static_cast<int>(middle) % grid.width;
  const int middle_v = static_cast<int>(middle) / grid.width;
  std::vector<Weighted> all;
  double weights = 0;
  for (int v = box.v0 + (middle_v - box.v0) % step; v < box.v1; v += step)
    for (int u = box.u0 + (middle_u - box.u0) % step; u < box.u1; u += step) {
      const auto pixel = static_cast<std::uint32_t>(v * grid.width + u);
      if (!usable[pixel]) continue;
      const double du = (u - middle_u) / options.half_px, dv = (v - middle_v) / options.half_px;
      all.push_back({pixel, static_cast<float>(1 / (1 + du * du + dv * dv))});
      weights += all.back().weight;
    }
  return fit_weighted(field, all, weights, options);
}

std::optional<LocalFit> fit_through(const WandField& field,
                                    std::span<const std::uint32_t> pixels,
                                    const LocalFitOptions& options) {
  if (pixels.empty()) return std::nullopt;
  const Vec3f middle = field.grid.points[pixels[0]];
  const double half_m = options.half_px * std::max(field.grid.spacing_m, 1e-6);
  const auto most = static_cast<std::size_t>(options.most_pixels);
  const std::size_t step = (pixels.size() + most - 1) / most;
  std::vector<Weighted> all;
  double weights = 0;
  for (std::size_t k = 0; k < pixels.size(); k += step) {
    const double away =
        static_cast<double>((field.grid.points[pixels[k]] - middle).norm()) / half_m;
    all.push_back({pixels[k], static_cast<float>(1 / (1 + away * away))});
    weights += static_cast<double>(all.back().weight);
  }
  return fit_weighted(field, all, weights, options);
}

}  // namespace planescope::labels
