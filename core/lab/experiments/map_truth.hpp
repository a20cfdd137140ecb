#pragma once

// Maps of real recordings against cuboids that were measured in the world of the camera's poses.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/lab/bench/table.hpp"
#include "core/model/types.hpp"

namespace planescope::lab {

/// A box that stands on the floor z = 0. World [m, rad].
struct Cuboid {
  Vec3d center = Vec3d::Zero();
  double yaw = 0;              // about z
  Vec3d half = Vec3d::Zero();  // of its edges
};

/// Of a text file: a line each, x y z yaw and the three half sizes. Throws Error naming the file
/// and the line, or the file that holds none.
std::vector<Cuboid> read_cuboids(const std::filesystem::path& file);

/// What a map has of the floor, or of a face of a cuboid.
struct FaceScore {
  std::string name;      // "floor", "cuboid 1 front"
  int frames = 0;        // that look at its middle
  int planes = 0;        // of the map that stand for it
  double area_m2 = 0;    // of them
  double offset_m = 0;   // of the largest one, outwards, at its centroid
  double angle_deg = 0;  // likewise
  bool is_missing() const { return frames >= kLeastFrames && planes == 0; }
  static constexpr int kLeastFrames = 3;
};

struct MapTruthScore {
  std::vector<FaceScore> faces;
  int elsewhere = 0;  // planes of the map that stand for no face
};

/// Reads map.json and poses.tum as planescope map wrote them, of the first segment of the map.
/// Throws Error naming the file that is missing or damaged.
MapTruthScore measure_map_truth(const std::filesystem::path& map, std::span<const Cuboid> cuboids);

Table map_truth_table(const MapTruthScore& score, const std::string& name);

}  // namespace planescope::lab
