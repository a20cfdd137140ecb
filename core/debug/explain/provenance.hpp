#pragma once

// A point's whole life, and why a place ended in no plane.

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// One station of a point's life. `step` -1: before the segmentation.
struct LifeEvent {
  std::string stage;  // "pixel", "voxel", "label", "node", "merge", "leftover", "join",
                      // "result"; on a depth image also "join", "grow", "hidden", "list"
  std::string text;   // "case III at depth 5: e_n 0.0071 m² > 0.005"
  std::int32_t step = -1;
  std::int32_t node = -1;
  std::int32_t plane = -1;
  bool decisive = false;  // the decision that lost it (or gave it its plane)
};

/// `source`: pixel v * width + u, or index in the cloud's file. Points that were never measured or
/// were cropped have a short life that says so.
std::vector<LifeEvent> life_of(const Run& run, std::size_t source);
/// A source of the voxel: the one nearest to its mean.
/// "pixel 320,240", "point 17" or, where a voxel holds several points, "voxel 17".
std::string point_name(const Run& run, std::int32_t voxel);

std::size_t source_of_voxel(const Subject& subject, std::uint32_t voxel);

/// What would have kept a point: all empty where nothing obvious would.
struct Remedy {
  std::string text = {};                // "theta_n_in <= 4 would ask for a plane in node 77"
  std::string option = {}, value = {};  // the same as --set takes it
};
struct WhyNot {
  std::string answer;      // one sentence: "Lost at step 812: dropped, the nearest plane P4 is ..."
  std::int32_t step = -1;  // of the decision, -1 where it never came to the segmentation
  std::int32_t node = -1;
  std::int32_t plane = -1;
  Remedy remedy = {};
};
WhyNot why_not(const Run& run, std::size_t source);

/// Why a source is no voxel: not measured, beyond the range, outside the cube.
struct Absence {
  std::string text;
  Remedy remedy = {};
};
std::optional<Absence> absence_of(const Run& run, std::size_t source);

// A voxel's way through the segmentation.

/// The steps that say something of it, and of the candidate that it was part of.
std::set<std::int32_t> steps_of_point(const Run& run, std::int32_t voxel);
/// The step at which it came to the plane it ends in, 0 where it ends in none.
std::int32_t step_of_plane(const Run& run, std::int32_t voxel);
/// The step at which it was left over for the last time, and at which it then came to no plane; 0
/// where that never happened.
struct Loss {
  std::int32_t left = 0;
  std::int32_t dropped = 0;
};
Loss loss_of(const Run& run, std::int32_t voxel);

/// The step from which on two voxels are in one plane until the end, 0 where they are not in the
/// end.
std::int32_t step_of_meeting(const Run& run, std::int32_t a, std::int32_t b);

/// "P4 (h)": a plane of the result.
std::string describe_plane(const Run& run, std::int32_t id);
/// The true plane of most voxels in a plane of the result, 0 where none is known.
std::int32_t truth_of_plane(const Run& run, std::int32_t id);

}  // namespace planescope::debug
