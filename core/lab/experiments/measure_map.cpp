// Scores tracks and maps against a synthetic walk and against measured cuboids.

#include "core/lab/experiments/measure_map.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>

#include "core/model/error.hpp"
#include "core/model/json.hpp"
#include "core/model/parallel.hpp"
#include "core/model/text.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/world/files/map_files.hpp"
#include "core/world/poses/poses.hpp"

namespace planescope::lab {
namespace {

constexpr double kOnPlane_m = 0.03, kBeside_m = 0.03;  // of map points from a true plane
constexpr double kSamePlane_deg = 10;
constexpr double kGhost_m2 = 0.01;
constexpr double kAgain = 0.2;        // share of a map plane that another one covers
constexpr double kInSight_m2 = 0.04;  // visible area in a frame for a true plane to count as missed
constexpr double kSeen_m = 0.02;
constexpr double kWithin_m = 0.005, kWithin_deg = 0.5;

/// The walk, generated once and held in memory.
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

/// History of one true plane.
struct TrueTrack {
  int last_seen = -2;                  // last frame in which it was found
  int track = 0;                       // its track then
  bool missed = false;                 // visible since then, but not found
  std::set<std::pair<int, int>> seen;  // points on it within range, in squares of kSeen_m
};

class Scoring {
 public:
  Scoring(const Walk& walk, MapScore& score) : walk_(walk), score_(score) {}

