#pragma once

// Labels of one frame, proposed in all frames that see its planes, where the camera's poses are
// known.

#include <functional>
#include <optional>
#include <stop_token>
#include <vector>

#include "core/labels/edit/edit.hpp"
#include "core/labels/review/carry.hpp"

namespace planescope::labels {

/// A frame as it is before labels are proposed in it.
struct SpreadFrame {
  Frame frame;
  LabelGrid grid;
  FrameLabels labels;
};

struct SpreadJob {
  int from = 0;    // whose labels are proposed
  int frames = 0;  // of the recording
  /// Throws Error where the frame cannot be labelled: it is left out.
  std::function<SpreadFrame(int frame)> open;
  /// Nothing: no pose is known, the frame is left out.
  std::function<std::optional<Pose>(int frame)> T_world_camera;
  std::stop_token stop = {};
  std::function<void(int done, int all)> progress = {};
};

/// What is proposed in a frame.
struct Proposal {
  LabelEdit edit;            // of the frame's labels as they were
  FrameLabels blank;         // of the frame, without images: what it is
  std::size_t doubtful = 0;  // pixels that are left open
};

Proposal proposal_of(int frame,
                     std::string title,
                     const FrameLabels& before,
                     const FrameLabels& after);

/// Goes on from the labelled frame to both ends, each frame from the one before it and, for planes
/// that were out of sight there, from the labelled frame: cut to the frame's own depth, around
/// labels that are there. Frames in which nothing is proposed are left out. By frame. Throws Error
/// where `from` has no pose or no planes, Cancelled when stopped.
std::vector<Proposal> spread_labels(const SpreadJob& job);

}  // namespace planescope::labels
