#pragma once

// Matches the planes of frames to tracks and fuses them: what a frame shows at the tracks' places,
// its pose aligned with them, where they are expected in it, which of its pixels measure them. And
// the history of tracks: what one was in a frame, which ones a filter selects, how steady they are.

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

/// A track's cells in a frame, by what the frame measures there. A cell in view is in one of the
/// four that follow.
struct Sight {
  int cells = 0;         // of the track
  int in_view = 0;       // within the image and the range
  int beyond_range = 0;  // within the image
  int hidden = 0;        // something stands before it
  int unmeasured = 0;
  int through = 0;  // something is measured behind it
  int there = 0;    // the measurement is on the plane

  struct On {
    int cells = 0;
    int hides = 0;              // cells that the plane stands before
    Vec3d sum = Vec3d::Zero();  // of their places in the world
  };
  struct Look {
    Cell* cell = nullptr;
    bool through = false;
  };
  std::vector<Look> looks;  // at cells in view that are measured and not hidden

  Moments places;  // of the cells that are there, about the camera

  std::vector<On> on;  // by plane id of the frame, 0 none: what is measured at the cells

  int visible() const { return through + there; }
  /// The plane on which most of it lies; 0: none.
  int most_on() const;
};

/// Looks at every present cell. Valid until the track gets cells. `there`: takes the pixels
/// v * width + u that measure it, one for each cell; may be null.
Sight sight_of(Track& track,
               const ObservedFrame& frame,
               const TrackOptions& options,
               std::vector<std::uint32_t>* there = nullptr);

/// The cells remember it; those that were seen through too often are gone.
void remember(const Sight& sight);

// ---- Alignment ----
// Aligns a frame with the tracks before matching. Poses err by a centimeter and half a degree, more
// in fast turns; uncorrected, planes match the wrong track.

/// T_world_camera of the frame, moved so that its depth fits the tracks (point to plane, the given
/// pose with its uncertainty as a prior). As given where the depth fits within its noise.
Pose aligned_pose(const ObservedFrame& frame, std::span<Track* const> tracks);

/// The same observation at another pose.
void move_to(ObservedFrame& frame, const Pose& T_world_camera);

// ---- Expected planes ----

/// The tracks as candidates for the planes of a frame at this pose; `KnownPlane::id` is the
/// track's. Of each, the measured pixels whose rays hit cells that are sure or gone.
std::vector<planes::KnownPlane> expected_planes(std::span<const Track* const> tracks,
                                                const Frame& frame,
                                                const Pose& T_world_camera,
                                                const TrackOptions& options,
                                                int threads = 1);

// ---- Labels from the map ----

struct PixelsOfTrack {
  labels::PixelSet sure;
  labels::PixelSet doubtful;  // at its place, and farther off than noise alone puts them, or at
                              // another angle
};

/// Of a depth image at this pose in the track's world.
PixelsOfTrack pixels_of_track(const Track& track,
                              const labels::LabelGrid& grid,
                              const Pose& T_world_camera);

// ---- Matching ----

/// What became of a frame.
struct FrameOfTracks {
  int frame = 0;
  double timestamp_s = 0;
  int segment = 0;
  Pose T_world_camera = Pose::Identity();  // as aligned
  std::optional<Vec3d> gravity;            // as ObservedFrame has it
  bool has_pose = true;
  bool set_aside = false;  // its depth does not fit what is known
  double agreement = 1;    // share of what was in sight that was where it should be
  int compared_cells = 0;
  std::vector<int> track_of;  // by plane id - 1; 0: none
  std::vector<int> covered;   // tracks that planes of larger ones stand for
  int listed = 0;             // planes; minor ones follow them

  bool is_in_map() const { return has_pose && !set_aside; }
};

/// A piece of a track that is beyond the window now.
struct LeftPiece {
  int track = 0, frame = 0;
  planes::Outline outline;  // of what was sure, in the world
};

/// Tracks of one camera's frames, taken in one after the other. Deterministic.
class Tracker {
 public:
  /// `known`: the frames' planes were expected of so many tracks of another tracker, of an earlier
  /// pass over the recording; 0: of this one's.
  explicit Tracker(TrackOptions options = {}, std::size_t known = 0)
      : options_(options), own_of_known_(known, 0) {}

  /// Aligns the frame with the tracks, unless its planes were expected of an earlier pass. Frames
  /// of a segment come together, in the order of time.
  const FrameOfTracks& add(ObservedFrame& frame);
  const FrameOfTracks& add(ObservedFrame&& frame) { return add(frame); }
  /// A frame without a pose, or one that failed.
  const FrameOfTracks& skip(int frame, double timestamp_s);

  /// Merges all tracks that turned out to be one, now that all frames are in.
  void consolidate();

  /// Called once for each piece that leaves the window.
  void on_left(std::function<void(const LeftPiece&)> take) { take_left_ = std::move(take); }

  const TrackOptions& options() const { return options_; }
  const std::deque<Track>& tracks() const { return tracks_; }  // by id - 1
  /// The map's segment for a segment of the poses.
  int segment_of(int pose_segment) const { return pose_segment + begun_; }
  const std::vector<FrameOfTracks>& frames() const { return frames_; }

