#pragma once

// A plane of the world, and when it was seen.

#include <cstdint>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/plane.hpp"
#include "core/world/tracks/cells.hpp"
#include "core/world/tracks/observation.hpp"

namespace planescope::world {

struct TrackOptions {
  double cell_m = 0.02;  // of the grids on planes
  // Two planes match if the gap between them is at most this plus so many sigmas of both:
  double max_offset_m = 0.015;
  double sigmas = 3;
  double least_overlap = 0.1;  // share of the smaller of both; nothing in common but an edge is
                               // enough where the gap is no wider than
  double join_gap_m = 0.06;
  int least_cells = 25;  // of a track must be in sight before it is said to be missed
  // What the map holds:
  int confirm_frames = 3;
  double confirm_share = 0.25;  // of the frames in which it was in sight
  double least_area_m2 = 0.01;
  // A frame whose depth fits less of what is known is set aside; so many in a row, or as many as
  // the segment has others, and a new segment begins:
  double least_agreement = 0.35;
  int most_aside = 10;
  // The map is held in a cube about the camera with this edge, and forgotten beyond; 0: everywhere.
  double window_m = 0;
};

/// Why a track is not in a frame.
enum class Absence : std::uint8_t {
  out_of_view,
  beyond_range,
  occluded,
  not_measured,
  seen_through,
  not_detected,  // its place is on no plane
  not_matched,   // its place is on a plane that is not taken for it
  set_aside,     // the frame as a whole does not fit the map
};
const char* to_string(Absence absence);
/// It was in sight.
inline bool is_miss(Absence absence) { return absence >= Absence::seen_through; }

/// Across a plane's shorter side [m]: of a full rectangle, as wide as it is.
double width_of(const PlaneFit& fit);

/// A test of whether two planes are the same: `value op threshold`.
enum class Term : std::uint8_t { none, angle_deg, gap_m, taken };
const char* to_string(Term term);
struct TermResult {
  Term failed = Term::none;
  double value = 0, threshold = 0;
};

struct Sighting {
  int frame = 0;
  int plane = 0;  // id in the frame
  float pixels = 0;
  // Of the observation from the track before, where they overlap; NaN: nowhere.
  float offset_m = std::numeric_limits<float>::quiet_NaN();
  float angle_deg = 0;                                     // between their normals
  Vec3f normal = Vec3f::Zero(), centroid = Vec3f::Zero();  // observed, world
  bool founding = false;  // of a track, of this one or of one that was merged into it
  bool minor = false;     // by a plane that is too poor to be listed
  bool part = false;      // another plane of the frame stands for the track, this one too
  bool undecided = false;
};

/// Frames first to last in a row in which the track is missing for one reason.
struct Gap {
  int first = 0, last = 0;
  int frames = 1;
  Absence why = Absence::out_of_view;
  int plane = 0;         // of frame `first`, on which its place lies; 0 none
  TermResult term = {};  // in frame `first`
};

/// `left`: all of it is beyond the window.
enum class TrackState : std::uint8_t { alive, gone, merged, left };
const char* to_string(TrackState state);

struct Track {
  int id = 0;  // from 1, in order of birth
  int segment = 0;
  Label label = Label::unknown;
  TrackState state = TrackState::alive;
  int known = 0;  // the track of an earlier pass that it is; 0: none
  std::map<int, int>
      covered;     // frames in which the plane of a larger track stood for it, by its id
  int born = 0;    // frame
  int ended = -1;  // frame; -1: not
  int merged_into = 0;

  // The grid's frame, which stays as it was at birth: anchor + x u + y v.
  Vec3d anchor = Vec3d::Zero();
  PlaneBasis basis;
  Moments moments;  // about the anchor; each measurement weighs 1 / sigma^2
  PlaneFit fit;     // of the moments, about the anchor; the normal on the seen side
  Mat3d information =
      Mat3d::Zero();  // of the slopes along u and v, and of the height at the anchor
  CellMap cells;

  std::vector<Sighting> sightings;  // by frame, in it minor ones last
  std::vector<Gap> gaps;
  int frames_seen = 0, frames_missed = 0;
  double left_m2 = 0;  // of what was sure, the area that is beyond the window

  explicit Track(double cell_m) : cells(cell_m) {}

  Vec3d centroid() const { return anchor + fit.centroid; }
  double distance_m(const Vec3d& p) const { return fit.normal.dot(p - centroid()); }
  Vec2d on_grid(const Vec3d& p) const {
    const Vec3d d = p - anchor;
    return {basis.u.dot(d), basis.v.dot(d)};
  }
  /// The point of the plane above a place of the grid, along the grid's normal.
  Vec3d on_plane(const Vec2d& place) const;
  /// Of the plane's height at a place of the grid [m].
  double sigma_m(const Vec2d& place) const;
  double width_m() const { return width_of(fit); }
  /// Of the normal, its worse direction.
  double sigma_tilt_deg() const;
  void refit();  // to the moments, the normal on the side that was seen
  void fuse(const ObservedPlane& plane, const Vec3d& camera);
  /// Whether the map holds it.
  bool is_sure(const TrackOptions& options) const;
  double sure_area_m2() const;
  /// Of frames_seen, those in which its plane was undecided.
  int frames_undecided() const;
  /// Places of the grid that it covers, or, where it is gone, covered.
  std::vector<Vec2d> places() const;
};

/// What the track covers, in the world.
planes::Outline outline_of(const Track& track);
/// The same of cells that were taken out of it.
planes::Outline outline_of(const Track& track, std::span<const CellMap::Tile> tiles);

}  // namespace planescope::world
