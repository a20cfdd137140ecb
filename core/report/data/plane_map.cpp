#include "core/report/data/plane_map.hpp"

#include <algorithm>
#include <array>
#include <charconv>

namespace planescope::report {
namespace {

constexpr int kCell = 4;         // pixels per sample, so that hatches and outlines have room
constexpr int kMostWidth = 480;  // of many small samples fewer pixels
constexpr int kHatch = 8;        // pixels from stroke to stroke

using Rgba8 = std::array<std::uint8_t, 4>;
constexpr Rgba8 kNothing = {0, 0, 0, 0}, kNoPlane = {128, 134, 142, 90};
constexpr Rgba8 kOutline = {28, 30, 34, 255}, kBorder = {255, 255, 255, 210};
constexpr const char* kLost = "#5d646d";

Rgba8 rgba_of(const std::string& color) {
  Rgba8 rgba = {136, 136, 136, 255};
  if (color.size() == 7)
    for (std::size_t c = 0; c < 3; ++c)
      std::from_chars(color.data() + 1 + 2 * c, color.data() + 3 + 2 * c, rgba[c], 16);
  return rgba;
}

Rgba8 lighter(Rgba8 color) {
  for (std::size_t c = 0; c < 3; ++c)
    color[c] = static_cast<std::uint8_t>(color[c] + (255 - color[c]) * 2 / 3);
  return color;
}

class Map {
 public:
  Map(const RegionSample& sample, const std::vector<PlaneInk>& inks)
      : inks_(inks), plane_of_(sample.plane_of()), columns_(sample.columns), rows_(sample.rows) {
    cell_ = std::max(1, std::min(kCell, kMostWidth / sample.columns));
    for (const PlaneInk& ink : inks) colors_.push_back(rgba_of(ink.color));
  }

  Image8 draw() const {
    Image8 image(columns_ * cell_, rows_ * cell_, 4);
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x) {
        const Rgba8 color = color_at(x, y);
        std::copy(color.begin(), color.end(), &image.at(x, y));
      }
    return image;
  }

 private:
  int plane_at(int x, int y) const {  // of a pixel; outside -1
    if (x < 0 || y < 0 || x >= columns_ * cell_ || y >= rows_ * cell_) return -1;
    return plane_of_[static_cast<std::size_t>(y / cell_) * columns_ + x / cell_];
  }
  bool is_edge(int x, int y, int plane, int width) const {
    return plane_at(x - width, y) != plane || plane_at(x + width, y) != plane ||
           plane_at(x, y - width) != plane || plane_at(x, y + width) != plane;
  }
  Rgba8 color_at(int x, int y) const {
    const int plane = plane_at(x, y);
    if (plane < 0) return kNothing;
    if (plane == 0 || plane > static_cast<int>(inks_.size())) return kNoPlane;
    const Rgba8 color = colors_[static_cast<std::size_t>(plane) - 1];
    if (!inks_[static_cast<std::size_t>(plane) - 1].marked)
      return is_edge(x, y, plane, 1) ? kBorder : color;
    if (is_edge(x, y, plane, 2)) return kOutline;
    return (x + y) % kHatch < kHatch / 2 ? color : lighter(color);
  }

  const std::vector<PlaneInk>& inks_;
  std::vector<int> plane_of_;
  int columns_, rows_, cell_ = 1;
  std::vector<Rgba8> colors_;
};

}  // namespace

Image8 draw_plane_map(const RegionSample& sample, const std::vector<PlaneInk>& inks) {
  if (sample.rows < 2 || sample.columns < 1) return {};
  return Map(sample, inks).draw();
}

ComparedInks compared_inks(const std::vector<PlaneComparison>& planes,
                           std::size_t planes_before,
                           const std::vector<std::string>& colors_now) {
  ComparedInks inks;
  inks.baseline.assign(planes_before, {kLost, true});
  for (const std::string& color : colors_now) inks.now.push_back({color, false});
  for (const PlaneComparison& plane : planes) {
    if (plane.fate == PlaneFate::gained)
      inks.now.at(static_cast<std::size_t>(plane.now) - 1).marked = true;
    if (plane.baseline > 0 && plane.now > 0)
      inks.baseline.at(static_cast<std::size_t>(plane.baseline) - 1) =
          inks.now.at(static_cast<std::size_t>(plane.now) - 1);
  }
  return inks;
}

}  // namespace planescope::report
