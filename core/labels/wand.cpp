// A local fit at the click, then growth over connected inliers in ever larger boxes, the plane
// fitted anew each time. What lies within tolerance but on another surface (the foot of a wall next
// to a floor) is cut off at the end, when the plane is known well.

#include "core/labels/wand.hpp"

#include <algorithm>
#include <cmath>
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
constexpr int kGap_px = 2;                 // a region crosses twice that where nothing was measured
constexpr int kTurned_px = 24;             // as far may normals be wrong beside an edge
constexpr int kFirstReach_px = 20;
constexpr double kLeastFacing = 0.3;  // of what lies on the plane; else normals tell nothing
constexpr int kLastRefits = 2;
constexpr int kLeastPixels = 25;  // of a plane
constexpr int kSpeck_px = 100;    // smaller holes are filled

/// Which pixels of a box lie on the sheet (1), and of these, where the surface faces with it (2).
void mark_inliers(const WandField& field,
                  const Sheet& sheet,
                  const PixelBox& box,
                  std::vector<std::uint8_t>& on) {
  const LabelGrid& grid = field.grid;
  const float least_cosine =
      static_cast<float>(std::cos(field.options.max_angle_deg * std::numbers::pi / 180));
  for_pixels(grid, box, [&](std::uint32_t i) {
    on[i] = 0;
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
  const auto across = [&](std::uint32_t first, int step, int count) {
    int last = -1;  // the last passable one
    for (int k = 0; k < count; ++k) {
      const std::uint32_t i = first + static_cast<std::uint32_t>(k * step);
      if (pass[i] == 1) {
        if (last >= 0 && k - last > 1)
          for (int j = last + 1; j < k; ++j) pass[first + static_cast<std::uint32_t>(j * step)] = 3;
        last = k;
      } else if (grid.measured[i] || k - last > 2 * kGap_px) {
        last = -1;
      }
    }
  };
  for (int v = box.v0; v < box.v1; ++v)
    across(static_cast<std::uint32_t>(v * grid.width + box.u0), 1, box.u1 - box.u0);
  for (int u = box.u0; u < box.u1; ++u)
    across(static_cast<std::uint32_t>(box.v0 * grid.width + u), grid.width, box.v1 - box.v0);
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
  for_pixels(grid, box, [&](std::uint32_t i) {
    if (region[i]) moments.add(grid.points[i].cast<double>());
  });
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
  for (int reach = kFirstReach_px;; reach *= 2) {
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
  for (int k = 0; k < kLastRefits; ++k) {
    region = growth.reach(clicks, sheet, whole, facing);
    if (const auto refitted = sheet_through(moments_of(grid, region, whole))) sheet = *refitted;
  }
  region = growth.reach(clicks, sheet, whole, facing);
  spread(growth.on(), grid.width, grid.height, kTurned_px, region);
  fill_specks(field, sheet, region);
  cut_at_creases(field, sheet, region);
  if (options.use_color && !grid.color.empty()) settle_border_by_color(field, sheet, region);
  fill_specks(field, sheet, region);

  // What was cut off from the clicks falls away.
  const std::vector<std::uint8_t> pass = passable(field, region, whole, 1);
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
