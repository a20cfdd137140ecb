#pragma once

// History of a point, and the reason why a position is in no plane.

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// One entry of a point's history. `step` -1: before the segmentation.
struct HistoryEvent {
  std::string stage;  // "pixel", "voxel", "label", "node", "merge", "leftover", "join",
                      // "result"; on a depth image also "join", "grow", "hidden", "list"
  std::string text;   // "case III at depth 5: e_n 0.0071 m² > 0.005"
  std::int32_t step = -1;
  std::int32_t node = -1;
  std::int32_t plane = -1;
  bool decisive = false;  // the decision that lost it (or assigned it to its plane)
};

/// History of a source: pixel v * width + u, or index in the cloud's file. For unmeasured and
/// cropped points, a short history with the reason.
std::vector<HistoryEvent> history_of(const Run& run, std::size_t source);
/// "pixel 320,240", "point 17" or, if a voxel contains several points, "voxel 17".
std::string point_name(const Run& run, std::int32_t voxel);
/// The source of the voxel nearest to its mean.
std::size_t source_of_voxel(const Subject& subject, std::uint32_t voxel);

/// A change that would have kept a point; empty if there is no obvious one.
struct Remedy {
  std::string text = {};                // "theta_n_in <= 4 would ask for a plane in node 77"
  std::string option = {}, value = {};  // as passed to --set
};
struct WhyNot {
  std::string answer;      // one sentence: "Lost at step 812: dropped, the nearest plane P4 is ..."
  std::int32_t step = -1;  // of the decision; -1 if the source was not segmented
  std::int32_t node = -1;
  std::int32_t plane = -1;
  Remedy remedy = {};
};
WhyNot why_not(const Run& run, std::size_t source);

/// Why a source has no voxel: unmeasured, out of range, or outside the cube.
struct Absence {
  std::string text;
  Remedy remedy = {};
};
std::optional<Absence> absence_of(const Run& run, std::size_t source);

// Steps in a voxel's history.

/// The steps that affected the voxel and the candidate that contained it.
std::set<std::int32_t> steps_of_point(const Run& run, std::int32_t voxel);
/// The step at which it joined its final plane; 0 if unassigned.
std::int32_t step_of_plane(const Run& run, std::int32_t voxel);
/// Step at which it was left over for the last time, and step at which its assignment then failed;
/// 0 if that never happened.
struct Loss {
  std::int32_t left = 0;
  std::int32_t dropped = 0;
};
Loss loss_of(const Run& run, std::int32_t voxel);

/// The step from which on two voxels are in the same plane; 0 if they end in different ones.
std::int32_t step_of_meeting(const Run& run, std::int32_t a, std::int32_t b);

/// "P4 (h)": a plane of the result.
std::string describe_plane(const Run& run, std::int32_t id);
/// The true plane of most voxels in a plane of the result; 0 if unknown.
std::int32_t truth_of_plane(const Run& run, std::int32_t id);

}  // namespace planescope::debug
