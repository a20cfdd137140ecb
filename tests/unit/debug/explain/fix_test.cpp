// Tests of the search for option changes that recover a plane, and of sensitivity curves.

#include "core/debug/explain/fix.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "core/debug/explain/score.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "runs.hpp"

namespace planescope::debug {
namespace {

double iou_with(const Run& run, const std::string& option, const std::string& value, int truth) {
  planes::PipelineOptions options = run.options;
  planes::set_option(options, option, value);
  const auto changed = make_run(run.subject, options);
  for (const TruthMatch& match :
       quick_score(changed->segmentation.plane_of, run.subject->voxel_truth).planes)
    if (match.truth == truth) return match.iou;
  return 0;
}

/// A lost tread (planes labeled h).
std::int32_t lost_tread(const Run& run) {
  const VoxelTruth& truth = run.subject->voxel_truth;
  for (const TruthMatch& match : quick_score(run.segmentation.plane_of, truth).planes)
    for (std::size_t i = 0; i < truth.plane.size(); ++i)
      if (match.iou < 0.8 && truth.plane[i] == match.truth && truth.label[i] == 1)
        return match.truth;
  return 0;
}

// Changes are measured as ratios: of the value, or of the odds of a share.
double position(const planes::OptionInfo& info, double value) {
  return std::log(info.range.max <= 1 ? value / (1 - value) : value);
}
std::string value_at(const planes::OptionInfo& info, double position) {
  const double e = std::exp(position);
  return planes::number_text(info, info.range.max <= 1 ? e / (1 + e) : e);
}

TEST(Fix, ALostTreadIsRecoveredByTheSmallestChangeOfEachOption) {
  int numbers = 0;
  for (int index = 0; index < 10; ++index) {
    const auto run =
        test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003, index);
    const std::int32_t tread = lost_tread(*run);
    if (tread == 0) continue;
    SCOPED_TRACE(index);
    const std::vector<Fix> fixes = find_fixes(*run, target_of_truth(*run, tread), {});
    ASSERT_FALSE(fixes.empty());
    std::set<std::string> options;
    for (const Fix& fix : fixes) {
      SCOPED_TRACE(fix.option + ": " + fix.before + " -> " + fix.after);
      EXPECT_GE(iou_with(*run, fix.option, fix.after, tread), 0.8);
      EXPECT_DOUBLE_EQ(iou_with(*run, fix.option, fix.after, tread), fix.share);
      EXPECT_TRUE(options.insert(fix.option).second);
      EXPECT_LE(fix.change, std::log(3) + 1e-3);
      const planes::OptionInfo& info = planes::find_option(fix.option);
      if (info.kind != planes::OptionKind::number || fix.before == "0") continue;
      const double before = position(info, planes::number_of(info, run->options));
      const double change = position(info, std::stod(fix.after)) - before;
      EXPECT_NEAR(fix.change, std::abs(change), 1e-4);
      const std::string less = value_at(info, before + 0.8 * change);
      EXPECT_LT(iou_with(*run, fix.option, less, tread), 0.8) << "with " << less;
      ++numbers;
    }
  }
  EXPECT_GT(numbers, 0);
}

TEST(Fix, ADetectedPlaneNeedsNone) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::refined), 0);
  EXPECT_TRUE(find_fixes(*run, target_of_truth(*run, 1), {}).empty());
}

TEST(Fix, VoxelsOutsideTheFrameAreIgnored) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::refined), 0);
  EXPECT_TRUE(
      find_fixes(*run, {.voxels = {1u << 30}, .name = "marked region", .wish = Wish::plane}, {})
          .empty());
}

TEST(Fix, TheSearchCanBeStopped) {
  int index = 0;
  auto run = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003, index);
  while (lost_tread(*run) == 0)
    run = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003, ++index);
  std::stop_source stop;
  int calls = 0;
  find_fixes(*run, target_of_truth(*run, lost_tread(*run)), stop.get_token(),
             [&](int, int, const std::vector<Fix>&) {
               ++calls;
               stop.request_stop();
             });
  EXPECT_EQ(calls, 1);
}

