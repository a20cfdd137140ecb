// planescope-lab train, with tiny networks and training sets.

#include "core/lab/training/train.hpp"

#include <gtest/gtest.h>
#include <signal.h>

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

struct Training {
  fs::path dir = scratch();
  fs::path start = dir / "start.safetensors";  // an untrained tiny network
  fs::path out = dir / "out.safetensors", page = dir / "out.html",
           checkpoint = dir / "out.checkpoint";

  Training() {
    planes::write_weights(
        start, lab::random_weights({.name = "tiny", .levels = {{4}, {4}}, .head = {4}}, 1));
  }

  std::vector<std::string> command(std::vector<std::string> more) const {
    std::vector<std::string> args = {"planescope-lab", "train", "--count", "1", "--from", start};
    args.insert(args.end(), more.begin(), more.end());
    if (std::find(args.begin(), args.end(), "-o") == args.end())
      args.insert(args.end(), {"-o", out});
    return args;
  }
  Ran with(const std::vector<std::string>& more) const { return run(command(more)); }

  std::string bytes_with(const std::vector<std::string>& more) const {
    well(with(more));
    return read_text(out);
  }

  /// Interrupts training after the first of many epochs.
  void stop(const std::vector<std::string>& more) const {
    const Ran ran = run_and_signal(command(more), SIGINT, checkpoint);
    ASSERT_EQ(ran.code, 130) << ran.err;
    ASSERT_TRUE(has(ran.err, "--resume"));
    ASSERT_TRUE(fs::exists(checkpoint));
  }

  void expect_refused(const std::vector<std::string>& more, const std::string& reported) const {
    testing_cli::expect_refused(with(more), reported);
  }
};

Json training_record(const fs::path& weights) {
  return Json::parse(planes::read_weights(weights).training);
}

/// A labeled recording of a staircase.
fs::path write_recording(const fs::path& dir, int seed) {
  const fs::path path = dir / ("recording_" + std::to_string(seed));
  well(run({"synth", "sample", "-o", path, "--size", "160x120", "--scenes", "stairs",
            "--depth-only", "--seed", std::to_string(seed)}));
  return path;
}

/// Accuracy in percent, away from edges.
double label_accuracy(const fs::path& recording, const fs::path& weights) {
  const Ran ran =
      well(run({"eval", recording, "--json", "--profile", "paper", "--classifier", weights}));
  return Json::parse(ran.out)["mean"]["label_accuracy_inner"].get<double>();
}

}  // namespace

TEST(Train, WritesWeightsTheirRecordAndAPageAndNothingElse) {
  const Training training;
  const Ran ran = well(training.with({"--steps", "4", "--epoch", "2", "--seed", "5"}));
  EXPECT_TRUE(has(ran.out, "scans")) << "names what it was validated with";
  EXPECT_FALSE(has(ran.err, "\r")) << "no bar without a terminal";
  EXPECT_EQ(std::count(ran.err.begin(), ran.err.end(), '\n'), 3)
      << "a line for each epoch, and what they mean";
  EXPECT_EQ(files_below(training.dir),
            (std::vector<std::string>{"out.html", "out.safetensors", "start.safetensors"}));
  const Json record = training_record(training.out);
  EXPECT_EQ(record["recipe"], "planescope");
  EXPECT_EQ(record["seed"], 5);
  EXPECT_EQ(record["steps"], 4);
  EXPECT_EQ(record["synthetic_clouds"], 4);
  EXPECT_TRUE(record["validation"].contains("scans"));
  EXPECT_FALSE(has(record.dump(), training.dir.string())) << "holds no path";
  EXPECT_TRUE(has(read_text(training.page), "<svg"));
}

TEST(Train, TheSameSeedGivesTheSameBytesForAnyThreadsAndInstructionSet) {
  const Training training;
  const std::string bytes = training.bytes_with({"--steps", "4", "--threads", "1"});
  setenv("PLANESCOPE_SIMD", "plain", 1);
  EXPECT_EQ(training.bytes_with({"--steps", "4", "--threads", "3"}), bytes);
  unsetenv("PLANESCOPE_SIMD");
  EXPECT_NE(training.bytes_with({"--steps", "4", "--seed", "2"}), bytes);
}

TEST(Train, AResumedTrainingGivesTheSameBytes) {
  const Training training;
  const std::vector<std::string> args = {"--steps", "40", "--epoch", "20", "--recipe", "paper"};
  const std::string bytes = training.bytes_with(args);
  training.stop(args);
  EXPECT_EQ(read_text(training.out), bytes) << "stopped, it leaves the weights of before";
  std::vector<std::string> resume = args;
  resume.insert(resume.end(), {"--resume", "--threads", "1"});
  EXPECT_EQ(training.bytes_with(resume), bytes);
  EXPECT_FALSE(fs::exists(training.checkpoint));
}

