// Reads more file formats through Open3D, and wraps the Open3D algorithms that the programs use.

#include "core/io/open3d/install.hpp"

#include <fmt/format.h>
#include <omp.h>
#include <open3d/camera/PinholeCameraIntrinsic.h>
#include <open3d/geometry/Octree.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/RGBDImage.h>
#include <open3d/geometry/TriangleMesh.h>
#include <open3d/io/PointCloudIO.h>
#include <open3d/io/TriangleMeshIO.h>
#include <open3d/pipelines/integration/ScalableTSDFVolume.h>
#include <open3d/utility/Logging.h>
#include <open3d/utility/Random.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fstream>
#include <memory>
#include <mutex>
#include <numeric>
#include <stdexcept>
#include <system_error>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/random.hpp"

namespace planescope::open3d {
namespace {

namespace fs = std::filesystem;
using ::open3d::geometry::PointCloud;
using ::open3d::geometry::TriangleMesh;

// Conversions between our types and Open3D's.

constexpr std::uint16_t kNoCount = 65535;

::open3d::camera::PinholeCameraIntrinsic to_open3d(const Intrinsics& k) {
  if (k.distortion != Distortion::none)
    throw Error("intrinsics: lens distortion is not supported by Open3D's camera");
  return {k.width, k.height, k.fx, k.fy, k.cx, k.cy};
}

/// Depth as floats [m], 0 for no measurement; with color if it is aligned to depth.
::open3d::geometry::RGBDImage to_open3d(const Frame& frame) {
  ::open3d::geometry::RGBDImage image;
  const Image16& depth = frame.depth;
  image.depth_.Prepare(depth.width, depth.height, 1, sizeof(float));
  for (int v = 0; v < depth.height; ++v)
    for (int u = 0; u < depth.width; ++u) {
      const std::uint16_t count = depth.at(u, v);
      *image.depth_.PointerAt<float>(u, v) =
          count == kNoCount ? 0.0f : static_cast<float>(count * frame.depth_unit_m);
    }
  const Image8& color = frame.color;
  if (frame.color_aligned && color.channels == 3 && color.pixels() == depth.pixels()) {
    image.color_.Prepare(color.width, color.height, 3, 1);
    std::memcpy(image.color_.data_.data(), color.data.data(), color.data.size());
  }
  return image;
}

PointSet from_open3d(const PointCloud& cloud) {
  using io::Scalar;
  std::vector<io::CloudField> fields = {{"x", Scalar::f64}, {"y", Scalar::f64}, {"z", Scalar::f64}};
  if (cloud.HasColors())
    fields.insert(fields.end(), {{"r", Scalar::f64}, {"g", Scalar::f64}, {"b", Scalar::f64}});
  io::CloudBuilder builder("Open3D cloud", fields);
  builder.reserve(cloud.points_.size());
  std::vector<double> values(fields.size());
  for (std::size_t i = 0; i < cloud.points_.size(); ++i) {
    Vec3d::Map(values.data()) = cloud.points_[i];
    if (cloud.HasColors()) Vec3d::Map(values.data() + 3) = cloud.colors_[i];
    builder.add(values);
  }
  return builder.finish();
}

// ---- Cloud formats -----------------------------------------------------------------------------

constexpr double kPointsPerSquareMetre = 1e4;
constexpr double kFewestPoints = 1e4, kMostPoints = 2e6;

/// Calls `read` and converts whatever Open3D and its libraries throw to Error.
template <typename Read>
void read_or_throw(const fs::path& path, const char* what, Read read) {
  std::string why = "no data that Open3D can read";
  try {
    if (read()) return;
  } catch (const std::exception& error) {
    why = error.what();
  }
  throw Error(fmt::format("{}: {}; expected {}", path.string(), why, what));
}

/// Open3D allocates as many points as the first line declares. Throws Error for read_or_throw().
void check_pts_count(const fs::path& path) {
  std::ifstream file = open_to_read(path);
  double count = 0;
  file >> count;
  constexpr double kFewestBytes = 6;  // "0 0 0\n"
  const std::uintmax_t bytes = fs::file_size(path);
  if (!file || !(count >= 0 && count * kFewestBytes <= static_cast<double>(bytes)))
    throw Error(fmt::format("its first line is not a valid point count for a {}-byte file", bytes));
}

double area_m2(const TriangleMesh& mesh, const Eigen::Vector3i& triangle) {
  const Vec3d& a = mesh.vertices_[triangle[0]];
  const Vec3d& b = mesh.vertices_[triangle[1]];
  const Vec3d& c = mesh.vertices_[triangle[2]];
  const double area = 0.5 * (b - a).cross(c - a).norm();
  return std::isfinite(area) ? area : 0;
}

/// Open3D's own sampling draws from one random sequence that all its users share, so avoid it.
PointCloud sampled(const TriangleMesh& mesh, double surface_m2) {
  const double count =
      std::clamp(std::round(kPointsPerSquareMetre * surface_m2), kFewestPoints, kMostPoints);
  PointCloud cloud;
  Random random(1);
  double passed_m2 = 0;
  for (const Eigen::Vector3i& triangle : mesh.triangles_) {
    passed_m2 += area_m2(mesh, triangle);
    const auto until = static_cast<std::size_t>(std::round(count * (passed_m2 / surface_m2)));
    while (cloud.points_.size() < until) {
      // Osada et al. 2002, Eq. (1): uniform on the triangle.
      const double root = std::sqrt(random.uniform()), along = random.uniform();
      const Vec3d weights(1 - root, root * (1 - along), root * along);
      const auto blend = [&](const std::vector<Vec3d>& values) -> Vec3d {
        return weights[0] * values[triangle[0]] + weights[1] * values[triangle[1]] +
               weights[2] * values[triangle[2]];
      };
      cloud.points_.push_back(blend(mesh.vertices_));
      if (mesh.HasVertexColors()) cloud.colors_.push_back(blend(mesh.vertex_colors_));
    }
  }
  return cloud;
}

/// .xyz: x y z on every line. .pts: a count, then x y z, intensity and color on every line.
PointSet read_points(const fs::path& path, io::CloudExtras*) {
  constexpr const char* kExpected = "a text file of points, with x y z on each line";
  PointCloud cloud;
  read_or_throw(path, kExpected, [&] {
    if (io::extension(path) == ".pts") check_pts_count(path);
    return ::open3d::io::ReadPointCloud(path.string(), cloud) && !cloud.IsEmpty();
  });
  return from_open3d(cloud);
}

/// .obj, .stl, .off: samples a mesh in meters, one point per square centimeter (at least 10 000, at
/// most two million), with the vertices' colors. Deterministic.
PointSet read_mesh(const fs::path& path, io::CloudExtras*) {
  TriangleMesh mesh;
  double surface_m2 = 0;
  read_or_throw(path, "a triangle mesh", [&] {
    if (!::open3d::io::ReadTriangleMesh(path.string(), mesh)) return false;
    for (const Eigen::Vector3i& triangle : mesh.triangles_) surface_m2 += area_m2(mesh, triangle);
    return surface_m2 > 0;
  });
  return from_open3d(sampled(mesh, surface_m2));
}

}  // namespace

void install() {
  ::open3d::utility::SetVerbosityLevel(::open3d::utility::VerbosityLevel::Error);
  planes::set_ransac(find_planes_ransac);
  for (const char* points : {".xyz", ".pts"}) io::add_cloud_format({points, read_points});
  for (const char* mesh : {".obj", ".stl", ".off"}) io::add_cloud_format({mesh, read_mesh});
}

namespace {

constexpr double kTruncation = 4;  // voxels

using ::open3d::pipelines::integration::ScalableTSDFVolume;
using ::open3d::pipelines::integration::TSDFVolumeColorType;

class Fusion : public SurfaceFusion {
 public:
  Fusion(double voxel_m, double max_range_m) : voxel_m_(voxel_m), max_range_m_(max_range_m) {}
  void add(const Frame& frame, const Pose& T_world_camera) override;
  bool write_ply(const std::filesystem::path& file) const override;

