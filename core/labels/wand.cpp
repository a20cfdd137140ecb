// A local fit at the click, then growth over connected inliers in ever larger boxes, the plane
// fitted anew each time. What lies within tolerance but on another surface (the foot of a wall next
// to a floor) is cut off at the end, when the plane is known well.

#include "core/labels/wand.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/labels/region.hpp"
#include "core/labels/wand_field.hpp"

namespace planescope {
namespace {

constexpr int kNearClick_px = 4;     // a click may miss the surface by so much
constexpr int kLeastWindow_px = 10;  // of the fit at the click, to each side
constexpr int kMostWindow_px = 40;
constexpr double kWindowTolerances = 2.5;  // and at least so many tolerances in space
constexpr double kLeastShare = 0.45;       // of the weights around the click must be on a plane
constexpr int kGap_px = 4;                 // a region crosses so much where nothing was measured
constexpr std::uint8_t kCrossed = 2;
constexpr int kTurned_px = 24;  // as far may normals be wrong beside an edge
constexpr int kFirstReach_px = 20;
constexpr double kLeastFacing = 0.3;  // of what lies on the plane; else normals tell nothing
constexpr int kManyPixels = 20000;    // of a box; then every fourth tells enough
constexpr int kMargin_px = 40;        // by which a region may still grow, once it is fitted
constexpr int kLeastPixels = 25;      // of a plane
constexpr int kSpeck_px = 100;        // smaller holes are filled

/// Which pixels of a box lie on the sheet (1), and of these, where the surface faces with it (2).
void mark_inliers(const WandField& field,
                  const Sheet& sheet,
                  const PixelBox& box,
                  std::vector<std::uint8_t>& on) {
  const LabelGrid& grid = field.grid;
  const float least_cosine =
      static_cast<float>(std::cos(field.options.max_angle_deg * std::numbers::pi / 180));
  for_pixels(grid, box, [&](std::uint32_t i) {
    if (!field.allowed[i]) return;
    if (!field.lies_on(sheet, i)) return;
    const Vec3f& normal = grid.normals[i];
    on[i] = normal.isZero(0) || normal.dot(sheet.normal) >= least_cosine ? 2 : 1;
  });
}

/// Inliers that face as the sheet does, and gaps between them that may be crossed.
std::vector<std::uint8_t> passable(const WandField& field,
                                   const std::vector<std::uint8_t>& on,
                                   const PixelBox& box,
                                   std::uint8_t least) {
  const LabelGrid& grid = field.grid;
  std::vector<std::uint8_t> pass(grid.pixels(), 0);
  for_pixels(grid, box, [&](std::uint32_t i) { pass[i] = on[i] >= least; });
  // `gap`: pixels without a measurement since the last inlier of the row or column; -1 no inlier.
  const auto cross = [&](std::uint32_t i, int& gap, std::uint32_t step) {
    if (pass[i] == 1) {
      for (; gap > 0; --gap) pass[i - static_cast<std::uint32_t>(gap) * step] = kCrossed;
      gap = 0;
    } else if (gap >= 0) {
      gap = grid.measured[i] || gap == kGap_px ? -1 : gap + 1;
    }
  };
  std::vector<int> gap_above(static_cast<std::size_t>(grid.width), -1);
  for (int v = box.v0; v < box.v1; ++v) {
    int gap_left = -1;
    for (int u = box.u0; u < box.u1; ++u) {
      const auto i = static_cast<std::uint32_t>(v * grid.width + u);
      cross(i, gap_left, 1);
      cross(i, gap_above[u], static_cast<std::uint32_t>(grid.width));
    }
  }
  return pass;
}

class Growth {
 public:
  Growth(const WandField& field) : field_(field), grid_(field.grid), on_(grid_.pixels(), 0) {}

  /// The plane around a click; nullopt where there is none.
  std::optional<LocalFit> fit_at(std::uint32_t click) const {
    const Vec3f& point = grid_.points[click];
    const double tolerance_m = field_.tolerance_m({-point.normalized(), -point.norm()}, click);
    const double reach =
        kWindowTolerances * tolerance_m * std::abs(grid_.intrinsics.fx) / point.z();
    const int window =
        static_cast<int>(std::clamp(reach, double{kLeastWindow_px}, double{kMostWindow_px}));
    return fit_around(field_, field_.grid.measured, box_around(grid_, click, window), click);
  }

