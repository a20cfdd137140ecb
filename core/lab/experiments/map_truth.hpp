#pragma once

// Maps of real recordings against cuboids that were measured in the world of the camera's poses.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/lab/bench/table.hpp"
#include "core/model/types.hpp"

namespace planescope::lab {

/// A box on the floor z = 0. World coordinates [m, rad].
struct Cuboid {
  Vec3d center = Vec3d::Zero();
  double yaw = 0;              // about z
  Vec3d half = Vec3d::Zero();  // half of each edge
};

/// Reads one cuboid per line: x y z, yaw and three half sizes. Throws Error naming the file and
/// line, also where the file holds no cuboid.
std::vector<Cuboid> read_cuboids(const std::filesystem::path& file);

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

struct MapTruthScore {
  std::vector<FaceScore> faces;
  int elsewhere = 0;  // planes of the map that match no face
};

/// Reads map.json, tracks.json and poses.tum of a folder that planescope map wrote; only the first
/// segment counts.
/// Throws Error naming the file that is missing or damaged.
MapTruthScore measure_map_truth(const std::filesystem::path& map, std::span<const Cuboid> cuboids);

Table map_truth_table(const MapTruthScore& score, const std::string& name);

}  // namespace planescope::lab
