#pragma once

// The planes of one frame in world coordinates; and tracks, which are planes of the world with a
// grid of observed cells and the frames in which they were seen.

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/plane.hpp"
#include "core/planes/foot/footholds.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::world {

inline double squared(double x) { return x * x; }

struct ObservedPlane {
  int id = 0;          // in its frame, from 1
  int known = 0;       // the track it was predicted from (expected_planes()), 0: none
  bool minor = false;  // below the listing threshold
  Label label = Label::unknown;
  // World frame [m]:
  Vec3d normal = Vec3d::UnitZ();  // unit; upward for h, else toward the camera
  Vec3d centroid = Vec3d::Zero();
  Moments moments;              // of the fitted points, relative to the camera
  planes::Certainty certainty;  // axes in the world frame
  planes::Outline outline;      // world frame
  std::uint32_t pixels = 0;     // number of measurements on it
  double rms_m = 0;             // of its voxels
  double margin = 0;            // from PlaneRegion
  bool undecided = false;       // from PlaneRegion

  double distance_m(const Vec3d& p) const { return normal.dot(p - centroid); }
};

struct ObservedFrame {
  int frame = 0;
  double timestamp_s = 0;
  int segment = 0;
  Pose T_world_camera = Pose::Identity();
  std::optional<Vec3d> gravity;  // unit, camera frame, as used to find the planes
  Intrinsics intrinsics;
  Image16 depth;  // counts
  double depth_unit_m = 0;
  double max_range_m = 0;  // depths beyond it were ignored; 0: none
  planes::NoiseModel noise;
  Image16 plane_of;                         // per pixel: id, 0 none
  std::vector<planes::KnownCover> covered;  // tracks represented by planes of larger tracks
  std::vector<ObservedPlane> planes;        // by id - 1, minor planes last

  Vec3d camera() const { return T_world_camera.translation(); }
};

/// Observes a depth image, processed with the gravity of its pose so that `result` is upright.
ObservedFrame observe(const Frame& frame,
                      planes::FrameResult result,
                      const planes::PipelineOptions& options,
                      const Pose& T_world_camera,
                      int segment);

/// Sets the fields that are derived from the frame, its pose and the options.
void set_frame_fields(ObservedFrame& seen,
                      const Frame& frame,
                      const planes::PipelineOptions& options,
                      const Pose& T_world_camera,
                      int segment);

/// Moments of points with this fit, relative to `origin`; `axes`: unit, in the plane, longer
/// extent first.
Moments moments_of(const PlaneFit& fit, const Vec3d axes[2], const Vec3d& origin);
/// Transforms the points of the moments: X becomes T X.
Moments moved(const Moments& moments, const Pose& T);
Moments shifted(const Moments& moments, const Vec3d& by);
/// Distance of the narrower of two point sets from the plane of the other [m].
struct Apart {
  double middle_m = 0;  // signed, along the other's normal
  double rim_m = 0;     // at its rim: the distance of its middle plus the effect of its tilt
};
Apart apart(const Moments& a, const Moments& b);
/// As if each measurement had been made `weight` times.
Moments scaled(const Moments& moments, double weight);

// ---- Tracks ----

/// History of a cell, over its last kHorizon observations.
struct Cell {
  std::uint8_t seen = 0;     // it was part of the plane
  std::uint8_t looked = 0;   // it was measured and unoccluded
  std::uint8_t through = 0;  // consecutive last observations that passed through it
  bool gone = false;         // enough of them to conclude that the surface is gone

  static constexpr int kHorizon = 64;
  static constexpr int kGone = 5;       // observations through it until it is gone
  static constexpr int kLeastSeen = 2;  // at edges, occasional outlines include too much
  static constexpr double kLeastShare = 0.3;

  void look(bool is_through);
  void see();
  /// Part of the plane, as far as known.
  bool present() const { return seen > 0; }
  /// Seen often enough, relative to the number of observations.
  bool sure() const { return seen >= kLeastSeen && seen >= kLeastShare * looked; }
};

/// Cells of a plane by position, in tiles; x and y count cells from the plane's origin.
class CellMap {
 public:
  static constexpr int kSide = 16;  // cells per tile side

  struct Tile {
    int x = 0, y = 0;  // [tiles]
    std::array<Cell, kSide * kSide> cells;
  };

