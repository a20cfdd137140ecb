#include "core/io/open3d/convert.hpp"

#include <gtest/gtest.h>
#include <open3d/camera/PinholeCameraIntrinsic.h>
#include <open3d/geometry/LineSet.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/geometry/RGBDImage.h>
#include <open3d/geometry/TriangleMesh.h>

#include "core/model/error.hpp"

namespace planescope::open3d {
namespace {

Frame small_frame() {
  Frame frame;
  frame.depth = Image16(4, 3);
  frame.depth_unit_m = 0.001;
  for (int i = 0; i < 12; ++i) frame.depth.data[i] = static_cast<std::uint16_t>(1000 + 7 * i);
  frame.depth.at(1, 1) = 0;
  frame.intrinsics = {4, 3, 5.5, 6, 1.5, 1, Distortion::none, {}};
  frame.color = Image8(4, 3, 3);
  for (std::size_t i = 0; i < frame.color.data.size(); ++i)
    frame.color.data[i] = static_cast<std::uint8_t>(i);
  frame.color_aligned = true;
  return frame;
}

TEST(Convert, AFrameComesBackAndOpen3dSeesItsPointsWhereWeDo) {
  const Frame frame = small_frame();
  const auto image = to_open3d(frame);
  const auto camera = to_open3d(frame.intrinsics);
  const Frame back = from_open3d(image, camera, frame.depth_unit_m);
  EXPECT_EQ(back.depth.data, frame.depth.data);
  EXPECT_EQ(back.color.data, frame.color.data);
  EXPECT_TRUE(back.color_aligned);
  EXPECT_EQ(back.intrinsics.fx, 5.5);
  EXPECT_EQ(back.intrinsics.cy, 1);
  const auto cloud = ::open3d::geometry::PointCloud::CreateFromRGBDImage(image, camera);
  ASSERT_EQ(cloud->points_.size(), 11u);
  EXPECT_NEAR(cloud->points_[0].z(), 1, 1e-6);
  EXPECT_NEAR(cloud->points_[0].x(), -1.5 / 5.5, 1e-6);
}

TEST(Convert, WhatWasNotMeasuredIsNoDepth) {
  Frame frame = small_frame();
  frame.depth.at(0, 0) = 65535;
  EXPECT_EQ(*to_open3d(frame).depth_.PointerAt<float>(0, 0), 0);
  EXPECT_EQ(*to_open3d(frame).depth_.PointerAt<float>(1, 1), 0);
}

TEST(Convert, WhatOpen3dCannotExpressIsRefused) {
  Intrinsics bent = small_frame().intrinsics;
  bent.distortion = Distortion::brown_conrady;
  EXPECT_THROW(to_open3d(bent), Error);
  Intrinsics large = small_frame().intrinsics;
  large.width = 640;
  EXPECT_THROW(from_open3d(to_open3d(small_frame()), to_open3d(large)), Error);
}

TEST(Convert, ACloudComesBackWithItsColoursAndItsOrigin) {
  PointSet set;
  set.origin = Vec3d(4000, -500, 20);
  set.points = {{0.5f, 1, 2}, {-0.5f, -1, -2}};
  set.rgb = {1, 2, 3, 250, 251, 255};
  const auto cloud = to_open3d(set);
  EXPECT_EQ(cloud.points_[0], Vec3d(4000.5, -499, 22));
  const PointSet back = from_open3d(cloud);
  EXPECT_EQ(back.rgb, set.rgb);
  EXPECT_EQ(back.origin, set.origin);
  EXPECT_EQ(back.points, set.points);
}

TEST(Convert, EachPlaneHasItsPointsInTheWorldAndItsNormal) {
  planes::FrameResult result;
  result.cloud.origin = Vec3d(1, 0, 0);
  result.cloud.points = {{0, 0, 0}, {1, 1, 1}, {2, 0, 0}};
  result.plane_of = {2, 0, 2};
  result.segmentation.planes.resize(2);
  result.segmentation.planes[1].fit.normal = Vec3d::UnitX();
  const auto clouds = planes_to_open3d(result);
  ASSERT_EQ(clouds.size(), 2u);
  EXPECT_TRUE(clouds[0].points_.empty());
  EXPECT_EQ(clouds[1].points_, (std::vector<Vec3d>{{1, 0, 0}, {3, 0, 0}}));
  EXPECT_EQ(clouds[1].normals_, (std::vector<Vec3d>(2, Vec3d::UnitX())));
  EXPECT_EQ(to_open3d(result.cloud).points_[1], Vec3d(2, 1, 1));
}

TEST(Convert, HullsAreOutlinesAndFacesAndOutlinesComeBack) {
  const std::vector<Polygon> hulls = {{{0, 0, 0}, {2, 0, 0}, {2, 1, 0}, {0, 1, 0}},
                                      {{0, 0, 1}, {1, 0, 1}},  // no polygon
                                      {{0, 0, 3}, {1, 0, 3}, {0, 1, 3}}};
  const auto lines = outlines_to_open3d(hulls);
  EXPECT_EQ(lines.lines_.size(), 7u);
  EXPECT_EQ(outlines_from_open3d(lines), (std::vector<Polygon>{hulls[0], hulls[2]}));
  const auto mesh = faces_to_open3d(hulls);
  EXPECT_EQ(mesh.triangles_.size(), 3u);
  EXPECT_NEAR(mesh.GetSurfaceArea(), 2.5, 1e-12);
}

TEST(Convert, WhatAPlaneCoversIsAMeshAndItsRingsAreLines) {
  planes::Outline outline;
  outline.origin = Vec3d(1, 2, 3);
  outline.basis = plane_basis(Vec3d(0, 0.6, 0.8));
  outline.parts.push_back({{{0, 0}, {3, 0}, {3, 2}, {0, 2}},
                           {{{1, 1}, {1, 1.5}, {2, 1.5}, {2, 1}}},
                           {{{0.2, 0.2}, {0.2, 0.4}, {0.4, 0.4}, {0.4, 0.2}}}});
  const std::vector<planes::Outline> outlines = {outline, outline};
  EXPECT_EQ(outlines_from_open3d(outlines_to_open3d(outlines)).size(), 6u);
  auto mesh = mesh_to_open3d(outlines);
  EXPECT_NEAR(mesh.GetSurfaceArea(), 2 * (6 - 0.5 - 0.04), 1e-12);
  mesh.ComputeTriangleNormals();
  for (const Vec3d& normal : mesh.triangle_normals_)
    EXPECT_NEAR(normal.dot(Vec3d(0, 0.6, 0.8)), 1, 1e-12);
}

}  // namespace
}  // namespace planescope::open3d
