#pragma once

// Matches the planes of frames with tracks and fuses them: visibility of tracks in a frame,
// alignment of its pose, expected planes, and labels from the map. Also the history of tracks:
// their state in each frame, track filters and stability.

#include <deque>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/labels/model/grid.hpp"
#include "core/planes/depth/inverse_depth.hpp"
#include "core/world/poses/poses.hpp"
#include "core/world/tracks/track.hpp"

namespace planescope::world {

/// The cells of a track in a frame, classified by the frame's measurements. Each cell in view is
/// counted in exactly one of `hidden`, `unmeasured`, `through` and `there`.
struct Visibility {
  int cells = 0;         // of the track
  int in_view = 0;       // inside image and range
  int beyond_range = 0;  // inside the image
  int hidden = 0;        // occluded by something else
  int unmeasured = 0;
  int through = 0;  // something behind it is measured
  int there = 0;    // the measurement is on the plane

  struct On {
    int cells = 0;
    int hides = 0;              // cells hidden by the plane
    Vec3d sum = Vec3d::Zero();  // of their world positions
  };
  struct Look {
    Cell* cell = nullptr;
    bool through = false;
  };
  std::vector<Look> looks;  // at cells in view that are measured and not hidden

  Moments places;  // of the cells that are there, relative to the camera

  std::vector<On> on;  // by plane id of the frame, 0 none: measurements at the cells

  int visible() const { return through + there; }
  /// The plane that contains most of its cells; 0: none.
  int most_on() const;
};

/// Checks every present cell. The result is valid until the track gets more cells. `there`:
/// receives one pixel v * width + u for each cell that is there; may be null.
Visibility visibility_of(Track& track,
                         const ObservedFrame& frame,
                         const TrackOptions& options,
                         std::vector<std::uint32_t>* there = nullptr);

/// Updates the cells' history; cells that were seen through too often are gone.
void update_cells(const Visibility& visibility);

// ---- Alignment ----
// Aligns a frame with the tracks before matching. Poses are off by a centimeter and half a degree,
// more in fast rotations; uncorrected, planes match the wrong track.

/// T_world_camera of the frame, corrected so that its depth fits the tracks (point to plane,
/// with the given pose and its uncertainty as a prior). Unchanged if the depth already fits
/// within its noise.
Pose aligned_pose(const ObservedFrame& frame, std::span<Track* const> tracks);

/// Moves the observation to another pose.
void move_to(ObservedFrame& frame, const Pose& T_world_camera);

// ---- Expected planes ----

/// The tracks as candidate planes for a frame at this pose, with the measured pixels whose rays hit
/// cells that are sure or gone. `KnownPlane::id` is the track's id.
std::vector<planes::KnownPlane> expected_planes(std::span<const Track* const> tracks,
                                                const Frame& frame,
                                                const Pose& T_world_camera,
                                                const TrackOptions& options,
                                                int threads = 1);

// ---- Labels from the map ----

struct PixelsOfTrack {
  labels::PixelSet sure;
  labels::PixelSet doubtful;  // in its region, but farther away than noise explains, or at
                              // another angle
};

/// Pixels of a track in a depth image at this pose in the track's world.
PixelsOfTrack pixels_of_track(const Track& track,
                              const labels::LabelGrid& grid,
                              const Pose& T_world_camera);

// ---- Matching ----

/// Result of matching one frame.
struct FrameOfTracks {
  int frame = 0;
  double timestamp_s = 0;
  int segment = 0;
  Pose T_world_camera = Pose::Identity();  // after alignment
  std::optional<Vec3d> gravity;            // from ObservedFrame
  bool has_pose = true;
  bool set_aside = false;  // its depth does not fit the known planes
  double agreement = 1;    // share of the visible cells whose measurement is on the plane
  int compared_cells = 0;
  std::vector<int> track_of;  // by plane id - 1; 0: none
  std::vector<int> covered;   // tracks represented by planes of larger tracks
  int listed = 0;             // number of listed planes; minor ones follow them

  bool is_in_map() const { return has_pose && !set_aside; }
};

/// A piece of a track that has left the window.
struct LeftPiece {
  int track = 0, frame = 0;
  planes::Outline outline;  // of its sure cells, in the world frame
};

/// Tracks over the frames of one camera, added in sequence. Deterministic.
class Tracker {
 public:
  /// `known`: number of tracks of an earlier pass from which the frames' planes were expected; 0:
  /// they were expected from this tracker's own tracks.
  explicit Tracker(TrackOptions options = {}, std::size_t known = 0)
      : options_(options), own_of_known_(known, 0) {}

  /// Aligns the frame with the tracks, unless its planes were expected from an earlier pass, and
  /// adds its planes. Frames of a segment must be contiguous and in order of time.
  const FrameOfTracks& add(ObservedFrame& frame);
  const FrameOfTracks& add(ObservedFrame&& frame) { return add(frame); }
  /// Records a frame without a pose, or one that failed.
  const FrameOfTracks& skip(int frame, double timestamp_s);

  /// Merges all equal tracks after the last frame.
  void consolidate();

  /// Sets a function to call for each piece that leaves the window.
  void on_left(std::function<void(const LeftPiece&)> callback) {
    left_callback_ = std::move(callback);
  }

  const TrackOptions& options() const { return options_; }
  const std::deque<Track>& tracks() const { return tracks_; }  // by id - 1
  /// Converts a segment of the poses to a segment of the map.
  int segment_of(int pose_segment) const { return pose_segment + begun_; }
  const std::vector<FrameOfTracks>& frames() const { return frames_; }

