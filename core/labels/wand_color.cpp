// Depth images are ragged at the borders of objects, colour images are not. Pixels at the border
// whose depth fits badly, or nearly, go to the side whose colour around there they have.

#include <algorithm>
#include <cmath>

#include "core/labels/wand_field.hpp"

namespace planescope {
namespace {

constexpr int kStrip_px = 3;       // of the border, to each side
constexpr int kAround_px = 6;      // where the two sides' colours are taken from
constexpr int kLeastPixels = 8;    // of each side
constexpr float kContrast = 36;    // between them, of 255 per channel
constexpr float kClearly = 0.6f;   // nearer to one than to the other
constexpr float kDoubtful = 0.6f;  // of the tolerance: what fits worse inside may be wrong
constexpr float kNearly = 2;       // times the tolerance: what fits better outside may belong

struct MeanColor {
  Vec3f sum = Vec3f::Zero();
  int count = 0;

  void add(const std::uint8_t* rgb) {
    sum += Vec3f(rgb[0], rgb[1], rgb[2]);
    ++count;
  }
  Vec3f value() const { return sum / static_cast<float>(count); }
};

}  // namespace

void settle_border_by_color(const WandField& field,
                            const Sheet& sheet,
                            std::vector<std::uint8_t>& region) {
  const LabelGrid& grid = field.grid;
  const int width = grid.width, height = grid.height;
  std::vector<std::uint8_t> strip(grid.pixels(), 0);
  for (int v = 0; v < height; ++v)
    for (int u = 0; u < width; ++u) {
      const int i = v * width + u;
      const bool right = u + 1 < width && region[i] != region[i + 1];
      const bool down = v + 1 < height && region[i] != region[i + width];
      if (!right && !down) continue;
      for_pixels(grid, box_around(grid, static_cast<std::uint32_t>(i), kStrip_px),
                 [&](std::uint32_t j) { strip[j] = 1; });
    }
  // 0 says nothing, 1 surely inside, 2 surely outside, 3 in doubt
  std::vector<std::uint8_t> side(grid.pixels(), 0);
  for (std::size_t i = 0; i < grid.pixels(); ++i) {
    if (!grid.measured[i]) continue;
    const auto pixel = static_cast<std::uint32_t>(i);
    const float off = std::abs(sheet.distance_m(grid.points[i])) / field.tolerance_m(sheet, pixel);
    if (region[i]) {
      side[i] = strip[i] && off > kDoubtful ? 3 : 1;
    } else {
      side[i] = strip[i] && field.allowed[i] && off <= kNearly ? 3 : 2;
    }
  }
  for (std::size_t i = 0; i < grid.pixels(); ++i) {
    if (side[i] != 3) continue;
    MeanColor inside, outside;
    for_pixels(grid, box_around(grid, static_cast<std::uint32_t>(i), kAround_px),
               [&](std::uint32_t j) {
                 if (side[j] == 1) inside.add(&grid.color.data[3 * std::size_t{j}]);
                 if (side[j] == 2) outside.add(&grid.color.data[3 * std::size_t{j}]);
               });
    if (inside.count < kLeastPixels || outside.count < kLeastPixels) continue;
    if ((inside.value() - outside.value()).norm() < kContrast) continue;
    const std::uint8_t* rgb = &grid.color.data[3 * i];
    const Vec3f own(rgb[0], rgb[1], rgb[2]);
    const float to_inside = (own - inside.value()).norm();
    const float to_outside = (own - outside.value()).norm();
    if (to_inside < kClearly * to_outside) region[i] = 1;
    if (to_outside < kClearly * to_inside) region[i] = 0;
  }
}

}  // namespace planescope
