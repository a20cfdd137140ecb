// Where two surfaces meet at an angle, both are within tolerance of either plane. Past the end of
// the region the other surface goes on: its plane is fitted there, tile by tile along the border,
// and of the pixels near the border each goes to the plane that it is nearer to.

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/labels/wand_field.hpp"

namespace planescope {
namespace {

constexpr int kTile_px = 16;
constexpr int kBeyond_px = 12;       // so far out of a tile is looked for the other surface
constexpr int kDeep_px = 20;         // so far into the region it may reach
constexpr int kLeastContact_px = 3;  // of a tile's pixels
constexpr double kLeastShare = 0.3;
constexpr double kLeastAngle_deg = 8;  // between the two: flatter creases are no creases
constexpr int kTwo = 2;                // surfaces at most that meet the region in one tile

/// Pixels that go on from the region without a step, just out of it.
std::vector<std::vector<std::uint32_t>> contacts_by_tile(const WandField& field,
                                                         const Sheet& sheet,
                                                         const std::vector<std::uint8_t>& region,
                                                         int tiles_across,
                                                         int tiles_down) {
  const LabelGrid& grid = field.grid;
  const int width = grid.width, height = grid.height;
  std::vector<std::vector<std::uint32_t>> tiles(static_cast<std::size_t>(tiles_across) *
                                                tiles_down);
  for (int v = 1; v + 1 < height; ++v)
    for (int u = 1; u + 1 < width; ++u) {
      const auto i = static_cast<std::uint32_t>(v * width + u);
      if (region[i] || !grid.measured[i]) continue;
      if (!region[i - 1] && !region[i + 1] && !region[i - width] && !region[i + width]) continue;
      if (std::abs(sheet.distance_m(grid.points[i])) > 3 * field.tolerance_m(sheet, i)) continue;
      tiles[static_cast<std::size_t>(v / kTile_px) * tiles_across + u / kTile_px].push_back(i);
    }
  return tiles;
}

/// Signed distance from a plane, averaged over the pixels around that are about as far.
float smooth_distance(const WandField& field, const Sheet& sheet, std::uint32_t pixel) {
  const LabelGrid& grid = field.grid;
  const float middle = sheet.distance_m(grid.points[pixel]);
  const float most = field.tolerance_m(sheet, pixel);
  float sum = 0, count = 0;
  for_pixels(grid, box_around(grid, pixel, 1), [&](std::uint32_t i) {
    const float d = sheet.distance_m(grid.points[i]);
    if (!(std::abs(d - middle) <= most)) return;  // also where not measured
    sum += d;
    count += 1;
  });
  return sum / count;
}

}  // namespace

void cut_at_creases(const WandField& field, const Sheet& sheet, std::vector<std::uint8_t>& region) {
  const LabelGrid& grid = field.grid;
  const int width = grid.width;
  const int tiles_across = (width + kTile_px - 1) / kTile_px;
  const int tiles_down = (grid.height + kTile_px - 1) / kTile_px;
  const auto tiles = contacts_by_tile(field, sheet, region, tiles_across, tiles_down);
  const float parallel = static_cast<float>(std::cos(kLeastAngle_deg * std::numbers::pi / 180));

  std::vector<std::uint8_t> outside(grid.pixels(), 0);
  for (std::size_t i = 0; i < grid.pixels(); ++i) outside[i] = grid.measured[i] && !region[i];
  std::vector<std::uint8_t> other_side(grid.pixels(), 0);  // 1: goes to another surface
  std::vector<std::uint32_t> front;
  for (const std::vector<std::uint32_t>& tile : tiles) {
    std::vector<std::uint32_t> open = tile;
    for (int k = 0; k < kTwo && open.size() >= kLeastContact_px; ++k) {
      const std::uint32_t middle = open[open.size() / 2];
      const PixelBox box = box_around(grid, middle, kTile_px / 2 + kBeyond_px);
      const auto fit = fit_around(field, outside, box, middle, kBeyond_px);
      if (!fit || fit->share < kLeastShare) break;
      const Sheet& other = fit->sheet;
      // Into the region from where the other surface touches it.
      front.clear();
      std::erase_if(open, [&](std::uint32_t i) {
        const bool on = std::abs(other.distance_m(grid.points[i])) <= field.tolerance_m(other, i);
        if (on) front.push_back(i);
        return on;
      });
      if (front.empty()) break;
      if (std::abs(other.normal.dot(sheet.normal)) > parallel) continue;
      const PixelBox reach = box_around(grid, middle, kTile_px / 2 + kDeep_px);
      for (std::size_t f = 0; f < front.size(); ++f) {
        const std::uint32_t i = front[f];
        const int u = static_cast<int>(i) % width, v = static_cast<int>(i) / width;
        if (u <= reach.u0 || v <= reach.v0 || u + 1 >= reach.u1 || v + 1 >= reach.v1) continue;
        for (const std::uint32_t j : {i - 1, i + 1, i - width, i + width}) {
          if (!region[j] || other_side[j]) continue;
          if (std::abs(smooth_distance(field, other, j)) >=
              std::abs(smooth_distance(field, sheet, j)))
            continue;
          other_side[j] = 1;
          front.push_back(j);
        }
      }
    }
  }
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (other_side[i]) region[i] = 0;
}

}  // namespace planescope
