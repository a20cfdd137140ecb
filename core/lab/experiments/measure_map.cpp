#include "core/lab/experiments/measure_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <numeric>
#include <set>
#include <tuple>

#include "core/model/parallel.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/world/files/map_files.hpp"

namespace planescope::lab {
namespace {

constexpr double kOnPlane_m = 0.03, kBeside_m = 0.03;  // a place of the map is on a true plane
constexpr double kSamePlane_deg = 10;
constexpr double kGhost_m2 = 0.01;
constexpr double kAgain = 0.2;        // share of a map plane that another one covers
constexpr double kInSight_m2 = 0.04;  // of a true plane in a frame, to be missed there
constexpr double kSeen_m = 0.02;
constexpr double kWithin_m = 0.005, kWithin_deg = 0.5;

/// The walk, made once and held in memory.
class Walk : public io::Recording {
 public:
  explicit Walk(const MapBenchOptions& options, const std::function<void(int)>& progress)
      : options_(options), sequence(make_sequence(options.sequence)) {
    frames.resize(sequence.cameras.size());
    work_through(
        static_cast<int>(frames.size()), options.pipeline.threads,
        [&](int i) { frames[i] = make_sequence_frame(options.sequence, sequence, i); },
        [&](int done, int) { progress(done); });
    info_.path = "walk";
    info_.width = options.sequence.width;
    info_.height = options.sequence.height;
    info_.intrinsics = frames[0].frame.intrinsics;
    info_.intrinsics_source = "model";
  }
  const io::RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(frames.size()); }
  Frame frame(int i) const override {
    Frame frame = frames[i].frame;
    if (frames[i].gravity) frame.gravity = Gravity{*frames[i].gravity, GravitySource::imu, 1, ""};
    return frame;
  }
  double timestamp_s(int i) const override { return *frames[i].timestamp_s; }
  std::optional<Pose> T_world_camera(int i) const override {
    if (options_.odometry) return std::nullopt;
    return frames[i].T_world_camera;
  }
  std::string frame_hash(int) const override { return {}; }

 private:
  MapBenchOptions options_;
  io::RecordingInfo info_;

 public:
  Sequence sequence;
  std::vector<SampleFrame> frames;
};

using PlaceKey = std::tuple<int, int, int>;
PlaceKey place_key(const Vec3d& p, double cell_m) {
  return {static_cast<int>(std::floor(p.x() / cell_m)),
          static_cast<int>(std::floor(p.y() / cell_m)),
          static_cast<int>(std::floor(p.z() / cell_m))};
}

/// What happened to one true plane so far.
struct TrueTrack {
  int last_seen = -2;                  // frame in which it was found
  int track = 0;                       // then
  bool missed = false;                 // in sight since, and not found
  std::set<std::pair<int, int>> seen;  // places on it within range, squares of kSeen_m
};

class Scoring {
 public:
  Scoring(const Walk& walk, MapScore& score) : walk_(walk), score_(score) {}

