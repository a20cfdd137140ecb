#pragma once

// The planes of one frame in world coordinates; and a plane of the world: a grid on it of what has
// been seen, and the frames it was seen in.

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
  int known = 0;       // the track it was predicted from (expected.hpp), 0: none
  bool minor = false;  // below the listing threshold
  Label label = Label::unknown;
  // World [m]:
  Vec3d normal = Vec3d::UnitZ();  // unit; of an h upwards, else to the camera's side
  Vec3d centroid = Vec3d::Zero();
  Moments moments;              // of the points it was fitted to, about the camera
  planes::Certainty certainty;  // axes in the world
  planes::Outline outline;      // in the world
  std::uint32_t pixels = 0;     // measurements on it
  double rms_m = 0;             // of its voxels
  double margin = 0;            // as PlaneRegion has it
  bool undecided = false;       // as PlaneRegion has it

  double distance_m(const Vec3d& p) const { return normal.dot(p - centroid); }
};

struct ObservedFrame {
  int frame = 0;
  double timestamp_s = 0;
  int segment = 0;
  Pose T_world_camera = Pose::Identity();
  std::optional<Vec3d> gravity;  // unit, in the camera, that its planes were found with
  Intrinsics intrinsics;
  Image16 depth;  // counts
  double depth_unit_m = 0;
  double max_range_m = 0;  // depths beyond it were left out; 0: none
  planes::NoiseModel noise;
  Image16 plane_of;                         // per pixel: id, 0 none
  std::vector<planes::KnownCover> covered;  // tracks that the planes of larger ones stand for
  std::vector<ObservedPlane> planes;        // by id - 1, the minor ones last

  Vec3d camera() const { return T_world_camera.translation(); }
};

/// Of a depth image, run with the gravity of its pose, so that `result` is upright as the world is.
ObservedFrame observe(const Frame& frame,
                      planes::FrameResult result,
                      const planes::PipelineOptions& options,
                      const Pose& T_world_camera,
                      int segment);

/// Sets what follows from the frame, its pose and the options.
void take_frame(ObservedFrame& seen,
                const Frame& frame,
                const planes::PipelineOptions& options,
                const Pose& T_world_camera,
                int segment);

/// Of points with this fit, about `origin`; `axes`: unit, in the plane, the longer extent first.
Moments moments_of(const PlaneFit& fit, const Vec3d axes[2], const Vec3d& origin);
/// The same points seen from elsewhere: of X, those of T X.
Moments moved(const Moments& moments, const Pose& T);
Moments shifted(const Moments& moments, const Vec3d& by);
/// How far the narrower of two sets of points is from the plane of the other [m].
struct Apart {
  double middle_m = 0;  // signed, along the other's normal
  double rim_m = 0;     // at its rim: of its middle, and what its tilt adds to it
};
Apart apart(const Moments& a, const Moments& b);
/// As if so many measurements of each had been made.
Moments scaled(const Moments& moments, double weight);

// ---- Tracks ----

/// A cell's history, over the last kHorizon looks at it.
struct Cell {
  std::uint8_t seen = 0;     // it was part of the plane
  std::uint8_t looked = 0;   // something was measured there, and nothing stood before it
  std::uint8_t through = 0;  // the last looks went through it, without a break
  bool gone = false;         // so many did that it is not there any more

  static constexpr int kHorizon = 64;
  static constexpr int kGone = 5;       // looks through: it is not there any more
  static constexpr int kLeastSeen = 2;  // of an edge, one outline in many takes too much
  static constexpr double kLeastShare = 0.3;

  void look(bool is_through);
  void see();
  /// Part of the plane as far as anybody knows.
  bool present() const { return seen > 0; }
  /// Seen often enough, for as often as it was looked at.
  bool sure() const { return seen >= kLeastSeen && seen >= kLeastShare * looked; }
};

/// Cells of a plane by their place in it, in tiles; x and y count cells from the plane's origin.
class CellMap {
 public:
  static constexpr int kSide = 16;  // cells along a tile

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

  /// Takes out the tiles for which `leaves` holds, in their order.
  std::vector<Tile> take_out(const std::function<bool(const Tile&)>& leaves);
  static constexpr double kTileRadius = 0.7072 * kSide;  // [cells], about a tile's middle
  Vec2d middle(const Tile& tile) const {
    return cell_m_ * kSide * Vec2d(tile.x + 0.5, tile.y + 0.5);
  }

  Cell& at(int x, int y);                // made where it is missing
  const Cell* find(int x, int y) const;  // null where it is missing
  int index_of(double metres) const { return whole(std::floor(metres / cell_m_)); }

  /// Calls visit(x, y) for the cells whose middles are inside rings, by the rule of even and odd.
  template <typename Visit>
  void fill(std::span<const planes::PolygonRing> rings, const Visit& visit) const;
  /// Whether a present cell is within `radius` cells of this one.
  bool is_near(int x, int y, int radius) const;

  std::size_t present() const;
  /// Middles of the cells that are sure, and of those that are gone; in order.
  std::vector<Vec2d> sure_places() const;
  std::vector<Vec2d> gone_places() const;

 private:
  /// A count of cells as an int; what no plane reaches ends at the border.
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

// ---- Of the template ----

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
  /// Takes over what another track knows, which turned out to be the same plane.
  void absorb(const Track& from);
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
