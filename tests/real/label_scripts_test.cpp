// Labels real frames as a person would, by the scripts in labels/, looks at what was drawn, and
// holds the method to what it reached on it. The
// recordings are read from $PLANESCOPE_DATA.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "core/io/recording.hpp"
#include "core/labels/model/label_files.hpp"
#include "support/temp_dir.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

const fs::path kFolder = fs::path(PLANESCOPE_SOURCE_DIR) / "tests" / "real" / "labels";

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

TEST_P(LabelScript, LabelsEveryPlaneOfTheFrame) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (data == nullptr) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const Labeled& labeled = GetParam();
  const fs::path dir = temp_dir() / "planescope_label_scripts" / labeled.name;
  fs::remove_all(dir);
  fs::create_directories(dir);
  const std::string recording = (fs::path(data) / labeled.recording).string();
  const std::string frame = fmt::format("'{}' --labels '{}' --frames {} {}", recording,
                                        dir.string(), labeled.frame, labeled.options);

  ASSERT_EQ(run(fmt::format("view {} --classifier pca --offscreen --size 640x400 --script '{}'",
                            frame, (kFolder / (labeled.name + ".json")).string())),
            0);
  const auto labels = labels::read_frame_labels(dir, labeled.frame, "");
  ASSERT_TRUE(labels);

  std::ifstream file(kFolder / "expected.json");
  const Json expected = Json::parse(file).at(labeled.name);
  EXPECT_EQ(labels->planes.size(), expected.size());
  for (const Json& plane : expected) {
    const std::string what = plane.at("what");
    const int id = labels->plane.at(plane.at("at").at(0), plane.at("at").at(1));
    const auto found = std::find_if(labels->planes.begin(), labels->planes.end(),
                                    [&](const LabelPlane& p) { return p.id == id; });
    ASSERT_NE(found, labels->planes.end()) << what;
    EXPECT_EQ(found->label == Label::h ? "h" : "v", plane.at("label")) << what;
    const auto pixels =
        static_cast<double>(std::count(labels->plane.data.begin(), labels->plane.data.end(), id));
    EXPECT_NEAR(pixels, plane.at("pixels"), 0.1 * plane.at("pixels").get<double>()) << what;
  }
  // Nothing is damaged, and what was drawn can be scored. (Findings there may be: real surfaces
  // bow.)
  EXPECT_LE(run(fmt::format("labels check '{}' --recording '{}' {}", dir.string(), recording,
                            labeled.options.substr(0, labeled.options.find("--gravity")))),
            1);
  EXPECT_EQ(run(fmt::format("eval {} --json >'{}'", frame, (dir / "eval.json").string())), 0);
  expect_what_was_reached(labeled.name, dir / "eval.json");
  if (!HasFailure()) fs::remove_all(dir);
}

INSTANTIATE_TEST_SUITE_P(, LabelScript, testing::ValuesIn(read_list()), [](const auto& instance) {
  return instance.param.name;
});

}  // namespace
}  // namespace planescope