  void take(const world::ObservedFrame& frame, const world::FrameOfTracks& told) {
    const SampleFrame& sample = walk_.frames[frame.frame];
    const Image16& truth = sample.truth.plane;
    const int most = walk_.sequence.scene.planes;
    const auto planes = static_cast<int>(frame.planes.size());
    std::vector<int> votes(static_cast<std::size_t>(planes + 1) * (most + 1), 0);
    std::vector<double> in_sight_m2(most + 1, 0);
    const Intrinsics& k = frame.intrinsics;
    for (int v = 0; v < k.height; ++v)
      for (int u = 0; u < k.width; ++u) {
        const int id = truth.at(u, v);
        const std::uint16_t counts = frame.depth.at(u, v);
        const double z = counts * frame.depth_unit_m;
        if (counts == 0 || z > frame.max_range_m) continue;
        if (const int p = frame.plane_of.at(u, v); p > 0)
          ++votes[static_cast<std::size_t>(p) * (most + 1) + id];
        if (id <= 0 || id > most) continue;
        in_sight_m2[id] += z * z / (k.fx * k.fy);
        if (u % 4 == 0 && v % 4 == 0)
          see(id, *sample.T_world_camera, Vec3d((u - k.cx) / k.fx, (v - k.cy) / k.fy, 1));
      }
    // The largest found plane stands for a true one.
    struct Found {
      int track = 0, pixels = 0;
    };
    std::map<int, Found> found;
    for (int p = 1; p <= planes; ++p) {
      const auto first = votes.begin() + static_cast<std::ptrdiff_t>(p) * (most + 1);
      const auto best = std::max_element(first, first + most + 1);
      const int id = static_cast<int>(best - first);
      if (frame.planes[p - 1].minor && told.track_of[p - 1] == 0) continue;
      if (id == 0 || 2 * *best < std::accumulate(first, first + most + 1, 0)) continue;
      ++score_.plane_frames;
      if (Found& f = found[id]; *best > f.pixels) f = {told.track_of[p - 1], *best};
    }
    for (const auto& [id, f] : found) {
      TrueTrack& track = true_[id];
      if (track.track > 0)
        pairs_.push_back({id, frame.frame, track.track, f.track, order_ == track.last_seen + 1});
      score_.breaks += track.missed && track.last_seen >= 0;
      track.missed = false;
      track.last_seen = order_;
      track.track = f.track;
    }
    for (int id = 1; id <= most; ++id) {
      if (in_sight_m2[id] < kInSight_m2)
        true_[id].missed = false, true_[id].last_seen = std::min(true_[id].last_seen, -2);
      else if (!found.contains(id))
        true_[id].missed = true;
    }
    ++order_;
  }

  void finish(const world::WorldMap& map, const Pose& T_truth_map) {
    const auto& tracks = map.tracker.tracks();
    for (MapScore::Change change : pairs_) {
      change.before = world::final_track(tracks, change.before);
      change.now = world::final_track(tracks, change.now);
      if (change.before == change.now) continue;
      ++(change.in_a_row ? score_.switches : score_.not_known_again);
      score_.changes.push_back(change);
    }
    score_map(map, T_truth_map);
  }

 private:
  const Surface& surface_of(int plane) const {
    return *std::ranges::find(walk_.sequence.scene.surfaces, plane, &Surface::plane);
  }

  /// Where a ray of the camera meets the true plane.
  void see(int id, const Pose& T_world_camera, const Vec3d& ray) {
    const Surface& surface = surface_of(id);
    const Vec3d to = surface.corners[0] - T_world_camera.translation(),
                along = T_world_camera.linear() * ray;
    if (std::abs(surface.normal.dot(along)) < 1e-6) return;
    const Vec3d p = along * (surface.normal.dot(to) / surface.normal.dot(along)) - to;
    const PlaneBasis basis = plane_basis(surface.normal);
    true_[id].seen.emplace(static_cast<int>(std::floor(basis.u.dot(p) / kSeen_m)),
                           static_cast<int>(std::floor(basis.v.dot(p) / kSeen_m)));
  }

  /// The true plane that a place is on; 0: none.
  int true_plane_at(const Vec3d& p, const Vec3d& normal) const {
    for (const Surface& s : walk_.sequence.scene.surfaces) {
      if (s.plane == 0 || std::abs(s.normal.dot(p - s.corners[0])) > kOnPlane_m) continue;
      if (planes::plane_angle_deg(s.normal, normal) > kSamePlane_deg) continue;
      bool inside = true;
      for (std::size_t i = 0; i < s.corners.size() && inside; ++i) {
        const Vec3d edge = s.corners[(i + 1) % s.corners.size()] - s.corners[i];
        inside = s.normal.cross(edge).normalized().dot(p - s.corners[i]) > -kBeside_m;
      }
      if (inside) return s.plane;
    }
    return 0;
  }

