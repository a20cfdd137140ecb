// Warnings about implausible calibration, color and depth: a wrong file, unit or image size.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/io/readers.hpp"

namespace planescope::io {
namespace {

constexpr double kLeastView_deg = 5, kMostView_deg = 150;
constexpr double kMostPixelRatio = 1.1;                // fx / fy, or its inverse
constexpr double kLeastCorner = 0.3, kMostCorner = 3;  // distorted radius / undistorted
constexpr double kNearest_m = 0.05, kFarthest_m = 100;

double view_deg(int size, double focal_px) {
  return 2 * std::atan(size / (2 * focal_px)) * 180 / std::numbers::pi;
}

/// Factor by which distortion moves the corner farthest from the principal point.
double corner_ratio(const Intrinsics& k) {
  const double x = std::max(k.cx, k.width - k.cx) / k.fx,
               y = std::max(k.cy, k.height - k.cy) / k.fy;
  const auto& [k1, k2, p1, p2, k3] = k.coefficients;
  const double r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  const double dx = 2 * p1 * x * y + p2 * (r2 + 2 * x * x);
  const double dy = p1 * (r2 + 2 * y * y) + 2 * p2 * x * y;
  return std::hypot(x * radial + dx, y * radial + dy) / std::sqrt(r2);
}

}  // namespace

void add_view_warning(int width, double focal_px, RecordingInfo& info) {
  constexpr double kMost_deg = 3;
  if (!(focal_px > 0 && width > 0 && info.intrinsics.fx > 0)) return;
  const double of_color = view_deg(width, focal_px),
               of_depth = view_deg(info.width, info.intrinsics.fx);
  if (std::abs(of_color - of_depth) > kMost_deg)
    info.warnings.push_back(fmt::format(
        "color is declared aligned with depth, but its intrinsics have a field of view of "
        "{:.3g} degrees; depth has {:.3g}",
        of_color, of_depth));
}

std::vector<std::string> camera_warnings(const RecordingInfo& info, bool of_color) {
  std::vector<std::string> warnings;
  const Intrinsics& k = info.intrinsics;
  for (const std::string& file : info.ignored_calibration)
    warnings.push_back(fmt::format("{}: {}", file, kNotACalibration));
  constexpr std::string_view kShown = "display only: ";
  if (of_color && info.color_note.starts_with(kShown))
    warnings.push_back("color cannot be aligned with depth: " +
                       info.color_note.substr(kShown.size()));
  if (info.width == 0 || info.intrinsics_source.empty()) return warnings;
  const std::string source = fmt::format("intrinsics from {}: ", info.intrinsics_source);
  if (k.cx < 0 || k.cy < 0 || k.cx > k.width || k.cy > k.height)
    warnings.push_back(fmt::format("{}the principal point {:.4g},{:.4g} is outside the {}x{} image",
                                   source, k.cx, k.cy, k.width, k.height));
  const double wide = view_deg(k.width, k.fx), high = view_deg(k.height, k.fy);
  if (std::min(wide, high) < kLeastView_deg || std::max(wide, high) > kMostView_deg)
    warnings.push_back(
        fmt::format("{}a field of view of {:.3g} x {:.3g} degrees; expected {} to {}; is the focal "
                    "length in pixels?",
                    source, wide, high, kLeastView_deg, kMostView_deg));
  if (std::max(k.fx / k.fy, k.fy / k.fx) > kMostPixelRatio)
    warnings.push_back(fmt::format(
        "{}fx {:.4g} and fy {:.4g} differ by {:.0f} %; depth cameras have square pixels", source,
        k.fx, k.fy, 100 * (std::max(k.fx / k.fy, k.fy / k.fx) - 1)));
  if (k.distortion != Distortion::none)
    if (const double ratio = corner_ratio(k); !(ratio > kLeastCorner && ratio < kMostCorner))
      warnings.push_back(
          fmt::format("{}distortion moves the image corner to {:.3g} of its distance from the "
                      "center, which is not plausible for a lens",
                      source, ratio));
  return warnings;
}

std::vector<std::string> frame_warnings(const RecordingInfo& info, const Frame& frame) {
  if (frame.is_cloud()) return {};
  std::vector<std::string> warnings;
  const Image8& color = frame.color;
  if (color.width > 0 && info.color_note.find("aligned") != std::string::npos &&
      (color.width != frame.depth.width || color.height != frame.depth.height))
    warnings.push_back(fmt::format(
        "color is declared aligned with depth, but is {}x{}; expected {}x{}; color is ignored",
        color.width, color.height, frame.depth.width, frame.depth.height));
  std::size_t measured = 0, near = 0, far = 0;
  for (const std::uint16_t count : frame.depth.data) {
    if (count == 0 || count == 65535) continue;
    const double depth_m = count * frame.depth_unit_m;
    ++measured;
    near += depth_m < kNearest_m;
    far += depth_m > kFarthest_m;
  }
  if (measured == 0 || 2 * std::max(near, far) <= measured) return warnings;
  warnings.push_back(fmt::format(
      "{} % of the depth values in frame {} are {}; is the depth unit ({:g} mm, {}) correct?",
      100 * std::max(near, far) / measured, frame.index,
      near > far ? "nearer than 5 cm" : "farther than 100 m", 1000 * frame.depth_unit_m,
      info.depth_unit_source));
  return warnings;
}

}  // namespace planescope::io
