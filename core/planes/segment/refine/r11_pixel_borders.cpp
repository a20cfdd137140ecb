#include "core/planes/segment/refine/r11_pixel_borders.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>

#include "core/model/parallel.hpp"
#include "core/planes/segment/depth_kernels.hpp"
#include "core/planes/segment/state.hpp"
#include "core/planes/segment/tile_depth.hpp"
#include "core/planes/segment/tile_sets.hpp"
#include "core/planes/segment/window_sums.hpp"

namespace planescope::planes::r11_pixel_borders {
namespace {

void add_plane(std::int32_t plane, std::vector<std::int32_t>& planes) {
  if (std::ranges::find(planes, plane) == planes.end()) planes.push_back(plane);
}

/// What the pixels of each tile are on.
class TilePlanes {
 public:
  /// `plane`: per pixel, that of its point.
  TilePlanes(const PixelGrid& pixels, const PixelReach& reach, std::span<const std::int32_t> plane)
      : pixels_(pixels),
        columns_((pixels.width + kTile - 1) / kTile),
        rows_((pixels.height + kTile - 1) / kTile) {
    for (int row = 0; row < rows_; ++row)
      for (int column = 0; column < columns_; ++column)
        held_.push_back(held_by(tile(column, row), reach, plane));
  }

  int columns() const { return columns_; }
  int rows() const { return rows_; }
  Rect tile(int column, int row) const {
    return pixels_.around({column * kTile, row * kTile, (column + 1) * kTile, (row + 1) * kTile},
                          0);
  }
  /// The planes that may be in reach of the tile's pixels, ascending; none where no pixel may go
  /// from one to another.
  void find_candidates(int column, int row, std::vector<std::int32_t>& candidates) const {
    static_assert(kMostReach_px <= kTile);  // so that no planes but those of its neighbours matter
    candidates.clear();
    for (int r = std::max(0, row - 1); r <= std::min(rows_ - 1, row + 1); ++r)
      for (int c = std::max(0, column - 1); c <= std::min(columns_ - 1, column + 1); ++c)
        for (const std::int32_t k : held_[r * columns_ + c].planes) add_plane(k, candidates);
    std::ranges::sort(candidates);
    if (candidates.size() == 1 && !held_[row * columns_ + column].has_open) candidates.clear();
  }

 private:
  struct Held {
    std::vector<std::int32_t> planes;
    bool has_open = false;  // pixels of no plane
  };
  Held held_by(const Rect& tile,
               const PixelReach& reaches,
               std::span<const std::int32_t> plane) const {
    Held held;
    for (int y = tile.y0; y < tile.y1; ++y) {
      const std::int32_t* row = &plane[pixels_.at(tile.x0, y)];
      const std::uint8_t* reach = &reaches.reach_px[pixels_.at(tile.x0, y)];
      const int width = tile.width();
      std::int32_t unlike = 0;  // most rows have one plane throughout: told without branches
      for (int x = 0; x < width; ++x) unlike |= row[x] ^ row[0];
      std::int32_t last = -1;
      for (int x = 0; x < (unlike == 0 ? 1 : width); ++x)
        if (row[x] >= 0 && row[x] != last) add_plane(last = row[x], held.planes);
      if (held.has_open || (unlike == 0 && row[0] >= 0)) continue;
      std::int32_t open = 0;
      for (int x = 0; x < width; ++x) open |= row[x] < 0 ? reach[x] : 0;
      held.has_open = open != 0;
    }
    return held;
  }

  const PixelGrid& pixels_;
  int columns_, rows_;
  std::vector<Held> held_;
};

/// Gives pixels to planes, tile by tile.
class Borders {
 public:
  /// `plane`: per pixel, that of its point.
  Borders(const SegmentState& state, const Options& options, std::span<const std::int32_t> plane)
      : state_(state),
        options_(options),
        pixels_(state.more.pixels),
        reach_(state.reach_of_pixels()),
        plane_(plane),
        kernels_(depth_kernels(best_simd())) {}

  /// Writes to the tile's pixels alone.
  void give_tile(const Rect& tile,
                 std::span<const std::int32_t> candidates,
                 std::vector<std::int32_t>& result) {
    find_borders(tile, candidates);
    bool loaded = false;
    for (std::size_t c = 0; c < candidates.size(); ++c) {
      const Rect around = bounds(borders_[c], tile);
      if (around.width() == 0) continue;
      if (!loaded) {
        depth_.load(pixels_, reach_, plane_, tile, options_.window_px / 2);
        least_.fill(std::numeric_limits<double>::infinity());
        loaded = true;
      }
      if (fits_into_32_bits(depth_.most_tau_m()))
        give_pixels_to(candidates[c], tile, borders_[c], around, off_um_, result);
      else
        give_pixels_to(candidates[c], tile, borders_[c], around, wide_off_um_, result);
    }
  }

