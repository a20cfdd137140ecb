#pragma once

// Scores tracks and maps on a synthetic walk with exact planes and poses, and maps of real
// recordings against cuboids measured in the world frame of the camera's poses.

#include <array>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "core/lab/synthetic/sample.hpp"
#include "core/model/json_fields.hpp"
#include "core/world/map_recording.hpp"

namespace planescope::lab {

struct MapScore {
  int frames = 0, plane_frames = 0;  // found planes that match a true one, over all frames
  // switches: a true plane found in two consecutive frames changed its track. not_known_again: a
  // plane found again after a gap lost its track.
  int switches = 0, not_known_again = 0;
  int true_tracks = 0;  // visible true planes, each counted once
  int breaks = 0;       // gaps in which a plane is visible but not found
  // The map. A true plane counts if more than kLeastSeen_m2 of it was visible.
  static constexpr double kLeastSeen_m2 = 0.04;
  int true_planes = 0;
  std::vector<std::array<double, 2>> missing;  // ids, and visible areas [m2]
  int twice = 0;   // map planes on an area that a larger one already covers
  int ghosts = 0;  // map planes over 100 cm2 on no true plane
  struct Plane {
    int track = 0, truth = 0;                         // ids; truth 0: a ghost
    double area_m2 = 0, offset_m = 0, angle_deg = 0;  // relative to the true one, at its centroid
  };
  std::vector<Plane> planes;  // of the map, at the end
  struct Change {
    int truth = 0, frame = 0, before = 0, now = 0;
    bool in_a_row = false;
  };
  std::vector<Change> changes;    // of tracks, counted by `switches` and `not_known_again`
  int within = 0;                 // 5 mm and 0.5 degrees
  double way_m = 0, drift_m = 0;  // length of the camera's path; error of its final position
};

void visit_fields(auto& fields, Same<MapScore::Plane> auto& plane) {
  fields("track", plane.track);
  fields("truth", plane.truth);
  fields("area_m2", plane.area_m2);
  fields("offset_m", plane.offset_m);
  fields("angle_deg", plane.angle_deg);
}
void visit_fields(auto& fields, Same<MapScore::Change> auto& change) {
  fields("truth", change.truth);
  fields("frame", change.frame);
  fields("before", change.before);
  fields("now", change.now);
  fields("in_a_row", change.in_a_row);
}
void visit_fields(auto& fields, Same<MapScore> auto& score) {
  fields("frames", score.frames);
  fields("plane_frames", score.plane_frames);
  fields("switches", score.switches);
  fields("not_known_again", score.not_known_again);
  fields("true_tracks", score.true_tracks);
  fields("breaks", score.breaks);
  fields("true_planes", score.true_planes);
  fields("missing", score.missing);
  fields("twice", score.twice);
  fields("ghosts", score.ghosts);
  fields("planes", score.planes);
  fields("changes", score.changes);
  fields("within", score.within);
  fields("way_m", score.way_m);
  fields("drift_m", score.drift_m);
}

struct MapBenchOptions {
  SequenceOptions sequence;
  planes::PipelineOptions pipeline;
  world::TrackOptions tracks;
  bool odometry = false;  // else the true poses
};

/// Throws Cancelled if stopped.
MapScore measure_map(const MapBenchOptions& options,
                     const planes::Classifier& classifier,
                     const std::function<void(int done, int all)>& progress = {});

// ---- Against measured cuboids ----

/// A box on the floor z = 0. World coordinates [m, rad].
struct Cuboid {
  Vec3d center = Vec3d::Zero();
  double yaw = 0;              // about z
  Vec3d half = Vec3d::Zero();  // half of each edge
};

/// Reads one cuboid per line: x y z, yaw and three half sizes. Throws Error naming the file and
/// line, also if the file contains no cuboid.
std::vector<Cuboid> read_cuboids(const std::filesystem::path& file);

/// A plane of the map matches a face within these limits.
inline constexpr double kNearFace_m = 0.15, kNearFace_deg = 10;

/// How a map represents the floor or one face of a cuboid.
struct FaceScore {
  std::string name;      // "floor", "cuboid 1 +x"
  int frames = 0;        // with its center in view; floor: all
  int planes = 0;        // matching planes of the map
  double area_m2 = 0;    // of these planes
  double offset_m = 0;   // of the largest one, outwards, at its centroid
  double angle_deg = 0;  // the same
  bool is_missing() const { return frames >= kLeastFrames && planes == 0; }
  static constexpr int kLeastFrames = 3;
};
void visit_fields(auto& fields, Same<FaceScore> auto& face) {
  fields("face", face.name);
  fields("frames", face.frames);
  fields("planes", face.planes);
  fields("area_m2", face.area_m2);
  fields("offset_m", face.offset_m);
  fields("angle_deg", face.angle_deg);
  fields("is_missing", face.is_missing());
}

struct MapTruthScore {
  std::vector<FaceScore> faces;
  int elsewhere = 0;  // planes of the map that match no face
};

/// Reads map.json, tracks.json and poses.tum of a folder written by `planescope map`; only the
/// first segment counts. Throws Error naming the missing or damaged file.
MapTruthScore measure_map_truth(const std::filesystem::path& map, std::span<const Cuboid> cuboids);

}  // namespace planescope::lab
