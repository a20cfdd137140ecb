#pragma once

// Measures distances between points and planes of a frame.

#include <cstdint>
#include <optional>
#include <string>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// A point, or a plane through it, in the sensor frame [m], which no option rotates.
struct MeasureEnd {
  Vec3d point = Vec3d::Zero();
  std::optional<Vec3d> normal = {};  // unit normal, for planes
  bool is_level = false;             // plane with label h
  std::string name = {};             // "P3", for planes
};

/// Measured pixel v * width + u, or point of a file. Throws Error with a phrase if there is none.
MeasureEnd measured_point(const Subject& subject, std::size_t source);
/// The mean of a voxel's points.
MeasureEnd measured_voxel(const Subject& subject, std::uint32_t voxel);
/// A plane of the trace as of a step, at the projection of `near` or, without it, at its centroid.
/// Throws Error with a phrase if there is none.
MeasureEnd measured_plane(const Run& run,
                          std::int32_t plane,
                          std::int32_t step,
                          const MeasureEnd* near = nullptr);

struct Measurement {
  // Line between two points, or perpendicular to a plane. Sensor frame.
  Vec3d from = Vec3d::Zero(), to = Vec3d::Zero();
  Vec3d corner = Vec3d::Zero();     // at the height of `from`, directly below or above `to`; if
                                    // gravity is known
  double distance_m = 0;            // to - from; negative: behind the plane
  std::optional<double> height_m;   // height of `to` above `from`; if gravity is known
  std::optional<double> angle_deg;  // between two planes
  std::string text;                 // "41.2 cm apart: 16.8 cm up, 37.6 cm across"
  std::string label;                // short form: "41.2 cm"
};
/// Measures between two ends; for two planes, at the position of the second end.
Measurement measure(const Subject& subject, const MeasureEnd& first, const MeasureEnd& second);

std::string height_text(double height_m);  // "16.8 cm up"

/// Converts from the sensor frame to the scene's frame, which is relative to Cloud::origin.
Vec3f in_scene(const Subject& subject, const Vec3d& at);

}  // namespace planescope::debug