  void score_map(const world::WorldMap& map, const Pose& T_truth_map) {
    std::set<int> covered;
    std::set<std::pair<int, PlaceKey>> taken;
    for (const world::Track* track : world::planes_of_map(map.tracker)) {
      if (track->state != world::TrackState::alive) continue;
      const Vec3d normal = T_truth_map.linear() * track->fit.normal;
      std::map<int, int> votes;
      std::vector<PlaceKey> keys;
      for (const Vec2d& place : track->cells.sure_places()) {
        const Vec3d p = T_truth_map * track->on_plane(place);
        ++votes[true_plane_at(p, normal)];
        keys.push_back(place_key(p, 0.04));
      }
      const auto best = std::ranges::max_element(votes, {}, [](const auto& v) { return v.second; });
      if (best == votes.end()) continue;
      const int id = best->first;
      if (id == 0 || 2 * best->second < static_cast<int>(keys.size())) {
        score_.ghosts += track->sure_area_m2() > kGhost_m2;
        score_.planes.push_back({track->id, 0, track->sure_area_m2(), 0, 0});
        continue;
      }
      std::ranges::sort(keys);
      const auto repeated = std::ranges::unique(keys);
      keys.erase(repeated.begin(), repeated.end());
      const auto again = std::ranges::count_if(keys, [&](const auto& key) {
        return taken.contains({id, key});
      });
      score_.twice += static_cast<double>(again) > kAgain * static_cast<double>(keys.size());
      for (const PlaceKey& key : keys) taken.insert({id, key});
      covered.insert(id);
      const Surface& surface = surface_of(id);
      const double offset =
          std::abs(surface.normal.dot(T_truth_map * track->centroid() - surface.corners[0]));
      const double angle = planes::plane_angle_deg(surface.normal, normal);
      score_.planes.push_back({track->id, id, track->sure_area_m2(), offset, angle});
      score_.within += offset <= kWithin_m && angle <= kWithin_deg;
    }
    for (const auto& [id, track] : true_) {
      if (track.seen.empty()) continue;
      ++score_.true_tracks;
      const double seen_m2 = static_cast<double>(track.seen.size()) * kSeen_m * kSeen_m;
      if (seen_m2 < MapScore::kLeastSeen_m2) continue;
      ++score_.true_planes;
      if (!covered.contains(id)) score_.missing.emplace_back(id, seen_m2);
    }
  }

  const Walk& walk_;
  MapScore& score_;
  std::map<int, TrueTrack> true_;
  std::vector<MapScore::Change> pairs_;
  int order_ = 0;
};

}  // namespace

MapScore measure_map(const MapBenchOptions& options,
                     const planes::Classifier& classifier,
                     const std::function<void(int done, int all)>& progress) {
  const int all = 2 * options.sequence.frames;
  const Walk walk(options, [&](int done) {
    if (progress) progress(done, all);
  });
  MapScore score;
  score.frames = options.sequence.frames;
  Scoring scoring(walk, score);
  world::MapJob job;
  job.recording = &walk;
  for (int i = 0; i < walk.frame_count(); ++i) job.frames.push_back(i);
  job.pipeline = options.pipeline;
  job.classifier = &classifier;
  job.tracks = options.tracks;
  job.threads = options.pipeline.threads;
  job.on_frame = [&](const world::ObservedFrame& frame, const world::FrameOfTracks& told) {
    scoring.take(frame, told);
  };
  job.progress = [&](const char*, int done, int) {
    if (progress) progress(options.sequence.frames + std::min(done, options.sequence.frames), all);
  };
  const world::WorldMap map = world::map_recording(job);
  const world::CameraPose &first = map.poses.poses.front(), &last = map.poses.poses.back();
  const auto true_pose = [&](int frame) { return *walk.frames[frame].T_world_camera; };
  const Pose T_truth_map = true_pose(first.frame) * first.T_world_camera.inverse();
  scoring.finish(map, T_truth_map);
  for (std::size_t i = 1; i < walk.frames.size(); ++i)
    score.way_m += (true_pose(static_cast<int>(i)).translation() -
                    true_pose(static_cast<int>(i) - 1).translation())
                       .norm();
  score.drift_m =
      (T_truth_map * last.T_world_camera.translation() - true_pose(last.frame).translation())
          .norm();
  return score;
}

