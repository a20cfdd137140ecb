#include "core/planes/segment/refine/r12_part_corners.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <span>
#include <vector>

#include "core/model/inverse_plane.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::planes::r12_part_corners {
namespace {

constexpr std::size_t kLeastPixels = 80;  // of a plane that is looked at
constexpr std::size_t kLeastPoints = 4;   // of the smaller; its pixels vouch for it
constexpr std::size_t kSamples = 1500;    // of them that are looked at, about
constexpr int kStarts = 8;                // directions of the line that a fit begins with
constexpr int kRounds = 12;

/// A pixel and the row of the image that it is in.
struct Pixel {
  PixelGrid::Seen seen;
  int row = 0;
};
using Pixels = std::vector<Pixel>;  // row by row, from left to right

/// A row's pixels: a line in the picture leaves those on either side of it standing together.
struct Row {
  std::uint32_t begin = 0, end = 0;
  std::uint32_t split = 0;  // the first on the other side of the line before; the end if none is
};

/// What is measured of a plane, parted by edge . ray > 0.
struct Sides {
  Vec3d edge = Vec3d::Zero();
  InverseSums first = {}, second = {};
  InversePlane first_fit = {}, second_fit = {};
  double squares = 0;  // about the two
};

/// Of one plane after the other.
class CornerFinder {
 public:
  explicit CornerFinder(const Options& options) : options_(options) {}

  /// Where two planes that meet fit much better than one.
  std::optional<Sides> find(const Pixels& pixels) {
    if (pixels.size() < kLeastPixels) return std::nullopt;
    begin_with(pixels);
    std::optional<Sides> best;
    // Lines through the middle of the picture.
    const Vec3d u = middle_.unitOrthogonal(), v = middle_.cross(u);
    for (int k = 0; k < kStarts; ++k) {
      const double angle = std::numbers::pi * k / kStarts;
      const auto end = follow(std::cos(angle) * u + std::sin(angle) * v);
      if (end && (!best || end->squares < best->squares)) best = end;
    }
    const double limit = options_.rms_share * all_.rms_about(all_.fit().w_of_ray);
    if (!best || !(best->squares <= limit * limit * all_.count)) return std::nullopt;
    const double cosine = best->first_fit.normal().dot(best->second_fit.normal());
    if (!(cosine <= std::cos(options_.min_angle_deg * std::numbers::pi / 180))) return std::nullopt;
    return best;
  }

 private:
  void begin_with(const Pixels& pixels) {
    pixels_ = pixels;
    rows_.clear();
    up_to_.clear();
    parted_.clear();
    all_ = {};
    middle_ = Vec3d::Zero();
    InverseSums of_row;
    up_to_.reserve(pixels.size());
    for (std::uint32_t i = 0; i < pixels.size(); ++i) {
      const auto& [ray, w] = pixels[i].seen;
      if (i == 0 || pixels[i].row != pixels[i - 1].row) {
        rows_.push_back({i, i, i});
        of_row = {};
      }
      ++rows_.back().end;
      of_row.add(ray, w);
      up_to_.push_back(of_row);
      all_.add(ray, w);
      middle_ += ray;
    }
    middle_.normalize();
  }

  /// Nothing where one side has too few pixels. Lines that began differently end in the same ones:
  /// what was parted by a line once is remembered.
  std::optional<Sides> part(const Vec3d& edge) {
    for (const auto& [known, sides] : parted_)
      if (known == edge) return sides;
    return parted_.emplace_back(edge, part_anew(edge)).second;
  }

  std::optional<Sides> part_anew(const Vec3d& edge) {
    Sides sides{.edge = edge, .second = all_};
    InverseSums first;  // in registers
    for (Row& row : rows_) add_first_side(edge, row, first);
    sides.first = first;
    sides.second -= first;
    const int least = std::min(sides.first.count, sides.second.count);
    if (least < std::max(4.0, options_.least_share * all_.count)) return std::nullopt;
    for (auto [sums, fit] :
         {std::pair{&sides.first, &sides.first_fit}, std::pair{&sides.second, &sides.second_fit}}) {
      *fit = sums->fit();
      sides.squares += std::pow(sums->rms_about(fit->w_of_ray), 2) * sums->count;
    }
    return sides;
  }

  /// Adds the row's pixels with edge . ray > 0: all, none, or those before or from some pixel on.
  void add_first_side(const Vec3d& edge, Row& row, InverseSums& sums) const {
    const auto is_first = [&](std::uint32_t i) { return edge.dot(pixels_[i].seen.ray) > 0; };
    const bool at_begin = move_split(row, is_first);
    if (at_begin) {
      sums += up_to_[row.split - 1];
    } else if (row.split < row.end) {
      sums.add_difference(up_to_[row.end - 1], up_to_[row.split - 1]);
    }
  }

  /// Finds row.split and says on which side the row begins. A line mostly differs little from the
  /// one before, so that most splits stay, which two looks tell.
  template <typename IsFirst>
  static bool move_split(Row& row, const IsFirst& is_first) {
    const std::uint32_t before = row.split;
    const bool is_inside = before > row.begin && before < row.end;
    const bool side = is_inside ? is_first(before) : is_first(row.begin);
    if (is_inside && is_first(before - 1) != side) return !side;
    std::uint32_t same = row.begin, other = row.end - 1;  // on the side of the first, and not
    const bool at_begin = is_inside ? is_first(same) : side;
    if (at_begin != side) {
      other = before - 1;
    } else if (is_first(other) == at_begin) {
      row.split = row.end;
      return at_begin;
    } else if (is_inside) {
      same = before;
    }
    // If it moved, then mostly not far: ever larger steps from where it was.
    for (std::uint32_t step = 1; is_inside && other - same > 2 * step; step *= 2) {
      const std::uint32_t next = at_begin != side ? other - step : same + step;
      const bool still = is_first(next) == side;
      ((at_begin != side) == still ? other : same) = next;
      if (!still) break;
    }
    while (other - same > 1) {
      const std::uint32_t middle = same + (other - same) / 2;
      (is_first(middle) == at_begin ? same : other) = middle;
    }
    row.split = other;
    return at_begin;
  }

