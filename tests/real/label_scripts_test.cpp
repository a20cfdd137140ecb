// Compares the method with its earlier results on real frames labeled in truth/, and the label
// tools with the truth, by repeating the gestures in labels/. Recordings are read from
// $PLANESCOPE_DATA.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/io/recording.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/labels/review/review.hpp"
#include "support/temp_dir.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path kReal = fs::path(PLANESCOPE_SOURCE_DIR) / "tests" / "real";
const fs::path kFolder = kReal / "labels";

/// A line of list.txt.
struct Labeled {
  std::string name, half, recording, options;
  int frame = 0;
};

void PrintTo(const Labeled& labeled, std::ostream* out) { *out << labeled.name; }

std::vector<Labeled> read_list() {
  std::ifstream file(kFolder / "list.txt");
  std::vector<Labeled> all;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    std::istringstream words(line);
    Labeled one;
    words >> one.name >> one.half >> one.recording >> one.frame;
    std::getline(words, one.options);
    all.push_back(one);
  }
  return all;
}

/// Runs the program and returns its exit code; its messages appear in the test's log.
int run(const std::string& arguments) {
  const int status =
      std::system(fmt::format("'{}' {} </dev/null", PLANESCOPE_BINARY, arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// Expects that the frame's scores are not below floors.json, which contains earlier scores minus a
/// small margin. Raise them after improvements.
void expect_what_was_reached(const std::string& name, const fs::path& eval) {
  std::ifstream file(kFolder / "floors.json"), scored(eval);
  const Json floors = Json::parse(file).at(name);
  const Json frame = Json::parse(scored).at("frames").at(0);
  for (const char* least : {"mean_iou", "pq", "detected_iou80"})
    EXPECT_GE(frame.at(least).get<double>(), floors.at(least).get<double>()) << least;
  EXPECT_LE(frame.at("ghosts").get<int>() + frame.at("pieces").get<int>(),
            floors.at("found_for_nothing").get<int>());
}

/// The frame and the label folder as arguments of the program.
std::string frame_with(const Labeled& labeled, const fs::path& recording, const fs::path& labels) {
  return fmt::format("'{}' --labels '{}' --frames {} {}", recording.string(), labels.string(),
                     labeled.frame, labeled.options);
}

class LabeledFrame : public testing::TestWithParam<Labeled> {};

TEST_P(LabeledFrame, ScoresAtLeastAsWellAsBefore) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const Labeled& labeled = GetParam();
  const fs::path recording = fs::path(data) / labeled.recording;
  const fs::path truth = kReal / "truth" / labeled.name;
  const fs::path scores = temp_dir() / ("planescope_" + labeled.name + "_eval.json");
  // Checks that nothing is damaged. Findings are allowed, because real surfaces bow.
  EXPECT_LE(run(fmt::format("labels check '{}' --recording '{}' {} >/dev/null", truth.string(),
                            recording.string(),
                            labeled.options.substr(0, labeled.options.find("--gravity")))),
            1);
  ASSERT_EQ(run(fmt::format("eval {} --json >'{}'", frame_with(labeled, recording, truth),
                            scores.string())),
            0);
  expect_what_was_reached(labeled.name, scores);
  fs::remove(scores);
}

INSTANTIATE_TEST_SUITE_P(, LabeledFrame, testing::ValuesIn(read_list()), [](const auto& instance) {
  return instance.param.name;
});

/// Expects a mean IoU between the truth and labels drawn by today's tools with the original
/// gestures. Three frames were drawn with an earlier plane wand, which selected more at borders.
void expect_drawn_again(const std::string& name, double least_iou) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const std::vector<Labeled> list = read_list();
  const auto labeled = std::ranges::find(list, name, &Labeled::name);
  ASSERT_NE(labeled, list.end());
  const fs::path dir = temp_dir() / "planescope_label_scripts" / name;
  fs::remove_all(dir);
  fs::create_directories(dir);
  ASSERT_EQ(run(fmt::format("view {} --classifier pca --offscreen --size 640x400 --script '{}'",
                            frame_with(*labeled, fs::path(data) / labeled->recording, dir),
                            (kFolder / (name + ".json")).string())),
            0);
  const auto drawn = labels::read_frame_labels(dir, labeled->frame, "");
  const auto truth = labels::read_frame_labels(kReal / "truth" / name, labeled->frame, "");
  ASSERT_TRUE(drawn && truth);
  EXPECT_GE(labels::agreement_of(*drawn, *truth).mean_iou, least_iou);
  fs::remove_all(dir);
}

TEST(LabelScript, DrawsTheTruthOfARoomAgain) { expect_drawn_again("aims_15", 0.999); }
TEST(LabelScript, DrawsTheTruthOfASmearedFrameAgain) { expect_drawn_again("polylidar_0", 0.999); }
TEST(LabelScript, DrawsStairsAgainWithTheWand) { expect_drawn_again("kinect_stairs", 0.9); }
TEST(LabelScript, DrawsABoxAndItsCornerAgainWithTheWand) {
  expect_drawn_again("felixchenfy_000001", 0.9);
}

TEST(LabelScriptOfACloud, LabelsTheFloorTheTreadsAndTheLandingOfStairs) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const fs::path dir = temp_dir() / "planescope_label_scripts" / "entrance_stairs";
  fs::remove_all(dir);
  fs::create_directories(dir);
  const std::string recording =
      (fs::path(data) / "plane_seg_clouds/anymal/ori_entrance_stair_climb/06.pcd").string();
  const std::string labeled =
      fmt::format("'{}' --labels '{}'", recording, (dir / "labels").string());
  ASSERT_EQ(run(fmt::format("view {} --classifier pca --offscreen --size 640x400 --script '{}'",
                            labeled, (kFolder / "entrance_stairs.json").string())),
            0);
  const auto labels = labels::read_frame_labels(dir / "labels", 0, "");
  ASSERT_TRUE(labels);
  EXPECT_TRUE(labels->is_cloud());
  ASSERT_EQ(labels->planes.size(), 5u);
  const auto ignored = std::ranges::count(labels->plane.data, kPlaneIgnore);
  EXPECT_GT(ignored, 2000) << "the lasso";

  // Compares heights above the floor: four risers of 17 cm.
  const PointSet cloud = *io::open_recording(recording)->frame(0).cloud;
  std::vector<double> heights;
  for (const LabelPlane& plane : labels->planes) {
    EXPECT_EQ(plane.label, Label::h);
    double sum = 0;
    int points = 0;
    for (std::size_t i = 0; i < cloud.points.size(); ++i) {
      if (labels->plane.data[i] != plane.id) continue;
      sum += static_cast<double>(cloud.points[i].z());
      ++points;
    }
    EXPECT_GT(points, 2500) << plane.id;
    heights.push_back(sum / points);
  }
  for (std::size_t k = 1; k < heights.size(); ++k)
    EXPECT_NEAR(heights[k] - heights[k - 1], 0.17, 0.02) << k;

  EXPECT_LE(
      run(fmt::format("labels check '{}' --recording '{}'", (dir / "labels").string(), recording)),
      1);
  for (const char* format : {"ply", "kitti"})
    EXPECT_EQ(run(fmt::format("labels export {} --format {} -o '{}'", labeled, format,
                              (dir / format).string())),
              0);
  EXPECT_EQ(fs::file_size(dir / "kitti/000000.label"), 4 * cloud.points.size());
  EXPECT_EQ(run(fmt::format("eval {} --classifier pca", labeled)), 0);
  if (!HasFailure()) fs::remove_all(dir);
}

}  // namespace
}  // namespace planescope
