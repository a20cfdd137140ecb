#include "core/lab/tuning/tuning_search.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/lab/tuning/tuning_answer.hpp"

namespace planescope::lab {
namespace {

/// Scores known options: best at two_planes 0.6, worth_px 2000 and use_labels off. All
/// else does nothing, but for theta_n_in, which is good for the first frame alone.
std::vector<double> known_scores(const planes::PipelineOptions& options, int frames) {
  const auto number = [&](const char* name) {
    return planes::number_of(planes::find_option(name), options);
  };
  const double two = 25 * std::pow(number("two_planes") - 0.6, 2);
  const double pixels = 5 * std::abs(std::log2(number("worth_px") / 2000));
  const double merge = planes::find_option("use_labels").get(options) == "on" ? 3 : 0;
  std::vector<double> scores;
  for (int i = 0; i < frames; ++i) scores.push_back(90 - i - two - pixels - merge);
  scores[0] += std::min(10.0, number("theta_n_in"));
  return scores;
}

struct Known {
  int frames = 6;
  std::vector<Setting> asked = {};

  TuningSearch search(int trials = 10000) {
    TuningSearch search;
    for (const planes::OptionInfo& info : planes::option_table())
      if (is_tunable(info)) search.options.push_back(info.name);
    search.trials = trials;
    search.evaluate = [this](std::span<const Setting> settings, bool) {
      std::vector<Trial> trials_made;
      for (const Setting& setting : settings) {
        asked.push_back(setting);
        trials_made.push_back(
            {setting, known_scores(with_setting(planes::PipelineOptions(), setting), frames)});
      }
      return trials_made;
    };
    return search;
  }
};

double value_of(const Tuned& tuned, const std::string& name) {
  return planes::number_of(planes::find_option(name),
                           with_setting(planes::PipelineOptions(), tuned.best.setting));
}

TEST(TuningSearch, FindsTheBestOfAKnownScoreAndChangesNothingElse) {
  Known known;
  const Tuned tuned = search_options(known.search());
  EXPECT_TRUE(tuned.complete);
  std::set<std::string> changed;
  for (const auto& [name, value] : tuned.best.setting) changed.insert(name);
  EXPECT_EQ(changed, (std::set<std::string>{"worth_px", "use_labels", "two_planes"}))
      << "theta_n_in gains on one frame alone: that is no reason to change it";
  EXPECT_NEAR(value_of(tuned, "two_planes"), 0.6, 0.03);
  EXPECT_NEAR(value_of(tuned, "worth_px"), 2000, 1);
  EXPECT_GT(mean_score(tuned.best), mean_score(tuned.base) + 7);
}

TEST(TuningSearch, TellsWhatEachChangeIsWorthTheMostFirst) {
  Known known;
  const Tuned tuned = search_options(known.search());
  ASSERT_EQ(tuned.changes.size(), 3u);
  EXPECT_EQ(tuned.changes[0].option, "worth_px");
  EXPECT_EQ(tuned.changes[1].option, "use_labels");
  EXPECT_NEAR(gain_of(tuned.best, tuned.changes[0].without).mean, 5, 1e-9);
  EXPECT_NEAR(gain_of(tuned.best, tuned.changes[1].without).mean, 3, 1e-9);
}

TEST(TuningSearch, EndsWithTheTrialsItMayMake) {
  for (const int most : {1, 2, 30, 150}) {
    Known known;
    const Tuned tuned = search_options(known.search(most));
    EXPECT_EQ(tuned.asked, most);
    EXPECT_FALSE(tuned.complete);
    // What is taken back in the end is beyond: once for each change, and once more for each that
    // went.
    EXPECT_LE(known.asked.size(), static_cast<std::size_t>(most) + 20);
    EXPECT_GE(mean_score(tuned.best), mean_score(tuned.base));
  }
}

TEST(TuningSearch, WhoeverEvaluatesMayEndItAndKeepsWhatWasFound) {
  Known known;
  TuningSearch search = known.search();
  const auto evaluate = search.evaluate;
  search.evaluate = [&](std::span<const Setting> settings, bool may_end) {
    if (may_end && known.asked.size() > 60) throw TuningSpent();
    return evaluate(settings, may_end);
  };
  const Tuned tuned = search_options(search);
  EXPECT_FALSE(tuned.complete);
  EXPECT_GT(mean_score(tuned.best), mean_score(tuned.base));
}

TEST(TuningSearch, AGainOfOneFrameIsNone) {
  const Trial before{{}, {50, 60, 70, 80}};
  EXPECT_FALSE(gain_of({{}, {70, 60, 70, 80}}, before).counts());
  EXPECT_TRUE(gain_of({{}, {60, 70, 70, 80}}, before).counts());
  EXPECT_FALSE(gain_of({{}, {60, 50, 70, 80}}, before).counts());
  EXPECT_FALSE(gain_of({{}, {50.01, 60.01, 70.01, 80.01}}, before).counts());
  const Gain gain = gain_of({{}, {60, 70, 65, 80}}, before);
  EXPECT_EQ(gain.better, 2);
  EXPECT_EQ(gain.worse, 1);
  EXPECT_EQ(gain.alike, 1);
}

TEST(TuningSpace, ValuesStayInTheirRangeAndComeNearerStepByStep) {
  for (const planes::OptionInfo& info : planes::option_table()) {
    if (!is_tunable(info)) continue;
    for (const double factor : kTuningFactors)
      for (const std::string& value : values_to_try(info, {}, factor)) {
        planes::PipelineOptions options;
        EXPECT_NO_THROW(info.set(options, value)) << info.name << " " << value;
        EXPECT_NE(info.get(options), info.get({})) << info.name;
      }
  }
  const auto of = [](const char* name, double factor) {
    return values_to_try(planes::find_option(name), {}, factor);
  };
  EXPECT_EQ(of("two_planes", 2), (std::vector<std::string>{"0.15", "0.6"}));
  EXPECT_EQ(of("worth_px", 2), (std::vector<std::string>{"500", "2000"}));
  EXPECT_EQ(of("use_labels", 2), (std::vector<std::string>{"off"}));
  EXPECT_TRUE(of("use_labels", kTuningFactors[1]).empty());
  EXPECT_TRUE(of("pca_neighbours", 2).empty()) << "gcn does not read it";
  EXPECT_TRUE(of("theta_e_n_m2", 2).empty()) << "the profile is refined";
  EXPECT_TRUE(of("region_patch_px", 2).empty()) << "the method is ours";
}

TEST(TuningSpace, WhatDecidesWhichPointsAreScoredIsNotTuned) {
  for (const char* name : {"max_range_m", "range_for_clouds", "cube_edge_m", "gravity", "profile",
                           "method", "classifier", "foot_radius_m"})
    EXPECT_FALSE(is_tunable(planes::find_option(name))) << name;
}

TEST(ParetoFront, HoldsWhatNoOtherBeatsInBoth) {
  const auto front =
      pareto_front({{{}, 80, 30}, {{}, 70, 10}, {{}, 60, 20}, {{}, 80, 40}, {{}, 75, 10}});
  ASSERT_EQ(front.size(), 2u);
  EXPECT_EQ(front[0].ms, 10);
  EXPECT_EQ(front[0].pq, 75);
  EXPECT_EQ(front[1].ms, 30);
}

}  // namespace
}  // namespace planescope::lab
