#include "core/planes/segment/refine/r11_pixel_borders.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "core/planes/segment/state.hpp"

namespace planescope::planes::r11_pixel_borders {
namespace {

constexpr int kTile = 32;  // [px]
constexpr int kMostReach_px = 20;

/// Sums over any rectangle of a part of the image, in four reads. Of whole numbers, so that it
/// does not matter in which order they are added.
template <typename T>
class BoxSums {
 public:
  /// Of `value(x, y)` of each pixel of the rectangle.
  template <typename Value>
  void fill(const Rect& rect, const Value& value) {
    rect_ = rect;
    stride_ = rect.width() + 1;
    sums_.resize(static_cast<std::size_t>(stride_) * (rect.height() + 1));
    std::fill_n(sums_.begin(), stride_, T{});
    T* above = sums_.data();
    for (int y = rect.y0; y < rect.y1; ++y, above += stride_) {
      T* sums = above + stride_;
      T row = sums[0] = 0;
      for (int x = 0; x < rect.width(); ++x) {
        row += value(rect.x0 + x, y);
        sums[x + 1] = above[x + 1] + row;
      }
    }
  }
  T of(const Rect& r) const {
    return sums_[at(r.x1, r.y1)] - sums_[at(r.x0, r.y1)] - sums_[at(r.x1, r.y0)] +
           sums_[at(r.x0, r.y0)];
  }

 private:
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y - rect_.y0) * stride_ + (x - rect_.x0);
  }
  Rect rect_;
  int stride_ = 0;
  std::vector<T> sums_;
};

/// How many measurements there are, and the sum of their distances from a plane, in one number to
/// be added up: [um] times 2^24, and the count.
struct Tally {
  static constexpr std::int64_t kShift = 24;
  static std::int64_t of_one(double distance_m) {
    return (static_cast<std::int64_t>(distance_m * 1e6) << kShift) + 1;
  }
  static int count(std::int64_t sum) {
    return static_cast<int>(sum & ((std::int64_t{1} << kShift) - 1));
  }
  static double distance_m(std::int64_t sum) { return 1e-6 * static_cast<double>(sum >> kShift); }
};

class Borders {
 public:
  Borders(const SegmentState& state, const Options& options)
      : state_(state),
        options_(options),
        pixels_(state.more.pixels),
        plane_(planes_of_pixels(state)) {}

