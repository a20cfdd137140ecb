#include "core/world/tracks/track.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>

namespace planescope::world {
namespace {

// A measurement with it weighs 1: so much that a plane of few, noisy ones still counts as three.
constexpr double kUnitSigma_m = 0.1;
constexpr double kLeastSigma_m = 1e-4;  // exact depth is rounded to counts all the same
constexpr double kLeastTilt_rad = 1e-5;
// What all observations of a plane have in common does not average away: the camera's calibration.
constexpr double kCommonOffset_m = 1e-3;
constexpr double kCommonTilt_rad = 1e-3;

Mat3d covariance_of(const Mat3d& information) {
  return (information + 1e-6 * Mat3d::Identity()).inverse();
}

}  // namespace

const char* to_string(Absence absence) {
  switch (absence) {
    case Absence::out_of_view:
      return "out of view";
    case Absence::beyond_range:
      return "beyond range";
    case Absence::occluded:
      return "occluded";
    case Absence::not_measured:
      return "not measured";
    case Absence::seen_through:
      return "seen through";
    case Absence::not_detected:
      return "not detected";
    case Absence::not_matched:
      return "not matched";
    case Absence::set_aside:
      return "frame set aside";
  }
  return "";
}

const char* to_string(Term term) {
  switch (term) {
    case Term::none:
      return "none";
    case Term::angle_deg:
      return "angle_deg";
    case Term::gap_m:
      return "gap_m";
    case Term::taken:
      return "taken";
  }
  return "";
}

const char* to_string(TrackState state) {
  switch (state) {
    case TrackState::alive:
      return "alive";
    case TrackState::gone:
      return "gone";
    case TrackState::merged:
      return "merged";
    case TrackState::left:
      return "left";
  }
  return "";
}

double width_of(const PlaneFit& fit) {
  return std::sqrt(12 * std::max(0.0, fit.eigenvalues[1]) / std::max(1.0, fit.count));
}

Vec3d Track::on_plane(const Vec2d& place) const {
  const Vec3d p = anchor + place.x() * basis.u + place.y() * basis.v;
  const Vec3d along = basis.u.cross(basis.v);
  return p - along * (distance_m(p) / fit.normal.dot(along));
}

double Track::sigma_m(const Vec2d& place) const {
  const Vec3d g(place.x(), place.y(), 1);
  return std::sqrt(std::max(0.0, g.dot(covariance_of(information) * g)) + squared(kCommonOffset_m) +
                   squared(kCommonTilt_rad) * place.squaredNorm());
}

double Track::sigma_tilt_deg() const {
  const Mat3d covariance = covariance_of(information);
  const double a = covariance(0, 0), b = covariance(0, 1), c = covariance(1, 1);
  const double worse = (a + c) / 2 + std::hypot((a - c) / 2, b);
  return std::sqrt(std::max(0.0, worse) + squared(kCommonTilt_rad)) * 180 / std::numbers::pi;
}

void Track::refit() {
  fit = fit_plane(moments);
  if (fit.normal.dot(basis.u.cross(basis.v)) < 0) fit.normal = -fit.normal;
}

void Track::fuse(const ObservedPlane& plane, const Vec3d& camera) {
  const double sigma = std::max(kLeastSigma_m, plane.certainty.sigma_m);
  Pose shift = Pose::Identity();
  shift.translation() = camera - anchor;
  moments += scaled(moved(plane.moments, shift), squared(kUnitSigma_m / sigma));
  refit();

  // The observation tells the height at its centroid and the slopes along its axes.
  const Vec2d at = on_grid(plane.centroid);
  const auto add = [&](const Vec3d& row, double sigma_of_row) {
    information += row * row.transpose() / squared(sigma_of_row);
  };
  add({at.x(), at.y(), 1}, std::max(kLeastSigma_m, plane.certainty.sigma_offset_m));
  for (int i = 0; i < 2; ++i) {
    const Vec3d& axis = plane.certainty.axes[i];
    add({axis.dot(basis.u), axis.dot(basis.v), 0},
        std::max(kLeastTilt_rad, plane.certainty.sigma_tilt_rad[i]));
  }
}

double Track::sure_area_m2() const {
  return static_cast<double>(cells.sure_places().size()) * squared(cells.cell_m());
}

int Track::frames_undecided() const {
  return static_cast<int>(std::ranges::count_if(
      sightings, [](const Sighting& sighting) { return sighting.undecided && !sighting.part; }));
}

std::vector<Vec2d> Track::places() const {
  return state == TrackState::gone ? cells.gone_places() : cells.sure_places();
}

bool Track::is_sure(const TrackOptions& options) const {
  return state != TrackState::merged && frames_seen >= options.confirm_frames &&
         frames_seen >= options.confirm_share * (frames_seen + frames_missed) &&
         (state == TrackState::gone || sure_area_m2() + left_m2 >= options.least_area_m2);
}

namespace {

planes::Outline outline_of_places(const Track& track, std::span<const Vec2d> on_grid) {
  std::vector<Vec2d> places;
  const PlaneBasis basis = plane_basis(track.fit.normal);
  const Vec3d origin = track.centroid();
  for (const Vec2d& place : on_grid) {
    const Vec3d d = track.on_plane(place) - origin;
    places.emplace_back(basis.u.dot(d), basis.v.dot(d));
  }
  return planes::outline_of_points(origin, basis, places, track.cells.cell_m());
}

}  // namespace

planes::Outline outline_of(const Track& track) { return outline_of_places(track, track.places()); }

planes::Outline outline_of(const Track& track, std::span<const CellMap::Tile> tiles) {
  std::vector<Vec2d> places;
  for (const CellMap::Tile& tile : tiles)
    for (int i = 0; i < CellMap::kSide * CellMap::kSide; ++i)
      if (tile.cells[i].sure()) places.push_back(track.cells.middle(tile, i));
  return outline_of_places(track, places);
}

}  // namespace planescope::world