 private:
  double voxel_m_, max_range_m_;
  // Created for the first image: a volume either has color or does not.
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

/// Binary PLY. Open3D's own writer ignores failed writes, such as those on a full disk.
void write_mesh(std::ostream& out, const TriangleMesh& mesh) {
  const bool has_color = mesh.HasVertexColors();
  out << "ply\nformat binary_little_endian 1.0\nelement vertex " << mesh.vertices_.size() << '\n';
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz"})
    out << "property double " << name << '\n';
  for (const char* name : {"red", "green", "blue"})
    if (has_color) out << "property uchar " << name << '\n';
  out << "element face " << mesh.triangles_.size()
      << "\nproperty list uchar uint vertex_indices\nend_header\n";
  const auto put = [&](const auto* values, std::size_t bytes) {
    out.write(reinterpret_cast<const char*>(values), static_cast<std::streamsize>(bytes));
  };
  for (std::size_t k = 0; k < mesh.vertices_.size(); ++k) {
    put(mesh.vertices_[k].data(), 3 * sizeof(double));
    put(mesh.vertex_normals_[k].data(), 3 * sizeof(double));
    for (int c = 0; has_color && c < 3; ++c)
      out.put(
          static_cast<char>(std::lround(255 * std::clamp(mesh.vertex_colors_[k][c], 0.0, 1.0))));
  }
  for (const Eigen::Vector3i& triangle : mesh.triangles_) {
    out.put(3);
    put(triangle.data(), 3 * sizeof(int));
  }
}

bool Fusion::write_ply(const std::filesystem::path& file) const {
  const auto mesh = volume_ ? volume_->ExtractTriangleMesh() : nullptr;
  if (!mesh || mesh->triangles_.empty()) return false;
  mesh->ComputeVertexNormals();
  write_file_stream(file, [&](std::ostream& out) { write_mesh(out, *mesh); });
  return true;
}

}  // namespace

std::unique_ptr<SurfaceFusion> make_surface_fusion(double voxel_m, double max_range_m) {
  return std::make_unique<Fusion>(voxel_m, max_range_m);
}

}  // namespace planescope::open3d

// Sun et al. 2023, Sec. V-C 1: "we set the maximum number of iterations to 1000 and excluded plane
// candidates with fewer than 50 points".

namespace planescope::open3d {
namespace {

/// Open3D's RANSAC divides its iterations among OpenMP threads, which draw random numbers in any
/// order. The setting applies only to the calling thread.
class OneThread {
 public:
  OneThread() { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_ = omp_get_max_threads();
};

}  // namespace

planes::FoundPlanes find_planes_ransac(std::span<const Vec3f> points,
                                       const planes::RansacOptions& options) {
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  const OneThread one_thread;
  ::open3d::utility::random::Seed(options.seed);

  ::open3d::geometry::PointCloud rest;
  rest.points_.reserve(points.size());
  for (const Vec3f& p : points) rest.points_.push_back(p.cast<double>());
  std::vector<std::size_t> index(points.size());  // index in `points` of each point of `rest`
  std::iota(index.begin(), index.end(), std::size_t{0});

  std::vector<std::int32_t> group(points.size(), 0);
  const std::size_t min_points = std::max(options.min_points, 3);
  for (std::int32_t id = 1; rest.points_.size() >= min_points; ++id) {
    // A probability below 1 would stop the search early. The paper's speed (3.1 frames per second)
    // includes all iterations.
    constexpr double kProbability = 1;
    const auto [plane, inliers] =
        rest.SegmentPlane(options.theta_pf_m, 3, options.iterations, kProbability);
    const bool spans_plane = !plane.isZero(0);  // points on one line: no plane, all inliers
    if (!spans_plane || inliers.size() < min_points) break;

    std::vector<bool> taken(index.size(), false);
    for (const std::size_t i : inliers) {
      taken[i] = true;
      group[index[i]] = id;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < index.size(); ++i) {
      if (taken[i]) continue;
      index[kept] = index[i];
      rest.points_[kept++] = rest.points_[i];
    }
    index.resize(kept);
    rest.points_.resize(kept);
  }
  return planes::found_planes(points, group);
}

std::function<void()> voxel_down_sample(const planes::Cloud& cloud, double voxel_size_m) {
  const auto theirs = std::make_shared<::open3d::geometry::PointCloud>();
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.kept[i]) theirs->points_.push_back(cloud.points[i].cast<double>());
  return [theirs, voxel_size_m] { theirs->VoxelDownSample(voxel_size_m); };
}

std::function<void()> pointer_octree(std::span<const Vec3f> points, const planes::Cube& cube) {
  const auto theirs = std::make_shared<::open3d::geometry::PointCloud>();
  for (const Vec3f& p : points) theirs->points_.push_back(p.cast<double>());
  return [theirs, depth = static_cast<std::size_t>(cube.max_depth)] {
    ::open3d::geometry::Octree octree(depth);
    octree.ConvertFromPointCloud(*theirs, 0.0);
  };
}

}  // namespace planescope::open3d
