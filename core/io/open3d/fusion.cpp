#include "core/io/open3d/fusion.hpp"

#include <open3d/camera/PinholeCameraIntrinsic.h>
#include <open3d/geometry/RGBDImage.h>
#include <open3d/geometry/TriangleMesh.h>
#include <open3d/io/TriangleMeshIO.h>
#include <open3d/pipelines/integration/ScalableTSDFVolume.h>

#include <stdexcept>
#include <system_error>

#include "core/io/open3d/convert.hpp"
#include "core/model/error.hpp"

namespace planescope::open3d {
namespace {

constexpr double kTruncation = 4;  // voxels

using ::open3d::pipelines::integration::ScalableTSDFVolume;
using ::open3d::pipelines::integration::TSDFVolumeColorType;

class Fusion : public io::SurfaceFusion {
 public:
  Fusion(double voxel_m, double max_range_m) : voxel_m_(voxel_m), max_range_m_(max_range_m) {}
  void add(const Frame& frame, const Pose& T_world_camera) override;
  bool write_ply(const std::filesystem::path& file) const override;

 private:
  double voxel_m_, max_range_m_;
  // Of the kind that the first image asks for: a volume has colour or has none.
  std::unique_ptr<ScalableTSDFVolume> volume_;
  bool colored_ = false;
};

void Fusion::add(const Frame& frame, const Pose& T_world_camera) {
  ::open3d::geometry::RGBDImage image = to_open3d(frame);
  if (max_range_m_ > 0)
    for (int v = 0; v < image.depth_.height_; ++v)
      for (int u = 0; u < image.depth_.width_; ++u) {
        float& depth = *image.depth_.PointerAt<float>(u, v);
        if (static_cast<double>(depth) > max_range_m_) depth = 0;
      }
  if (!volume_) {
    colored_ = !image.color_.IsEmpty();
    volume_ = std::make_unique<ScalableTSDFVolume>(
        voxel_m_, kTruncation * voxel_m_,
        colored_ ? TSDFVolumeColorType::RGB8 : TSDFVolumeColorType::NoColor);
  }
  if (colored_ && image.color_.IsEmpty())
    image.color_.Prepare(image.depth_.width_, image.depth_.height_, 3, 1);
  volume_->Integrate(image, to_open3d(frame.intrinsics), T_world_camera.inverse().matrix());
}

bool Fusion::write_ply(const std::filesystem::path& file) const {
  if (!volume_) return false;
  std::filesystem::path unfinished = file;
  unfinished += ".unfinished.ply";
  std::error_code failed;
  try {
    const auto mesh = volume_->ExtractTriangleMesh();
    if (!mesh || mesh->triangles_.empty()) return false;
    mesh->ComputeVertexNormals();
    if (::open3d::io::WriteTriangleMesh(unfinished.string(), *mesh))
      std::filesystem::rename(unfinished, file, failed);
    else
      failed = std::make_error_code(std::errc::io_error);
  } catch (const std::runtime_error&) {  // Open3D's
    failed = std::make_error_code(std::errc::io_error);
  }
  if (!failed) return true;
  std::error_code ignored;
  std::filesystem::remove(unfinished, ignored);
  throw Error(file.string() + ": cannot be written: " + failed.message());
}

}  // namespace

std::unique_ptr<io::SurfaceFusion> make_fusion(double voxel_m, double max_range_m) {
  return std::make_unique<Fusion>(voxel_m, max_range_m);
}

}  // namespace planescope::open3d
