// Observes a frame's planes, and accumulates them in tracks.

#include "core/world/tracks/track.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <numbers>
#include <utility>

#include "core/model/plane.hpp"

namespace planescope::world {

// ---- Observations ----

namespace {

constexpr int kLeastPixels = 100;        // for a fit along the rays
constexpr double kLeastIncidence = 0.1;  // cosine: below it, a ray is almost parallel to the plane

Mat3d second_moments(const Moments& m) {
  Mat3d s;
  s << m.xx, m.xy, m.xz, m.xy, m.yy, m.yz, m.xz, m.yz, m.zz;
  return s;
}

/// Rotates the plane to the fit along the rays, about its center. A fit to 3D points mistakes part
/// of the stereo error for extent and tilts: a riser 15 cm high by one degree at 1.5 m.
void fit_along_rays(ObservedPlane& plane, const InverseSums& rays, const Pose& T_world_camera) {
  if (rays.count < kLeastPixels) return;
  const Vec3d g = T_world_camera.linear() * rays.fit().w_of_ray, normal = g.normalized();
  const Vec3d camera = T_world_camera.translation(), ray = plane.centroid - camera;
  if (!(std::abs(normal.dot(ray)) > kLeastIncidence * ray.norm())) return;
  plane.normal = normal.dot(plane.normal) < 0 ? Vec3d(-normal) : normal;
  plane.centroid = camera + ray / g.dot(ray);
  for (Vec3d& axis : plane.certainty.axes)
    axis = (axis - axis.dot(plane.normal) * plane.normal).normalized();
}

/// Appends the minor planes to the regular ones; they get the points not assigned to others.
void list_minor(planes::FrameResult& result) {
  planes::Segmentation& all = result.segmentation;
  for (std::size_t k = 0; k < all.minor.size(); ++k) {
    planes::PlaneRegion& plane = all.planes.emplace_back(all.minor[k]);
    plane.id = static_cast<int>(all.planes.size());
    for (const std::uint32_t voxel : all.minor_points[k])
      if (all.plane_of[voxel] == 0) all.plane_of[voxel] = plane.id;
  }
  const std::int32_t first = static_cast<std::int32_t>(all.planes.size() - all.minor.size()) + 1;
  for (std::size_t i = 0; i < result.plane_of.size(); ++i) {
    const std::uint32_t voxel = result.voxels.voxel_of[i];
    if (result.plane_of[i] > 0 || voxel == planes::kNoVoxel) continue;
    if (all.plane_of[voxel] >= first) result.plane_of[i] = all.plane_of[voxel];
  }
}

}  // namespace

Moments moments_of(const PlaneFit& fit, const Vec3d axes[2], const Vec3d& origin) {
  const Vec3d mean = fit.centroid - origin;
  const auto square = [](const Vec3d& v) -> Mat3d { return v * v.transpose(); };
  const Mat3d s = fit.eigenvalues[0] * square(fit.normal) + fit.eigenvalues[1] * square(axes[1]) +
                  fit.eigenvalues[2] * square(axes[0]) + fit.count * square(mean);
  return {fit.count, fit.count * mean, s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2)};
}

Moments moved(const Moments& m, const Pose& T) {
  const Mat3d& R = T.linear();
  const Vec3d t = T.translation(), turned = R * m.sum;
  const Mat3d s = R * second_moments(m) * R.transpose() + turned * t.transpose() +
                  t * turned.transpose() + m.count * t * t.transpose();
  return {m.count, turned + m.count * t, s(0, 0), s(0, 1), s(0, 2), s(1, 1), s(1, 2), s(2, 2)};
}

Moments shifted(const Moments& m, const Vec3d& by) {
  Pose T = Pose::Identity();
  T.translation() = by;
  return moved(m, T);
}

Apart apart(const Moments& a, const Moments& b) {
  PlaneFit narrow = fit_plane(a), wide = fit_plane(b);
  const bool is_first = narrow.eigenvalues[1] * wide.count < wide.eigenvalues[1] * narrow.count;
  if (!is_first) std::swap(narrow, wide);
  const Moments& points = is_first ? a : b;
  const double middle = wide.distance_m(narrow.centroid);
  const double across = wide.normal.dot(points.scatter() * wide.normal) - narrow.eigenvalues[0];
  // For evenly distributed points, the rim is at sqrt(3) times their RMS distance.
  return {middle, std::abs(middle) + std::sqrt(3 * std::max(0.0, across) / points.count)};
}

Moments scaled(const Moments& m, double weight) {
  return {m.count * weight, m.sum * weight, m.xx * weight, m.xy * weight,
          m.xz * weight,    m.yy * weight,  m.yz * weight, m.zz * weight};
}