  std::vector<std::int32_t> give_pixels() {
    std::vector<std::int32_t> result = plane_;
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
    const int most_px = reach_px(nearest_m());
    std::vector<Part> candidates;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        candidates.clear();
        for (int r = std::max(0, row - 1); r <= std::min(rows - 1, row + 1); ++r)
          for (int c = std::max(0, column - 1); c <= std::min(columns - 1, column + 1); ++c)
            for (const Part& part : held[r * columns + c].parts) add(part, candidates);
        const Rect tile = tile_at(column, row);
        std::erase_if(candidates, [&](const Part& part) {
          return is_empty(within(tile, pixels_.around(part.around, most_px)));
        });
        std::ranges::sort(candidates, {}, &Part::plane);
        const bool has_open = held[row * columns + column].has_open;
        if (candidates.size() > (has_open ? 0u : 1u)) give_tile(tile, candidates, result);
      }
    return result;
  }

 private:
  /// A plane, and the rectangle around its pixels in some part of the image.
  struct Part {
    std::int32_t plane = -1;
    Rect around;
  };
  static void add(const Part& part, std::vector<Part>& parts) {
    const auto found = std::ranges::find(parts, part.plane, &Part::plane);
    if (found == parts.end()) return parts.push_back(part);
    Rect& rect = found->around;
    rect = {std::min(rect.x0, part.around.x0), std::min(rect.y0, part.around.y0),
            std::max(rect.x1, part.around.x1), std::max(rect.y1, part.around.y1)};
  }

  static Rect within(const Rect& a, const Rect& b) {
    return {std::max(a.x0, b.x0), std::max(a.y0, b.y0), std::min(a.x1, b.x1), std::min(a.y1, b.y1)};
  }
  static bool is_empty(const Rect& rect) { return rect.x0 >= rect.x1 || rect.y0 >= rect.y1; }

  /// What a tile's pixels are on.
  struct Held {
    std::vector<Part> parts;
    bool has_open = false;  // pixels of no plane
  };
  Held held_by(const Rect& tile) const {
    Held held;
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1;) {
        const int begin = x;
        const std::int32_t k = plane_[pixels_.at(x, y)];
        for (; x < tile.x1 && plane_[pixels_.at(x, y)] == k; ++x)
          held.has_open = held.has_open || (k < 0 && pixels_.has(pixels_.at(x, y)));
        if (k >= 0) add({k, {begin, y, x, y + 1}}, held.parts);
      }
    return held;
  }

  /// What one pixel is to any plane.
  struct Measured {
    Vec3d point = Vec3d::Zero();
    double tau = 0;  // [m]; 0: nothing was measured
    int reach_px = 0;
    double distance_m = 0;  // of the plane in question
  };
  Measured measured(std::size_t i) const {
    Measured m;
    m.point = pixels_.measured[i].cast<double>();
    const double range = state_.range(m.point);
    m.tau = state_.noise.tau(range);
    m.reach_px = reach_px(range);
    return m;
  }
  int reach_px(double range) const {
    const double reach = options_.reach_m * pixels_.focal_px / std::max(range, 0.01);
    return static_cast<int>(std::clamp<double>(reach, 1, kMostReach_px));
  }
  /// What was measured nearest to the sensor.
  double nearest_m() const {
    const Vec3f sensor = state_.sensor.cast<float>();
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < pixels_.point.size(); ++i)
      if (pixels_.has(i)) least = std::min(least, (pixels_.measured[i] - sensor).squaredNorm());
    return 0.999 * std::sqrt(static_cast<double>(least));  // and somewhat less, for rounding
  }

  /// `candidates`: the planes that may be in reach of the tile's pixels.
  void give_tile(const Rect& tile,
                 std::span<const Part> candidates,
                 std::vector<std::int32_t>& result) {
    const int half = options_.window_px / 2;
    near_ = pixels_.around(tile, half);
    known_.assign(static_cast<std::size_t>(near_.width()) * near_.height(), {});
    int farthest_px = half;
    all_.fill(near_, [&](int x, int y) {
      const std::size_t i = pixels_.at(x, y);
      if (!pixels_.has(i)) return 0;
      known(x, y) = measured(i);
      farthest_px = std::max(farthest_px, known(x, y).reach_px);
      return 1;
    });
    any_.fill(pixels_.around(tile, farthest_px),
              [&](int x, int y) { return plane_[pixels_.at(x, y)] >= 0 ? 1 : 0; });
    least_.assign(static_cast<std::size_t>(kTile) * kTile, std::numeric_limits<double>::infinity());
    for (const Part& candidate : candidates) {
      const Rect part = within(tile, pixels_.around(candidate.around, farthest_px));
      if (is_empty(part)) continue;
      own_.fill(pixels_.around(part, farthest_px),
                [&](int x, int y) { return plane_[pixels_.at(x, y)] == candidate.plane ? 1 : 0; });
      give_pixels_to(candidate.plane, tile, part, result);
    }
  }

  /// Those that lie on the plane better than on the planes before it.
  /// `part`: the rectangle of the tile that is within reach of it.
  void give_pixels_to(std::int32_t k,
                      const Rect& tile,
                      const Rect& part,
                      std::vector<std::int32_t>& result) {
    const PlaneFit& fit = state_.planes[k].fit;
    // Signed distances of what may lie on the plane: noise averages away, a slope does not.
    off_.fill(pixels_.around(part, options_.window_px / 2), [&](int x, int y) -> std::int64_t {
      Measured& m = known(x, y);
      if (m.tau <= 0) return 0;
      m.distance_m = fit.distance_m(m.point);
      if (std::abs(m.distance_m) > 2 * m.tau) return 0;
      return Tally::of_one(std::clamp(m.distance_m, -m.tau, m.tau));
    });
    for (int y = part.y0; y < part.y1; ++y)
      for (int x = part.x0; x < part.x1; ++x) {
        const std::size_t i = pixels_.at(x, y);
        const Measured& m = known(x, y);
        const Rect pixel{x, y, x + 1, y + 1};
        if (!pixels_.has(i)) continue;
        const bool is_own = plane_[i] == k;
        if (!is_own && std::abs(m.distance_m) > options_.taus * m.tau) continue;
        const Rect in_reach = pixels_.around(pixel, m.reach_px);
        const int own = own_.of(in_reach);
        if (is_own ? own == any_.of(in_reach) : own == 0) continue;  // no other, or not this one
        const Rect window = pixels_.around(pixel, options_.window_px / 2);
        const std::int64_t off = off_.of(window);
        const double off_m = std::abs(Tally::distance_m(off)) / std::max(1, Tally::count(off));
        const double company = static_cast<double>(own_.of(window)) / all_.of(window);
        const double cost = off_m / m.tau - options_.company_taus * company;
        double& best = least_[static_cast<std::size_t>(y - tile.y0) * kTile + (x - tile.x0)];
        if (cost >= best) continue;
        best = cost;
        result[i] = k;
      }
  }

  Measured& known(int x, int y) {
    return known_[static_cast<std::size_t>(y - near_.y0) * near_.width() + (x - near_.x0)];
  }

  const SegmentState& state_;
  const Options& options_;
  const PixelGrid& pixels_;
  const std::vector<std::int32_t> plane_;  // per pixel, that of its point

  // Of one tile.
  Rect near_;  // it and the windows of its pixels
  std::vector<Measured> known_;
  std::vector<double> least_;     // cost of the best plane so far
  BoxSums<int> all_, any_, own_;  // with a measurement, of any plane, of the one in question
  BoxSums<std::int64_t> off_;
};

/// A point goes where most of its pixels went; where as many stayed, it stays.
void move_points(SegmentState& state) {
  const PixelGrid& pixels = state.more.pixels;
  std::vector<std::uint32_t> morton(state.plane_of.size());
  for (std::uint32_t i = 0; i < morton.size(); ++i) morton[state.octree.order[i]] = i;
  std::vector<std::pair<std::uint32_t, std::int32_t>> votes;
  std::vector<std::uint8_t> in_doubt(morton.size(), 0);
  for (std::size_t p = 0; p < pixels.point.size(); ++p)
    if (pixels.has(p)) {
      const std::uint32_t i = morton[pixels.point[p]];
      if (state.plane_of_pixel[p] != state.plane_of[i]) in_doubt[i] = 1;
    }
  for (std::size_t p = 0; p < pixels.point.size(); ++p)
    if (pixels.has(p))
      if (const std::uint32_t i = morton[pixels.point[p]]; in_doubt[i])
        votes.emplace_back(i, state.plane_of_pixel[p]);
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
  state.plane_of_pixel = Borders(state, options).give_pixels();
  move_points(state);
}

}  // namespace planescope::planes::r11_pixel_borders
