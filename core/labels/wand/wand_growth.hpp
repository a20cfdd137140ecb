#pragma once

// A region of the wand, and the plane under it, as it grows. Internal to core/labels.

#include "core/labels/wand/wand_field.hpp"

namespace planescope::labels {

/// The nearest free pixel to a click that may have hit a hole.
std::optional<std::uint32_t> nearest_allowed(const WandField& field, std::uint32_t click);

/// The plane around a click; nullopt where there is none.
std::optional<Sheet> plane_at(const WandField& field, std::uint32_t click);

class WandGrowth {
 public:
  explicit WandGrowth(const WandField& field);

  /// From a click and the plane there, in ever larger boxes, the plane fitted anew each time.
  /// False where that ends in nothing.
  bool grow(std::uint32_t click, const Sheet& start);

  /// Continues from there with further clicks until nothing changes.
  void grow_on(const std::vector<std::uint32_t>& clicks);

  /// Adds, up to some distance, what lies on the plane but faces elsewhere, as normals beside an
  /// edge do.
  void take_turned();

  const Sheet& sheet() const { return sheet_; }
  const PixelBox& box() const { return box_; }  // holds the region
  std::vector<std::uint8_t>& region() { return region_; }

  /// Adds to `reached` what is connected to a click within the region. Returns the pixels added.
  PixelSet reach_within_region(std::uint32_t click, std::vector<std::uint8_t>& reached) const;

 private:
  void regrow(const std::vector<std::uint32_t>& clicks, const PixelBox& box);
  bool refit();

  const WandField& field_;
  const LabelGrid& grid_;
  Sheet sheet_;
  // Strips narrower than the normals' windows have no normals: there distance alone decides.
  bool facing_ = true;
  PixelBox box_;
  std::vector<std::uint8_t> on_;  // 1 on the sheet, 2 and facing as it does
  std::vector<std::uint8_t> region_;
};

}  // namespace planescope::labels
