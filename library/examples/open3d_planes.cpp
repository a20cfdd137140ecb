// Converts an Open3D cloud, with z up, to a mesh of its planes: open3d_planes CLOUD [MESH.ply]

#include <open3d/io/PointCloudIO.h>
#include <open3d/io/TriangleMeshIO.h>

#include <cstdio>
#include <planescope/open3d.hpp>

int main(int argc, char** argv) try {
  if (argc < 2) throw planescope::Error("expected CLOUD [MESH.ply]");
  open3d::geometry::PointCloud cloud;
  if (!open3d::io::ReadPointCloud(argv[1], cloud))
    throw planescope::Error(std::string(argv[1]) + ": Open3D cannot read it");

  const planescope::Result result = planescope::segment(planescope::from_open3d(cloud));
  const auto clouds = planescope::planes_to_open3d(result);
  for (const planescope::Plane& plane : result.planes())
    std::printf("plane %d: normal %.3f %.3f %.3f, %zu points, %.2f m2\n", plane.id, plane.normal[0],
                plane.normal[1], plane.normal[2], clouds[plane.id - 1].points_.size(),
                plane.outline.area_m2);
  const open3d::geometry::TriangleMesh mesh = planescope::mesh_to_open3d(result);
  std::printf("%zu triangles\n", mesh.triangles_.size());
  if (argc > 2 && !open3d::io::WriteTriangleMesh(argv[2], mesh))
    throw planescope::Error(std::string(argv[2]) + ": Open3D cannot write it");
  return 0;
} catch (const planescope::Error& error) {
  std::fprintf(stderr, "open3d_planes: %s\n", error.what());
  return 2;
}
