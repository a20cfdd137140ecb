#include "core/planes/segment/refine/r11_pixel_borders.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <span>

#include "core/planes/segment/state.hpp"

namespace planescope::planes::r11_pixel_borders {
namespace {

constexpr int kTile = 24;          // [px]
constexpr int kMostReach_px = 20;  // a tile's row with what is in reach of it is a word

/// Pixels of a tile and around it, a bit each: (0, 0) is kMostReach_px left of and above the tile.
struct PixelSet {
  static constexpr int kSize = kTile + 2 * kMostReach_px;
  static_assert(kSize == 64);
  std::uint64_t rows[kSize] = {};
};
/// Of the tile alone; bits of a row as there.
struct TileSet {
  std::uint64_t rows[kTile] = {};
};

/// The tile's pixels that have one of the set in the square of 2 reach + 1 pixels about them.
TileSet near(const PixelSet& set, int reach) {
  std::uint64_t rows[PixelSet::kSize];
  const int begin = kMostReach_px - reach, end = kMostReach_px + kTile + reach;
  std::copy(set.rows + begin, set.rows + end, rows + begin);
  // Each becomes the union of `covered` of them: to the right, then below.
  const int all = 2 * reach + 1;
  for (int covered = 1; covered < all;) {
    const int more = std::min(covered, all - covered);
    for (int y = begin; y < end; ++y) rows[y] |= rows[y] << more;
    covered += more;
  }
  for (int covered = 1; covered < all;) {
    const int more = std::min(covered, all - covered);
    for (int y = begin; y < end - more; ++y) rows[y] |= rows[y + more];
    covered += more;
  }
  TileSet result;
  for (int y = 0; y < kTile; ++y) result.rows[y] = rows[begin + y] >> reach;
  return result;
}

/// What a window holds, added up.
struct Tally {
  // Whole numbers, so that it does not matter in which order they are added: signed distances from
  // a plane [um] times 2^24, and of how many; pixels with a measurement times 2^32, and those of
  // the plane.
  using Sums = std::int64_t __attribute__((vector_size(16)));
  static constexpr int kShift = 24;

  static std::int64_t of_one(double distance_m) {
    return (static_cast<std::int64_t>(distance_m * 1e6) << kShift) + 1;
  }
  static double mean_distance_m(const Sums& sums) {
    const auto count = static_cast<int>(sums[0] & ((std::int64_t{1} << kShift) - 1));
    return 1e-6 * static_cast<double>(sums[0] >> kShift) / std::max(1, count);
  }
  static double company(const Sums& sums) {
    return static_cast<double>(sums[1] & 0xffffffff) / static_cast<double>(sums[1] >> 32);
  }
};

/// Sums over any rectangle of a part of the image, in four reads.
class BoxSums {
 public:
  /// Of `value(x, y)` of each pixel of the rectangle.
  template <typename Value>
  void fill(const Rect& rect, const Value& value) {
    rect_ = rect;
    stride_ = rect.width() + 1;
    sums_.resize(static_cast<std::size_t>(stride_) * (rect.height() + 1));
    std::fill_n(sums_.begin(), stride_, Tally::Sums{});
    Tally::Sums* above = sums_.data();
    for (int y = rect.y0; y < rect.y1; ++y, above += stride_) {
      Tally::Sums* sums = above + stride_;
      Tally::Sums row = sums[0] = Tally::Sums{};
      for (int x = 0; x < rect.width(); ++x) {
        row += value(rect.x0 + x, y);
        sums[x + 1] = above[x + 1] + row;
      }
    }
  }
  Tally::Sums of(const Rect& r) const {
    return sums_[at(r.x1, r.y1)] - sums_[at(r.x0, r.y1)] - sums_[at(r.x1, r.y0)] +
           sums_[at(r.x0, r.y0)];
  }

 private:
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y - rect_.y0) * stride_ + (x - rect_.x0);
  }
  Rect rect_;
  int stride_ = 0;
  std::vector<Tally::Sums> sums_;
};

class Borders {
 public:
  /// `plane`: per pixel, that of its point.
  Borders(const SegmentState& state, const Options& options, std::span<const std::int32_t> plane)
      : state_(state),
        options_(options),
        pixels_(state.more.pixels),
        plane_(plane),
        tau_m_(plane.size(), 0),
        reach_px_(plane.size(), 0) {
    const double reach_px = options.reach_m * pixels_.focal_px;
    for (std::size_t i = 0; i < plane.size(); ++i) {
      if (!pixels_.has(i)) continue;
      const double range = state.range(pixels_.measured[i].cast<double>());
      tau_m_[i] = std::max(state.noise.tau(range), 1e-9);
      reach_px_[i] = static_cast<std::uint8_t>(
          std::clamp<double>(reach_px / std::max(range, 0.01), 1, kMostReach_px));
    }
  }

