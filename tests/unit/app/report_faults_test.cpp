// Faults that a change of the code might cause are injected into one or all frames of the labeled
// sample. A report compared with a baseline without faults must report them.

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

/// Input of a frame's run, which a fault may change.
struct Run {
  Frame frame;
  planes::PipelineOptions options;
  const planes::Classifier* classifier;
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

const Fault kFaults[] = {
    {"thresholds off by 2x",
     [](Run& run) {
       run.options.segment.objective.flat *= 2;
       run.options.segment.objective.merge_cost *= 2;
     }},
    {"gravity tilted 5 degrees", tilt_gravity},
    {"depth scale 1.01", [](Run& run) { run.frame.depth_unit_m *= 1.01; }},
    {"only large planes listed", [](Run& run) { run.options.segment.objective.worth_px *= 20; }},
    {"planes cheap to join", [](Run& run) { run.options.segment.objective.merge_cost *= 8; }},
    {"a bow that excuses steps", [](Run& run) { run.options.segment.objective.bow *= 8; }},
    {"a third of the columns missing",
     [](Run& run) {
       auto& depth = run.frame.depth;
       for (std::size_t i = 0; i < depth.pixels(); ++i)
         if (static_cast<int>(i) % depth.width < depth.width / 3) depth.data[i] = 0;
     }},
    {"points beyond 1.2 m cropped", [](Run& run) { run.options.cloud.max_range_m = 1.2; }},
    {"focal lengths of another resolution",
     [](Run& run) {
       run.frame.intrinsics.fx *= 1.05;
       run.frame.intrinsics.fy *= 1.05;
     }},
    {"principal point of another crop", [](Run& run) { run.frame.intrinsics.cx += 40; }},
};

FrameRunner runner_with(const Fault* fault, int only_frame) {
  return [=](const OpenInput& input, int index, const planes::PipelineOptions& options,
             const planes::Classifier* classifier) {
    if (!fault || (only_frame >= 0 && index != only_frame))
      return run_report_frame(input, index, options, classifier);
    Run run{input.recording->frame(index), options, classifier};
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

TEST_P(ReportFault, InOneFrameIsAnErrorThatReportsItFirst) {
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

TEST(ReportGuard, TenUnchangedRerunsPass) {
  for (int i = 0; i < 10; ++i) {
    const Outcome outcome = report(baseline());
    EXPECT_EQ(outcome.exit_code, 0);
    EXPECT_EQ(outcome.verdict["errors"], 0) << outcome.verdict;
  }
}

}  // namespace
}  // namespace planescope::app
