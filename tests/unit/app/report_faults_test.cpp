// What the guard is for: mistakes such as a change of the code may bring are made in one frame of
// the labelled sample, or in all, and the report held against one without them must name them.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cstring>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/commands/report.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/classify/classifier.hpp"
#include "support/temp_dir.hpp"

namespace planescope::app {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr int kFrame = 1;

/// A frame before it is run, as a fault may find it.
struct Run {
  Frame frame;
  planes::PipelineOptions options;
  const planes::Classifier* classifier;
  std::unique_ptr<planes::Classifier> own_classifier;
};

struct Fault {
  const char* name;
  void (*apply)(Run&);
};
void PrintTo(const Fault& fault, std::ostream* out) { *out << fault.name; }

void tilt_gravity(Run& run) {
  const Gravity gravity = planes::resolve_gravity(run.frame, run.options.gravity);
  run.options.gravity.mode = planes::GravityMode::fixed;
  run.options.gravity.direction =
      Eigen::AngleAxisd(5 * std::numbers::pi / 180, Vec3d::UnitZ()) * gravity.direction;
}

/// Takes h for v and v for h wherever the other label is near.
class FlippedAtEdges : public planes::Classifier {
 public:
  explicit FlippedAtEdges(const planes::Classifier& classifier) : classifier_(classifier) {}
  std::string name() const override { return classifier_.name(); }
  planes::Classification classify(std::span<const Vec3f> points, int threads) const override {
    planes::Classification result = classifier_.classify(points, threads);
    const std::vector<Label> labels = result.labels;
    constexpr float kNear = 0.045F;
    for (std::size_t i = 0; i < points.size(); ++i)
      for (std::size_t j = 0; j < points.size() && result.labels[i] == labels[i]; ++j)
        if (labels[j] != labels[i] && (points[i] - points[j]).norm() < kNear)
          result.labels[i] = labels[j];
    return result;
  }

 private:
  const planes::Classifier& classifier_;
};

void flip_labels(Run& run) {
  run.own_classifier = std::make_unique<FlippedAtEdges>(*run.classifier);
  run.classifier = run.own_classifier.get();
}

/// The shipped weights, but for a stretch of them, as a file half written over would hold them.
const planes::Classifier& stale_classifier() {
  static const planes::ChosenClassifier stale = [] {
    auto bytes = read_file_bytes(PLANESCOPE_SOURCE_DIR "/assets/classifier.safetensors");
    for (std::size_t at = bytes.size() / 2 / 4 * 4; at < bytes.size() * 3 / 4; at += 4) {
      float weight;
      std::memcpy(&weight, &bytes[at], 4);
      weight = -weight;
      std::memcpy(&bytes[at], &weight, 4);
    }
    const fs::path file = temp_dir() / "stale.safetensors";
    write_file_bytes(file, bytes);
    planes::PipelineOptions options;
    options.classifier = file.string();
    return planes::make_classifier(options, {});
  }();
  return *stale.classifier;
}

const Fault kFaults[] = {
    {"thresholds off by 2x",
     [](Run& run) {
       run.options.segment.noise.estimate_sigma = false;
       run.options.segment.noise.fixed_rms_m *= 2;
       run.options.segment.noise.fixed_tau_m *= 2;
     }},
    {"gravity tilted 5 degrees", tilt_gravity},
    {"depth scale 1.01", [](Run& run) { run.frame.depth_unit_m *= 1.01; }},
    {"labels flipped at edges", flip_labels},
    {"merge by first instead of best",
     [](Run& run) {
       run.options.segment.r1_merge_by_distance.on = false;
       run.options.segment.merge_partner = planes::MergePartner::first;
     }},
    {"stale weights", [](Run& run) { run.classifier = &stale_classifier(); }},
    {"voxel grid doubled", [](Run& run) { run.options.cloud.voxel_size_m *= 2; }},
    {"points beyond 1.2 m cropped", [](Run& run) { run.options.cloud.max_range_m = 1.2; }},
    {"focal lengths of another resolution",
     [](Run& run) {
       run.frame.intrinsics.fx *= 1.05;
       run.frame.intrinsics.fy *= 1.05;
     }},
    {"labels not used", [](Run& run) { run.options.segment.use_labels = false; }},
};

FrameRunner runner_with(const Fault* fault, int only_frame) {
  return [=](const OpenInput& input, int index, const planes::PipelineOptions& options,
             const planes::Classifier* classifier) {
    if (!fault || (only_frame >= 0 && index != only_frame))
      return run_report_frame(input, index, options, classifier);
    Run run{input.recording->frame(index), options, classifier, nullptr};
    fault->apply(run);
    LoadedFrame loaded;
    loaded.truth =
        labels::frame_truth(run.frame, input.label_dir, input.recording->frame_hash(index));
    loaded.result = planes::run_frame(run.frame, run.options, run.classifier, nullptr, nullptr);
    loaded.frame = std::move(run.frame);
    return loaded;
  };
}

struct Outcome {
  int exit_code = 0;
  Json verdict;
};

Outcome report(const fs::path& baseline, const Fault* fault = nullptr, int only_frame = -1) {
  static int runs = 0;
  ReportArgs args;
  args.input.inputs = {PLANESCOPE_SOURCE_DIR "/assets/sample"};
  args.out = temp_dir() / ("faults_" + std::to_string(++runs));
  args.guard.baseline = baseline;
  args.guard.approve = !fs::exists(baseline);
  args.pictures = false;
  Outcome outcome;
  outcome.exit_code = run_report(args, {}, runner_with(fault, only_frame));
  outcome.verdict = Json::parse(std::ifstream(args.out / "report.json"))["verdict"];
  fs::remove_all(args.out);
  return outcome;
}

const fs::path& baseline() {
  static const fs::path file = [] {
    const fs::path path = temp_dir() / "faults_baseline.json";
    fs::remove(path);
    EXPECT_EQ(report(path).exit_code, 0);
    return path;
  }();
  return file;
}

class ReportFault : public testing::TestWithParam<Fault> {};

TEST_P(ReportFault, InOneFrameIsAnErrorThatNamesItFirst) {
  const Outcome outcome = report(baseline(), &GetParam(), kFrame);
  EXPECT_EQ(outcome.exit_code, 1);
  ASSERT_FALSE(outcome.verdict["breaches"].empty());
  const Json& worst = outcome.verdict["breaches"][0];
  EXPECT_EQ(worst["level"], "error");
  EXPECT_EQ(worst["frame"], kFrame) << worst;
}

TEST_P(ReportFault, InAllFramesIsAnError) {
  EXPECT_EQ(report(baseline(), &GetParam()).exit_code, 1);
}

std::string name_of(const testing::TestParamInfo<Fault>& info) {
  std::string name = info.param.name;
  for (char& c : name)
    if (!std::isalnum(static_cast<unsigned char>(c))) c = '_';
  return name;
}
INSTANTIATE_TEST_SUITE_P(Ten, ReportFault, testing::ValuesIn(kFaults), name_of);

TEST(ReportGuard, TenUnchangedRerunsBreakNothing) {
  for (int i = 0; i < 10; ++i) {
    const Outcome outcome = report(baseline());
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.verdict["errors"], 0) << outcome.verdict;
  }
}

}  // namespace
}  // namespace planescope::app
