// Depth images are ragged at the borders of objects, colour images are not. Pixels at the border
// whose depth fits badly, or almost fits, go to the side whose colour nearby they share.

#include <algorithm>
#include <cmath>

#include "core/labels/wand/wand_field.hpp"

namespace planescope::labels {
namespace {

constexpr int kStrip_px = 3;          // of the border, to each side
constexpr int kAround_px = 6;         // where the two sides' colours are taken from
constexpr int kLeastColorPixels = 8;  // of each side
constexpr float kContrast = 36;       // between them, of 255 per channel
constexpr float kClearly = 0.6f;      // nearer to one than to the other
constexpr float kDoubtful = 0.6f;     // of the tolerance: what fits worse inside may be wrong
constexpr float kNearly = 2;          // times the tolerance: what fits better outside may belong

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
                            const PixelBox& box,
                            std::vector<std::uint8_t>& region) {
  const LabelGrid& grid = field.grid;
  const int width = grid.width, height = grid.height;
  std::vector<std::uint8_t> strip(grid.pixels(), 0);
  for (int v = box.v0; v < box.v1; ++v)
    for (int u = box.u0; u < box.u1; ++u) {
      const int i = v * width + u;
      const bool right = u + 1 < width && region[i] != region[i + 1];
      const bool down = v + 1 < height && region[i] != region[i + width];
      if (!right && !down) continue;
      for_pixels(grid, box_around(grid, static_cast<std::uint32_t>(i), kStrip_px),
                 [&](std::uint32_t j) { strip[j] = 1; });
    }
  enum : std::uint8_t { kUnknown, kInside, kOutside };
  std::vector<std::uint8_t> side(grid.pixels(), kUnknown);
  std::vector<std::uint32_t> doubtful;
  for_pixels(grid, box, [&](std::uint32_t i) {
    if (!grid.measured[i]) return;
    const bool in_doubt =
        strip[i] && field.allowed[i] &&
        (region[i] ? !field.lies_on(sheet, i, kDoubtful) : field.lies_on(sheet, i, kNearly));
    if (in_doubt)
      doubtful.push_back(i);
    else
      side[i] = region[i] ? kInside : kOutside;
  });
  for (const std::uint32_t i : doubtful) {
    MeanColor inside, outside;
    for_pixels(grid, box_around(grid, i, kAround_px), [&](std::uint32_t j) {
      if (side[j] == kInside) inside.add(&grid.color.data[std::size_t{3} * j]);
      if (side[j] == kOutside) outside.add(&grid.color.data[std::size_t{3} * j]);
    });
    if (inside.count < kLeastColorPixels || outside.count < kLeastColorPixels) continue;
    if ((inside.value() - outside.value()).norm() < kContrast) continue;
    const std::uint8_t* rgb = &grid.color.data[std::size_t{3} * i];
    const Vec3f own(rgb[0], rgb[1], rgb[2]);
    const float to_inside = (own - inside.value()).norm();
    const float to_outside = (own - outside.value()).norm();
    if (to_inside < kClearly * to_outside) region[i] = 1;
    if (to_outside < kClearly * to_inside) region[i] = 0;
  }
}

}  // namespace planescope::labels