void set_frame_fields(ObservedFrame& seen,
                      const Frame& frame,
                      const planes::PipelineOptions& options,
                      const Pose& T_world_camera,
                      int segment) {
  seen.frame = frame.index;
  seen.timestamp_s = frame.timestamp_s;
  seen.segment = segment;
  seen.T_world_camera = T_world_camera;
  if (frame.gravity && frame.gravity->known()) seen.gravity = frame.gravity->direction;
  seen.intrinsics = frame.intrinsics;
  seen.depth = frame.depth;
  seen.depth_unit_m = frame.depth_unit_m;
  seen.max_range_m = options.cloud.max_range_m;
}

ObservedFrame observe(const Frame& frame,
                      planes::FrameResult result,
                      const planes::PipelineOptions& options,
                      const Pose& T_world_camera,
                      int segment) {
  ObservedFrame seen;
  set_frame_fields(seen, frame, options, T_world_camera, segment);
  seen.noise = result.segmentation.noise;
  seen.covered = result.segmentation.covered;
  const auto listed = static_cast<int>(result.segmentation.planes.size());
  const double cell_m = options.cloud.voxel_size_m;
  std::vector<planes::Outline> outlines = planes::outlines_of(frame, result, cell_m);
  std::ranges::move(planes::minor_outlines_of(result, cell_m), std::back_inserter(outlines));
  list_minor(result);

  // A frame's own world is upright and relative to the camera: it maps to ours by a rotation about
  // z and a translation.
  const Pose T_world_local = T_world_camera * result.cloud.T_world_sensor.inverse();
  const std::vector<planes::Certainty> certainties =
      planes::certainties_of(result, /*against_truth=*/false);
  for (const planes::PlaneRegion& region : result.segmentation.planes) {
    ObservedPlane& plane = seen.planes.emplace_back();
    plane.id = region.id;
    plane.known = region.known;
    plane.minor = region.id > listed;
    plane.label = region.label;
    plane.normal = T_world_local.linear() * region.fit.normal;
    plane.centroid = T_world_local * (result.cloud.origin + region.fit.centroid);
    plane.rms_m = region.fit.rms_m();
    plane.margin = region.margin;
    plane.undecided = region.undecided;
    plane.certainty = certainties[region.id - 1];
    for (Vec3d& axis : plane.certainty.axes) axis = T_world_local.linear() * axis;
    plane.outline = planes::moved(std::move(outlines[region.id - 1]), T_world_local);
  }
  const Pose T_camera_local = result.cloud.T_world_sensor.inverse();
  std::vector<InverseSums> rays(seen.planes.size());
  seen.plane_of = Image16(frame.depth.width, frame.depth.height);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    if (const std::int32_t id = result.plane_of[i]; id > 0) {
      seen.plane_of.data[result.cloud.source[i]] = static_cast<std::uint16_t>(id);
      ++seen.planes[id - 1].pixels;
      const Vec3d p =
          T_camera_local * (result.cloud.points[i].cast<double>() + result.cloud.origin);
      const double w = 1 / p.z();
      rays[id - 1].add(w * p, w);
    }
  for (ObservedPlane& plane : seen.planes) {
    fit_along_rays(plane, rays[plane.id - 1], T_world_camera);
    PlaneFit fit = result.segmentation.planes[plane.id - 1].fit;
    fit.normal = plane.normal;
    fit.centroid = plane.centroid;
    plane.moments = moments_of(fit, plane.certainty.axes, seen.camera());
  }
  return seen;
}

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

std::vector<CellMap::Tile> CellMap::extract_tiles(const std::function<bool(const Tile&)>& leaves) {
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

// A measurement with this sigma weighs 1, so that even a plane with few noisy points has at
// least three.
constexpr double kUnitSigma_m = 0.1;
constexpr double kLeastSigma_m = 1e-4;  // exact depth is still rounded to counts
constexpr double kLeastTilt_rad = 1e-5;
// Errors common to all observations of a plane do not average out: the camera's calibration.
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
  moments += scaled(shifted(plane.moments, camera - anchor), squared(kUnitSigma_m / sigma));
  refit();

  // An observation provides the height at its centroid and the slopes along its axes.
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
  moments += shifted(from.moments, from.anchor - anchor);
  refit();
  // (slope u, slope v, height at from's anchor) as functions of ours.
  const Vec2d at = on_grid(from.anchor);
  Mat3d j;
  j << from.basis.u.dot(basis.u), from.basis.u.dot(basis.v), 0, from.basis.v.dot(basis.u),
      from.basis.v.dot(basis.v), 0, at.x(), at.y(), 1;
  information += j.transpose() * from.information * j;

  // Frames in which both were seen count once.
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
