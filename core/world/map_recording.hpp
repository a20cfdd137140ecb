#pragma once

// A recording becomes a map: poses, one direction of gravity, tracks.

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
#include "core/model/error.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/world/poses/poses.hpp"
#include "core/world/tracks/tracker.hpp"

namespace planescope::world {

/// Camera poses in worlds whose z points up.
struct UprightPoses {
  Trajectory poses;                    // of the frames that have one
  std::vector<SharedGravity> gravity;  // by segment of the poses
  std::vector<std::string> told;       // warnings, one line each
};

struct MapJob {
  const io::Recording* recording = nullptr;
  std::vector<int> frames;
  planes::PipelineOptions pipeline;
  const planes::Classifier* classifier = nullptr;  // none where points are not labelled
  TrackOptions tracks;
  std::optional<Trajectory> trajectory;  // else the recording's own, else odometry
  int threads = 1;
  std::function<void(const char* what, int done, int all)> progress = {};
  /// After each frame, in their order.
  std::function<void(const ObservedFrame&, const FrameOfTracks&)> on_frame = {};
  /// The planes of each frame, in their order, as a PNG of 16 bits: per pixel the plane's id, 0
  /// none. Not called if frames get no candidates: then segmenting them again gives the same
  /// planes.
  std::function<void(int frame, std::span<const unsigned char> png)> on_planes = {};
  /// What leaves the window (TrackOptions::window_m).
  std::function<void(const LeftPiece&)> on_left = {};
  /// Segment each frame independently. Otherwise planes of other frames are candidates: all of
  /// them, in a second pass, or earlier ones only with at_own_rate or a window.
  bool alone = false;
  /// Simulate a live camera: frames arrive at their timestamps, or at 30 Hz if these do not
  /// increase. Frames that arrive while another is processed are dropped. Needs poses.
  bool at_own_rate = false;
  /// Frames that were observed elsewhere (observed_files.hpp): their planes are taken from there.
  std::function<ObservedFrame(int frame, const UprightPoses& upright)> observed = {};
  std::stop_token stop = {};
};

/// How a job at the recording's own rate kept up.
struct Pace {
  int frames = 0, taken = 0;
  double rate_hz = 0;                             // of the recording
  double behind_s_median = 0, behind_s_most = 0;  // latency from arrival to map
};

/// The planes of a frame, as the map has them.
struct StoredPlanes {
  std::string sha256;           // of the PNG that MapJob::on_planes took
  std::vector<double> margins;  // by id - 1
};

/// What the planes of a frame follow from: options, and the camera under "camera". Of classifier
/// weights only the name.
using PlanesFrom = std::map<std::string, std::string>;
PlanesFrom planes_from(const planes::PipelineOptions& options, const io::RecordingInfo& recording);
/// Empty, or the first difference: "min_pixels is 400, expected 200".
std::string difference(const PlanesFrom& found, const PlanesFrom& expected);

struct WorldMap : UprightPoses {  // with the poses at which the map has the frames
  PlanesFrom planes_from;
  Tracker tracker;
  std::map<int, StoredPlanes> stored;  // by frame
  Stability stability;
  int refused = 0;           // frames that could not be read or worked on, told each
  std::optional<Pace> pace;  // where it was made at the recording's own rate
};

/// Options for a frame after turn_to_map().
planes::PipelineOptions options_of_map(planes::PipelineOptions options);

/// Gives the frame its pose's time and, if asked for, the map's gravity.
/// Returns options_of_map().
planes::PipelineOptions turn_to_map(Frame& frame,
                                    planes::PipelineOptions options,
                                    const CameraPose& pose,
                                    const UprightPoses& upright);

/// Throws Error where the recording is of clouds, or no frame has a pose; Cancelled when stopped.
/// Given the poses, the result is bit-identical for any number of threads, except with at_own_rate.
WorldMap map_recording(const MapJob& job);

struct ObservedPart {
  int refused = 0;                // frames that could not be read or worked on, told each
  std::vector<std::string> told;  // one line each
};

/// A part of it: observes the frames of the job for whose position in MapJob::frames `is_mine`
/// holds, and hands them over in their order. Needs poses: odometry would go through all frames.
/// Throws as map_recording() does.
ObservedPart observe_recording(
    const MapJob& job,
    const std::function<bool(std::size_t position)>& is_mine,
    const std::function<void(const ObservedFrame&, const UprightPoses&)>& take);

// ---- One pass over the frames; internal to core/world ----

inline void check_stop(const MapJob& job) {
  if (job.stop.stop_requested()) throw Cancelled();
}

inline void report_progress(const MapJob& job, const char* what, int done, int all) {
  if (job.progress) job.progress(what, done, all);
}

/// The pose of each frame of the job; null if it has none.
std::vector<const CameraPose*> poses_by_frame(const MapJob& job, const UprightPoses& upright);

/// The tracks of a segment that a map holds: candidates for its next frame.
std::vector<const Track*> sure_tracks(const Tracker& tracker, int segment);

/// Candidates for each frame: none, the tracks so far, or all tracks of an earlier pass.
enum class Offer { nothing, so_far, all };

/// Result of one pass.
struct Pass {
  Tracker tracker;
  std::map<int, StoredPlanes> stored;
  std::vector<std::string> refused;  // frames that failed, one line each
  int without_pose = 0;
  std::optional<Pace> pace;
};

/// `earlier`: the pass whose tracks are offered (Offer::all). `what`: for MapJob::progress. Only
/// the last pass calls on_frame, on_planes and on_left.
Pass pass_through(const MapJob& job,
                  const UprightPoses& upright,
                  Offer offer,
                  const Tracker* earlier,
                  const char* what,
                  bool is_last);

/// Observes the frames at these poses without candidates. Calls `take` in this order, and not for
/// frames that failed; returns these, a line each.
std::vector<std::string> observe_each(const MapJob& job,
                                      const UprightPoses& upright,
                                      const std::vector<const CameraPose*>& poses,
                                      const std::function<void(const ObservedFrame&)>& take);

}  // namespace planescope::world
