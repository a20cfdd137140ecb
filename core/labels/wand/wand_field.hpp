#pragma once

// Code shared by the parts of the wand. Internal to core/labels.

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
/// nullopt for too few points, or points in a line. Moments about the sensor are accurate enough: a
/// few meters in doubles.
std::optional<Sheet> sheet_through(const Moments& moments);

constexpr float kLoosely = 1.5f;  // tolerances: in holes, and at borders decided by color

/// A frame, and the tolerance of its pixels to a plane.
struct WandField {
  const LabelGrid& grid;
  WandOptions options;
  std::vector<float> noise;  // across a sheet at 1 m offset, per pixel; in a cloud at any [m]
  std::vector<std::uint8_t> allowed;  // measured and available
  float least_cosine = 0;             // between normals that face the same way

  /// At close range, the option itself. Grows in proportion to noise above the expected level, but
  /// a large tolerance does not grow with noise that it already covers.
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
  /// True also if the normal is unknown.
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
  double half_px = 4;              // distance from the center at which a pixel has half weight
  int samples = 64;                // a fixed series of random ones
  int most_pixels = 256;           // tested, spread evenly
  std::span<const Sheet> hints{};  // tried first: no search if one contains most of the pixels
};
struct LocalFit {
  Sheet sheet;
  double share = 0;  // of the weights, on the sheet
};
/// The plane with most of the pixels in `box`, among those with nonzero `usable`. Pixels count more
/// the nearer they are to `middle`.
std::optional<LocalFit> fit_around(const WandField& field,
                                   const std::vector<std::uint8_t>& usable,
                                   const PixelBox& box,
                                   std::uint32_t middle,
                                   const LocalFitOptions& options = {});

/// The same for points of a cloud, of which the first is the center; `half_px` is in spacings.
std::optional<LocalFit> fit_through(const WandField& field,
                                    std::span<const std::uint32_t> pixels,
                                    const LocalFitOptions& options = {});

/// A region and its plane, growing from clicks: in an image over pixels (wand.cpp), in a cloud over
/// each point's neighbors (wand_cloud.cpp).
class Growth {
 public:
  Growth(const WandField& field, std::size_t least)
      : least_pixels(least), field_(field), grid_(field.grid), region_(grid_.pixels(), 0) {}
  virtual ~Growth() = default;
  Growth(const Growth&) = delete;
  Growth& operator=(const Growth&) = delete;

  /// The free pixel nearest to a click that may have hit a hole.
  virtual std::optional<std::uint32_t> free_pixel(std::uint32_t click) const = 0;
  virtual std::optional<Sheet> plane_at(std::uint32_t click) const = 0;
  /// Grows from a click and the plane there, fitting the plane again as the region grows. Returns
  /// false if nothing is left.
  virtual bool begin(std::uint32_t click, const Sheet& start) = 0;
  /// Grows from further clicks until nothing changes, up to the region's border.
  virtual bool complete(const std::vector<std::uint32_t>& clicks) = 0;
  /// Adds to `reached` the pixels connected to a click within the region. Returns the added pixels.
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
  // Strips narrower than the normals' windows have no normals: there, only distance decides.
  bool facing_ = true;
  std::vector<std::uint8_t> region_;
};
std::unique_ptr<Growth> growth_in_cloud(const WandField& field);

/// Removes pixels from `region` that belong to another surface meeting the sheet at a crease. All
/// of `region` is within tolerance of the sheet; the part of the other surface outside the region
/// shows its plane. `box` contains the region.
void cut_at_creases(const WandField& field,
                    const Sheet& sheet,
                    const PixelBox& box,
                    std::vector<std::uint8_t>& region);

/// Assigns pixels at the border of the region by color if their depth is ambiguous.
void settle_border_by_color(const WandField& field,
                            const Sheet& sheet,
                            const PixelBox& box,
                            std::vector<std::uint8_t>& region);

}  // namespace planescope::labels
