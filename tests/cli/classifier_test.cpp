// --classifier: networks from weights files, the shipped one among them.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/classify/weights.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

/// $PLANESCOPE_ASSETS for the programs that a test runs.
class Assets {
 public:
  explicit Assets(const fs::path& dir) { setenv("PLANESCOPE_ASSETS", dir.c_str(), 1); }
  ~Assets() { unsetenv("PLANESCOPE_ASSETS"); }
  Assets(const Assets&) = delete;
  Assets& operator=(const Assets&) = delete;
};

/// A network made by hand: v where a point has neighbours right above or below it, which are the
/// first two channels of the surface convolution.
planes::NetworkWeights hand_made() {
  planes::NetworkWeights weights;
  weights.config = {.name = "by hand", .levels = {{2}}, .neighbours = 16, .head = {1}};
  weights.training = R"({"recipe":"by hand"})";
  weights.tensors = {{0, 0, 0, 0, 1, -1},  // conv_0.directions: +z and -z, column by column
                     {1, 1},               // conv1d_block.0.weight: their sum
                     {0},                  // conv1d_block.0.bias
                     {0, 8},               // conv1d_block.2.weight: the more, the more v
                     {8, 0}};              // conv1d_block.2.bias: h below 1
  return weights;
}

struct Commands {
  fs::path dir = scratch();
  Commands() { write_depth_folder(dir / "rec", floor_and_wall()); }

  Ran with(const std::string& command, const std::string& classifier) const {
    std::vector<std::string> args = {command, (dir / "rec").string(), "--gravity",
                                     "0,1,0", "--classifier",         classifier,
                                     "-o",    (dir / "out").string()};
    return run(args);
  }

  void expect_refused(const std::string& classifier, const std::string& told) const {
    for (const char* command : {"segment", "report"}) {
      const Ran ran = with(command, classifier);
      EXPECT_EQ(ran.code, 2) << command;
      EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
      EXPECT_NE(ran.err.find(told), std::string::npos) << "no '" << told << "' in: " << ran.err;
      EXPECT_FALSE(fs::exists(dir / "out")) << command;
    }
  }
};

}  // namespace

TEST(Classifier, AWeightsFileLabelsEveryFrame) {
  const Commands commands;
  const fs::path file = commands.dir / "own.safetensors";
  planes::write_weights(file, hand_made());
  const Ran ran = commands.with("segment", file.string());
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Json json = Json::parse(read_text(commands.dir / "out/frames/000000/planes.json"));
  EXPECT_EQ(json["options"]["classifier"], file.string());
  ASSERT_EQ(json["planes"].size(), 2u);
  EXPECT_NE(json["planes"][0]["label"], json["planes"][1]["label"]);
}

TEST(Classifier, TheShippedWeightsAreThoseInTheAssets) {
  const Commands commands;
  planes::write_weights(commands.dir / "classifier.safetensors", hand_made());
  const Assets assets(commands.dir);
  const Ran ran = commands.with("report", "gcn");
  ASSERT_EQ(ran.code, 0) << ran.err;
  const Json record = Json::parse(read_text(commands.dir / "out/report.json"))["record"];
  EXPECT_EQ(record["classifier"], "gcn");
  const Json& weights = record["weights"];
  EXPECT_EQ(weights["file"], "classifier.safetensors");
  EXPECT_EQ(weights["sha256"], sha256_hex_of_file(commands.dir / "classifier.safetensors"));
  EXPECT_EQ(weights["network"], "by hand, 13 parameters");
  EXPECT_EQ(weights["training"]["recipe"], "by hand");
}

TEST(Classifier, AMissingWeightsFileIsNamed) {
  const Commands commands;
  const std::string file = (commands.dir / "none.safetensors").string();
  commands.expect_refused(file, file + ": no such file");
}

TEST(Classifier, ACutWeightsFileIsRefused) {
  const Commands commands;
  const fs::path file = commands.dir / "cut.safetensors";
  planes::write_weights(file, hand_made());
  fs::resize_file(file, fs::file_size(file) - 4);
  commands.expect_refused(file.string(), file.string() + ": tensor");
}

TEST(Classifier, AWeightsFileWithALyingHeaderIsRefused) {
  const Commands commands;
  const fs::path file = commands.dir / "lie.safetensors";
  planes::write_weights(file, hand_made());
  std::vector<unsigned char> bytes = read_file_bytes(file);
  bytes[5] = 1;  // a header of a terabyte
  write_file_bytes(file, bytes);
  commands.expect_refused(file.string(), file.string() + ": a header of");
}

TEST(Classifier, WithoutShippedWeightsNothingTakesTheirPlace) {
  const Commands commands;
  fs::create_directories(commands.dir / "empty");
  const Assets assets(commands.dir / "empty");
  commands.expect_refused("gcn", (commands.dir / "empty/classifier.safetensors").string());
}