 private:
  struct Candidate;
  std::vector<Track*> alive();
  /// Uses the measurements in the frame at the track's cells or, if there are too few, the
  /// whole track.
  Apart apart_from(const ObservedFrame& frame,
                   const Candidate& candidate,
                   const ObservedPlane& plane) const;
  TermResult compare(const ObservedFrame& frame,
                     const Candidate& candidate,
                     const ObservedPlane& plane) const;
  /// Computes how well the frame's depth fits the tracks.
  void evaluate_agreement(std::span<const Candidate> candidates, FrameOfTracks& result) const;
  /// Assigns planes to the tracks from which they were expected.
  void match_expected(const ObservedFrame& frame,
                      std::vector<Candidate>& candidates,
                      FrameOfTracks& result);
  /// Assigns the remaining planes (all minor, or none) to tracks. Minor planes create no tracks,
  /// and are not matched by touching alone.
  void assign(const ObservedFrame& frame,
              std::span<const ObservedPlane> planes,
              std::vector<Candidate>& candidates,
              FrameOfTracks& result);
  void add_sighting(const Candidate& candidate,
                    const ObservedFrame& frame,
                    const ObservedPlane& plane);
  void create_track(const ObservedFrame& frame, const ObservedPlane& plane, FrameOfTracks& result);
  bool touch(const Track& track, const ObservedPlane& plane) const;
  void record_absence(const ObservedFrame& frame,
                      Candidate& candidate,
                      const FrameOfTracks& result);
  /// Merges equal tracks; one track of each pair must have grown. Returns whether any were merged.
  bool merge_equal(int frame, const std::function<bool(const Track&)>& has_grown);
  /// Merges tracks into larger ones that represent them in most frames.
  void merge_covered(int frame);
  void merge(Track& from, Track& into, int frame);
  void end_gone_tracks(int frame);
  void leave_window(const ObservedFrame& frame);

  TrackOptions options_;
  std::vector<int> own_of_known_;  // by id - 1; 0: not seen yet
  std::deque<Track> tracks_;
  std::vector<FrameOfTracks> frames_;
  int segment_ = 0;  // of the last frame, including segments that began here
  int begun_ = 0;    // number of segments that began because frames did not fit
  int taken_ = 0;    // number of frames of this segment
  int aside_ = 0;    // consecutive frames
  std::function<void(const LeftPiece&)> left_callback_;
};

/// The track into which a merged track has been merged; otherwise `id`.
int final_track(const std::deque<Track>& tracks, int id);

// ---- History ----

struct Moment {
  enum class Kind : std::uint8_t {
    unborn,
    seen,
    absent,
    ended,
    unknown  // a frame that has no pose or is not part of the map
  };
  Kind kind = Kind::unknown;
  const Sighting* sighting = nullptr;  // if seen
  const Gap* gap = nullptr;            // if absent

  /// Whether the track is visible in the frame, but has no listed plane.
  bool is_unlisted() const { return gap ? world::is_miss(gap->why) : sighting && sighting->minor; }
};
Moment moment_of(const Track& track, int frame);

/// One line: "T12 is not in frame 37: not matched, its region is on P4, angle_deg 7.2 > 5.1".
std::string moment_text(const Tracker& tracker, const Track& track, int frame);

/// Track filter such as "length<5", "gap", "merged", "track==12 && frame==37": conditions joined by
/// &&, each a flag, a flag preceded by !, or a comparison of a number. docs/map.md lists the words.
class TrackFilter {
 public:
  TrackFilter() = default;
  /// Throws Error naming the invalid word.
  explicit TrackFilter(const std::string& text);
  bool matches(const Tracker& tracker, const Track& track) const;

 private:
  using Condition = std::function<bool(const Tracker&, const Track&)>;
  std::vector<Condition> conditions_;
};

// ---- Stability of a recording's planes over time ----

/// Difference of a plane between two successive frames while the camera is still.
struct StillPlane {
  double pixels = 0, angle_deg = 0, offset_m = 0;
};

/// Stability of a frame that has a pose and is not set aside. Breaks and swaps are counted in the
/// frame where they begin; still planes are seen in this and the previous frame.
struct FrameStability {
  int frame = 0;
  double pixels = 0, kept = 0;  // on planes; on planes whose track continues in the next frame
  bool is_last = false;         // there is no next frame
  int breaks = 0, swaps = 0;
  std::vector<StillPlane> still;

  double kept_share() const;         // NaN if there are no pixels on planes
  double normal_jitter_deg() const;  // NaN if there are no still planes
  double offset_jitter_m() const;
};
std::vector<FrameStability> stability_by_frame(const Tracker& tracker,
                                               std::span<const CameraPose> poses);

struct Stability {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  int frames = 0;             // with a pose, not set aside
  double kept_share = kNone;  // share of pixels on planes whose track continues in the next frame
  // Breaks: frames in which a track of the map is visible and was seen before, but is missing, per
  // 100 frames. Swaps: breaks in which another track took its region.
  double breaks = kNone, swaps = kNone;
  // Change of a track's planes between successive frames while the camera is still, per frame:
  // pixel-weighted median.
  int still_pairs = 0;
  double normal_jitter_deg = kNone, offset_jitter_m = kNone;
  // Tracks that return after kAway frames out of view: distance from their previous position (RMS).
  static constexpr int kAway = 10;
  int returns = 0;
  double drift_m = kNone;
};

Stability stability_of(const Tracker& tracker, std::span<const CameraPose> poses);

}  // namespace planescope::world
