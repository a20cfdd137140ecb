#pragma once

// Back-projects a frame into a gravity-aligned cloud, and divides the cloud into voxels.

#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/plane.hpp"

namespace planescope::planes {

struct CloudOptions {
  double max_range_m = 1.5;       // depth frames: limit on depth z; clouds: limit on distance from
                                  // the origin
  bool range_for_clouds = false;  // whether to crop clouds by range as well
  double cube_edge_m = 3.2;       // smallest edge of the cube; doubled until it contains the range
  double voxel_size_m = 0.02;     // 0: every point is its own voxel
  int base_depth = 8;             // octree depth of a 3.2 m cube: leaf 1.25 cm
  template <typename Rows>
  static void describe(Rows& rows) {
    using O = CloudOptions;
    rows.number("max_range_m", "Maximum range", "m",
                "Depth z beyond which pixels are ignored (depth images)", &O::max_range_m,
                {0, 1000, true});
    rows.flag("range_for_clouds", "Limit clouds to the range",
              "Ignore points farther than max_range_m from the origin (clouds)",
              &O::range_for_clouds);
    rows.group.images = false;
    rows.number("cube_edge_m", "Octree cube", "m",
                "Minimum edge of the octree cube; doubled until it contains the range",
                &O::cube_edge_m, {0.01, 10000});
    rows.number("voxel_size_m", "Voxel size", "m", "Voxel edge; 0 makes every point a voxel",
                &O::voxel_size_m, {0, 10});
    rows.number("base_depth", "Octree depth", "levels",
                "Octree depth for a cube of cube_edge_m: 8 gives leaves of 1.25 cm in 3.2 m",
                &O::base_depth, {1, 16});
  }
};

/// Number of points kept and dropped, by reason; shown in every output.
struct CloudCounts {
  std::uint64_t pixels = 0;          // of the depth image, or points of the file
  std::uint64_t no_measurement = 0;  // zero depth, (0,0,0)
  std::uint64_t invalid = 0;         // 65535, NaN, inf
  std::uint64_t beyond_range = 0;
  std::uint64_t outside_cube = 0;
  std::uint64_t kept = 0;  // N_m in the paper
};

/// The cube that the octree divides, in the cloud's local coordinates.
struct Cube {
  Vec3d min_corner = Vec3d::Zero();  // [m]
  double edge_m = 3.2;
  int max_depth = 8;
};

inline constexpr std::uint32_t kNoVoxel = std::numeric_limits<std::uint32_t>::max();

/// All valid measurements of a frame in raster (or file) order, gravity-aligned: world frame, z up,
/// meters, relative to `origin`. The world position of a point is origin + points[i]. For depth
/// frames the origin is 0, the sensor.
struct Cloud {
  Pose T_world_sensor = Pose::Identity();
  Vec3d origin = Vec3d::Zero();
  std::vector<Vec3f> points;          // valid measurements, including cropped ones
  std::vector<std::uint32_t> source;  // pixel index v * width + u, or index in the file
  int width = 0, height = 0;          // of the depth image; 0 for clouds
  double focal_px = 0;                // of the depth image
  std::vector<std::uint8_t> kept;     // 1: inside range and cube
  Cube cube;
  CloudCounts counts;
};

/// One point per occupied voxel (the mean of its points), in order of first appearance in the
/// cloud: the same for any thread count.
struct VoxelCloud {
  std::vector<Vec3f> points;            // relative to the cloud's origin [m]
  std::vector<std::uint32_t> voxel_of;  // per cloud point: its voxel; kNoVoxel if cropped
  std::vector<std::uint32_t> count;     // cloud points per voxel
  double size_m = 0;                    // voxel edge; 0: every point is its own voxel
};

/// Back-projects, crops and aligns a frame. Sec. V: depth beyond 1.5 m is discarded.
Cloud make_cloud(const Frame& frame, const Gravity& gravity, const CloudOptions& options);

/// Voxel grid anchored at the cube's corner. Sec. II-B: N_d points.
VoxelCloud voxelize(const Cloud& cloud, double voxel_size_m);

/// A warning if voxels of this size are larger than the scene; empty if not.
std::string doubt_in_voxels(const Cloud& cloud, double voxel_size_m);

/// Points of each voxel as CSR: members[first[v] .. first[v+1]) are ascending cloud point indices.
struct VoxelMembers {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> members;
};
VoxelMembers voxel_members(const VoxelCloud& voxels);

/// Majority vote of per-point values for each voxel (0 = unknown, does not vote). Ties go to the
/// smaller value.
std::vector<std::uint8_t> vote_labels(const VoxelCloud& voxels,
                                      std::span<const std::uint8_t> labels);
std::vector<std::int32_t> vote_instances(const VoxelCloud& voxels,
                                         std::span<const std::int32_t> ids);

/// Rotation from the sensor frame to the world frame: maps gravity to -z and keeps the sensor's
/// forward axis (z for depth, x for clouds) in the world's x-z half plane where that is defined.
Pose world_from_gravity(const Vec3d& gravity_sensor, bool depth_camera);

}  // namespace planescope::planes
