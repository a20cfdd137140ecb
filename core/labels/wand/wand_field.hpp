#pragma once

// What the parts of the wand share. Internal to core/labels.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/labels/model/grid.hpp"
#include "core/labels/wand/wand.hpp"
#include "core/model/plane.hpp"
#include "core/model/types.hpp"

namespace planescope::labels {

/// Part of an image: [u0, u1) x [v0, v1).
struct PixelBox {
  int u0 = 0, v0 = 0, u1 = 0, v1 = 0;
};
inline PixelBox box_around(const LabelGrid& grid, std::uint32_t pixel, int reach) {
  const int u = static_cast<int>(pixel) % grid.width, v = static_cast<int>(pixel) / grid.width;
  return {std::max(0, u - reach), std::max(0, v - reach), std::min(grid.width, u + reach + 1),
          std::min(grid.height, v + reach + 1)};
}
/// Calls visit(pixel) row by row.
template <typename Visit>
void for_pixels(const LabelGrid& grid, const PixelBox& box, const Visit& visit) {
  for (int v = box.v0; v < box.v1; ++v)
    for (int u = box.u0; u < box.u1; ++u) visit(static_cast<std::uint32_t>(v * grid.width + u));
}

/// A plane normal . x = offset, in floats for speed: every pixel is compared with it.
struct Sheet {
  Vec3f normal = Vec3f::UnitZ();
  float offset_m = 0;

  float distance_m(const Vec3f& point) const { return normal.dot(point) - offset_m; }
};
/// nullopt where there are too few points, or all in a line. Moments about the sensor are exact
/// enough: a few metres in doubles.
std::optional<Sheet> sheet_through(const Moments& moments);

constexpr float kLoosely = 1.5f;  // tolerances: within holes, and at borders that colour decides

/// A frame, and how far from a plane its pixels may lie.
struct WandField {
  const LabelGrid& grid;
  WandOptions options;
  std::vector<float> noise;  // across a sheet at 1 m of offset, per pixel; of a cloud at any [m]
  std::vector<std::uint8_t> allowed;  // measured, and free to take
  float least_cosine = 0;             // between normals that face the same way

  /// At close range the option itself. Where noise is more than it allows for it grows in that
  /// ratio, but a tolerance that is large already does not grow with noise that it covers.
  float tolerance_m(const Sheet& sheet, std::uint32_t pixel) const {
    constexpr double kCloseNoise_m = 0.0023;
    const auto tolerance = static_cast<float>(options.tolerance_m);
    const auto close = static_cast<float>(std::min(options.tolerance_m, kCloseTolerance_m));
    const float away = grid.is_cloud() ? 1 : std::abs(sheet.offset_m);
    return std::max(tolerance, close * noise[pixel] * away * static_cast<float>(1 / kCloseNoise_m));
  }
  bool lies_on(const Sheet& sheet, std::uint32_t pixel, float times = 1) const {
    return std::abs(sheet.distance_m(grid.points[pixel])) <= times * tolerance_m(sheet, pixel);
  }
  /// True also where the normal is not known.
  bool faces(const Sheet& sheet, std::uint32_t pixel) const {
    const Vec3f& normal = grid.normals[pixel];
    const float cosine = normal.dot(sheet.normal);
    return normal.isZero(0) || (grid.is_cloud() ? std::abs(cosine) : cosine) >= least_cosine;
  }
};
WandField make_wand_field(const LabelGrid& grid,
                          const FrameLabels* labels,
                          const WandOptions& options);

struct LocalFitOptions {
  double half_px = 4;              // distance from the middle at which a pixel counts half
  int samples = 64;                // a fixed series of random ones
  int most_pixels = 256;           // looked at, spread evenly
  std::span<const Sheet> hints{};  // tried first: no search where one holds most of the pixels
};
struct LocalFit {
  Sheet sheet;
  double share = 0;  // of the weights, on the sheet
};
/// The plane that most of the pixels in `box` lie on, of those where `usable` is not 0; the nearer
/// to the pixel `middle`, the more they count.
std::optional<LocalFit> fit_around(const WandField& field,
                                   const std::vector<std::uint8_t>& usable,
                                   const PixelBox& box,
                                   std::uint32_t middle,
                                   const LocalFitOptions& options = {});

/// The same of points of a cloud, the first of them the middle; `half_px` is in spacings.
std::optional<LocalFit> fit_through(const WandField& field,
                                    std::span<const std::uint32_t> pixels,
                                    const LocalFitOptions& options = {});

/// A region and the plane under it, as it grows from clicks: in an image over pixels (wand.cpp), in
/// a cloud over each point's neighbours (wand_cloud.cpp).
class Growth {
 public:
  Growth(const WandField& field, std::size_t least)
      : least_pixels(least), field_(field), grid_(field.grid), region_(grid_.pixels(), 0) {}
  virtual ~Growth() = default;
  Growth(const Growth&) = delete;
  Growth& operator=(const Growth&) = delete;

  /// The nearest free pixel to a click that may have hit a hole.
  virtual std::optional<std::uint32_t> free_pixel(std::uint32_t click) const = 0;
  virtual std::optional<Sheet> plane_at(std::uint32_t click) const = 0;
  /// From a click and the plane there, the plane fitted anew as the region grows. False where that
  /// ends in nothing.
  virtual bool begin(std::uint32_t click, const Sheet& start) = 0;
  /// With further clicks, until nothing changes, and to the region's border.
  virtual bool complete(const std::vector<std::uint32_t>& clicks) = 0;
  /// Adds to `reached` what is connected to a click within the region. Returns the pixels added.
  virtual PixelSet reach_from(std::uint32_t click, std::vector<std::uint8_t>& reached) const = 0;

  const Sheet& sheet() const { return sheet_; }
  const std::size_t least_pixels;  // of a plane

 protected:
  bool refit(const Moments& moments) {
    const auto refitted = sheet_through(moments);
    if (!refitted || moments.count < static_cast<double>(least_pixels)) return false;
    sheet_ = *refitted;
    return true;
  }

  const WandField& field_;
  const LabelGrid& grid_;
  Sheet sheet_;
  // Strips narrower than the normals' windows have no normals: there distance alone decides.
  bool facing_ = true;
  std::vector<std::uint8_t> region_;
};
std::unique_ptr<Growth> growth_in_cloud(const WandField& field);

/// Takes pixels off `region` that lie on another surface which meets the sheet at a crease. All of
/// `region` is within tolerance of the sheet; where the other surface lies is told by its part
/// outside of the region. `box` holds the region.
void cut_at_creases(const WandField& field,
                    const Sheet& sheet,
                    const PixelBox& box,
                    std::vector<std::uint8_t>& region);

/// Lets colour decide at the border of the region where depth leaves it open.
void settle_border_by_color(const WandField& field,
                            const Sheet& sheet,
                            const PixelBox& box,
                            std::vector<std::uint8_t>& region);

}  // namespace planescope::labels
