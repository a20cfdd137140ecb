#pragma once

// What the program takes from Open3D. Without -DPLANESCOPE_OPEN3D=ON there is none of it
// (absent.cpp).

#include <filesystem>
#include <functional>
#include <memory>
#include <span>

#include "core/model/frame.hpp"
#include "core/planes/cloud/cloud.hpp"
#include "core/planes/rivals/rivals.hpp"

namespace planescope::open3d {

/// Hands over the rival `ransac` (core/planes/rivals/rivals.hpp) and the cloud formats .xyz, .pts,
/// .obj, .stl and .off. Call it once, before any recording, method or option is asked for.
void install();

/// The surfaces of many depth images as one mesh. The same images in the same order make the same
/// mesh.
class SurfaceFusion {
 public:
  virtual ~SurfaceFusion() = default;
  /// Throws Error where the camera has lens distortion, which Open3D's does not.
  virtual void add(const Frame& frame, const Pose& T_world_camera) = 0;
  /// The mesh so far, PLY; colored where the first image has color that lies on its depth, black
  /// where a later one has none. Whole or not at all. False, and nothing written, where there is
  /// none. Throws Error naming the file.
  virtual bool write_ply(const std::filesystem::path& file) const = 0;
};
/// ScalableTSDFVolume, truncated at four voxels. `voxel_m`: edge of a voxel. `max_range_m`: depth
/// beyond it is left out; 0: none. Throws Error in builds without Open3D.
std::unique_ptr<SurfaceFusion> make_surface_fusion(double voxel_m, double max_range_m);

/// SegmentPlane, under one thread and the seed so that it repeats; calls wait for each other, since
/// Open3D has one random sequence for the whole process. Ends with the first plane that has too few
/// points. Not in builds without Open3D.
planes::FoundPlanes find_planes_ransac(std::span<const Vec3f> points,
                                       const planes::RansacOptions& options);

// Stages that ours are timed beside, each with its input in Open3D's own types: what is returned
// runs the stage alone. Empty functions in builds without Open3D.

/// VoxelDownSample of the cloud's kept points.
std::function<void()> voxel_down_sample(const planes::Cloud& cloud, double voxel_size_m);
/// An octree of pointers, with every node down to the cube's depth.
std::function<void()> pointer_octree(std::span<const Vec3f> points, const planes::Cube& cube);

}  // namespace planescope::open3d
