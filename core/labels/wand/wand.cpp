// Fits a plane at the click, then grows over connected inliers. Pixels within tolerance but on
// another surface (the foot of a wall next to a floor) are cut off at the end, when the plane is
// known accurately.

#include "core/labels/wand/wand.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>

#include "core/labels/model/pixel_sets.hpp"
#include "core/labels/wand/wand_field.hpp"

namespace planescope::labels {
namespace {

constexpr std::size_t kLeastPixels = 25;  // of a plane
constexpr int kSpeck_px = 100;            // smaller holes are filled as far as pixels fit the plane
constexpr int kHole_px = 5000;            // larger holes up to here, only if most pixels do
constexpr double kMostOfHole = 0.8;
constexpr int kNearClick_px = 4;     // by which a click may miss the surface
constexpr int kLeastWindow_px = 10;  // of the fit at the click, to each side
constexpr int kMostWindow_px = 40;
constexpr double kWindowTolerances = 2.5;  // and at least this many tolerances in space
constexpr double kLeastShare = 0.45;       // of the weights near the click that must be on a plane
constexpr int kGap_px = 4;                 // unmeasured gap that a region may cross
constexpr std::uint8_t kCrossed = 2;
constexpr int kTurned_px = 24;  // from an edge: nearer normals may be wrong
constexpr int kFirstReach_px = 20;
constexpr double kLeastFacing = 0.3;  // of pixels on the plane; below it, normals are useless here
constexpr int kManyPixels = 20000;    // of a box; above it, use every fourth
constexpr int kMargin_px = 40;        // by which a fitted region may still grow
constexpr int kMostRounds = 4;
constexpr double kSettled = 0.02;  // of the pixels

/// Marks pixels of a box on the sheet (1), and those that also face like it (2).
void mark_inliers(const WandField& field,
                  const Sheet& sheet,
                  const PixelBox& box,
                  std::vector<std::uint8_t>& on) {
  for_pixels(field.grid, box, [&](std::uint32_t i) {
    if (!field.allowed[i] || !field.lies_on(sheet, i)) return;
    on[i] = field.faces(sheet, i) ? 2 : 1;
  });
}

/// Inliers, and gaps between them that may be crossed.
std::vector<std::uint8_t> passable(const WandField& field,
                                   const std::vector<std::uint8_t>& on,
                                   const PixelBox& box,
                                   std::uint8_t least) {
  const LabelGrid& grid = field.grid;
  std::vector<std::uint8_t> pass(grid.pixels(), 0);
  for_pixels(grid, box, [&](std::uint32_t i) { pass[i] = on[i] >= least; });
  // `gap`: unmeasured pixels since the last inlier of the row or column; -1 no inlier.
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

/// Passable pixels that a click may refer to.
PixelSet starts_at(const LabelGrid& grid,
                   std::uint32_t click,
                   const std::vector<std::uint8_t>& pass) {
  PixelSet starts;
  for_pixels(grid, box_around(grid, click, kNearClick_px), [&](std::uint32_t i) {
    if (pass[i]) starts.push_back(i);
  });
  return starts;
}

Moments moments_of(const LabelGrid& grid,
                   const std::vector<std::uint8_t>& region,
                   const PixelBox& box) {
  Moments moments;
  const int step = (box.u1 - box.u0) * (box.v1 - box.v0) > kManyPixels ? 2 : 1;
  for (int v = box.v0; v < box.v1; v += step)
    for (int u = box.u0; u < box.u1; u += step) {
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

/// Bounding box of the region, with a margin.
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

/// Grows over connected inliers, crossing unmeasured gaps.
class ImageGrowth : public Growth {
 public:
  explicit ImageGrowth(const WandField& field)
      : Growth(field, kLeastPixels), on_(grid_.pixels(), 0) {}

  std::optional<std::uint32_t> free_pixel(std::uint32_t click) const override;
  std::optional<Sheet> plane_at(std::uint32_t click) const override;
  /// Grows in increasingly large boxes.
  bool begin(std::uint32_t click, const Sheet& start) override;
  bool complete(const std::vector<std::uint32_t>& clicks) override;
  PixelSet reach_from(std::uint32_t click, std::vector<std::uint8_t>& reached) const override;

 private:
  void regrow(const std::vector<std::uint32_t>& clicks, const PixelBox& box);
  void grow_on(const std::vector<std::uint32_t>& clicks);

  PixelBox box_;                  // contains the region
  std::vector<std::uint8_t> on_;  // 1 on the sheet, 2 if also facing like it
};

/// Fills holes in the depth, for example of a curved surface, if no other surface is visible there.
void fill_holes(const WandField& field, const Sheet& sheet, std::vector<std::uint8_t>& region) {
  const LabelGrid& grid = field.grid;
  for (const PixelSet& hole : small_holes(region, grid.width, grid.height, kHole_px)) {
    const auto lies_on = [&](std::uint32_t i) {
      return grid.measured[i] && field.lies_on(sheet, i, kLoosely);
    };
    const auto measured =
        std::ranges::count_if(hole, [&](std::uint32_t i) { return grid.measured[i] != 0; });
    if (hole.size() > kSpeck_px && static_cast<double>(std::ranges::count_if(hole, lies_on)) <
                                       kMostOfHole * static_cast<double>(measured))
      continue;
    for (const std::uint32_t i : hole)
      if (field.allowed[i] && lies_on(i)) region[i] = 1;
  }
}

std::optional<std::uint32_t> ImageGrowth::free_pixel(std::uint32_t click) const {
  std::optional<std::uint32_t> nearest;
  int best = kNearClick_px * kNearClick_px + 1;
  const int u = static_cast<int>(click) % grid_.width, v = static_cast<int>(click) / grid_.width;
  for_pixels(grid_, box_around(grid_, click, kNearClick_px), [&](std::uint32_t i) {
    const int du = static_cast<int>(i) % grid_.width - u,
              dv = static_cast<int>(i) / grid_.width - v;
    if (!field_.allowed[i] || du * du + dv * dv >= best) return;
    best = du * du + dv * dv;
    nearest = i;
  });
  return nearest;
}

std::optional<Sheet> ImageGrowth::plane_at(std::uint32_t click) const {
  const Vec3f& point = grid_.points[click];
  const double tolerance_m = field_.tolerance_m({-point.normalized(), -point.norm()}, click);
  const double reach = kWindowTolerances * tolerance_m * std::abs(grid_.intrinsics.fx) / point.z();
  const int window =
      static_cast<int>(std::clamp(reach, double{kLeastWindow_px}, double{kMostWindow_px}));
  const auto fit = fit_around(field_, grid_.measured, box_around(grid_, click, window), click);
  if (!fit || fit->share < kLeastShare) return std::nullopt;
  return fit->sheet;
}

bool ImageGrowth::begin(std::uint32_t click, const Sheet& start) {
  sheet_ = start;
  for (int reach = kFirstReach_px;; reach *= 3) {
    const PixelBox box = box_around(grid_, click, reach);
    regrow({click}, box);
    if (reach == kFirstReach_px) {
      const auto facing = std::ranges::count(region_, 1);
      facing_ = false;
      regrow({click}, box);
      facing_ = static_cast<double>(facing) >=
                kLeastFacing * static_cast<double>(std::ranges::count(region_, 1));
      if (facing_) regrow({click}, box);
    }
    if (!refit(moments_of(grid_, region_, box_))) return false;
    if (!touches(grid_, region_, box)) return true;
  }
}

void ImageGrowth::grow_on(const std::vector<std::uint32_t>& clicks) {
  const PixelBox whole{0, 0, grid_.width, grid_.height};
  PixelBox box = clicks.size() > 1 ? whole : bounds_of(grid_, region_, kMargin_px);
  // A better fit finds more pixels, and more pixels improve the fit.
  for (int round = 0; round < kMostRounds; ++round) {
    const auto before = static_cast<double>(std::ranges::count(region_, 1));
    regrow(clicks, box);
    const auto after = static_cast<double>(std::ranges::count(region_, 1));
    const bool cut_off = touches(grid_, region_, box);
    if (!cut_off && std::abs(after - before) <= kSettled * before) return;
    if (cut_off) box = whole;
    refit(moments_of(grid_, region_, box_));
  }
  regrow(clicks, box);
}

bool ImageGrowth::complete(const std::vector<std::uint32_t>& clicks) {
  grow_on(clicks);
  // Add pixels on the plane that face elsewhere, like normals beside an edge.
  spread(on_, grid_.width, grid_.height, kTurned_px, region_);
  fill_holes(field_, sheet_, region_);
  cut_at_creases(field_, sheet_, box_, region_);
  if (field_.options.use_color && !grid_.color.empty())
    settle_border_by_color(field_, sheet_, box_, region_);
  fill_holes(field_, sheet_, region_);
  return true;
}

PixelSet ImageGrowth::reach_from(std::uint32_t click, std::vector<std::uint8_t>& reached) const {
  const std::vector<std::uint8_t> pass = passable(field_, region_, box_, 1);
  PixelSet added = flood(pass, grid_.width, grid_.height, starts_at(grid_, click, pass), reached);
  std::erase_if(added, [&](std::uint32_t i) { return !region_[i]; });
  return added;
}

void ImageGrowth::regrow(const std::vector<std::uint32_t>& clicks, const PixelBox& box) {
  box_ = box;
  std::ranges::fill(on_, std::uint8_t{0});
  mark_inliers(field_, sheet_, box, on_);
  const std::vector<std::uint8_t> pass = passable(field_, on_, box, facing_ ? 2 : 1);
  std::ranges::fill(region_, std::uint8_t{0});
  for (const std::uint32_t click : clicks)
    flood(pass, grid_.width, grid_.height, starts_at(grid_, click, pass), region_);
  for_pixels(grid_, box, [&](std::uint32_t i) { region_[i] = region_[i] && on_[i]; });
}

/// Whether a later click is on the same plane.
bool is_part(const WandField& field, const Growth& growth, std::uint32_t click) {
  const auto there = growth.plane_at(click);
  if (!there || !field.lies_on(growth.sheet(), click, 2)) return false;
  const float cosine = there->normal.dot(growth.sheet().normal);
  return (field.grid.is_cloud() ? std::abs(cosine) : cosine) >=
         std::cos(field.options.max_angle_deg * std::numbers::pi / 180);
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
  const std::unique_ptr<Growth> growth =
      grid.is_cloud() ? growth_in_cloud(field) : std::make_unique<ImageGrowth>(field);
  const auto click = growth->free_pixel(seeds[0]);
  if (!click)
    return refuse(!grid.measured[seeds[0]] ? "no measurement there"
                  : !options.within.empty() && !options.within[seeds[0]]
                      ? "it is outside the lasso"
                      : "it already has a label");
  const auto start = growth->plane_at(*click);
  if (!start || !growth->begin(*click, *start)) return refuse("no plane there");

  std::vector<std::uint32_t> clicks{*click};
  std::vector<std::size_t> seed_of{0};
  for (std::size_t k = 1; k < seeds.size(); ++k)
    if (const auto other = growth->free_pixel(seeds[k]); other && is_part(field, *growth, *other)) {
      clicks.push_back(*other);
      seed_of.push_back(k);
    }
  if (!growth->complete(clicks)) return refuse("no plane there");

  // Drop pixels no longer connected to a click.
  WandResult result;
  result.fragment_pixels.resize(seeds.size(), 0);
  std::vector<std::uint8_t> reached(grid.pixels(), 0);
  for (std::size_t k = 0; k < clicks.size(); ++k) {
    const PixelSet fragment = growth->reach_from(clicks[k], reached);
    result.fragment_pixels[seed_of[k]] = fragment.size();
    result.pixels.insert(result.pixels.end(), fragment.begin(), fragment.end());
  }
  if (result.pixels.size() < growth->least_pixels) return refuse("no plane there");
  std::ranges::sort(result.pixels);
  result.plane = fit_plane(grid, result.pixels);
  result.label = class_of_tilt(result.plane.tilt_deg);
  return result;
}

}  // namespace planescope::labels