  std::vector<std::uint8_t> reach(const std::vector<std::uint32_t>& clicks,
                                  const Sheet& sheet,
                                  const PixelBox& box,
                                  bool facing) {
    std::ranges::fill(on_, std::uint8_t{0});
    mark_inliers(field_, sheet, box, on_);
    const std::vector<std::uint8_t> pass = passable(field_, on_, box, facing ? 2 : 1);
    std::vector<std::uint8_t> region(grid_.pixels(), 0);
    flood(pass, grid_.width, grid_.height, starts(clicks, pass), region);
    for_pixels(grid_, box, [&](std::uint32_t i) { region[i] = region[i] && on_[i]; });
    return region;
  }

  std::vector<std::uint32_t> starts(const std::vector<std::uint32_t>& clicks,
                                    const std::vector<std::uint8_t>& pass) const {
    std::vector<std::uint32_t> result;
    for (const std::uint32_t click : clicks)
      for_pixels(grid_, box_around(grid_, click, kNearClick_px), [&](std::uint32_t i) {
        if (pass[i]) result.push_back(i);
      });
    return result;
  }

  const std::vector<std::uint8_t>& on() const { return on_; }

 private:
  const WandField& field_;
  const LabelGrid& grid_;
  std::vector<std::uint8_t> on_;
};

Moments moments_of(const LabelGrid& grid,
                   const std::vector<std::uint8_t>& region,
                   const PixelBox& box) {
  Moments moments;
  const int step = (box.u1 - box.u0) * (box.v1 - box.v0) > kManyPixels ? 2 : 1;
  for (int v = box.v0; v < box.v1; v += step)
    for (int u = box.u0 + v / step % step; u < box.u1; u += step) {
      const std::size_t i = static_cast<std::size_t>(v) * grid.width + u;
      if (region[i]) moments.add(grid.points[i].cast<double>());
    }
  return moments;
}

bool touches(const LabelGrid& grid, const std::vector<std::uint8_t>& region, const PixelBox& box) {
  for (int u = box.u0; u < box.u1; ++u)
    if ((box.v0 > 0 && region[box.v0 * grid.width + u]) ||
        (box.v1 < grid.height && region[(box.v1 - 1) * grid.width + u]))
      return true;
  for (int v = box.v0; v < box.v1; ++v)
    if ((box.u0 > 0 && region[v * grid.width + box.u0]) ||
        (box.u1 < grid.width && region[v * grid.width + box.u1 - 1]))
      return true;
  return false;
}

/// The region's pixels, with a margin around.
PixelBox bounds_of(const LabelGrid& grid, const std::vector<std::uint8_t>& region, int margin) {
  PixelBox box{grid.width, grid.height, 0, 0};
  for (int v = 0; v < grid.height; ++v) {
    const auto row = region.begin() + static_cast<std::ptrdiff_t>(v) * grid.width;
    const auto end = row + grid.width;
    const auto first = std::find(row, end, 1);
    if (first == end) continue;
    const auto last = std::find(std::reverse_iterator(end), std::reverse_iterator(row), 1);
    box.u0 = std::min(box.u0, static_cast<int>(first - row));
    box.u1 = std::max(box.u1, static_cast<int>(last.base() - row));
    box.v0 = std::min(box.v0, v);
    box.v1 = v + 1;
  }
  return {std::max(0, box.u0 - margin), std::max(0, box.v0 - margin),
          std::min(grid.width, box.u1 + margin), std::min(grid.height, box.v1 + margin)};
}

/// The nearest free pixel to a click that may have hit a hole.
std::optional<std::uint32_t> nearest_allowed(const WandField& field, std::uint32_t click) {
  const LabelGrid& grid = field.grid;
  std::optional<std::uint32_t> nearest;
  int best = kNearClick_px * kNearClick_px + 1;
  const int u = static_cast<int>(click) % grid.width, v = static_cast<int>(click) / grid.width;
  for_pixels(grid, box_around(grid, click, kNearClick_px), [&](std::uint32_t i) {
    const int du = static_cast<int>(i) % grid.width - u, dv = static_cast<int>(i) / grid.width - v;
    if (!field.allowed[i] || du * du + dv * dv >= best) return;
    best = du * du + dv * dv;
    nearest = i;
  });
  return nearest;
}

void fill_specks(const WandField& field, const Sheet& sheet, std::vector<std::uint8_t>& region) {
  for (const std::uint32_t i : small_holes(region, field.grid.width, field.grid.height, kSpeck_px))
    if (field.allowed[i] && field.lies_on(sheet, i, 2)) region[i] = 1;
}

}  // namespace

std::optional<WandResult> grow_plane(const LabelGrid& grid,
                                     const FrameLabels* labels,
                                     std::span<const std::uint32_t> seeds,
                                     const WandOptions& options,
                                     std::string* why_not) {
  const auto refuse = [&](const char* why) {
    if (why_not) *why_not = why;
    return std::nullopt;
  };
  if (seeds.empty()) return refuse("nothing was clicked");
  const WandField field = make_wand_field(grid, labels, options);
  const auto click = nearest_allowed(field, seeds[0]);
  if (!click && grid.measured[seeds[0]]) return refuse("it has a label already");
  if (!click) return refuse("nothing was measured there");
  Growth growth(field);
  const auto local = growth.fit_at(*click);
  if (!local || local->share < kLeastShare) return refuse("no plane there");

  Sheet sheet = local->sheet;
  std::vector<std::uint32_t> clicks{*click};
  const PixelBox whole{0, 0, grid.width, grid.height};
  // Strips narrower than the windows of the normals face nowhere: there distance alone must do.
  bool facing = true;
  std::vector<std::uint8_t> region;
  for (int reach = kFirstReach_px;; reach = reach * 5 / 2) {
    const PixelBox box = box_around(grid, *click, reach);
    region = growth.reach(clicks, sheet, box, facing);
    Moments moments = moments_of(grid, region, box);
    if (facing && reach == kFirstReach_px) {
      const auto all = growth.reach(clicks, sheet, box, false);
      const Moments moments_of_all = moments_of(grid, all, box);
      if (moments.count < kLeastFacing * moments_of_all.count) {
        facing = false;
        region = all;
        moments = moments_of_all;
      }
    }
    const auto refitted = sheet_through(moments);
    if (!refitted || moments.count < kLeastPixels) return refuse("no plane there");
    sheet = *refitted;
    if (!touches(grid, region, box)) break;
  }
  for (std::size_t k = 1; k < seeds.size(); ++k) {
    const auto other = nearest_allowed(field, seeds[k]);
    if (!other) continue;
    const auto fit = growth.fit_at(*other);
    if (!fit || fit->share < kLeastShare) continue;
    const float cosine = fit->sheet.normal.dot(sheet.normal);
    const bool same =
        std::abs(sheet.distance_m(grid.points[*other])) <= 2 * field.tolerance_m(sheet, *other) &&
        cosine >= std::cos(options.max_angle_deg * std::numbers::pi / 180);
    if (same) clicks.push_back(*other);
  }
  const PixelBox box = clicks.size() > 1 ? whole : bounds_of(grid, region, kMargin_px);
  region = growth.reach(clicks, sheet, box, facing);
  if (clicks.size() > 1) {  // together with the fragments
    if (const auto refitted = sheet_through(moments_of(grid, region, box))) sheet = *refitted;
    region = growth.reach(clicks, sheet, box, facing);
  }
  spread(growth.on(), grid.width, grid.height, kTurned_px, region);
  fill_specks(field, sheet, region);
  cut_at_creases(field, sheet, box, region);
  if (options.use_color && !grid.color.empty()) settle_border_by_color(field, sheet, box, region);
  fill_specks(field, sheet, region);

  // What was cut off from the clicks falls away.
  const std::vector<std::uint8_t> pass = passable(field, region, box, 1);
  std::vector<std::uint8_t> reached(grid.pixels(), 0);
  WandResult result;
  result.fragment_pixels.resize(seeds.size(), 0);
  for (std::size_t k = 0; k < seeds.size(); ++k) {
    const auto at = nearest_allowed(field, seeds[k]);
    if (!at || std::ranges::find(clicks, *at) == clicks.end()) continue;
    for (const std::uint32_t i :
         flood(pass, grid.width, grid.height, growth.starts({*at}, pass), reached))
      result.fragment_pixels[k] += region[i];
  }
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (reached[i] && region[i]) result.pixels.push_back(static_cast<std::uint32_t>(i));
  if (result.pixels.size() < kLeastPixels) return refuse("no plane there");
  result.plane = fit_plane(grid, result.pixels);
  result.label = class_of_tilt(result.plane.tilt_deg);
  return result;
}

}  // namespace planescope
