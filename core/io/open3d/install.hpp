#pragma once

// The program's use of Open3D. Builds without -DPLANESCOPE_OPEN3D=ON use absent.cpp instead.

#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "core/model/frame.hpp"
#include "core/planes/cloud/cloud.hpp"
#include "core/planes/rivals/rivals.hpp"

namespace planescope::open3d {

/// Registers the rival `ransac` (core/planes/rivals/rivals.hpp) and the cloud formats .xyz, .pts,
/// .obj, .stl and .off. Call once, before any recording, method or option is used.
void install();

/// Fuses the surfaces of many depth images into one mesh. Deterministic for the same images in the
/// same order.
class SurfaceFusion {
 public:
  virtual ~SurfaceFusion() = default;
  /// Throws Error if the camera has lens distortion, which Open3D does not support.
  virtual void add(const Frame& frame, const Pose& T_world_camera) = 0;
  /// Writes the mesh so far as PLY, completely or not at all. The mesh is colored if the first
  /// image has color aligned to depth; surfaces from later images without color are black. Returns
  /// false, and writes nothing, if there is no mesh. Throws Error naming the file.
  virtual bool write_ply(const std::filesystem::path& file) const = 0;
};
/// ScalableTSDFVolume, truncated at four voxels. `voxel_m`: edge of a voxel. `max_range_m`: ignore
/// depth beyond it; 0: no limit. Throws Error in builds without Open3D.
std::unique_ptr<SurfaceFusion> make_surface_fusion(double voxel_m, double max_range_m);

/// SegmentPlane with one thread and a fixed seed, so that it is repeatable. Calls wait for each
/// other, since Open3D has one random sequence per process. Stops at the first plane with too few
/// points. Not in builds without Open3D.
planes::FoundPlanes find_planes_ransac(std::span<const Vec3f> points,
                                       const planes::RansacOptions& options);

// Stages to time against ours, each with its input converted to Open3D's types: the returned
// function runs the stage alone. Empty functions in builds without Open3D.

/// VoxelDownSample of the cloud's kept points.
std::function<void()> voxel_down_sample(const planes::Cloud& cloud, double voxel_size_m);
/// An octree of pointers, with every node down to the cube's depth.
std::function<void()> pointer_octree(std::span<const Vec3f> points, const planes::Cube& cube);

}  // namespace planescope::open3d