TEST(Train, OnlyTheSameTrainingOverwritesACheckpoint) {
  const Training training;
  const std::vector<std::string> args = {"--steps", "4000", "--epoch", "1"};
  training.stop(args);
  const std::string checkpoint = read_text(training.checkpoint);
  training.expect_refused({"--steps", "4000", "--epoch", "1"}, "--resume, or delete this file");
  training.expect_refused(
      {"--steps", "4001", "--epoch", "1", "--resume"},
      "out.checkpoint: belongs to a different training run: steps 4000; expected 4001");
  training.expect_refused({"--steps", "4000", "--epoch", "1", "--resume", "--recipe", "paper"},
                          "belongs to a different training run");
  EXPECT_EQ(read_text(training.checkpoint), checkpoint);

  fs::resize_file(training.checkpoint, checkpoint.size() - 100);
  training.expect_refused({"--steps", "4000", "--epoch", "1", "--resume"}, "out.checkpoint: ");
  fs::copy_file(training.start, training.checkpoint, fs::copy_options::overwrite_existing);
  training.expect_refused({"--steps", "4000", "--epoch", "1", "--resume"},
                          "not a training checkpoint");
  EXPECT_FALSE(fs::exists(training.out));
}

TEST(Train, InvalidSettingsAreReportedBeforeAnythingIsWritten) {
  const Training training;
  const fs::path recording = write_recording(training.dir, 1);
  fs::remove_all(recording.string() + ".labels");
  write_text(training.out, "weights of before");
  const std::string out = training.out.string(), dir = training.dir.string();
  fs::create_directories(training.dir / "folder.safetensors");
  training.expect_refused({"--resume"}, "out.checkpoint: no such file");
  training.expect_refused({"-o", dir + "/none/out.safetensors"},
                          "no such folder: " + dir + "/none");
  training.expect_refused({"-o", dir + "/folder.safetensors"}, "is a folder");
  training.expect_refused({"-o", dir + "/start.safetensors/out.safetensors"}, "is not a folder");
  training.expect_refused({"-o", dir + "/out.bin"}, "expected a name that ends in .safetensors");
  training.expect_refused({"--network", "official"},
                          "different network; expected weights for official (--network)");
  training.expect_refused({"--baseline", dir + "/none"}, "none: no such file");
  training.expect_refused({"--recipe", "cookies"},
                          "expected planescope, real-camera, paper, or recordings");
  training.expect_refused({"--recipe", "recordings"}, "needs labeled recordings");
  training.expect_refused({"--labels", dir}, "needs the recording");
  training.expect_refused({recording}, "no labeled frames");
  training.expect_refused({"--steps", "0"}, "--steps");
  training.expect_refused({"--epoch", "0"}, "--epoch");
  training.expect_refused({"--classifier", "pca"}, "unknown option");
  EXPECT_EQ(read_text(training.out), "weights of before");
  EXPECT_FALSE(fs::exists(training.checkpoint));
  EXPECT_FALSE(fs::exists(training.page));
}

TEST(Train, OnOwnRecordingsLearnsTheirTerrain) {
  const Training training;
  const fs::path recording = write_recording(training.dir, 1),
                 other = write_recording(training.dir, 2);
  const fs::path labels = training.dir / "labels";
  fs::rename(recording.string() + ".labels", labels);
  well(training.with({recording, "--labels", labels, "--recipe", "recordings", "--steps", "130",
                      "--baseline", training.start}));
  EXPECT_GT(label_accuracy(other, training.out), label_accuracy(other, training.start) + 10);
  const Json record = training_record(training.out);
  EXPECT_EQ(record["recipe"], "recordings");
  EXPECT_EQ(record["synthetic_clouds"], 0);
  EXPECT_EQ(record["recorded_clouds"], 1);
}

TEST(Train, ABetterBaselineEndsItWithCode1) {
  const Training training;
  // A handmade network: v if a point has neighbors right above or below it.
  planes::NetworkWeights good;
  good.config = {.name = "by hand", .levels = {{2}}, .head = {1}};
  good.tensors = {{0, 0, 0, 0, 1, -1}, {1, 1}, {0}, {0, 8}, {8, 0}};
  const fs::path baseline = training.dir / "good.safetensors";
  planes::write_weights(baseline, good);
  const Ran ran = training.with({"--steps", "1", "--baseline", baseline});
  EXPECT_EQ(ran.code, 1) << ran.out;
  EXPECT_TRUE(has(ran.out, "worse"));
  EXPECT_TRUE(fs::exists(training.out)) << "the weights are kept all the same";
}
