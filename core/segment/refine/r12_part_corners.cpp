#include "core/segment/refine/r12_part_corners.hpp"

#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/geometry/inverse_plane.hpp"
#include "core/segment/state.hpp"

namespace planescope::r12_part_corners {
namespace {

constexpr std::size_t kLeastPixels = 80;  // of a plane that is looked at
constexpr std::size_t kSamples = 1500;    // of them that are looked at, about
constexpr int kStarts = 8;                // directions of the line that a fit begins with
constexpr int kRounds = 12;

using Pixels = std::vector<PixelGrid::Seen>;

/// Two planes that meet: where edge . ray > 0 a pixel belongs to the first.
struct Corner {
  Vec3d edge;
  InversePlane first, second;
  double rms = 0;  // about them [1/m]
};

struct Sides {
  InverseSums first, second;
  int least() const { return std::min(first.count, second.count); }
};

Sides sides_of(const Pixels& pixels, const Vec3d& edge) {
  Sides sides;
  for (const auto& [ray, w] : pixels) (edge.dot(ray) > 0 ? sides.first : sides.second).add(ray, w);
  return sides;
}

/// Beginning with a line across the picture: fits a plane to either side of it, takes the line in
/// which these meet, and so on.
std::optional<Corner> fit_corner(const Pixels& pixels, Vec3d edge, const Options& options) {
  const auto least = std::max(4.0, options.least_share * static_cast<double>(pixels.size()));
  Sides sides = sides_of(pixels, edge);
  for (int round = 0; round < kRounds; ++round) {
    if (sides.least() < least) return std::nullopt;
    const Vec3d first = sides.first.fit().w_of_ray, second = sides.second.fit().w_of_ray;
    // Which of the two is in front where they do not meet, is what the line before tells.
    Vec3d next = first - second;
    if (next.dot(edge) < 0) next = -next;
    const int before = sides.first.count;
    sides = sides_of(pixels, next);
    edge = next;
    if (sides.first.count == before && round > 0) break;
  }
  if (sides.least() < least) return std::nullopt;
  Corner corner{.edge = edge, .first = sides.first.fit(), .second = sides.second.fit()};
  const double squares =
      std::pow(sides.first.rms_about(corner.first.w_of_ray), 2) * sides.first.count +
      std::pow(sides.second.rms_about(corner.second.w_of_ray), 2) * sides.second.count;
  corner.rms = std::sqrt(squares / static_cast<double>(pixels.size()));
  return corner;
}

std::optional<Corner> find_corner(const Pixels& pixels, const Options& options) {
  InverseSums all;
  Vec3d middle = Vec3d::Zero();
  for (const auto& [ray, w] : pixels) {
    all.add(ray, w);
    middle += ray;
  }
  const InversePlane plane = all.fit();
  const double limit = options.rms_share * all.rms_about(plane.w_of_ray);
  // Lines through the middle of the picture.
  middle.normalize();
  const Vec3d u = middle.unitOrthogonal(), v = middle.cross(u);
  std::optional<Corner> best;
  for (int k = 0; k < kStarts; ++k) {
    const double angle = std::numbers::pi * k / kStarts;
    const auto corner = fit_corner(pixels, std::cos(angle) * u + std::sin(angle) * v, options);
    if (corner && corner->rms <= limit && (!best || corner->rms < best->rms)) best = corner;
  }
  if (!best) return std::nullopt;
  const double cosine = best->first.normal().dot(best->second.normal());
  if (cosine > std::cos(options.min_angle_deg * std::numbers::pi / 180)) return std::nullopt;
  return best;
}

/// Of each plane, evenly thinned out.
std::vector<Pixels> pixels_of_planes(const SegmentState& state) {
  const std::vector<std::int32_t> plane = planes_of_pixels(state);
  std::vector<std::size_t> count(state.planes.size(), 0), at(state.planes.size(), 0);
  for (const std::int32_t k : plane)
    if (k >= 0) ++count[k];
  std::vector<Pixels> all(state.planes.size());
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const std::int32_t k = plane[i];
    if (k < 0 || count[k] < kLeastPixels) continue;
    const std::size_t stride = std::max<std::size_t>(1, count[k] / kSamples);
    if (at[k]++ % stride == 0) all[k].push_back(state.more.pixels.seen(i, state.sensor));
  }
  return all;
}

void part(SegmentState& state,
          const Options& options,
          std::int32_t plane,
          const Corner& corner,
          std::span<const std::uint32_t> points) {
  std::vector<std::uint32_t> first, second;
  for (const std::uint32_t i : points)
    (corner.edge.dot(state.point(i) - state.sensor) > 0 ? first : second).push_back(i);
  if (first.size() < second.size()) first.swap(second);
  if (second.size() < 4) return;
  found_part(state, stage_of(options), plane, second);
  log_refine(state, options, plane);
  fit_again(state, plane, moments_of(state, first));
}

}  // namespace

void run(SegmentState& state, const Options& options) {
  if (!options.on || state.more.pixels.empty()) return;
  const std::vector<Pixels> pixels = pixels_of_planes(state);
  const PlanePoints members = points_by_plane(state);
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(pixels.size()); ++k) {
    if (!state.planes[k].alive || pixels[k].empty()) continue;
    if (const auto corner = find_corner(pixels[k], options))
      part(state, options, k, *corner, members.of(k));
  }
}

}  // namespace planescope::r12_part_corners