 private:
  /// Of each candidate the tile's measured pixels that may go to it or leave it: its own that have
  /// another plane in reach, and those of others that have it.
  void find_borders(const Rect& tile, std::span<const std::int32_t> candidates) {
    const int left = tile.x0 - kMostReach_px, above = tile.y0 - kMostReach_px;
    TileSet with_reach[kMostReach_px + 1];
    int least_px = kMostReach_px, most_px = 0;
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x) {
        const int reach = reach_.reach_px[pixels_.at(x, y)];
        with_reach[reach].rows[y - tile.y0] |= std::uint64_t{1} << (x - left);
        if (reach > 0) least_px = std::min(least_px, reach);
        most_px = std::max(most_px, reach);
      }

    own_.assign(candidates.size(), {});
    const Rect rect = pixels_.around(tile, most_px);
    for (int y = rect.y0; y < rect.y1; ++y) {
      const std::int32_t* row = &plane_[pixels_.at(0, y)];
      for (int x = rect.x0; x < rect.x1;) {
        const int begin = x;
        const std::int32_t k = row[x];
        x = static_cast<int>(end_of_run({row, static_cast<std::size_t>(rect.x1)}, x));
        if (k < 0) continue;
        const auto found = std::ranges::lower_bound(candidates, k);
        if (found == candidates.end() || *found != k) continue;
        const std::uint64_t run = ~std::uint64_t{0} >> (64 - (x - begin));
        own_[found - candidates.begin()].rows[y - above] |= run << (begin - left);
      }
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

  /// Sums of distances of at most tau, over a window's rows across a tile and around it [um].
  bool fits_into_32_bits(double tau_m) const {
    const double window_px = options_.window_px;
    return 1e6 * tau_m * window_px * (kTile + window_px) < std::numeric_limits<std::int32_t>::max();
  }

  void lay_on(std::int32_t k,
              const PixelRow& row,
              int width,
              std::int32_t* off_um,
              std::int32_t* counts) const {
    const auto& [count, centroid, normal, eigenvalues] = state_.planes[k].fit;
    kernels_.lay_on(
        row, width,
        {{normal.x(), normal.y(), normal.z()}, {centroid.x(), centroid.y(), centroid.z()}, k},
        off_um, counts);
  }
  /// The same for distances that take more bits, which no camera measures.
  void lay_on(std::int32_t k,
              const PixelRow& row,
              int width,
              std::int64_t* off_um,
              std::int32_t* counts) const {
    for (int i = 0; i < width; ++i) {
      const double off_m = state_.planes[k].fit.distance_m({row.x[i], row.y[i], row.z[i]});
      const bool may_lie_on_it = std::abs(off_m) <= 2 * row.tau_m[i];
      off_um[i] =
          may_lie_on_it
              ? static_cast<std::int64_t>(std::clamp(off_m, -row.tau_m[i], row.tau_m[i]) * 1e6)
              : 0;
      counts[i] = (may_lie_on_it ? 1 : 0) + (row.plane[i] == k ? kOwnPixel : 0);
    }
  }

  /// Those of the set that lie on the plane better than on the planes before it. `around`: the
  /// rectangle about the set.
  template <typename Int>
  void give_pixels_to(std::int32_t k,
                      const Rect& tile,
                      const TileSet& set,
                      const Rect& around,
                      WindowSums<Int>& off_um,
                      std::vector<std::int32_t>& result) {
    const PlaneFit& fit = state_.planes[k].fit;
    // Signed distances of what may lie on the plane: noise averages away, a slope does not.
    const int half = options_.window_px / 2;
    const Rect rect = pixels_.around(around, half);
    off_um.start(rect.width(), rect.height(), half);
    counts_.start(rect.width(), rect.height(), half);
    for (int y = rect.y0; y < rect.y1; ++y)
      lay_on(k, depth_.row(rect.x0, y), rect.width(), off_um.row(y - rect.y0),
             counts_.row(y - rect.y0));
    for (int y = around.y0; y < around.y1; ++y) {
      std::uint64_t row = set.rows[y - tile.y0];
      if (row == 0) continue;
      off_um.move_to(y - rect.y0);
      counts_.move_to(y - rect.y0);
      for (; row != 0; row &= row - 1) {
        const int x = tile.x0 - kMostReach_px + std::countr_zero(row);
        const std::size_t i = pixels_.at(x, y);
        const double tau_m = depth_.tau_m(x, y);
        if (plane_[i] != k && std::abs(depth_.distance_m(fit, x, y)) > options_.taus * tau_m)
          continue;
        const std::int32_t counts = counts_.at(x - rect.x0);
        const int on_plane = counts % kOwnPixel, own = counts / kOwnPixel;
        const double off_m =
            std::abs(1e-6 * static_cast<double>(off_um.at(x - rect.x0)) / std::max(1, on_plane));
        const double company = static_cast<double>(own) / depth_.measured_in_window(x, y);
        const double cost = off_m / tau_m - options_.company_taus * company;
        double& best = least_[static_cast<std::size_t>(y - tile.y0) * kTile + (x - tile.x0)];
        if (cost >= best) continue;
        best = cost;
        result[i] = k;
      }
    }
  }

  const SegmentState& state_;
  const Options& options_;
  const PixelGrid& pixels_;
  const PixelReach& reach_;
  const std::span<const std::int32_t> plane_;
  const DepthKernels& kernels_;

  // Of one tile.
  std::vector<PixelSet> own_;               // per candidate
  std::vector<TileSet> reached_, borders_;  // likewise
  std::array<double, static_cast<std::size_t>(kTile)* kTile> least_ =
      {};  // cost of the best plane so far
  TileDepth depth_;
  WindowSums<std::int32_t> off_um_, counts_;
  WindowSums<std::int64_t> wide_off_um_;
};

std::vector<std::int32_t> give_pixels(const SegmentState& state,
                                      const Options& options,
                                      std::span<const std::int32_t> plane) {
  std::vector<std::int32_t> result(plane.begin(), plane.end());
  const TilePlanes tiles(state.more.pixels, state.reach_of_pixels(), plane);
  work_through_with(tiles.rows(), state.threads, [&] {
    return [&, borders = Borders(state, options, plane),
            candidates = std::vector<std::int32_t>()](int row) mutable {
      for (int column = 0; column < tiles.columns(); ++column) {
        tiles.find_candidates(column, row, candidates);
        if (!candidates.empty()) borders.give_tile(tiles.tile(column, row), candidates, result);
      }
    };
  });
  return result;
}

/// A point goes where most of its pixels went; where as many stayed, it stays. `before`: per pixel,
/// the plane of its point.
void move_points(SegmentState& state, std::span<const std::int32_t> before) {
  const std::span<const MeasuredRun> runs = state.pixel_runs();
  const std::vector<std::int32_t>& after = state.plane_of_pixel;
  std::vector<std::uint8_t> in_doubt(state.plane_of.size(), 0);
  constexpr std::size_t kAtOnce = 256;  // pixels: hardly any are given away
  for (std::size_t first = 0, r = 0; first < before.size(); first += kAtOnce) {
    const std::size_t end = std::min(first + kAtOnce, before.size());
    if (std::memcmp(&before[first], &after[first], (end - first) * sizeof(std::int32_t)) == 0)
      continue;
    for (std::size_t p = first; p < end; ++p) {
      if (after[p] == before[p]) continue;
      while (runs[r + 1].begin <= p) ++r;
      in_doubt[runs[r].point] = 1;
    }
  }
  struct Vote {
    std::uint32_t point = 0;
    std::int32_t plane = -1;
    std::size_t pixels = 0;
  };
  std::vector<Vote> votes;
  for (std::size_t r = 0; r + 1 < runs.size(); ++r)
    if (runs[r].is_measured() && in_doubt[runs[r].point])
      for (std::uint32_t p = runs[r].begin; p < runs[r + 1].begin;) {
        const std::uint32_t begin = p;
        const std::int32_t plane = after[p];
        do ++p;
        while (p < runs[r + 1].begin && after[p] == plane);
        votes.push_back({runs[r].point, plane, p - begin});
      }
  std::ranges::sort(votes, {}, [](const Vote& v) { return std::pair(v.point, v.plane); });
  for (std::size_t v = 0; v < votes.size();) {
    const std::uint32_t i = votes[v].point;
    const std::int32_t now = state.plane_of[i];
    std::int32_t winner = now;
    std::size_t most = 0, stay = 0;
    while (v < votes.size() && votes[v].point == i) {
      const std::int32_t plane = votes[v].plane;
      std::size_t pixels = 0;
      for (; v < votes.size() && votes[v].point == i && votes[v].plane == plane; ++v)
        pixels += votes[v].pixels;
      if (plane == now) stay = pixels;
      if (pixels > most) most = pixels, winner = plane;
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
  const std::span<const std::int32_t> plane = planes_of_pixels(state);
  state.plane_of_pixel = give_pixels(state, options, plane);
  move_points(state, plane);
}

}  // namespace planescope::planes::r11_pixel_borders
