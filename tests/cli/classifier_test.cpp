// --classifier with weights files, including the shipped one.

#include <gtest/gtest.h>

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

/// A handmade network that returns v if a point has neighbors right above or below it, which are
/// the first two channels of the surface convolution.
planes::NetworkWeights hand_made() {
  planes::NetworkWeights weights;
  weights.config = {.name = "by hand", .levels = {{2}}, .neighbors = 16, .head = {1}};
  weights.training = R"({"recipe":"by hand"})";
  weights.tensors = {{0, 0, 0, 0, 1, -1},  // conv_0.directions: +z and -z, column by column
                     {1, 1},               // conv1d_block.0.weight: their sum
                     {0},                  // conv1d_block.0.bias
                     {0, 8},               // the larger, the more v
                     {8, 0}};              // conv1d_block.2.bias: h below 1
  return weights;
}

struct Commands {
  fs::path dir = scratch();
  Commands() { write_depth_folder(dir / "rec", floor_and_wall()); }

  Ran with(const std::string& command, const std::string& classifier) const {
    std::vector<std::string> args = {command,        dir / "rec", "--gravity", "0,1,0",
                                     "--classifier", classifier,  "-o",        dir / "out"};
    return run(args);
  }

  void expect_refused(const std::string& classifier, const std::string& reported) const {
    for (const char* command : {"segment", "report"}) {
      testing_cli::expect_refused(with(command, classifier), reported);
      EXPECT_FALSE(fs::exists(dir / "out")) << command;
    }
  }
};

}  // namespace

TEST(Classifier, AWeightsFileLabelsEveryFrame) {
  const Commands commands;
  const fs::path file = commands.dir / "own.safetensors";
  planes::write_weights(file, hand_made());
  well(commands.with("segment", file.string()));
  const Json json = Json::parse(read_text(commands.dir / "out/frames/000000/planes.json"));
  EXPECT_EQ(json["options"]["classifier"], file.string());
  ASSERT_EQ(json["planes"].size(), 2u);
  EXPECT_NE(json["planes"][0]["label"], json["planes"][1]["label"]);
}

TEST(Classifier, TheShippedWeightsAreTheAssets) {
  const Commands commands;
  planes::write_weights(commands.dir / "classifier.safetensors", hand_made());
  const Environment assets("PLANESCOPE_ASSETS", commands.dir);
  well(commands.with("report", "gcn"));
  const Json record = Json::parse(read_text(commands.dir / "out/report.json"))["record"];
  EXPECT_EQ(record["classifier"], "gcn");
  const Json& weights = record["weights"];
  EXPECT_EQ(weights["file"], "classifier.safetensors");
  EXPECT_EQ(weights["sha256"], sha256_hex_of_file(commands.dir / "classifier.safetensors"));
  EXPECT_EQ(weights["network"], "by hand, 13 parameters");
  EXPECT_EQ(weights["training"]["recipe"], "by hand");
}

TEST(Classifier, MissingTruncatedAndInconsistentWeightsAreRejected) {
  const Commands commands;
  const std::string missing = (commands.dir / "none.safetensors").string();
  commands.expect_refused(missing, missing + ": no such file");
  const fs::path file = commands.dir / "bad.safetensors";
  planes::write_weights(file, hand_made());
  std::vector<unsigned char> bytes = read_file_bytes(file);
  fs::resize_file(file, bytes.size() - 4);
  commands.expect_refused(file.string(), file.string() + ": tensor");
  bytes[5] = 1;  // declares a header of a terabyte
  write_file_bytes(file, bytes);
  commands.expect_refused(file.string(), "-byte header; expected at most");
  // The shipped weights have no fallback.
  fs::create_directories(commands.dir / "empty");
  const Environment assets("PLANESCOPE_ASSETS", commands.dir / "empty");
  commands.expect_refused("gcn", (commands.dir / "empty/classifier.safetensors").string());
}
