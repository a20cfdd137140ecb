// A local fit at the click, then growth over connected inliers. What lies within tolerance but on
// another surface (the foot of a wall next to a floor) is cut off at the end, when the plane is
// known well.

#include "core/labels/wand/wand.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/labels/model/region.hpp"
#include "core/labels/wand/wand_growth.hpp"

namespace planescope::labels {
namespace {

constexpr std::size_t kLeastPixels = 25;  // of a plane
constexpr int kSpeck_px = 100;            // smaller holes are filled

/// Whether a later click means the same plane.
bool is_fragment(const WandField& field, const Sheet& sheet, std::uint32_t click) {
  const auto there = plane_at(field, click);
  return there && field.lies_on(sheet, click, 2) &&
         there->normal.dot(sheet.normal) >=
             std::cos(field.options.max_angle_deg * std::numbers::pi / 180);
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
  if (!click)
    return refuse(grid.measured[seeds[0]] ? "it has a label already"
                                          : "nothing was measured there");
  const auto start = plane_at(field, *click);
  WandGrowth growth(field);
  if (!start || !growth.grow(*click, *start)) return refuse("no plane there");

  std::vector<std::uint32_t> clicks{*click};
  std::vector<std::size_t> seed_of{0};
  for (std::size_t k = 1; k < seeds.size(); ++k)
    if (const auto other = nearest_allowed(field, seeds[k]);
        other && is_fragment(field, growth.sheet(), *other)) {
      clicks.push_back(*other);
      seed_of.push_back(k);
    }
  growth.grow_on(clicks);
  growth.take_turned();
  fill_specks(field, growth.sheet(), growth.region());
  cut_at_creases(field, growth.sheet(), growth.box(), growth.region());
  if (options.use_color && !grid.color.empty())
    settle_border_by_color(field, growth.sheet(), growth.box(), growth.region());
  fill_specks(field, growth.sheet(), growth.region());

  // Drops what is no longer connected to a click.
  WandResult result;
  result.fragment_pixels.resize(seeds.size(), 0);
  std::vector<std::uint8_t> reached(grid.pixels(), 0);
  for (std::size_t k = 0; k < clicks.size(); ++k) {
    const PixelSet fragment = growth.reach_within_region(clicks[k], reached);
    result.fragment_pixels[seed_of[k]] = fragment.size();
    result.pixels.insert(result.pixels.end(), fragment.begin(), fragment.end());
  }
  if (result.pixels.size() < kLeastPixels) return refuse("no plane there");
  std::ranges::sort(result.pixels);
  result.plane = fit_plane(grid, result.pixels);
  result.label = class_of_tilt(result.plane.tilt_deg);
  return result;
}

}  // namespace planescope::labels