  void take(const world::ObservedFrame& frame, const world::FrameOfTracks& tracked) {
    const SampleFrame& sample = walk_.frames[frame.frame];
    const Image16& truth = sample.truth.plane;
    const int most = walk_.sequence.scene.planes;
    const auto planes = static_cast<int>(frame.planes.size());
    std::vector<int> votes(static_cast<std::size_t>(planes + 1) * (most + 1), 0);
    std::vector<double> visible_m2(most + 1, 0);
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
        visible_m2[id] += z * z / (k.fx * k.fy);
        if (u % 4 == 0 && v % 4 == 0)
          see(id, *sample.T_world_camera, Vec3d((u - k.cx) / k.fx, (v - k.cy) / k.fy, 1));
      }
    // The largest found plane represents a true one.
    struct Found {
      int track = 0, pixels = 0;
    };
    std::map<int, Found> found;
    for (int p = 1; p <= planes; ++p) {
      const auto first = votes.begin() + static_cast<std::ptrdiff_t>(p) * (most + 1);
      const auto best = std::max_element(first, first + most + 1);
      const int id = static_cast<int>(best - first);
      if (frame.planes[p - 1].minor && tracked.track_of[p - 1] == 0) continue;
      if (id == 0 || 2 * *best < std::accumulate(first, first + most + 1, 0)) continue;
      ++score_.plane_frames;
      if (Found& f = found[id]; *best > f.pixels) f = {tracked.track_of[p - 1], *best};
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
      if (visible_m2[id] < kInSight_m2)
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

  /// Records the intersection of a camera ray with the true plane.
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

  /// The true plane at a point; 0: none.
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
      if (!covered.contains(id)) score_.missing.push_back({static_cast<double>(id), seen_m2});
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
  job.on_frame = [&](const world::ObservedFrame& frame, const world::FrameOfTracks& tracked) {
    scoring.take(frame, tracked);
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

// ---- Against measured cuboids ----

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::uintmax_t kMostBytes = std::uintmax_t{1} << 30;
// Smaller planes of the map are ignored.
constexpr double kLeastArea_m2 = 0.04;
// A face is in view if its center is near the optical axis and it is not seen edge-on.
constexpr double kView_deg = 30, kMostIncidence_deg = 75;

double degrees(double radians) { return radians * 180 / std::numbers::pi; }
double cosine(double degrees) { return std::cos(degrees * std::numbers::pi / 180); }

struct Face {
  std::string name;
  Vec3d center, normal;  // outwards
  Vec3d along[2];
  double half[2];

  bool is_near(const Vec3d& p) const {
    const Vec3d d = p - center;
    return std::abs(d.dot(normal)) <= kNearFace_m &&
           std::abs(d.dot(along[0])) <= half[0] + kNearFace_m &&
           std::abs(d.dot(along[1])) <= half[1] + kNearFace_m;
  }
};

std::vector<Face> faces_of(std::span<const Cuboid> cuboids) {
  const double everywhere = std::numeric_limits<double>::infinity();
  std::vector<Face> faces{{"floor",
                           Vec3d::Zero(),
                           Vec3d::UnitZ(),
                           {Vec3d::UnitX(), Vec3d::UnitY()},
                           {everywhere, everywhere}}};
  for (std::size_t k = 0; k < cuboids.size(); ++k) {
    const Cuboid& box = cuboids[k];
    const Mat3d R = Eigen::AngleAxisd(box.yaw, Vec3d::UnitZ()).toRotationMatrix();
    for (int axis = 0; axis < 3; ++axis)
      for (const int side : {1, -1}) {
        if (axis == 2 && side < 0) continue;  // the bottom face touches the floor
        const int u = (axis + 1) % 3, v = (axis + 2) % 3;
        const Vec3d normal = side * R.col(axis);
        const std::string name =
            fmt::format("cuboid {} {}{}", k + 1, side > 0 ? '+' : '-', "xyz"[axis]);
        faces.push_back({name,
                         box.center + box.half[axis] * normal,
                         normal,
                         {R.col(u), R.col(v)},
                         {box.half[u], box.half[v]}});
      }
  }
  return faces;
}

struct MapPlane {
  Vec3d normal, centroid;
  double area_m2 = 0;
};

Vec3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Error not_a_map(const fs::path& file, const Json::exception& problem) {
  return Error(fmt::format("{}: {}; expected the output of planescope map", file.string(),
                           json_problem(problem)));
}

/// The largest first.
std::vector<MapPlane> read_planes(const fs::path& file) {
  std::vector<MapPlane> planes;
  const Json json = read_json<Json>(file, kMostBytes);
  try {
    for (const Json& plane : json.at("planes"))
      if (plane.at("segment") == 0 && plane.at("state") != "gone")
        planes.push_back({vector_of(plane.at("normal")), vector_of(plane.at("centroid")),
                          plane.at("area_m2").get<double>()});
  } catch (const Json::exception& problem) {
    throw not_a_map(file, problem);
  }
  std::ranges::stable_sort(planes, std::greater(), &MapPlane::area_m2);
  return planes;
}

/// T_world_camera of the frames in the first segment.
std::vector<Pose> read_poses(const fs::path& map) {
  const fs::path file = map / "tracks.json";
  const Json json = read_json<Json>(file, kMostBytes);
  const world::Trajectory trajectory = world::read_trajectory(map / "poses.tum");
  std::vector<Pose> poses;
  try {
    for (const Json& frame : json.at("frames")) {
      if (frame.at("segment") != 0 || frame.contains("set_aside")) continue;
      if (const auto* pose = world::pose_of(trajectory, frame.at("frame").get<int>()))
        poses.push_back(pose->T_world_camera);
    }
  } catch (const Json::exception& problem) {
    throw not_a_map(file, problem);
  }
  return poses;
}

bool looks_at(const Pose& T_world_camera, const Face& face) {
  const Vec3d to = face.center - T_world_camera.translation();
  return to.dot(T_world_camera.linear().col(2)) > cosine(kView_deg) * to.norm() &&
         -to.dot(face.normal) > cosine(kMostIncidence_deg) * to.norm();
}

}  // namespace

std::vector<Cuboid> read_cuboids(const fs::path& file) {
  std::vector<Cuboid> cuboids;
  for (const TextLine& line : read_text_lines(file, kMostBytes)) {
    if (line.words.empty()) continue;
    const std::vector<double> n = numbers_in(file, line, 7, "x y z yaw and three half sizes");
    const Cuboid& box = cuboids.emplace_back(Cuboid{{n[0], n[1], n[2]}, n[3], {n[4], n[5], n[6]}});
    if (!(box.half.minCoeff() > 0)) fail_at(file, line, "a half size is not above 0");
  }
  if (cuboids.empty())
    throw Error(file.string() +
                ": contains no cuboids; expected lines with x, y, z, yaw, and half sizes");
  return cuboids;
}

MapTruthScore measure_map_truth(const fs::path& map, std::span<const Cuboid> cuboids) {
  const std::vector<Face> faces = faces_of(cuboids);
  const std::vector<MapPlane> planes = read_planes(map / "map.json");
  const std::vector<Pose> poses = read_poses(map);
  MapTruthScore score;
  for (const Face& face : faces) {
    FaceScore& of = score.faces.emplace_back();
    of.name = face.name;
    for (const Pose& T_world_camera : poses)
      of.frames += face.name == "floor" || looks_at(T_world_camera, face);
  }
  for (const MapPlane& plane : planes) {
    if (plane.area_m2 < kLeastArea_m2) continue;
    const auto off_m = [&](const Face& face) {
      return std::abs(plane.normal.dot(face.normal)) >= cosine(kNearFace_deg) &&
                     face.is_near(plane.centroid)
                 ? std::abs((plane.centroid - face.center).dot(face.normal))
                 : std::numeric_limits<double>::infinity();
    };
    const auto face = std::ranges::min_element(faces, {}, off_m);
    if (std::isinf(off_m(*face))) {
      ++score.elsewhere;
      continue;
    }
    FaceScore& of = score.faces[face - faces.begin()];
    of.area_m2 += plane.area_m2;
    if (of.planes++ > 0) continue;
    of.offset_m = (plane.centroid - face->center).dot(face->normal);
    of.angle_deg = degrees(std::acos(std::min(1.0, std::abs(plane.normal.dot(face->normal)))));
  }
  return score;
}

}  // namespace planescope::lab