  explicit CellMap(double cell_m) : cell_m_(cell_m) {}

  double cell_m() const { return cell_m_; }
  Vec2d middle(const Tile& tile, int i) const {
    return cell_m_ * Vec2d(tile.x * kSide + i % kSide + 0.5, tile.y * kSide + i / kSide + 0.5);
  }
  std::vector<Tile>& tiles() { return tiles_; }  // in order of first appearance
  const std::vector<Tile>& tiles() const { return tiles_; }

  /// Removes and returns the tiles for which `leaves` holds, in order.
  std::vector<Tile> extract_tiles(const std::function<bool(const Tile&)>& leaves);
  static constexpr double kTileRadius = 0.7072 * kSide;  // [cells], around a tile's middle
  Vec2d middle(const Tile& tile) const {
    return cell_m_ * kSide * Vec2d(tile.x + 0.5, tile.y + 0.5);
  }

  Cell& at(int x, int y);                // created if missing
  const Cell* find(int x, int y) const;  // null if missing
  int index_of(double meters) const { return whole(std::floor(meters / cell_m_)); }

  /// Calls visit(x, y) for the cells whose middles are inside the rings (even-odd rule).
  template <typename Visit>
  void fill(std::span<const planes::PolygonRing> rings, const Visit& visit) const;
  /// Whether a present cell is within `radius` cells of this one.
  bool is_near(int x, int y, int radius) const;

  std::size_t present() const;
  /// Middles of the cells that are sure, and of those that are gone; in order.
  std::vector<Vec2d> sure_places() const;
  std::vector<Vec2d> gone_places() const;

 private:
  /// A number of cells as an int, clamped far beyond any plane.
  static int whole(double cells) {
    constexpr double kMost = 1 << 30;
    return static_cast<int>(cells > -kMost ? std::min(cells, kMost) : -kMost);
  }
  template <typename Which>
  std::vector<Vec2d> places(const Which& which) const;

  double cell_m_;
  std::vector<Tile> tiles_;
  std::unordered_map<std::int64_t, std::uint32_t> index_;
};

// ---- Template implementation ----

template <typename Visit>
void CellMap::fill(std::span<const planes::PolygonRing> rings, const Visit& visit) const {
  struct Crossing {
    int y;
    double x;
    auto operator<=>(const Crossing&) const = default;
  };
  std::vector<Crossing> crossings;
  for (const planes::PolygonRing& ring : rings)
    for (std::size_t i = 0; i < ring.size(); ++i) {
      const Vec2d a = ring[i] / cell_m_, b = ring[(i + 1) % ring.size()] / cell_m_;
      const int first = whole(std::ceil(std::min(a.y(), b.y()) - 0.5));
      const int end = whole(std::ceil(std::max(a.y(), b.y()) - 0.5));
      for (int y = first; y < end; ++y)
        crossings.push_back({y, a.x() + (b.x() - a.x()) * (y + 0.5 - a.y()) / (b.y() - a.y())});
    }
  std::sort(crossings.begin(), crossings.end());
  for (std::size_t i = 0; i + 1 < crossings.size(); i += 2) {
    const int end = whole(std::ceil(crossings[i + 1].x - 0.5));
    for (int x = whole(std::ceil(crossings[i].x - 0.5)); x < end; ++x) visit(x, crossings[i].y);
  }
}

struct TrackOptions {
  double cell_m = 0.02;  // of the grids on planes
  // Two planes match if the gap between them is at most max_offset_m plus `sigmas` times both
  // uncertainties.
  double max_offset_m = 0.015;
  double sigmas = 3;
  double least_overlap = 0.1;  // share of the smaller plane
  double join_gap_m = 0.06;    // without overlap: largest gap between the outlines
  int least_cells = 25;  // smallest number of visible cells for which a track counts as missed
  // Tracks in the map:
  int confirm_frames = 3;
  double confirm_share = 0.25;  // of the frames in which it was visible
  double least_area_m2 = 0.01;
  // A frame is set aside if its depth agrees less than this with the known planes. A new segment
  // begins after `most_aside` such frames in a row, or after as many as the segment has others.
  double least_agreement = 0.35;
  int most_aside = 10;
  // The map keeps a cube around the camera with this edge, and forgets the rest; 0: everything.
  double window_m = 0;
};

