#include <algorithm>
#include <cmath>

#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/sha256.hpp"

namespace planescope::io {
namespace {

constexpr double kRealSenseUnit_m = 0.001;

bool usable(const Intrinsics& k) {
  return std::isfinite(k.fx) && std::isfinite(k.fy) && std::isfinite(k.cx) && std::isfinite(k.cy) &&
         k.fx > 0 && k.fy > 0;
}

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

}  // namespace

void settle_camera(const RecordingOptions& options,
                   const Sidecar& sidecar,
                   const CameraFacts& facts,
                   RecordingInfo& info) {
  if (options.intrinsics) {
    const auto& [fx, fy, cx, cy] = *options.intrinsics;
    info.intrinsics = {0, 0, fx, fy, cx, cy, Distortion::none, {}};
    info.intrinsics_source = "option --intrinsics";
  } else if (sidecar.intrinsics) {
    info.intrinsics = *sidecar.intrinsics;
    info.intrinsics_source = sidecar.path.filename().string();
  } else if (facts.intrinsics) {
    info.intrinsics = *facts.intrinsics;
    info.intrinsics_source = facts.intrinsics_source;
  } else {
    throw Error(info.path.string() +
                ": the recording does not say its camera intrinsics; give them with "
                "--intrinsics FX,FY,CX,CY");
  }
  Intrinsics& k = info.intrinsics;
  if (!usable(k)) {
    throw Error(info.path.string() + ": intrinsics fx " + std::to_string(k.fx) + ", fy " +
                std::to_string(k.fy) + " from " + info.intrinsics_source +
                " are not usable, expected focal lengths above 0 in pixels");
  }
  if (k.width > 0 && k.height > 0 && (k.width != info.width || k.height != info.height)) {
    throw Error(info.path.string() + ": depth images are " + size_text(info.width, info.height) +
                " but the intrinsics in " + info.intrinsics_source + " are for " +
                size_text(k.width, k.height));
  }
  k.width = info.width;
  k.height = info.height;

  if (options.depth_unit_m) {
    info.depth_unit_m = *options.depth_unit_m;
    info.depth_unit_source = "option --depth-unit";
  } else if (sidecar.depth_unit_m) {
    info.depth_unit_m = *sidecar.depth_unit_m;
    info.depth_unit_source = sidecar.path.filename().string();
  } else if (facts.depth_unit_m) {
    info.depth_unit_m = *facts.depth_unit_m;
    info.depth_unit_source = facts.depth_unit_source;
  } else {
    info.depth_unit_m = kRealSenseUnit_m;
    info.depth_unit_source = "assumed (RealSense default)";
  }
  if (!(info.depth_unit_m > 0) || !std::isfinite(info.depth_unit_m)) {
    throw Error(info.path.string() + ": depth unit " + std::to_string(info.depth_unit_m) +
                " m from " + info.depth_unit_source + ", expected metres per count above 0");
  }
}

bool set_distortion(const std::string& model,
                    const std::vector<double>& coefficients,
                    Intrinsics& intrinsics) {
  intrinsics.distortion = Distortion::none;
  intrinsics.coefficients = {};
  const bool all_zero =
      std::all_of(coefficients.begin(), coefficients.end(), [](double c) { return c == 0; });
  if (all_zero) return true;
  std::string lower = model;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  const auto names = [&](const char* part) { return lower.find(part) != std::string::npos; };
  const bool finite = std::all_of(coefficients.begin(), coefficients.end(),
                                  [](double c) { return std::isfinite(c); });
  // More than five coefficients are a rational model, which ours cannot express.
  const bool five =
      coefficients.size() <= 5 ||
      std::all_of(coefficients.begin() + 5, coefficients.end(), [](double c) { return c == 0; });
  if (!finite || !five || !(names("brown") || names("plumb"))) return false;
  std::copy_n(coefficients.begin(), std::min<std::size_t>(5, coefficients.size()),
              intrinsics.coefficients.begin());
  intrinsics.distortion =
      names("inverse") ? Distortion::inverse_brown_conrady : Distortion::brown_conrady;
  return true;
}

std::string sha256_of_depth(const Image16& depth) {
  return sha256_hex(std::as_bytes(std::span(depth.data)));
}

}  // namespace planescope::io
