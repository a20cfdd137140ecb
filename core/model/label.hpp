#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "core/model/types.hpp"

namespace planescope {

/// Local surface inclination against gravity (Sec. III): h where the angle between the local normal
/// and gravity is at most 45 degrees, v otherwise.
enum class Label : std::uint8_t { unknown = 0, h = 1, v = 2 };

constexpr std::array<const char*, 3> names_of(Label) { return {"unknown", "h", "v"}; }
/// `unknown`: the text for a label that is neither.
inline const char* to_string(Label label, const char* unknown = "unknown") {
  return label == Label::h ? "h" : label == Label::v ? "v" : unknown;
}

/// Eq. (1), of the cosine of the angle between a normal, on either side, and up.
inline Label label_of_cosine(double cosine) {
  return std::abs(cosine) >= std::numbers::sqrt2 / 2 ? Label::h : Label::v;
}
/// Of a unit normal, world frame.
inline Label label_of_normal(const Vec3d& normal) { return label_of_cosine(normal.z()); }

}  // namespace planescope
