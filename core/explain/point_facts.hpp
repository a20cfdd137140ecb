#pragma once

// What can be said of a point before and after the segmentation. Internal to core/explain.

#include <optional>
#include <set>
#include <string>

#include "core/explain/provenance.hpp"

namespace planescope {

/// "pixel (320, 240): depth 0.842 m", "point 17 of the file: (1.20, 0.03, -0.40) m".
std::string describe_source(const Subject& subject, std::size_t source);

/// Why a source is no voxel: not measured, beyond the range, outside the cube.
struct Absence {
  std::string text;
  Remedy remedy;
};
std::optional<Absence> absence_of(const Run& run, std::size_t source);

/// "plane 4 (P3, h)".
std::string describe_plane(const Run& run, std::int32_t id);
/// The true plane of most voxels in a plane of the result, 0 where none is known.
std::int32_t truth_of_plane(const Run& run, std::int32_t id);

/// The steps that say something of the voxel, and of the candidate that it was part of.
std::set<std::int32_t> steps_of_point(const Run& run, std::int32_t voxel);

/// The step at which the point came to the plane it ends in, 0 where it ends in none.
std::int32_t step_of_plane(const Run& run, std::int32_t voxel);
/// The step at which it was left over for the last time, and at which it then came to no plane; 0
/// where that never happened.
struct Loss {
  std::int32_t left = 0;
  std::int32_t dropped = 0;
};
Loss loss_of(const Run& run, std::int32_t voxel);

}  // namespace planescope