  std::vector<std::int32_t> give_pixels() {
    std::vector<std::int32_t> result(plane_.begin(), plane_.end());
    const int columns = (pixels_.width + kTile - 1) / kTile;
    const int rows = (pixels_.height + kTile - 1) / kTile;
    const auto tile_at = [&](int column, int row) {
      return pixels_.around({column * kTile, row * kTile, (column + 1) * kTile, (row + 1) * kTile},
                            0);
    };
    std::vector<Held> held;  // per tile
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column)
        held.push_back(held_by(tile_at(column, row)));
    static_assert(kMostReach_px <= kTile);  // so that no planes but those of its neighbours matter
    std::vector<std::int32_t> candidates;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        candidates.clear();
        for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r)
          for (int c = std::max(0, column - 1); c <= std::min(columns - 1, column + 1); ++c)
            for (const std::int32_t k : held[r * columns + c].planes) add(k, candidates);
        std::ranges::sort(candidates);
        const bool has_open = held[row * columns + column].has_open;
        if (candidates.size() > (has_open ? 0u : 1u))
          give_tile(tile_at(column, row), candidates, result);
      }
    return result;
  }

 private:
  /// What a tile's pixels are on.
  struct Held {
    std::vector<std::int32_t> planes;
    bool has_open = false;  // pixels of no plane
  };
  static void add(std::int32_t plane, std::vector<std::int32_t>& planes) {
    if (std::ranges::find(planes, plane) == planes.end()) planes.push_back(plane);
  }
  Held held_by(const Rect& tile) const {
    Held held;
    std::int32_t last = -1;
    for (int y = tile.y0; y < tile.y1; ++y)
      for (std::size_t i = pixels_.at(tile.x0, y); i < pixels_.at(tile.x1, y); ++i) {
        const std::int32_t k = plane_[i];
        if (k < 0) held.has_open = held.has_open || pixels_.has(i);
        if (k < 0 || k == last) continue;
        add(k, held.planes);
        last = k;
      }
    return held;
  }

  /// `candidates`: the planes that may be in reach of the tile's pixels.
  void give_tile(const Rect& tile,
                 std::span<const std::int32_t> candidates,
                 std::vector<std::int32_t>& result) {
    find_borders(tile, candidates);
    least_.fill(std::numeric_limits<double>::infinity());
    for (std::size_t c = 0; c < candidates.size(); ++c)
      give_pixels_to(candidates[c], tile, borders_[c], result);
  }

  /// Of each candidate the tile's measured pixels that may go to it or leave it: its own that have
  /// another plane in reach, and those of others that have it.
  void find_borders(const Rect& tile, std::span<const std::int32_t> candidates) {
    const int left = tile.x0 - kMostReach_px, above = tile.y0 - kMostReach_px;
    TileSet with_reach[kMostReach_px + 1];
    int least_px = kMostReach_px, most_px = 0;
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x) {
        const int reach = reach_px_[pixels_.at(x, y)];
        if (reach == 0) continue;
        with_reach[reach].rows[y - tile.y0] |= std::uint64_t{1} << (x - left);
        least_px = std::min(least_px, reach);
        most_px = std::max(most_px, reach);
      }

    own_.assign(candidates.size(), {});
    const Rect rect = pixels_.around(tile, most_px);
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1;) {
        const int begin = x;
        const std::int32_t k = plane_[pixels_.at(x, y)];
        while (x < rect.x1 && plane_[pixels_.at(x, y)] == k) ++x;
        const auto found = std::ranges::lower_bound(candidates, k);
        if (found == candidates.end() || *found != k) continue;
        const std::uint64_t run = ~std::uint64_t{0} >> (64 - (x - begin));
        own_[found - candidates.begin()].rows[y - above] |= run << (begin - left);
      }

    borders_.assign(candidates.size(), {});
    reached_.resize(candidates.size());
    for (int reach = least_px; reach <= most_px; ++reach) {
      TileSet once, twice;  // in reach of a candidate, of more than one
      for (std::size_t c = 0; c < candidates.size(); ++c) {
        reached_[c] = near(own_[c], reach);
        for (int y = 0; y < kTile; ++y) {
          twice.rows[y] |= once.rows[y] & reached_[c].rows[y];
          once.rows[y] |= reached_[c].rows[y];
        }
      }
      for (std::size_t c = 0; c < candidates.size(); ++c)
        for (int y = 0; y < kTile; ++y)
          borders_[c].rows[y] |= with_reach[reach].rows[y] & reached_[c].rows[y] &
                                 (~own_[c].rows[y + kMostReach_px] | twice.rows[y]);
    }
  }

  /// The rectangle about the set in the image; empty where it is.
  static Rect bounds(const TileSet& set, const Rect& tile) {
    std::uint64_t columns = 0;
    Rect rect;
    for (int y = 0; y < kTile; ++y) {
      if (set.rows[y] == 0) continue;
      if (columns == 0) rect.y0 = tile.y0 + y;
      rect.y1 = tile.y0 + y + 1;
      columns |= set.rows[y];
    }
    if (columns == 0) return {};
    const int left = tile.x0 - kMostReach_px;
    rect.x0 = left + std::countr_zero(columns);
    rect.x1 = left + 64 - std::countl_zero(columns);
    return rect;
  }

  /// Those of the set that lie on the plane better than on the planes before it.
  void give_pixels_to(std::int32_t k,
                      const Rect& tile,
                      const TileSet& set,
                      std::vector<std::int32_t>& result) {
    const Rect around = bounds(set, tile);
    if (around.width() == 0) return;
    const PlaneFit& fit = state_.planes[k].fit;
    const auto distance_m = [&](std::size_t i) {
      return fit.distance_m(pixels_.measured[i].cast<double>());
    };
    // Signed distances of what may lie on the plane: noise averages away, a slope does not.
    sums_.fill(pixels_.around(around, options_.window_px / 2), [&](int x, int y) {
      const std::size_t i = pixels_.at(x, y);
      const double tau_m = tau_m_[i];
      if (tau_m <= 0) return Tally::Sums{};
      const std::int64_t counts = (std::int64_t{1} << 32) + (plane_[i] == k ? 1 : 0);
      const double off_m = distance_m(i);
      if (std::abs(off_m) > 2 * tau_m) return Tally::Sums{0, counts};
      return Tally::Sums{Tally::of_one(std::clamp(off_m, -tau_m, tau_m)), counts};
    });
    for (int y = around.y0; y < around.y1; ++y)
      for (std::uint64_t row = set.rows[y - tile.y0]; row != 0; row &= row - 1) {
        const int x = tile.x0 - kMostReach_px + std::countr_zero(row);
        const std::size_t i = pixels_.at(x, y);
        const double tau_m = tau_m_[i];
        if (plane_[i] != k && std::abs(distance_m(i)) > options_.taus * tau_m) continue;
        const Tally::Sums sums =
            sums_.of(pixels_.around({x, y, x + 1, y + 1}, options_.window_px / 2));
        const double off_m = std::abs(Tally::mean_distance_m(sums));
        const double cost = off_m / tau_m - options_.company_taus * Tally::company(sums);
        double& best = least_[static_cast<std::size_t>(y - tile.y0) * kTile + (x - tile.x0)];
        if (cost >= best) continue;
        best = cost;
        result[i] = k;
      }
  }

  const SegmentState& state_;
  const Options& options_;
  const PixelGrid& pixels_;
  const std::span<const std::int32_t> plane_;

  // Per pixel; 0 where nothing was measured.
  std::vector<double> tau_m_;
  std::vector<std::uint8_t> reach_px_;

  // Of one tile.
  std::vector<PixelSet> own_;               // per candidate
  std::vector<TileSet> reached_, borders_;  // likewise
  std::array<double, static_cast<std::size_t>(kTile)* kTile> least_ =
      {};  // cost of the best plane so far
  BoxSums sums_;
};

