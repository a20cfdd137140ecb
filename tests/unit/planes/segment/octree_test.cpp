// Tests of Morton codes, octree cells and neighbors.

#include "core/planes/segment/octree.hpp"

#include <gtest/gtest.h>

#include <set>

#include "core/model/morton.hpp"
#include "core/model/random.hpp"
#include "core/planes/segment/cells.hpp"
#include "support/image_octree.hpp"
#include "support/scenes.hpp"

namespace planescope::planes {
namespace {

TEST(Morton, CodesSurviveARoundTrip) {
  Random random(3);
  for (int i = 0; i < 1000; ++i) {
    const auto x = static_cast<std::uint32_t>(random.integer(0, (1 << 21) - 1));
    const auto y = static_cast<std::uint32_t>(random.integer(0, (1 << 21) - 1));
    const auto z = static_cast<std::uint32_t>(random.integer(0, (1 << 21) - 1));
    EXPECT_EQ(morton_cell(morton_code(x, y, z)), (std::array<std::uint32_t, 3>{x, y, z}));
  }
  EXPECT_EQ(morton_code(1, 0, 0), 1u);
  EXPECT_EQ(morton_code(0, 1, 0), 2u);
  EXPECT_EQ(morton_code(0, 0, 1), 4u);
}

/// The whole tree, divided down to its leaves.
Octree full_tree(const test::LabeledCloud& cloud) {
  Octree octree = build_octree(cloud.points, cloud.labels, cloud.cube);
  for (std::int32_t i = 0; i < static_cast<std::int32_t>(octree.nodes.size()); ++i)
    if (octree.nodes[i].depth < cloud.cube.max_depth) divide(octree, i);
  return octree;
}

TEST(Octree, CornersOfACubeFollowFromItsLowerCornerAndEdge) {
  const Octree octree = full_tree(test::random_cloud(5));
  for (const OctreeNode& node : octree.nodes) {
    const Vec3d low = octree.node_min(node);
    const double edge = octree.node_edge_m(node);
    const auto corners = cell_corners(octree, node);
    for (unsigned i = 0; i < 8; ++i) {
      const Vec3d at = low + edge * Vec3d(i & 1, (i >> 1) & 1, (i >> 2) & 1);
      EXPECT_EQ(corners[i], at.cast<float>());
    }
    EXPECT_TRUE(cell_center(octree, node).isApprox(low + Vec3d::Constant(edge / 2)));
  }
  EXPECT_EQ(cell_size_text(octree, 0), "3.2 m");
  EXPECT_EQ(cell_size_text(octree, 6), "5 cm");
}

TEST(Octree, CornersOfAFrustumProjectToTheLimitsOfItsCell) {
  const Octree octree = test::image_octree();
  const ImageSpace& image = *octree.image;
  const Pose T_camera_local = image.T_local_camera.inverse();
  for (const OctreeNode& node : octree.nodes) {
    const auto cell = morton_cell(node.code);
    const double side_px = 64.0 / (1 << node.depth);
    const auto corners = cell_corners(octree, node);
    for (unsigned i = 0; i < 8; ++i) {
      const Vec3d p = T_camera_local * corners[i].cast<double>();
      EXPECT_NEAR(image.fx * p.x() / p.z() + image.cx, side_px * (cell[0] + (i & 1)), 1e-3);
      EXPECT_NEAR(image.fy * p.y() / p.z() + image.cy, side_px * (cell[1] + ((i >> 1) & 1)), 1e-3);
      const double rho = side_px / 64 * (cell[2] + ((i & 4) != 0 ? 0 : 1));
      EXPECT_NEAR(p.z(), std::min(image.farthest_m, 1 / rho), 1e-4) << "finite where rho is 0";
    }
    const Bounds bounds = cell_bounds(octree, node);
    const auto holds = [&](const Vec3d& at) {
      return (at - bounds.min).minCoeff() > -1e-4 && (bounds.max - at).minCoeff() > -1e-4;
    };
    for (std::uint32_t k = node.begin; k < node.end; ++k)
      ASSERT_TRUE(holds(image.from_local(octree.points[k].cast<double>())));
    EXPECT_TRUE(holds(image.from_local(cell_center(octree, node))));
  }
  EXPECT_EQ(cell_size_text(octree, 0), "64 px × 1 1/m");
  EXPECT_EQ(cell_size_text(octree, 2), "16 px × 0.25 1/m");
}

TEST(Octree, PointsOnTheCubesFacesBelongToIt) {
  Cube cube;
  const std::vector<Vec3f> points{{0, 0, 0}, {3.2f, 3.2f, 3.2f}, {1.6f, 0, 3.2f}};
  const std::vector<Label> labels(3, Label::h);
  const Octree octree = build_octree(points, labels, cube);
  EXPECT_EQ(octree.keys.back(), morton_code(255, 255, 255));
}

/// Near cells and far cells are looked up in different ways.
TEST(Cells, NeighborsAreTheTouchingCells) {
  for (const int max_depth : {5, 21}) {
    Cube cube;
    cube.max_depth = max_depth;
    cube.edge_m = 0.02 * (1 << max_depth);
    cube.min_corner = Vec3d::Zero();
    Random random(7);
    std::vector<Vec3f> points;
    for (int i = 0; i < 300; ++i) {  // around the cube's corners, where few cells have neighbors
      const auto coordinate = [&] {
        const double in_corner = random.uniform(0, 0.12);
        return random.integer(0, 1) == 0 ? in_corner : cube.edge_m - 0.001 - in_corner;
      };
      points.push_back(Vec3d(coordinate(), coordinate(), coordinate()).cast<float>());
    }
    const Octree octree = build_octree(points, std::vector<Label>(points.size(), Label::h), cube);
    const CellGrid grid = make_cell_grid(octree, 0);
    for (std::uint32_t a = 0; a < grid.size(); ++a) {
      const auto place = [&](std::uint32_t c) {
        const auto cell = morton_cell(octree.keys[grid.starts[c]]);
        return Vec3d(cell[0], cell[1], cell[2]);
      };
      std::set<std::uint32_t> touching;
      for (std::uint32_t b = 0; b < grid.size(); ++b)
        if ((place(a) - place(b)).cwiseAbs().maxCoeff() <= 1) touching.insert(b);
      EXPECT_EQ(std::set<std::uint32_t>(grid.neighbors.begin() + grid.neighbor_first[a],
                                        grid.neighbors.begin() + grid.neighbor_first[a + 1]),
                touching);
    }
  }
}

}  // namespace
}  // namespace planescope::planes