TEST(Fix, TheEffectListsGainedAndLostPlanes) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003);
  planes::PipelineOptions refined = run->options;
  refined.segment = planes::profile_options(planes::Profile::refined);
  const FixEffect effect = effect_of(*run, refined);
  EXPECT_EQ(effect.detected_after - effect.detected_before,
            static_cast<int>(effect.recovered.size()) - static_cast<int>(effect.broken.size()));
  EXPECT_GT(effect.recovered.size(), 0u);
  EXPECT_GT(effect.iou_after, effect.iou_before);
  EXPECT_TRUE(effect_of(*run, run->options).recovered.empty());
}

TEST(Sensitivity, TheCurrentValueIsAmongAscendingOnes) {
  const auto run = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.002);
  for (const char* option : {"theta_e_n_m2", "theta_n_in", "theta_coplane"}) {
    SCOPED_TRACE(option);
    const Sensitivity strip = sensitivity_of(*run, option, {});
    ASSERT_GT(strip.values.size(), 10u);
    EXPECT_EQ(strip.values.size(), strip.scores.size());
    EXPECT_TRUE(std::is_sorted(strip.values.begin(), strip.values.end()));
    const auto current = std::find(strip.values.begin(), strip.values.end(),
                                   planes::number_of(planes::find_option(option), run->options));
    ASSERT_NE(current, strip.values.end());
    const double score =
        quick_score(run->segmentation.plane_of, run->subject->voxel_truth).mean_iou;
    EXPECT_EQ(strip.scores[current - strip.values.begin()], score);
  }
}

VoxelTruth truth_of(std::vector<std::int32_t> planes, int count) {
  return {std::vector<std::uint8_t>(planes.size(), 1), std::move(planes), count};
}

TEST(QuickScore, SharesAreCountedOverVoxelsWithATruePlane) {
  const VoxelTruth truth = truth_of({1, 1, 1, 1, 2, 2, 0, -1}, 2);
  const std::vector<std::int32_t> found{1, 1, 1, 1, 0, 2, 2, 1};
  const QuickScore score = quick_score(found, truth);
  ASSERT_EQ(score.planes.size(), 2u);
  EXPECT_EQ(score.planes[0].found, 1);
  EXPECT_DOUBLE_EQ(score.planes[0].iou, 1) << "what is not scored counts nowhere";
  EXPECT_DOUBLE_EQ(score.planes[1].iou, 1.0 / 3);
  EXPECT_EQ(score.detected, 1);
  EXPECT_DOUBLE_EQ(score.mean_iou, (1 + 1.0 / 3) / 2);
  EXPECT_DOUBLE_EQ(score.in_no_plane, 1.0 / 6);
  EXPECT_EQ(score.found_planes, 2);
}

TEST(QuickScore, WithoutTruthOnlyThePlanesAreCounted) {
  const std::vector<std::int32_t> found{1, 0, 2};
  const QuickScore score = quick_score(found, {});
  EXPECT_TRUE(score.planes.empty());
  EXPECT_EQ(score.found_planes, 2);
}

TEST(QuickScore, EveryKindOfLossHasAName) {
  const auto verdict = [](const std::vector<std::int32_t>& found, std::int32_t plane) {
    const VoxelTruth truth = truth_of({1, 1, 1, 1, 2, 2, 2, 2}, 2);
    return verdicts_of(quick_score(found, truth), found, truth)[plane - 1];
  };
  EXPECT_EQ(verdict({1, 1, 1, 1, 2, 2, 2, 2}, 1), TruthVerdict::detected);
  EXPECT_EQ(verdict({1, 1, 1, 1, 1, 1, 1, 1}, 1), TruthVerdict::merged);
  EXPECT_EQ(verdict({1, 1, 3, 3, 2, 2, 2, 2}, 1), TruthVerdict::split);
  EXPECT_EQ(verdict({0, 0, 0, 1, 2, 2, 2, 2}, 1), TruthVerdict::missed);
  EXPECT_EQ(verdict({0, 0, 0, 0, 2, 2, 2, 2}, 1), TruthVerdict::missed);
}

}  // namespace
}  // namespace planescope::debug
