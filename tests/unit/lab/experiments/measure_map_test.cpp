// Tests of scoring maps against measured cuboids.

#include "core/lab/experiments/measure_map.hpp"

#include <gtest/gtest.h>

#include "core/model/file_bytes.hpp"
#include "support/refusal.hpp"
#include "support/temp_dir.hpp"

namespace planescope::lab {
namespace {

// A box of 1 m width, depth and height.
const Cuboid kBox{{0, 0, 0.5}, 0, {0.5, 0.5, 0.5}};

/// A camera at (3, 0, 0.5) that looks at the box along -x, in three frames of the first segment.
void write_poses(const std::filesystem::path& map) {
  std::string poses;
  for (int frame = 0; frame < 5; ++frame)
    poses += "# frame " + std::to_string(frame) + " segment 0\n" + std::to_string(frame) +
             " 3 0 0.5 -0.5 -0.5 0.5 0.5\n";
  write_file_text(map / "poses.tum", poses);
  write_file_text(map / "tracks.json", R"({"frames": [{"frame": 0, "segment": 0},
      {"frame": 1, "segment": 0}, {"frame": 2, "segment": 0},
      {"frame": 3, "segment": 0, "set_aside": true}, {"frame": 4, "segment": 1}]})");
}
std::string plane(const char* normal, const char* centroid, const char* state = "sure") {
  return std::string(R"({"segment": 0, "state": ")") + state + R"(", "normal": )" + normal +
         R"(, "centroid": )" + centroid + R"(, "area_m2": 0.9})";
}

TEST(MapTruth, CountsMissingDuplicateAndDisplacedFacesAndOtherPlanes) {
  write_poses(temp_dir());
  write_file_text(temp_dir() / "map.json", R"({"planes": [)" +
                                               plane("[1, 0, 0]", "[0.52, 0, 0.5]") + "," +
                                               plane("[1, 0, 0]", "[0.45, 0.2, 0.5]") + "," +
                                               plane("[1, 0, 0]", "[0.5, 0, 0.5]", "gone") + "," +
                                               plane("[0, 0, 1]", "[5, 5, 0]") + "," +
                                               plane("[0, 0, 1]", "[0, 0, 3]") + "]}");
  const MapTruthScore score = measure_map_truth(temp_dir(), std::vector{kBox});
  ASSERT_EQ(score.faces.size(), 6u);
  const FaceScore &floor = score.faces[0], &front = score.faces[1], &back = score.faces[2];
  EXPECT_EQ(floor.planes, 1);
  EXPECT_EQ(front.name, "cuboid 1 +x");
  EXPECT_EQ(front.frames, 3);
  EXPECT_EQ(front.planes, 2) << "one of them twice, the one that was taken away not";
  EXPECT_NEAR(front.offset_m, 0.02, 1e-9);
  EXPECT_EQ(back.frames, 0) << "out of sight";
  EXPECT_FALSE(back.is_missing());
  EXPECT_EQ(score.elsewhere, 1);

  write_file_text(temp_dir() / "map.json", R"({"planes": []})");
  EXPECT_TRUE(measure_map_truth(temp_dir(), std::vector{kBox}).faces[1].is_missing());
}

TEST(MapTruth, DamagedCuboidsAreRejectedWithTheirLine) {
  const std::filesystem::path file = temp_dir() / "boxes.txt";
  const auto refusal = [&](const char* text) {
    write_file_text(file, text);
    return message_of([&] { read_cuboids(file); });
  };
  EXPECT_EQ(
      refusal("# none\n"),
      file.string() + ": contains no cuboids; expected lines with x, y, z, yaw, and half sizes");
  EXPECT_EQ(refusal("# one\n0 0 1 0 1 1\n"),
            file.string() + ", line 2: 6 words; expected x y z yaw and three half sizes");
  EXPECT_EQ(
      refusal("0 0 1 0 1 1 nan\n"),
      file.string() + ", line 1: 'nan' is not a number; expected x y z yaw and three half sizes");
  EXPECT_EQ(refusal("0 0 1 0 1 1 0\n"), file.string() + ", line 1: a half size is not above 0");
}

}  // namespace
}  // namespace planescope::lab
