#pragma once

// Tracks and maps against a synthetic walk whose planes and poses are known exactly; and maps of
// real recordings against cuboids that were measured in the world of the camera's poses.

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
  int frames = 0, plane_frames = 0;  // found planes that stand for a true one, over all frames
  // A true plane, found in two frames in a row, has changed its track; or, found again after frames
  // without it, has not kept it.
  int switches = 0, not_known_again = 0;
  int true_tracks = 0;  // true planes in sight, one time each
  int breaks = 0;  // frames in a row in which one is in sight and not found, found on both sides
  // The map. A true plane counts where more than kLeastSeen of it was in sight.
  static constexpr double kLeastSeen_m2 = 0.04;
  int true_planes = 0;
  std::vector<std::array<double, 2>> missing;  // ids, and how much was in sight [m2]
  int twice = 0;   // map planes that cover again what a larger one covers
  int ghosts = 0;  // map planes over 100 cm2 that are on no true plane
  struct Plane {
    int track = 0, truth = 0;                         // ids; truth 0: a ghost
    double area_m2 = 0, offset_m = 0, angle_deg = 0;  // from the true one, at its centroid
  };
  std::vector<Plane> planes;  // of the map, those that are there at the end
  struct Change {
    int truth = 0, frame = 0, before = 0, now = 0;
    bool in_a_row = false;
  };
  std::vector<Change> changes;    // of tracks, what `switches` and `not_known_again` count
  int within = 0;                 // 5 mm and 0.5 degrees
  double way_m = 0, drift_m = 0;  // of the camera; where it was thought to be at the end
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

/// Throws Cancelled when stopped.
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
/// line, also where the file holds no cuboid.
std::vector<Cuboid> read_cuboids(const std::filesystem::path& file);

/// A plane of the map matches a face within these limits.
inline constexpr double kNearFace_m = 0.15, kNearFace_deg = 10;

/// How a map represents the floor or one face of a cuboid.
struct FaceScore {
  std::string name;      // "floor", "cuboid 1 +x"
  int frames = 0;        // in which its center is in view; floor: all
  int planes = 0;        // of the map that match it
  double area_m2 = 0;    // of them
  double offset_m = 0;   // of the largest one, outwards, at its centroid
  double angle_deg = 0;  // likewise
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

/// Reads map.json, tracks.json and poses.tum of a folder that planescope map wrote; only the first
/// segment counts.
/// Throws Error naming the file that is missing or damaged.
MapTruthScore measure_map_truth(const std::filesystem::path& map, std::span<const Cuboid> cuboids);

}  // namespace planescope::lab