/// A point goes where most of its pixels went; where as many stayed, it stays. `before`: per pixel,
/// the plane of its point.
void move_points(SegmentState& state, std::span<const std::int32_t> before) {
  const PixelGrid& pixels = state.more.pixels;
  std::vector<std::uint8_t> in_doubt(state.plane_of.size(), 0);
  for (std::size_t p = 0; p < before.size(); ++p)
    if (state.plane_of_pixel[p] != before[p]) in_doubt[pixels.point[p]] = 1;
  std::vector<std::uint32_t> morton(state.plane_of.size());
  for (std::uint32_t i = 0; i < morton.size(); ++i) morton[state.octree.order[i]] = i;
  std::vector<std::pair<std::uint32_t, std::int32_t>> votes;
  for (std::size_t p = 0; p < before.size(); ++p)
    if (pixels.has(p) && in_doubt[pixels.point[p]])
      votes.emplace_back(morton[pixels.point[p]], state.plane_of_pixel[p]);
  std::ranges::sort(votes);
  for (std::size_t v = 0; v < votes.size();) {
    const std::uint32_t i = votes[v].first;
    const std::int32_t now = state.plane_of[i];
    std::int32_t winner = now;
    std::size_t most = 0, stay = 0;
    while (v < votes.size() && votes[v].first == i) {
      const std::size_t begin = v;
      while (v < votes.size() && votes[v] == votes[begin]) ++v;
      if (votes[begin].second == now) stay = v - begin;
      if (v - begin > most) most = v - begin, winner = votes[begin].second;
    }
    if (winner == now || most == stay) continue;
    log(state, {.type = now < 0 ? EventType::assign : EventType::refine,
                .stage = Stage::r11_pixel_borders,
                .plane = now < 0 ? winner : now,
                .other = now < 0 ? -1 : winner,
                .point = state.input_index(i),
                .value = static_cast<float>(
                    std::abs(state.planes[winner].fit.distance_m(state.point(i))))});
    give_point(state, i, winner);
  }
}

}  // namespace

void run(SegmentState& state, const Options& options) {
  if (!options.on || state.more.pixels.empty()) return;
  const std::vector<std::int32_t> plane = planes_of_pixels(state);
  state.plane_of_pixel = Borders(state, options, plane).give_pixels();
  move_points(state, plane);
}

}  // namespace planescope::planes::r11_pixel_borders
