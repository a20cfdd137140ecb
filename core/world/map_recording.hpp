#pragma once

// Builds the map of a recording: poses, a shared direction of gravity, and tracks.

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

/// Camera poses in upright worlds (z up).
struct UprightPoses {
  Trajectory poses;                    // for frames with a pose
  std::vector<SharedGravity> gravity;  // by segment of the poses
  std::vector<std::string> warnings;   // warnings, one line each
};

struct MapJob {
  const io::Recording* recording = nullptr;
  std::vector<int> frames;
  planes::PipelineOptions pipeline;
  const planes::Classifier* classifier = nullptr;  // null if points are not labeled
  TrackOptions tracks;
  std::optional<Trajectory> trajectory;  // default: the recording's own poses, else odometry
  int threads = 1;
  std::function<void(const char* what, int done, int all)> progress = {};
  /// Called after each frame, in order.
  std::function<void(const ObservedFrame&, const FrameOfTracks&)> on_frame = {};
  /// Receives the planes of each frame, in order, as a 16-bit PNG with the plane id per pixel,
  /// 0 none. Not called if frames get no candidates, because segmenting them again gives the
  /// same planes.
  std::function<void(int frame, std::span<const unsigned char> png)> on_planes = {};
  /// Receives pieces that leave the window (TrackOptions::window_m).
  std::function<void(const LeftPiece&)> on_left = {};
  /// Segment each frame independently. Otherwise planes of other frames are candidates: all of
  /// them, in a second pass, or earlier ones only with at_own_rate or a window.
  bool alone = false;
  /// Simulate a live camera: frames arrive at their timestamps, or at 30 Hz if these do not
  /// increase. Frames that arrive while another is processed are dropped. Requires poses.
  bool at_own_rate = false;
  /// Provides the planes of frames observed elsewhere (observed_files.cpp).
  std::function<ObservedFrame(int frame, const UprightPoses& upright)> observed = {};
  std::stop_token stop = {};
};

/// Statistics of a job at the recording's own rate.
struct Pace {
  int frames = 0, taken = 0;
  double rate_hz = 0;                             // of the recording
  double behind_s_median = 0, behind_s_most = 0;  // latency from arrival to map
};

/// Planes of a frame as stored in the map.
struct StoredPlanes {
  std::string sha256;           // of the PNG passed to MapJob::on_planes
  std::vector<double> margins;  // by id - 1
};

/// Everything that determines the planes of a frame: options, and the camera under "camera".
/// Classifier weights are identified by name only.
using PlanesFrom = std::map<std::string, std::string>;
PlanesFrom planes_from(const planes::PipelineOptions& options, const io::RecordingInfo& recording);
/// The first difference, "min_pixels is 400; expected 200"; empty if equal.
std::string difference(const PlanesFrom& found, const PlanesFrom& expected);

struct WorldMap : UprightPoses {  // includes the aligned poses of the frames
  PlanesFrom planes_from;
  Tracker tracker;
  std::map<int, StoredPlanes> stored;  // by frame
  Stability stability;
  int refused = 0;           // frames that were unreadable or failed, each reported
  std::optional<Pace> pace;  // if made at the recording's own rate
};

/// Options for a frame after turn_to_map().
planes::PipelineOptions options_of_map(planes::PipelineOptions options);

/// Sets the frame's time to its pose's time and, if requested, its gravity to the map's.
/// Returns options_of_map().
planes::PipelineOptions turn_to_map(Frame& frame,
                                    planes::PipelineOptions options,
                                    const CameraPose& pose,
                                    const UprightPoses& upright);

/// Throws Error for recordings of clouds or without poses; Cancelled when stopped. Given the poses,
/// the result is bit-identical for any number of threads, except with at_own_rate.
WorldMap map_recording(const MapJob& job);

struct ObservedPart {
  int refused = 0;                    // frames that were unreadable or failed, each reported
  std::vector<std::string> warnings;  // one line each
};

/// Observes the subset of frames whose position in MapJob::frames satisfies `is_mine`, and passes
/// them to `take` in order. Requires poses, because odometry would process all frames. Throws
/// like map_recording().
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

/// `earlier`: the pass whose tracks are candidates (Offer::all). `what`: for MapJob::progress. Only
/// the last pass calls on_frame, on_planes and on_left.
Pass pass_through(const MapJob& job,
                  const UprightPoses& upright,
                  Offer offer,
                  const Tracker* earlier,
                  const char* what,
                  bool is_last);

/// Observes the frames at these poses without candidates, and calls `take` in order, skipping
/// failed frames. Returns one line per failed frame.
std::vector<std::string> observe_each(const MapJob& job,
                                      const UprightPoses& upright,
                                      const std::vector<const CameraPose*>& poses,
                                      const std::function<void(const ObservedFrame&)>& take);

}  // namespace planescope::world
