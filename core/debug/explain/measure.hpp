#pragma once

// How far apart two places of a frame are: points, or planes.

#include <cstdint>
#include <optional>
#include <string>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// A point, or a plane through it, in the sensor's axes [m], which no option turns.
struct MeasureEnd {
  Vec3d point = Vec3d::Zero();
  std::optional<Vec3d> normal = {};  // unit, of a plane
  bool is_level = false;             // of a plane of label h
  std::string name = {};             // "P3", of a plane
};

/// A measured pixel v * width + u, or point of a file. Throws Error, a phrase, where there is none.
MeasureEnd measured_point(const Subject& subject, std::size_t source);
/// The mean of a voxel's points.
MeasureEnd measured_voxel(const Subject& subject, std::uint32_t voxel);
/// A plane of the trace as it is at a step, at the foot of `near`, or else at its centroid. Throws
/// Error, a phrase, where there is none.
MeasureEnd measured_plane(const Run& run,
                          std::int32_t plane,
                          std::int32_t step,
                          const MeasureEnd* near = nullptr);

struct Measurement {
  // The line between two points; from a plane, at right angles to it. In the sensor's axes.
  Vec3d from = Vec3d::Zero(), to = Vec3d::Zero();
  Vec3d corner = Vec3d::Zero();    // as high as `from`, below or above `to`; where gravity is known
  double distance_m = 0;           // to - from; negative: behind the plane
  std::optional<double> height_m;  // up from `from`; where gravity is known
  std::optional<double> angle_deg;  // between two planes
  std::string text;                 // "41.2 cm apart: 16.8 cm up, 37.6 cm across"
  std::string label;                // the same in few letters: "41.2 cm"
};
/// Of two planes: where the second end is.
Measurement measure(const Subject& subject, const MeasureEnd& first, const MeasureEnd& second);

std::string height_text(double height_m);  // "16.8 cm up"

/// Of the sensor's axes in the scene's, which are about Cloud::origin.
Vec3f in_scene(const Subject& subject, const Vec3d& at);

}  // namespace planescope::debug
