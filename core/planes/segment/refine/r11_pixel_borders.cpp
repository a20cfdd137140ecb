#include "core/planes/segment/refine/r11_pixel_borders.hpp"

#include <algorithm>
#include <cmath>

#include "core/planes/segment/state.hpp"

namespace planescope::planes::r11_pixel_borders {
namespace {

constexpr int kTile = 32;  // [px]
constexpr int kMostReach_px = 20;

/// Sums over any rectangle of a part of the image, in four reads.
template <typename T>
class BoxSums {
 public:
  /// Of `value(x, y)` of each pixel of the rectangle.
  template <typename Value>
  void fill(const Rect& rect, const Value& value) {
    rect_ = rect;
    stride_ = rect.width() + 1;
    sums_.assign(static_cast<std::size_t>(stride_) * (rect.height() + 1), T{});
    for (int y = rect.y0; y < rect.y1; ++y)
      for (int x = rect.x0; x < rect.x1; ++x)
        sums_[at(x + 1, y + 1)] =
            value(x, y) + sums_[at(x, y + 1)] + sums_[at(x + 1, y)] - sums_[at(x, y)];
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

class Borders {
 public:
  Borders(const SegmentState& state, const Options& options)
      : state_(state),
        options_(options),
        pixels_(state.more.pixels),
        plane_(planes_of_pixels(state)) {}

  std::vector<std::int32_t> give_pixels() {
    std::vector<std::int32_t> result = plane_;
    for (int y = 0; y < pixels_.height; y += kTile)
      for (int x = 0; x < pixels_.width; x += kTile)
        give_tile(pixels_.around({x, y, x + kTile, y + kTile}, 0), result);
    return result;
  }

 private:
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
    const double reach = options_.reach_m * pixels_.focal_px / std::max(range, 0.01);
    m.reach_px = static_cast<int>(std::clamp<double>(reach, 1, kMostReach_px));
    return m;
  }

  /// Planes around the tile, ascending; none where its pixels have no choice.
  std::vector<std::int32_t> candidates(const Rect& tile, const Rect& reached) const {
    std::vector<std::int32_t> planes;
    for (int y = reached.y0; y < reached.y1; ++y)
      for (int x = reached.x0; x < reached.x1; ++x)
        if (const std::int32_t k = plane_[pixels_.at(x, y)];
            k >= 0 && (planes.empty() || planes.back() != k))
          planes.push_back(k);
    std::ranges::sort(planes);
    planes.erase(std::unique(planes.begin(), planes.end()), planes.end());
    if (planes.size() > 1) return planes;
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x)
        if (const std::size_t i = pixels_.at(x, y); pixels_.has(i) && plane_[i] < 0) return planes;
    return {};
  }

  void give_tile(const Rect& tile, std::vector<std::int32_t>& result) {
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
    const Rect reached = pixels_.around(tile, farthest_px);
    least_.assign(static_cast<std::size_t>(kTile) * kTile, std::numeric_limits<double>::infinity());
    for (const std::int32_t k : candidates(tile, reached)) {
      own_.fill(reached, [&](int x, int y) { return plane_[pixels_.at(x, y)] == k ? 1 : 0; });
      give_pixels_to(k, tile, result);
    }
  }

  /// Those that lie on the plane better than on the planes before it.
  void give_pixels_to(std::int32_t k, const Rect& tile, std::vector<std::int32_t>& result) {
    const PlaneFit& fit = state_.planes[k].fit;
    // Signed distances of what may lie on the plane: noise averages away, a slope does not.
    counted_.fill(near_, [&](int x, int y) {
      Measured& m = known(x, y);
      m.distance_m = m.tau > 0 ? fit.distance_m(m.point) : 0;
      return m.tau > 0 && std::abs(m.distance_m) <= 2 * m.tau ? 1 : 0;
    });
    distances_.fill(near_, [&](int x, int y) {
      const Measured& m = known(x, y);
      return std::abs(m.distance_m) <= 2 * m.tau ? std::clamp(m.distance_m, -m.tau, m.tau) : 0;
    });
    for (int y = tile.y0; y < tile.y1; ++y)
      for (int x = tile.x0; x < tile.x1; ++x) {
        const std::size_t i = pixels_.at(x, y);
        const Measured& m = known(x, y);
        const Rect pixel{x, y, x + 1, y + 1};
        if (!pixels_.has(i)) continue;
        if (plane_[i] != k && (std::abs(m.distance_m) > options_.taus * m.tau ||
                               own_.of(pixels_.around(pixel, m.reach_px)) == 0))
          continue;
        const Rect window = pixels_.around(pixel, options_.window_px / 2);
        const double off_m = std::abs(distances_.of(window)) / std::max(1, counted_.of(window));
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
  std::vector<double> least_;  // cost of the best plane so far
  BoxSums<int> all_, own_, counted_;
  BoxSums<double> distances_;
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
