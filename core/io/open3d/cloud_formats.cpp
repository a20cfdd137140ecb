// Files that Open3D reads and io does not, and what the programs are handed of Open3D.

#include <fmt/format.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/TriangleMesh.h>
#include <open3d/io/PointCloudIO.h>
#include <open3d/io/TriangleMeshIO.h>
#include <open3d/utility/Logging.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/open3d/convert.hpp"
#include "core/io/open3d/fusion.hpp"
#include "core/io/open3d/install.hpp"
#include "core/io/open3d/ransac.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/random.hpp"

namespace planescope::open3d {
namespace {

namespace fs = std::filesystem;
using ::open3d::geometry::PointCloud;
using ::open3d::geometry::TriangleMesh;

constexpr double kPointsPerSquareMetre = 1e4;
constexpr double kFewestPoints = 1e4, kMostPoints = 2e6;

/// Open3D and what it reads with throw whatever they like.
template <typename Read>
void read_or_throw(const fs::path& path, const char* what, Read read) {
  std::string why = "nothing that Open3D can read";
  try {
    if (read()) return;
  } catch (const std::exception& error) {
    why = error.what();
  }
  throw Error(fmt::format("{}: {}, expected {}", path.string(), why, what));
}

/// Open3D makes room for as many points as the first line says. Throws Error for read_or_throw().
void check_pts_count(const fs::path& path) {
  std::ifstream file = open_to_read(path);
  double count = 0;
  file >> count;
  constexpr double kFewestBytes = 6;  // "0 0 0\n"
  const std::uintmax_t bytes = fs::file_size(path);
  if (!file || !(count >= 0 && count * kFewestBytes <= static_cast<double>(bytes)))
    throw Error(fmt::format("a first line that does not count the points of {} bytes", bytes));
}

double area_m2(const TriangleMesh& mesh, const Eigen::Vector3i& triangle) {
  const Vec3d& a = mesh.vertices_[triangle[0]];
  const Vec3d& b = mesh.vertices_[triangle[1]];
  const Vec3d& c = mesh.vertices_[triangle[2]];
  const double area = 0.5 * (b - a).cross(c - a).norm();
  return std::isfinite(area) ? area : 0;
}

/// Not Open3D's own sampling, which draws from a random sequence that all its users share.
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

/// .xyz: x y z on every line. .pts: a count, then x y z, intensity and colour on every line.
PointSet read_points(const fs::path& path) {
  constexpr const char* kExpected = "a text of points, x y z on each line";
  PointCloud cloud;
  read_or_throw(path, kExpected, [&] {
    if (io::extension(path) == ".pts") check_pts_count(path);
    return ::open3d::io::ReadPointCloud(path.string(), cloud) && !cloud.IsEmpty();
  });
  return from_open3d(cloud);
}

/// .obj, .stl, .off: a mesh in metres as points on its triangles, one per square centimetre (at
/// least 10 000, at most two million), with the vertices' colours. The same file gives the same
/// points.
PointSet read_mesh(const fs::path& path) {
  TriangleMesh mesh;
  double surface_m2 = 0;
  read_or_throw(path, "a mesh of triangles", [&] {
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
  io::set_surface_fusion(make_fusion);
  for (const char* points : {".xyz", ".pts"}) io::add_cloud_format({points, read_points});
  for (const char* mesh : {".obj", ".stl", ".off"}) io::add_cloud_format({mesh, read_mesh});
}

}  // namespace planescope::open3d
