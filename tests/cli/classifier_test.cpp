// --classifier: networks from weights files, the shipped one among them.

#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/base/file_bytes.hpp"
#include "core/classify/weights.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
namespace fs = std::filesystem;

namespace {

/// $PLANESCOPE_ASSETS for the programs that a test runs.
class Assets {
 public:
  explicit Assets(const fs::path& dir) { setenv("PLANESCOPE_ASSETS", dir.c_str(), 1); }
  ~Assets() { unsetenv("PLANESCOPE_ASSETS"); }
  Assets(const Assets&) = delete;
  Assets& operator=(const Assets&) = delete;
};

/// A network that has learned nothing, but labels.
NetworkWeights untrained() {
  NetworkWeights weights;
  weights.training = R"({"recipe":"none","seed":7})";
  std::uint32_t state = 1;
  for (const TensorSpec& spec : tensor_specs(weights.config)) {
    std::size_t size = 1;
    for (const int extent : spec.shape) size *= static_cast<std::size_t>(extent);
    auto& tensor = weights.tensors.emplace_back(size);
    for (float& value : tensor) {
      state = state * 1664525 + 1013904223;
      value = static_cast<float>(state >> 8) / (1 << 23) - 1;
      value *= 0.2F;
    }
  }
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

TEST(Classifier, AMissingWeightsFileIsNamed) {
  const Commands commands;
  const std::string file = (commands.dir / "none.safetensors").string();
  commands.expect_refused(file, file + ": no such file");
}

TEST(Classifier, ACutWeightsFileIsRefused) {
  const Commands commands;
  const fs::path file = commands.dir / "cut.safetensors";
  write_weights(file, untrained());
  fs::resize_file(file, fs::file_size(file) - 4);
  commands.expect_refused(file.string(), file.string() + ": tensor");
}

TEST(Classifier, AWeightsFileWithALyingHeaderIsRefused) {
  const Commands commands;
  const fs::path file = commands.dir / "lie.safetensors";
  write_weights(file, untrained());
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