 private:
  struct Judged;
  std::vector<Track*> alive();
  /// Of the plane and what the frame shows of the track, or all that is known of it.
  Apart apart_from(const ObservedFrame& frame,
                   const Judged& judged,
                   const ObservedPlane& plane) const;
  TermResult compare(const ObservedFrame& frame,
                     const Judged& judged,
                     const ObservedPlane& plane) const;
  /// How well the frame's depth fits the tracks.
  void judge_agreement(std::span<const Judged> judged, FrameOfTracks& told) const;
  /// Gives planes that were expected of a track to it.
  void take_expected(const ObservedFrame& frame, std::vector<Judged>& judged, FrameOfTracks& told);
  /// Gives other planes, all minor or none, to tracks. Minor ones found none, and nothing joins by
  /// them.
  void assign(const ObservedFrame& frame,
              std::span<const ObservedPlane> planes,
              std::vector<Judged>& judged,
              FrameOfTracks& told);
  void take(const Judged& judged, const ObservedFrame& frame, const ObservedPlane& plane);
  void found(const ObservedFrame& frame, const ObservedPlane& plane, FrameOfTracks& told);
  bool touch(const Track& track, const ObservedPlane& plane) const;
  void note_absence(const ObservedFrame& frame, Judged& judged, const FrameOfTracks& told);
  /// Merges tracks that turned out to be one, the first of each pair one that has grown. Whether
  /// there were any.
  bool merge_equal(int frame, const std::function<bool(const Track&)>& has_grown);
  /// Merges tracks into larger ones that explain them more often than not.
  void merge_covered(int frame);
  void merge(Track& from, Track& into, int frame);
  void end_those_gone(int frame);
  void leave_window(const ObservedFrame& frame);

  TrackOptions options_;
  std::vector<int> own_of_known_;  // by id - 1; 0: not seen yet
  std::deque<Track> tracks_;
  std::vector<FrameOfTracks> frames_;
  int segment_ = 0;  // of the last frame, with those that were begun here
  int begun_ = 0;    // segments that began because frames did not fit
  int taken_ = 0;    // frames of this segment
  int aside_ = 0;    // frames in a row
  std::function<void(const LeftPiece&)> take_left_;
};

/// The track that a merged one has become.
int final_track(const std::deque<Track>& tracks, int id);

// ---- History ----

struct Moment {
  enum class Kind : std::uint8_t {
    unborn,
    seen,
    absent,
    ended,
    unknown  // a frame without a pose, or one that nobody asked about
  };
  Kind kind = Kind::unknown;
  const Sighting* sighting = nullptr;  // where it is seen
  const Gap* gap = nullptr;            // where it is absent

  /// No plane of the frame is listed for it, though it is in sight.
  bool is_unlisted() const { return gap ? world::is_miss(gap->why) : sighting && sighting->minor; }
};
Moment moment_of(const Track& track, int frame);

/// "T12 is not in frame 37: not matched, its place is on P4, angle_deg 7.2 > 5.1". One line.
std::string moment_text(const Tracker& tracker, const Track& track, int frame);

/// "length<5", "gap", "merged", "track==12 && frame==37": conditions joined by &&, each a flag, a
/// flag with ! before it, or a number compared with a value. docs/map.md lists the words.
class TrackFilter {
 public:
  TrackFilter() = default;
  /// Throws Error that names the word it stumbles over.
  explicit TrackFilter(const std::string& text);
  bool matches(const Tracker& tracker, const Track& track) const;

 private:
  using Condition = std::function<bool(const Tracker&, const Track&)>;
  std::vector<Condition> conditions_;
};

// ---- How steady the planes of a recording are over time ----

/// A plane that is seen in two frames in a row while the camera stands still: how it differs.
struct StillPlane {
  double pixels = 0, angle_deg = 0, offset_m = 0;
};

/// Of one frame that has a pose and was not set aside. Breaks and swaps begin in it; still planes
/// are seen in it and in the frame before.
struct FrameStability {
  int frame = 0;
  double pixels = 0, kept = 0;  // on planes; of these, of tracks that are in the next frame too
  bool is_last = false;         // there is no next frame
  int breaks = 0, swaps = 0;
  std::vector<StillPlane> still;

  double kept_share() const;         // NaN where nothing could be kept
  double normal_jitter_deg() const;  // NaN where there is no still plane
  double offset_jitter_m() const;
};
std::vector<FrameStability> stability_by_frame(const Tracker& tracker,
                                               std::span<const CameraPose> poses);

struct Stability {
  static constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

  int frames = 0;             // with a pose, not set aside
  double kept_share = kNone;  // of the pixels on planes: their track is in the next frame too
  // Of tracks that the map holds, a frame in which one is in sight but missing, and was there
  // before, per 100 frames; of these, swaps: its place was taken for another track's.
  double breaks = kNone, swaps = kNone;
  // Over still stretches, of a track's planes from frame to frame, each frame's share: the median
  // by pixels.
  int still_pairs = 0;
  double normal_jitter_deg = kNone, offset_jitter_m = kNone;
  // Tracks that come back after kAway frames out of sight: how far from where they were (RMS).
  static constexpr int kAway = 10;
  int returns = 0;
  double drift_m = kNone;
};

Stability stability_of(const Tracker& tracker, std::span<const CameraPose> poses);

}  // namespace planescope::world
