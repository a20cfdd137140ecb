#include "core/planes/segment/refine/r9_join_sheets.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <span>

#include "core/model/inverse_plane.hpp"
#include "core/planes/segment/seen_pixels.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::planes::r9_join_sheets {
namespace {

constexpr int kTile = 16;        // the border is cut into stretches of about this length [px]
constexpr int kBand = 12;        // how far the depth beside a stretch is looked at [px]
constexpr int kStride = 2;       // of the pixels looked at, along rows and columns
constexpr int kLeastPixels = 5;  // on either side of it
constexpr int kLeastContacts = 3;

using PlanePair = std::pair<std::int32_t, std::int32_t>;  // first < second

/// Where two planes touch.
struct Border {
  int pixels = 0;   // pairs of neighbouring pixels
  double step = 0;  // sum of the steps of its stretches, weighted: w of the second's side more
  double weight = 0;

  void append(const Border& other, bool reversed) {
    pixels += other.pixels;
    step += reversed ? -other.step : other.step;
    weight += other.weight;
  }
};

/// A pixel on the first plane's side of a border, the other side's being next to it.
struct Contact {
  PlanePair planes;
  int x = 0, y = 0;
  auto operator<=>(const Contact&) const = default;
};

class Sheets {
 public:
  Sheets(SegmentState& state, const Options& options)
      : state_(state),
        options_(options),
        pixels_(state.more.pixels),
        plane_(planes_of_pixels(state)),
        runs_(runs_by_plane(pixels_, plane_, state.planes.size())),
        seen_(pixels_, state.sensor),
        sheets_(state.planes.size()),
        points_(state.planes.size()) {
    for (std::size_t k = 0; k < sheets_.size(); ++k)
      for (const PlaneRuns::Run& run : runs_.of(k)) sheets_[k].pixels += run.end - run.begin;
    for (std::uint32_t i = 0; i < state.plane_of.size(); ++i)
      if (state.plane_of[i] >= 0) points_[state.plane_of[i]].push_back(i);
  }

  void join_all() {
    find_borders();
    std::map<PlanePair, std::optional<double>> costs;
    for (const auto& [planes, border] : borders_) costs[planes] = cost(planes, border);
    for (;;) {
      const auto best = std::ranges::min_element(costs, {}, [](const auto& entry) {
        return entry.second.value_or(std::numeric_limits<double>::infinity());
      });
      if (best == costs.end() || !best->second) return;
      std::int32_t small = best->first.first, large = best->first.second;
      if (sheets_[small].pixels > sheets_[large].pixels) std::swap(small, large);
      join(small, large);
      std::erase_if(costs, [&](const auto& entry) { return touches(entry.first, small, large); });
      for (const auto& [planes, border] : borders_)
        if (touches(planes, large, large)) costs[planes] = cost(planes, border);
    }
  }

 private:
  static bool touches(const PlanePair& planes, std::int32_t a, std::int32_t b) {
    return planes.first == a || planes.first == b || planes.second == a || planes.second == b;
  }

  void find_borders() {
    for (int y = 0; y < pixels_.height; y += kTile)
      for (int x = 0; x < pixels_.width; x += kTile)
        find_stretches(pixels_.around({x, y, x + kTile, y + kTile}, 0));
  }

  bool has_one_plane(const Rect& rect) const {
    std::int32_t only = -1;
    for (int y = rect.y0; y < rect.y1; ++y) {
      const std::int32_t* row = &plane_[pixels_.at(0, y)];
      std::int32_t unlike = 0;  // most rows are on the one plane throughout: told without branches
      for (int x = rect.x0; x < rect.x1; ++x) unlike |= row[x] ^ only;
      if (unlike == 0) continue;
      for (int x = rect.x0; x < rect.x1; ++x) {
        if (row[x] >= 0 && only >= 0 && row[x] != only) return false;
        only = std::max(only, row[x]);
      }
    }
    return true;
  }

  void find_stretches(const Rect& tile) {
    if (has_one_plane(pixels_.around({tile.x0, tile.y0, tile.x1 + 2, tile.y1 + 2}, 0))) return;
    contacts_.clear();
    // Two pixels apart as well, over what was not measured between.
    for (const auto& [dx, dy] : {std::pair{1, 0}, {0, 1}, {2, 0}, {0, 2}}) {
      if (tile.x0 >= pixels_.width - dx) continue;  // nothing is so far to the right
      for (int y = tile.y0; y < std::min(tile.y1, pixels_.height - dy); ++y) {
        const std::int32_t *row = &plane_[pixels_.at(0, y)],
                           *other = &plane_[pixels_.at(dx, y + dy)];
        for (int x = tile.x0; x < std::min(tile.x1, pixels_.width - dx); ++x) {
          const std::int32_t a = row[x], b = other[x];
          if (a == b || a < 0 || b < 0) continue;
          contacts_.push_back({std::minmax(a, b), a < b ? x : x + dx, a < b ? y : y + dy});
        }
      }
    }
    std::ranges::sort(contacts_);
    for (auto begin = contacts_.begin(); begin != contacts_.end();) {
      const auto end = std::find_if(begin, contacts_.end(), [&](const Contact& contact) {
        return contact.planes != begin->planes;
      });
      add_stretch({begin, end});
      begin = end;
    }
  }

