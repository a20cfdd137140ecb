#pragma once

// The surfaces of many depth images as one mesh, where the program has what makes it.

#include <filesystem>
#include <memory>

#include "core/model/frame.hpp"

namespace planescope::io {

/// The same images in the same order make the same mesh.
class SurfaceFusion {
 public:
  virtual ~SurfaceFusion() = default;
  /// Throws Error where the camera is of a kind that it does not take.
  virtual void add(const Frame& frame, const Pose& T_world_camera) = 0;
  /// The mesh so far, PLY; coloured where the first image has colour that lies on its depth, black
  /// where a later one has none. Whole or not at all. False, and nothing written, where there is
  /// none. Throws Error naming the file.
  virtual bool write_ply(const std::filesystem::path& file) const = 0;
};

/// `voxel_m`: edge of a voxel. `max_range_m`: depth beyond it is left out; 0: none.
using SurfaceFusionMaker = std::unique_ptr<SurfaceFusion>(double voxel_m, double max_range_m);

/// Open3D's, handed over by open3d::install(). Throws Error in builds without it.
std::unique_ptr<SurfaceFusion> make_surface_fusion(double voxel_m, double max_range_m);
void set_surface_fusion(SurfaceFusionMaker* make);

}  // namespace planescope::io
