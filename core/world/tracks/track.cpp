#include "core/world/tracks/track.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

namespace planescope::world {

// ---- Cells ----

namespace {

int floor_div(int a, int b) { return (a >= 0 ? a : a - b + 1) / b; }

std::int64_t key_of(int tile_x, int tile_y) {
  return (static_cast<std::int64_t>(tile_x) << 32) ^ static_cast<std::uint32_t>(tile_y);
}

}  // namespace

void Cell::look(bool is_through) {
  if (looked >= kHorizon) {
    looked /= 2;
    if (seen > 1) seen /= 2;
  }
  ++looked;
  through = is_through ? static_cast<std::uint8_t>(through + 1) : std::uint8_t{0};
  if (through >= kGone) *this = {.gone = gone || seen > 0};
}

void Cell::see() {
  if (seen < kHorizon) ++seen;
  if (looked < seen) looked = seen;
  through = 0;
  gone = false;
}

Cell& CellMap::at(int x, int y) {
  const int tile_x = floor_div(x, kSide), tile_y = floor_div(y, kSide);
  const auto [at, is_new] =
      index_.try_emplace(key_of(tile_x, tile_y), static_cast<std::uint32_t>(tiles_.size()));
  if (is_new) tiles_.push_back({tile_x, tile_y, {}});
  return tiles_[at->second].cells[(y - tile_y * kSide) * kSide + (x - tile_x * kSide)];
}

const Cell* CellMap::find(int x, int y) const {
  const int tile_x = floor_div(x, kSide), tile_y = floor_div(y, kSide);
  const auto at = index_.find(key_of(tile_x, tile_y));
  if (at == index_.end()) return nullptr;
  return &tiles_[at->second].cells[(y - tile_y * kSide) * kSide + (x - tile_x * kSide)];
}

std::vector<CellMap::Tile> CellMap::take_out(const std::function<bool(const Tile&)>& leaves) {
  std::vector<Tile> left, stay;
  for (Tile& tile : tiles_) (leaves(tile) ? left : stay).push_back(tile);
  if (left.empty()) return left;
  tiles_ = std::move(stay);
  index_.clear();
  for (std::size_t i = 0; i < tiles_.size(); ++i)
    index_[key_of(tiles_[i].x, tiles_[i].y)] = static_cast<std::uint32_t>(i);
  return left;
}

bool CellMap::is_near(int x, int y, int radius) const {
  for (int dy = -radius; dy <= radius; ++dy)
    for (int dx = -radius; dx <= radius; ++dx)
      if (const Cell* cell = find(x + dx, y + dy); cell && cell->present()) return true;
  return false;
}

std::size_t CellMap::present() const {
  std::size_t count = 0;
  for (const Tile& tile : tiles_)
    for (const Cell& cell : tile.cells) count += cell.present();
  return count;
}

template <typename Which>
std::vector<Vec2d> CellMap::places(const Which& which) const {
  std::vector<Vec2d> places;
  for (const Tile& tile : tiles_)
    for (int i = 0; i < kSide * kSide; ++i)
      if (which(tile.cells[i])) places.push_back(middle(tile, i));
  return places;
}

std::vector<Vec2d> CellMap::sure_places() const {
  return places([](const Cell& cell) { return cell.sure(); });
}
std::vector<Vec2d> CellMap::gone_places() const {
  return places([](const Cell& cell) { return cell.gone; });
}

// ---- Tracks ----

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

/// After a merge, drops gaps that overlap a sighting.
void drop_gaps_of_sightings(Track& track) {
  std::vector<Gap> gaps;
  track.frames_missed = 0;
  for (const Gap& gap : track.gaps) {
    const auto first = std::ranges::lower_bound(track.sightings, gap.first, {}, &Sighting::frame);
    const auto end = std::ranges::upper_bound(track.sightings, gap.last, {}, &Sighting::frame);
    if (first != end) continue;
    if (is_miss(gap.why)) track.frames_missed += gap.frames;
    gaps.push_back(gap);
  }
  track.gaps = std::move(gaps);
}

}  // namespace

const char* to_string(Absence absence) {
  constexpr const char* kNames[] = {"out of view",  "beyond range",   "occluded",
                                    "not measured", "seen through",   "not detected",
                                    "not matched",  "frame set aside"};
  return kNames[static_cast<int>(absence)];
}

const char* to_string(Term term) {
  constexpr const char* kNames[] = {"none", "angle_deg", "gap_m", "taken"};
  return kNames[static_cast<int>(term)];
}

const char* to_string(TrackState state) {
  constexpr const char* kNames[] = {"alive", "gone", "merged", "left"};
  return kNames[static_cast<int>(state)];
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

void Track::absorb(const Track& from) {
  for (const CellMap::Tile& tile : from.cells.tiles())
    for (int i = 0; i < CellMap::kSide * CellMap::kSide; ++i) {
      const Cell& cell = tile.cells[i];
      if (!cell.present()) continue;
      const Vec2d at = on_grid(from.on_plane(from.cells.middle(tile, i)));
      Cell& target = cells.at(cells.index_of(at.x()), cells.index_of(at.y()));
      if (cell.seen > target.seen) target = cell;
    }
  Pose shift = Pose::Identity();
  shift.translation() = from.anchor - anchor;
  moments += moved(from.moments, shift);
  refit();
  // (slope u, slope v, height at from's anchor) as functions of ours.
  const Vec2d at = on_grid(from.anchor);
  Mat3d j;
  j << from.basis.u.dot(basis.u), from.basis.u.dot(basis.v), 0, from.basis.v.dot(basis.u),
      from.basis.v.dot(basis.v), 0, at.x(), at.y(), 1;
  information += j.transpose() * from.information * j;

  // A frame in which both were seen counts once.
  std::vector<Sighting> both;
  std::ranges::merge(
      sightings, from.sightings, std::back_inserter(both), {},
      [](const Sighting& s) { return std::pair(s.frame, s.minor); },
      [](const Sighting& s) { return std::pair(s.frame, s.minor); });
  frames_seen = 0;
  for (std::size_t i = 0; i < both.size(); ++i) {
    both[i].part = i > 0 && both[i - 1].frame == both[i].frame;
    frames_seen += !both[i].part;
  }
  sightings = std::move(both);
  drop_gaps_of_sightings(*this);
  born = std::min(born, from.born);
  known = std::max(known, from.known);
  left_m2 += from.left_m2;
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
