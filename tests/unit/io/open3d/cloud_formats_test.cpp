// Tests of the cloud and mesh formats that Open3D reads.

#include "core/io/cloud_files/cloud_file.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

/// A square of 2 m by 2 m at z = 1, made of two triangles.
constexpr const char* kSquareOff = "OFF\n4 2 0\n0 0 1\n2 0 1\n2 2 1\n0 2 1\n3 0 1 2\n3 0 2 3\n";
constexpr const char* kSquareObj = "v 0 0 1\nv 2 0 1\nv 2 2 1\nv 0 2 1\nf 1 2 3\nf 1 3 4\n";
constexpr const char* kTriangleStl =
    "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 2 0 1\nvertex 2 2 1\n"
    "endloop\nendfacet\nendsolid t\n";

fs::path written(const std::string& name, const std::string& text) {
  const fs::path path = temp_folder() / name;
  write_text(path, text);
  return path;
}

PointSet only_frame(const fs::path& path) {
  const auto recording = open_recording(path);
  EXPECT_EQ(recording->frame_count(), 1);
  EXPECT_EQ(recording->info().format, "point cloud");
  return *recording->frame(0).cloud;
}

TEST(Open3dFormats, PointsOfTextFilesKeepTheirOrder) {
  const PointSet xyz = only_frame(written("a.xyz", "1 2 3\n-4.5 5 0\n"));
  ASSERT_EQ(xyz.points.size(), 2u);
  EXPECT_EQ(xyz.points[1], Vec3f(-4.5f, 5, 0));
  const PointSet pts = only_frame(written("b.pts", "2\n1 2 3 7 255 0 16\n4 5 6 7 1 2 3\n"));
  ASSERT_EQ(pts.points.size(), 2u);
  EXPECT_EQ(pts.points[0], Vec3f(1, 2, 3));
  EXPECT_EQ(pts.rgb, (std::vector<std::uint8_t>{255, 0, 16, 1, 2, 3}));
}

TEST(Open3dFormats, MeshesAreSampledAllOverTheirTriangles) {
  for (const auto& [name, text, area_m2] : {std::tuple{"a.off", kSquareOff, 4.0},
                                            {"a.obj", kSquareObj, 4.0},
                                            {"a.stl", kTriangleStl, 2.0}}) {
    SCOPED_TRACE(name);
    const PointSet set = only_frame(written(name, text));
    EXPECT_EQ(set.points.size(), static_cast<std::size_t>(1e4 * area_m2));
    std::size_t lower = 0;
    for (const Vec3f& p : set.points) {
      EXPECT_FLOAT_EQ(p.z(), 1);
      EXPECT_TRUE(p.x() >= 0 && p.x() <= 2 && p.y() >= 0 && p.y() <= 2);
      lower += p.y() < 1;
    }
    const double expected = area_m2 == 4 ? 0.5 : 0.75;
    EXPECT_NEAR(static_cast<double>(lower) / static_cast<double>(set.points.size()), expected,
                0.02);
  }
}

TEST(Open3dFormats, TheSameMeshGivesTheSamePoints) {
  const auto recording = open_recording(written("a.off", kSquareOff));
  EXPECT_EQ(recording->frame_hash(0), recording->frame_hash(0));
  EXPECT_EQ(recording->frame(0).cloud->points, recording->frame(0).cloud->points);
}

TEST(Open3dFormats, AFolderOfThemIsARecordingUnlessItContainsPlyOrPcd) {
  const fs::path folder = temp_folder();
  for (const char* name : {"10.xyz", "2.xyz"}) write_text(folder / name, "1 2 3\n");
  const auto recording = open_recording(folder);
  ASSERT_EQ(recording->frame_count(), 2);
  EXPECT_EQ(recording->frame(0).name, "2");
  PointSet scan;
  scan.points = {{1, 2, 3}};
  write_ply(folder / "scan.ply", scan);
  EXPECT_EQ(open_recording(folder)->frame_count(), 1);
}

TEST(Open3dFormats, EmptyFilesAreRejectedInOneLine) {
  const auto expect_refused = [](const char* name, const std::string& text) {
    SCOPED_TRACE(std::string(name) + ": " + text);
    const fs::path path = written(name, text);
    expect_one_line_with(message_of([&] { open_recording(path)->frame(0); }), {name, "expected"});
  };
  for (const char* name : {"a.xyz", "a.pts", "a.off", "a.obj", "a.stl"})
    for (const char* text : {"", "nothing here\n", "99999999999999\n"}) expect_refused(name, text);
  expect_refused("cut.off", "OFF\n99999999 1 0\n1 2 3\n");
  expect_refused("flat.off", "OFF\n3 1 0\n0 0 1\n1 0 1\n2 0 1\n3 0 1 2\n");
}

TEST(Open3dFormats, HaveNoPlaneField) {
  RecordingOptions options;
  options.instance_field = "intensity";
  const auto recording = open_recording(written("a.xyz", "1 2 3\n"), options);
  expect_one_line_with(message_of([&] { recording->frame(0); }), {"a.xyz", "'intensity'"});
}

TEST(Open3dFormats, AreListedInTheErrorForUnknownFormats) {
  expect_one_line_with(message_of([&] { open_recording(written("a.doc", "x")); }),
                       {".xyz", ".off"});
}

}  // namespace
}  // namespace planescope::io
