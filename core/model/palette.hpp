#pragma once

// The colors of planes, 0xRRGGBB, the same in pictures, windows and files.

#include <array>
#include <cstdint>

namespace planescope {

// Found by search over a grid of OKLCh: maximizes the smallest distance between any two colors, and
// to the gray of points without a plane, for normal, protanopic, deuteranopic and tritanopic vision
// (Machado et al. 2009), where distances for normal vision count 1/1.3. In OKLab times 100, it is
// 12.5 for normal vision and 9.1 for others; to the gray 12.0 and 10.0. In order of difference from
// the preceding colors; orange and amber, which resemble marks in label mode, come last.
inline constexpr std::array<std::uint32_t, 14> kPlaneHues = {
    0x3E7CBD, 0xB0000F, 0x80DEF5, 0xB76A32, 0xBD9EDE, 0x65BC82, 0xBED995,
    0x2C6149, 0x8D2198, 0x8A6283, 0x6B44DE, 0xD06AFA, 0xF58324, 0xFDB803};

/// Color of a color id, from 1; the palette repeats.
constexpr std::uint32_t plane_hue(int color_id) {
  constexpr int n = static_cast<int>(kPlaneHues.size());
  return kPlaneHues[static_cast<std::size_t>((((color_id - 1) % n) + n) % n)];
}

}  // namespace planescope
