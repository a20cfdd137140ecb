// Joins parts of one plane that are separated by a closer object.

#include <algorithm>
#include <array>
#include <cmath>

#include "core/model/disjoint_sets.hpp"
#include "core/planes/depth/regions.hpp"

namespace planescope::planes {
namespace {

constexpr double kLeastPart = 500;          // px
constexpr double kWidestGap = 200.0 / 640;  // share of the image's width
constexpr double kWidestHole = 40.0 / 640;  // same, if the gap between them is unmeasured
constexpr int kLinesFrom = 64,
              kLinesTo = 256;     // number of sampled pixels on either rim
constexpr double kInFront = 0.9;  // smallest share of the pixels between them that must be in front

struct Pair {
  double cost = 0;
  std::int32_t a = 0, b = 0;
};

struct Line {
  double length2_px2 = 0;
  std::uint32_t from = 0, to = 0;
};

class HiddenParts {
 public:
  explicit HiddenParts(DepthSegmentation& s)
      : s_(s), rim_(s.regions.size()), roots_(s.regions.size()) {}

  void run() {
    const double limit = s_.options.hidden_share * s_.options.merge_cost;
    std::vector<std::int32_t> large;
    for (std::size_t k = 0; k < s_.regions.size(); ++k)
      if (s_.regions[k].alive && s_.regions[k].moments.n >= kLeastPart)
        large.push_back(static_cast<std::int32_t>(k));
    std::vector<Pair> pairs;
    for (std::size_t i = 0; i < large.size(); ++i)
      for (std::size_t j = i + 1; j < large.size(); ++j)
        if (const double cost = s_.join_cost(large[i], large[j]); cost < limit)
          pairs.push_back({cost, large[i], large[j]});
    if (pairs.empty()) return;
    std::ranges::stable_sort(pairs, {}, &Pair::cost);
    find_rims();
    for (const Pair& pair : pairs) {
      const std::int32_t a = roots_.root(pair.a), b = roots_.root(pair.b);
      if (a == b) continue;
      const double cost = s_.join_cost(a, b);
      if (cost >= limit || !is_hidden_between(pair, a, b)) continue;
      const bool first = s_.regions[a].moments.n >= s_.regions[b].moments.n;
      join_regions(s_, Stage::hidden, first ? b : a, first ? a : b, cost);
      roots_.join_into(first ? b : a, first ? a : b);
    }
    roots_.apply_to(s_.region_of);
  }

 private:
  void find_rims() {
    std::vector<std::uint32_t> borders;
    for (int y = 1; y + 1 < s_.image.height; ++y)
      append_border_pixels(s_.region_of, s_.image.width, y, borders);
    for (const std::uint32_t pixel : borders) rim_[s_.region_of[pixel]].push_back(pixel);
  }

  /// Finds the shortest lines from one rim to the other.
  std::vector<Line> shortest_lines(const Pair& pair) const {
    const std::vector<std::uint32_t>&from = rim_[pair.a], &to = rim_[pair.b];
    const std::size_t step_from = std::max<std::size_t>(1, from.size() / kLinesFrom);
    const std::size_t step_to = std::max<std::size_t>(1, to.size() / kLinesTo);
    std::vector<Line> lines;
    for (std::size_t i = 0; i < from.size(); i += step_from) {
      Line best{INFINITY, from[i], from[i]};
      for (std::size_t j = 0; j < to.size(); j += step_to) {
        const double du = s_.u(to[j]) - s_.u(from[i]), dv = s_.v(to[j]) - s_.v(from[i]);
        if (du * du + dv * dv < best.length2_px2) best = {du * du + dv * dv, from[i], to[j]};
      }
      if (std::isfinite(best.length2_px2)) lines.push_back(best);
    }
    std::ranges::stable_sort(lines, {}, &Line::length2_px2);
    lines.resize(std::min(lines.size(), std::max<std::size_t>(4, lines.size() / 4)));
    return lines;
  }

  bool is_hidden_between(const Pair& pair, std::int32_t a, std::int32_t b) {
    const std::vector<Line> lines = shortest_lines(pair);
    if (lines.empty()) return false;
    const double shortest = std::sqrt(lines[0].length2_px2);
    if (shortest > kWidestGap * s_.image.width) return false;
    PixelMoments both = s_.regions[a].moments;
    both += s_.regions[b].moments;
    const InversePlane plane = both.fit();
    const double behind = -s_.options.reach_sigma * std::sqrt(s_.noise.pixel2(plane));
    double measured = 0, in_front = 0;
    for (const Line& line : lines) {
      const int steps = std::max(1, static_cast<int>(std::sqrt(line.length2_px2)));
      const int width = s_.image.width;
      const int x = static_cast<int>(line.from) % width, y = static_cast<int>(line.from) / width;
      const int dx = static_cast<int>(line.to) % width - x;
      const int dy = static_cast<int>(line.to) / width - y;
      for (int t = 1; t < steps; ++t) {
        const auto at =
            static_cast<std::uint32_t>((y + dy * t / steps) * width + x + dx * t / steps);
        if (s_.image.rho[at] <= 0) continue;
        const std::int32_t region = s_.region_of[at];
        if (region >= 0 && (roots_.root(region) == a || roots_.root(region) == b)) continue;
        measured += 1;
        in_front += s_.residual(at, plane) > behind;
      }
    }
    if (measured == 0) return shortest <= kWidestHole * s_.image.width;
    return in_front >= kInFront * measured;
  }

  DepthSegmentation& s_;
  std::vector<std::vector<std::uint32_t>> rim_;  // per region
  Roots roots_;
};

}  // namespace

void join_hidden_parts(DepthSegmentation& s) {
  if (s.options.hidden_share > 0) HiddenParts(s).run();
}

}  // namespace planescope::planes