Table map_table(const std::vector<MapScore>& scores, const std::vector<std::string>& names) {
  Table table;
  table.title = "Tracks and map of a walk";
  table.note =
      "Switches: of 1000 found planes, those that had another track in the frame before. Not known "
      "again: found again after frames without it, as another track. Breaks: of 100 true planes, "
      "rows of frames in which one was in sight and not found. The map: true planes of which over "
      "400 cm2 were in sight; planes that cover a place again; planes over 100 cm2 on no true one; "
      "errors at the planes' centroids, their 95th percentile.";
  table.columns = {"figure"};
  for (const std::string& name : names) table.columns.push_back(name);
  const auto row = [&](const std::string& name, const auto& text) {
    std::vector<std::string>& cells = table.rows.emplace_back();
    cells.push_back(name);
    for (const MapScore& score : scores) cells.push_back(text(score));
  };
  const auto worst = [](const MapScore& score, double MapScore::Plane::*error) {
    std::vector<double> values;
    for (const MapScore::Plane& plane : score.planes)
      if (plane.truth > 0) values.push_back(plane.*error);
    if (values.empty()) return std::nan("");
    std::ranges::sort(values);
    return values[static_cast<std::size_t>(0.95 * static_cast<double>(values.size() - 1) + 0.5)];
  };
  using S = MapScore;
  row("frames", [](const S& s) { return fmt::format("{}", s.frames); });
  row("found planes", [](const S& s) { return fmt::format("{}", s.plane_frames); });
  row("switches per 1000",
      [](const S& s) { return fixed(1000.0 * s.switches / std::max(1, s.plane_frames), 2); });
  row("not known again", [](const S& s) { return fmt::format("{}", s.not_known_again); });
  row("breaks per 100",
      [](const S& s) { return fixed(100.0 * s.breaks / std::max(1, s.true_tracks), 1); });
  row("true planes", [](const S& s) { return fmt::format("{}", s.true_planes); });
  row("missing", [](const S& s) { return fmt::format("{}", s.missing.size()); });
  row("covered twice", [](const S& s) { return fmt::format("{}", s.twice); });
  row("ghosts", [](const S& s) { return fmt::format("{}", s.ghosts); });
  row("offset p95 [mm]",
      [&](const S& s) { return fixed(1000 * worst(s, &MapScore::Plane::offset_m), 1); });
  row("angle p95 [deg]",
      [&](const S& s) { return fixed(worst(s, &MapScore::Plane::angle_deg), 2); });
  row("within 5 mm, 0.5 deg [%]",
      [](const S& s) { return fixed(percent(s.within, static_cast<int>(s.planes.size())), 0); });
  row("drift [% of the way]",
      [](const S& s) { return fixed(s.way_m > 0 ? 100 * s.drift_m / s.way_m : 0, 2); });
  return table;
}

Table map_planes_table(const MapScore& score) {
  Table table;
  table.title = "Planes of the map";
  table.note =
      "The true plane that most of each is on; none: a ghost. Of a missing one, the area in sight.";
  table.columns = {"track", "true plane", "area [m2]", "offset [mm]", "angle [deg]"};
  for (const MapScore::Plane& plane : score.planes)
    table.rows.push_back(
        {fmt::format("{}", plane.track), plane.truth > 0 ? fmt::format("{}", plane.truth) : "none",
         fixed(plane.area_m2, 3), fixed(1000 * plane.offset_m, 1), fixed(plane.angle_deg, 2)});
  for (const auto& [truth, seen_m2] : score.missing)
    table.rows.push_back({"missing", fmt::format("{}", truth), fixed(seen_m2, 3), "", ""});
  return table;
}

Table track_changes_table(const MapScore& score) {
  Table table;
  table.title = "Changes of tracks";
  table.note = "Frames in which a true plane is found as another track than before.";
  table.columns = {"true plane", "frame", "track before", "track now", "in a row"};
  for (const MapScore::Change& change : score.changes)
    table.rows.push_back({fmt::format("{}", change.truth), fmt::format("{}", change.frame),
                          fmt::format("{}", change.before), fmt::format("{}", change.now),
                          change.in_a_row ? "yes" : "no"});
  return table;
}

}  // namespace planescope::lab