  /// Fits a plane to either side of the line, takes the line in which these meet, and so on.
  std::optional<Sides> follow(const Vec3d& line) {
    std::optional<Sides> sides = part(line);
    for (int round = 0; sides && round < kRounds; ++round) {
      // Which of the two is in front where they do not meet, is what the line before tells.
      Vec3d edge = sides->first_fit.w_of_ray - sides->second_fit.w_of_ray;
      if (edge.dot(sides->edge) < 0) edge = -edge;
      const int before = sides->first.count;
      sides = part(edge);
      if (sides && sides->first.count == before && round > 0) break;
    }
    return sides;
  }

  const Options& options_;
  std::span<const Pixel> pixels_;
  std::vector<Row> rows_;
  std::vector<InverseSums> up_to_;  // per pixel: of its row, from the first to it
  std::vector<std::pair<Vec3d, std::optional<Sides>>> parted_;  // by edge
  InverseSums all_;
  Vec3d middle_ = Vec3d::Zero();
};

/// Of each plane, evenly thinned out in both directions.
std::vector<Pixels> pixels_of_planes(const SegmentState& state) {
  const PixelGrid& grid = state.more.pixels;
  const std::span<const std::int32_t> plane = planes_of_pixels(state);
  std::vector<std::size_t> count(state.planes.size(), 0);
  visit_plane_runs(grid, plane, [&](std::int32_t k, int, int begin, int end) {
    count[k] += static_cast<std::size_t>(end - begin);
  });
  struct Every {
    int rows = 1, columns = 1;
  };
  std::vector<Every> every;
  std::vector<Pixels> all(state.planes.size());
  for (std::size_t k = 0; k < all.size(); ++k) {
    const auto surplus = static_cast<int>(count[k] / kSamples);
    const int rows = std::max(1, static_cast<int>(std::sqrt(surplus)));
    every.push_back({rows, std::max(1, surplus / rows)});
    if (count[k] >= kLeastPixels)
      all[k].reserve(count[k] / static_cast<std::size_t>(rows * every[k].columns) + kLeastPixels);
  }
  visit_plane_runs(grid, plane, [&](std::int32_t k, int y, int begin, int end) {
    const auto [rows, columns] = every[k];
    if (count[k] < kLeastPixels || y % rows != 0) return;
    for (int x = (begin + columns - 1) / columns * columns; x < end; x += columns)
      all[k].push_back({grid.seen(grid.at(x, y), state.sensor), y});
  });
  return all;
}

/// Either side of an edge.
struct Halves {
  Pixels first_pixels, second_pixels;
  std::vector<std::uint32_t> first, second;  // points
};

Halves halve(const SegmentState& state,
             const Vec3d& edge,
             const Pixels& pixels,
             std::span<const std::uint32_t> points) {
  Halves halves;
  for (const auto& pixel : pixels)
    (edge.dot(pixel.seen.ray) > 0 ? halves.first_pixels : halves.second_pixels).push_back(pixel);
  for (const std::uint32_t i : points)
    (edge.dot(state.point(i) - state.sensor) > 0 ? halves.first : halves.second).push_back(i);
  if (halves.first.size() < halves.second.size()) {
    halves.first.swap(halves.second);
    halves.first_pixels.swap(halves.second_pixels);
  }
  return halves;
}

/// And what is left of it on either side, for a box may show three faces.
void part(SegmentState& state,
          const Options& options,
          CornerFinder& finder,
          std::int32_t plane,
          const Pixels& pixels,
          std::span<const std::uint32_t> points,
          const std::optional<Sides>& sides) {
  if (!sides) return;
  const Halves halves = halve(state, sides->edge, pixels, points);
  if (halves.second.size() < kLeastPoints) return;
  const std::int32_t other = found_part(state, stage_of(options), plane, halves.second);
  log_refine(state, options, plane);
  fit_again(state, plane, moments_of(state, halves.first));
  part(state, options, finder, plane, halves.first_pixels, halves.first,
       finder.find(halves.first_pixels));
  part(state, options, finder, other, halves.second_pixels, halves.second,
       finder.find(halves.second_pixels));
}

}  // namespace

void run(SegmentState& state, const Options& options) {
  if (!options.on || state.more.pixels.empty()) return;
  const std::vector<Pixels> pixels = pixels_of_planes(state);
  const PlanePoints members = points_by_plane(state);
  const auto planes = static_cast<std::int32_t>(pixels.size());
  std::vector<std::optional<Sides>> sides(pixels.size());
  work_through_with(planes, state.threads, [&] {
    return [&, finder = CornerFinder(options)](std::int32_t k) mutable {
      if (state.planes[k].alive) sides[k] = finder.find(pixels[k]);
    };
  });
  CornerFinder finder(options);
  for (std::int32_t k = 0; k < planes; ++k)
    part(state, options, finder, k, pixels[k], members.of(k), sides[k]);
}

}  // namespace planescope::planes::r12_part_corners