  /// Fits the depth around the stretch by planes of one direction on both sides.
  void add_stretch(std::span<const Contact> contacts) {
    const auto [a, b] = contacts[0].planes;
    Border& border = borders_[contacts[0].planes];
    const int length = static_cast<int>(contacts.size());
    border.pixels += length;
    if (length < kLeastContacts) return;
    int x = 0, y = 0;
    for (const Contact& contact : contacts) x += contact.x, y += contact.y;
    x /= length, y /= length;
    // Unknowns: w_of_ray, and by how much w is more on b's side. Of the normal equations the lower
    // triangle, which is what is read.
    double rr[6] = {}, ray_on_b[3] = {}, rw[3] = {}, w_on_b = 0;
    int on_a = 0, on_b = 0;
    const Rect around = pixels_.around({x, y, x + 1, y + 1}, kBand);
    for (int v = around.y0; v < around.y1; v += kStride)
      for (int u = around.x0; u < around.x1; u += kStride) {
        const std::size_t i = pixels_.at(u, v);
        if (plane_[i] != a && plane_[i] != b) continue;
        const auto [ray, w] = pixels_.seen(i, state_.sensor);
        const double products[6] = {ray[0] * ray[0], ray[1] * ray[0], ray[2] * ray[0],
                                    ray[1] * ray[1], ray[2] * ray[1], ray[2] * ray[2]};
        for (int k = 0; k < 6; ++k) rr[k] += products[k];
        for (int k = 0; k < 3; ++k) rw[k] += ray[k] * w;
        if (plane_[i] == a) {
          ++on_a;
          continue;
        }
        ++on_b;
        for (int k = 0; k < 3; ++k) ray_on_b[k] += ray[k];
        w_on_b += w;
      }
    if (on_a < kLeastPixels || on_b < kLeastPixels) return;
    Eigen::Matrix4d normal_equations;
    normal_equations << rr[0], 0, 0, 0, rr[1], rr[3], 0, 0, rr[2], rr[4], rr[5], 0, ray_on_b[0],
        ray_on_b[1], ray_on_b[2], on_b;
    const Eigen::Vector4d right(rw[0], rw[1], rw[2], w_on_b);
    border.step += length * normal_equations.ldlt().solve(right)[3];
    border.weight += length;
  }

  /// How badly the two are one plane [1/m]; nothing where they are not.
  std::optional<double> cost(const PlanePair& planes, const Border& border) {
    if (border.pixels < options_.border_px || border.weight == 0) return std::nullopt;
    const double step = std::abs(border.step) / border.weight;
    if (!(step <= options_.step_m)) return std::nullopt;
    const InverseSums &first = sums(planes.first), &second = sums(planes.second);
    const InverseSums& small = first.count < second.count ? first : second;
    const InverseSums& large = first.count < second.count ? second : first;
    const InversePlane plane = large.fit(), other = small.fit();
    const double own = std::max(plane.rms, other.rms);
    const double misfit = small.rms_about(plane.w_of_ray);
    const double cosine = other.normal().dot(plane.normal());
    if (!(step <= options_.step_own * own) || !(misfit <= options_.misfit_m) ||
        !(cosine >= std::cos(options_.max_angle_deg * std::numbers::pi / 180)))
      return std::nullopt;
    return misfit;
  }

  /// Of the plane's pixels, added up when first asked for: most planes have no border without a
  /// step, and are not fitted.
  const InverseSums& sums(std::int32_t k) {
    Sheet& sheet = sheets_[k];
    if (sheet.sums.count > 0) return sheet.sums;
    InverseSums sums;  // in registers
    for (const PlaneRuns::Run& run : runs_.of(static_cast<std::size_t>(k)))
      seen_.visit(run.begin, run.end,
                  [&](std::size_t, const PixelGrid::Seen& seen) { sums.add(seen.ray, seen.w); });
    return sheet.sums = sums;
  }

  void join(std::int32_t small, std::int32_t large) {
    log_refine(state_, options_, small, large);
    join_planes(state_, small, large, points_[small]);
    points_[large].insert(points_[large].end(), points_[small].begin(), points_[small].end());
    sheets_[large].sums += sheets_[small].sums;  // both were asked for
    sheets_[large].pixels += sheets_[small].pixels;
    std::map<PlanePair, Border> borders;
    for (const auto& [planes, border] : borders_) {
      const auto [a, b] = planes;
      const std::int32_t c = a == small ? large : a, d = b == small ? large : b;
      if (c != d) borders[std::minmax(c, d)].append(border, c > d);
    }
    borders_ = std::move(borders);
  }

  SegmentState& state_;
  const Options& options_;
  const PixelGrid& pixels_;
  const std::span<const std::int32_t> plane_;  // per pixel, as it was before anything is joined
  const PlaneRuns runs_;                       // likewise
  SeenPixels seen_;
  struct Sheet {
    std::size_t pixels = 0;
    InverseSums sums;  // see sums()
  };
  std::vector<Sheet> sheets_;  // per plane
  std::vector<std::vector<std::uint32_t>> points_;
  std::map<PlanePair, Border> borders_;
  std::vector<Contact> contacts_;  // of one tile
};

}  // namespace

void run(SegmentState& state, const Options& options) {
  if (!options.on || state.more.pixels.empty()) return;
  Sheets(state, options).join_all();
}

}  // namespace planescope::planes::r9_join_sheets