/// Reason why a track is missing in a frame.
enum class Absence : std::uint8_t {
  out_of_view,
  beyond_range,
  occluded,
  not_measured,
  seen_through,
  not_detected,  // its region is on no plane
  not_matched,   // its region is on a plane that does not match
  set_aside,     // the whole frame does not fit the map
};
const char* to_string(Absence absence);
/// Whether the track was visible.
inline bool is_miss(Absence absence) { return absence >= Absence::seen_through; }

/// Width of a plane across its shorter side [m], exact for filled rectangles.
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
  // Distance of the observation from the previous track, where they overlap; NaN: no overlap.
  float offset_m = std::numeric_limits<float>::quiet_NaN();
  float angle_deg = 0;                                     // between their normals
  Vec3f normal = Vec3f::Zero(), centroid = Vec3f::Zero();  // observed, world frame
  bool founding = false;  // founding sighting of this track, or of a track merged into it
  bool minor = false;     // from a minor plane
  bool part = false;      // another plane of the frame already represents the track
  bool undecided = false;
};

/// Consecutive frames in which the track is missing for the same reason.
struct Gap {
  int first = 0, last = 0;
  int frames = 1;
  Absence why = Absence::out_of_view;
  int plane = 0;         // in frame `first`: the plane on which its region is; 0 none
  TermResult term = {};  // in frame `first`
};

/// `left`: entirely outside the window.
enum class TrackState : std::uint8_t { alive, gone, merged, left };
const char* to_string(TrackState state);

struct Track {
  int id = 0;  // from 1, in order of creation
  int segment = 0;
  Label label = Label::unknown;
  TrackState state = TrackState::alive;
  int known = 0;               // the same track in an earlier pass; 0: none
  std::map<int, int> covered;  // number of frames in which a larger track's plane represented it,
                               // by that track's id
  int born = 0;                // frame
  int ended = -1;              // frame; -1: not ended
  int merged_into = 0;

  // Frame of the grid, fixed at creation: anchor + x u + y v.
  Vec3d anchor = Vec3d::Zero();
  PlaneBasis basis;
  Moments moments;  // relative to the anchor; each measurement weighs 1 / sigma^2
  PlaneFit fit;     // of the moments, relative to the anchor; the normal is on the seen side
  Mat3d information = Mat3d::Zero();  // of the slopes along u and v, and the height at the anchor
  CellMap cells;

  std::vector<Sighting> sightings;  // by frame; within a frame, minor ones last
  std::vector<Gap> gaps;
  int frames_seen = 0, frames_missed = 0;
  double left_m2 = 0;  // area of sure cells outside the window

  explicit Track(double cell_m) : cells(cell_m) {}

  Vec3d centroid() const { return anchor + fit.centroid; }
  double distance_m(const Vec3d& p) const { return fit.normal.dot(p - centroid()); }
  Vec2d on_grid(const Vec3d& p) const {
    const Vec3d d = p - anchor;
    return {basis.u.dot(d), basis.v.dot(d)};
  }
  /// The point on the plane above a grid position, along the grid's normal.
  Vec3d on_plane(const Vec2d& place) const;
  /// Standard deviation of the plane's height at a grid position [m].
  double sigma_m(const Vec2d& place) const;
  double width_m() const { return width_of(fit); }
  /// Standard deviation of the normal in its worse direction.
  double sigma_tilt_deg() const;
  void refit();  // refits to the moments, with the normal on the seen side
  void fuse(const ObservedPlane& plane, const Vec3d& camera);
  /// Merges the data of another track that turned out to be the same plane.
  void absorb(const Track& from);
  /// Whether the track is in the map.
  bool is_sure(const TrackOptions& options) const;
  double sure_area_m2() const;
  /// The number of frames_seen in which its plane was undecided.
  int frames_undecided() const;
  /// Grid positions that it covers or, if gone, covered.
  std::vector<Vec2d> places() const;
};

/// Outline of the track, in the world frame.
planes::Outline outline_of(const Track& track);
/// Outline of tiles that were removed from it.
planes::Outline outline_of(const Track& track, std::span<const CellMap::Tile> tiles);

}  // namespace planescope::world
