// Open3D's own readers on our files: the tensor readers keep unknown fields.

#include <open3d/t/io/PointCloudIO.h>

#include "unit/labels/exchange_fixture.hpp"

namespace planescope::labels {
namespace {

TEST_F(Exchange, Open3dReadsTheFieldsOfPlyAndPcd) {
  const LabeledPoints points = points_of_labels(labels, grid);
  for (const LabelFormat format : {LabelFormat::ply, LabelFormat::pcd}) {
    SCOPED_TRACE(to_string(format));
    const auto path = write_labeled(dir / "frame", format, points).at(0);
    ::open3d::t::geometry::PointCloud cloud;
    ASSERT_TRUE(
        ::open3d::t::io::ReadPointCloud(path.string(), cloud, {"auto", false, false, false}));
    ASSERT_EQ(cloud.GetPointPositions().GetLength(), static_cast<std::int64_t>(points.size()));
    for (const char* field : {"label", "instance", "u", "v"})
      ASSERT_TRUE(cloud.HasPointAttr(field)) << field;
    const auto classes = cloud.GetPointAttr("label").ToFlatVector<std::uint8_t>();
    const auto instances = cloud.GetPointAttr("instance").ToFlatVector<std::int32_t>();
    const auto u = cloud.GetPointAttr("u").ToFlatVector<std::int32_t>();
    const auto v = cloud.GetPointAttr("v").ToFlatVector<std::int32_t>();
    EXPECT_EQ(classes, points.label);
    EXPECT_EQ(instances, points.instance);
    for (std::size_t i = 0; i < points.size(); ++i) {
      EXPECT_EQ(u[i], points.pixel[i].u);
      EXPECT_EQ(v[i], points.pixel[i].v);
    }
  }
}

}  // namespace
}  // namespace planescope::labels
