// Holds the method to what it reached on real frames whose truth lies in truth/, and the label
// tools to drawing that truth again, gesture by gesture, as the scripts in labels/ have it. The
// recordings are read from $PLANESCOPE_DATA.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/labels/model/label_files.hpp"
#include "core/labels/review/agreement.hpp"
#include "core/model/file_bytes.hpp"
#include "support/temp_dir.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path kReal = fs::path(PLANESCOPE_SOURCE_DIR) / "tests" / "real";
const fs::path kFolder = kReal / "labels";

// Mean IoU with the truth of what the tools of today draw by the same gestures. Three frames were
// drawn by the plane wand, when it took more at borders.
constexpr double kRedrawn = 0.999, kRedrawnByWand = 0.9;

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

bool uses_the_wand(const fs::path& script) {
  const auto bytes = read_file_bytes(script);
  return std::string(bytes.begin(), bytes.end()).find("label.wand ") != std::string::npos;
}

/// Exit code of the program; what it says goes into the test's log.
int run(const std::string& arguments) {
  const int status =
      std::system(fmt::format("'{}' {} </dev/null", PLANESCOPE_BINARY, arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

/// The frame's scores by default are no worse than floors.json says: what was reached, less a
/// small margin. Raise them where they are passed.
void expect_what_was_reached(const std::string& name, const fs::path& eval) {
  std::ifstream file(kFolder / "floors.json"), scored(eval);
  const Json floors = Json::parse(file).at(name);
  const Json frame = Json::parse(scored).at("frames").at(0);
  for (const char* least : {"mean_iou", "pq", "detected_iou80"})
    EXPECT_GE(frame.at(least).get<double>(), floors.at(least).get<double>()) << least;
  EXPECT_LE(frame.at("ghosts").get<int>() + frame.at("pieces").get<int>(),
            floors.at("found_for_nothing").get<int>());
}

class LabelScript : public testing::TestWithParam<Labeled> {};

TEST_P(LabelScript, DrawsTheTruthAgainAndTheMethodReachesItAsBefore) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const Labeled& labeled = GetParam();
  const fs::path dir = temp_dir() / "planescope_label_scripts" / labeled.name;
  const fs::path truth_dir = kReal / "truth" / labeled.name;
  const fs::path script = kFolder / (labeled.name + ".json");
  fs::remove_all(dir);
  fs::create_directories(dir);
  const std::string recording = (fs::path(data) / labeled.recording).string();
  const auto frame_with = [&](const fs::path& labels) {
    return fmt::format("'{}' --labels '{}' --frames {} {}", recording, labels.string(),
                       labeled.frame, labeled.options);
  };

  ASSERT_EQ(run(fmt::format("view {} --classifier pca --offscreen --size 640x400 --script '{}'",
                            frame_with(dir), script.string())),
            0);
  const auto labels = labels::read_frame_labels(dir, labeled.frame, "");
  const auto truth = labels::read_frame_labels(truth_dir, labeled.frame, "");
  ASSERT_TRUE(labels);
  ASSERT_TRUE(truth);
  const bool by_wand = uses_the_wand(script);
  EXPECT_GE(labels::agreement_of(*labels, *truth).mean_iou, by_wand ? kRedrawnByWand : kRedrawn);

  // Nothing is damaged, and what was drawn can be scored. (Findings there may be: real surfaces
  // bow.)
  EXPECT_LE(run(fmt::format("labels check '{}' --recording '{}' {}", truth_dir.string(), recording,
                            labeled.options.substr(0, labeled.options.find("--gravity")))),
            1);
  EXPECT_EQ(
      run(fmt::format("eval {} --json >'{}'", frame_with(truth_dir), (dir / "eval.json").string())),
      0);
  expect_what_was_reached(labeled.name, dir / "eval.json");
  if (!HasFailure()) fs::remove_all(dir);
}

INSTANTIATE_TEST_SUITE_P(, LabelScript, testing::ValuesIn(read_list()), [](const auto& instance) {
  return instance.param.name;
});

}  // namespace
}  // namespace planescope
