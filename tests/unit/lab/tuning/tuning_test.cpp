// Tests of tuning: search, journal, Pareto front and the resulting report.

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "core/lab/tuning/tuning_answer.hpp"
#include "core/lab/tuning/tuning_search.hpp"
#include "core/lab/tuning/tuning_trials.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::lab {
namespace {

// ---- Search ----

/// A known score, which is best at two_planes 0.6, worth_px 2000 and use_labels off. Other options
/// have no effect, except theta_n_in, which improves only the first frame.
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

TEST(TuningSearch, ReportsTheGainOfEachChangeLargestFirst) {
  Known known;
  const Tuned tuned = search_options(known.search());
  ASSERT_EQ(tuned.changes.size(), 3u);
  EXPECT_EQ(tuned.changes[0].option, "worth_px");
  EXPECT_EQ(tuned.changes[1].option, "use_labels");
  EXPECT_NEAR(gain_of(tuned.best, tuned.changes[0].without).mean, 5, 1e-9);
  EXPECT_NEAR(gain_of(tuned.best, tuned.changes[1].without).mean, 3, 1e-9);
}

TEST(TuningSearch, EndsAfterTheAllowedTrials) {
  for (const int most : {1, 2, 30, 150}) {
    Known known;
    const Tuned tuned = search_options(known.search(most));
    EXPECT_EQ(tuned.asked, most);
    EXPECT_FALSE(tuned.complete);
    // Final trials that revert changes are additional: one per change, and one more for each
    // reverted change.
    EXPECT_LE(known.asked.size(), static_cast<std::size_t>(most) + 20);
    EXPECT_GE(mean_score(tuned.best), mean_score(tuned.base));
  }
}

TEST(TuningSearch, CanBeStoppedAndKeepsItsResult) {
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

TEST(TuningSearch, WithoutTimeForATrialTheResultIsTheStart) {
  Known known;
  TuningSearch search = known.search();
  search.evaluate = [evaluate = search.evaluate](std::span<const Setting> settings, bool may_end) {
    if (may_end) throw TuningSpent();
    return evaluate(settings, may_end);
  };
  const Tuned tuned = search_options(search);
  EXPECT_FALSE(tuned.complete);
  EXPECT_TRUE(tuned.changes.empty());
}

TEST(TuningSearch, AGainOnASingleFrameDoesNotCount) {
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

TEST(TuningSpace, ValuesStayInTheirRangeAndStepsGetSmaller) {
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

TEST(TuningSpace, OptionsThatSelectScoredPointsAreNotTuned) {
  for (const char* name : {"max_range_m", "range_for_clouds", "cube_edge_m", "gravity", "profile",
                           "method", "classifier", "foot_radius_m"})
    EXPECT_FALSE(is_tunable(planes::find_option(name))) << name;
}

TEST(ParetoFront, ContainsTrialsThatNoOtherBeatsInBoth) {
  const auto front =
      pareto_front({{{}, 80, 30}, {{}, 70, 10}, {{}, 60, 20}, {{}, 80, 40}, {{}, 75, 10}});
  ASSERT_EQ(front.size(), 2u);
  EXPECT_EQ(front[0].ms, 10);
  EXPECT_EQ(front[0].pq, 75);
  EXPECT_EQ(front[1].ms, 30);
}

// ---- Journal ----

namespace fs = std::filesystem;

const TuningPurpose kPurpose = {{"frames or labels", "abc"}, {"weights", "def"}};
const Trial kFirst{{}, {1.0 / 3, 95.76322775203958}};
const Trial kSecond{{{"theta_coplane", "0.9"}, {"criterion4_n2", "off"}}, {50, 0}};

std::string text_of(const fs::path& file) {
  const auto bytes = read_file_bytes(file);
  return {bytes.begin(), bytes.end()};
}

class TuningJournalTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = fs::path(testing::TempDir()) /
           testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(dir_);
    fs::create_directories(dir_);
  }
  void write_both() const {
    TuningJournal journal(dir_, kPurpose);
    journal.add(kFirst, 12.5);
    journal.add(kSecond, 7);
  }
  std::string refusal_of(const TuningPurpose& purpose = kPurpose) const {
    try {
      (void)TuningJournal(dir_, purpose);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }
  fs::path dir_;
};

TEST_F(TuningJournalTest, IsReadBackAsItWasWritten) {
  write_both();
  const TuningJournal journal(dir_, kPurpose);
  ASSERT_EQ(journal.trials().size(), 2u);
  EXPECT_EQ(journal.trials()[0].scores, kFirst.scores);
  ASSERT_TRUE(journal.find(kSecond.setting));
  EXPECT_EQ(journal.find(kSecond.setting)->scores, kSecond.scores);
  EXPECT_EQ(journal.time_of(kSecond.setting), 7);
  EXPECT_FALSE(journal.find({{"theta_coplane", "0.91"}}));
}

TEST_F(TuningJournalTest, ATruncatedLineIsDroppedAndWrittenAgainIdentically) {
  write_both();
  const fs::path file = dir_ / "journal.jsonl";
  const std::string whole = text_of(file);
  const std::size_t second = whole.rfind('\n', whole.size() - 2) + 1;
  for (std::size_t size = second; size < whole.size(); size += 7) {
    write_file_text(file, whole.substr(0, size));
    TuningJournal journal(dir_, kPurpose);
    ASSERT_EQ(journal.trials().size(), 1u) << size;
    journal.add(kSecond, 7);
    EXPECT_EQ(text_of(file), whole) << size;
  }
}

TEST_F(TuningJournalTest, OneOfAnotherSearchIsRejectedWithTheDifference) {
  write_both();
  EXPECT_NE(refusal_of({{"frames or labels", "abc"}, {"weights", "other"}})
                .find("belongs to a search with different weights"),
            std::string::npos);
  EXPECT_NE(refusal_of({{"frames or labels", "x"}, {"weights", "def"}})
                .find("belongs to a search with different frames or labels"),
            std::string::npos);
  EXPECT_EQ(refusal_of(), "");
}

TEST_F(TuningJournalTest, DamageIsReportedWithItsLine) {
  write_both();
  const fs::path file = dir_ / "journal.jsonl";
  const std::string whole = text_of(file);
  write_file_text(file, whole + "{\"set\":{}}\n");
  EXPECT_NE(refusal_of().find("journal.jsonl, line 4"), std::string::npos) << refusal_of();
  write_file_text(file, whole + "{\"set\":{},\"scores\":[1]}\n");
  EXPECT_NE(refusal_of().find("line 4: found 1 scores; expected 2"), std::string::npos);
  write_file_text(file, "no journal\n");
  EXPECT_NE(refusal_of().find("line 1"), std::string::npos);
}

TEST_F(TuningJournalTest, WithoutTimesTheTrialsAreStillRead) {
  write_both();
  write_file_text(dir_ / "times.jsonl", "{\"trial\":1,\"ms\":3}\nrubbish\n");
  const TuningJournal journal(dir_, kPurpose);
  EXPECT_EQ(journal.trials().size(), 2u);
  EXPECT_FALSE(journal.time_of(kFirst.setting));
  EXPECT_EQ(journal.time_of(kSecond.setting), 3);
}

// ---- Answer ----

TuningAnswer answer_with(const std::vector<double>& held_base,
                         const std::vector<double>& held_tuned) {
  const Setting setting = {{"worth_px", "800"}};
  TuningAnswer answer;
  answer.frames = {"a 0", "a 1"};
  answer.tuned.base = {{}, {50, 60}};
  answer.tuned.best = {setting, {55, 66}};
  answer.tuned.changes = {{"worth_px", answer.tuned.base}};
  answer.held.assign(held_base.size(), "b 0");
  answer.held_base = {{}, held_base};
  answer.held_tuned = {setting, held_tuned};
  answer.priced = {{{}, 55, 30}, {setting, 60.5, 31.5}};
  answer.trials = 2;
  return answer;
}

TEST(TuningAnswer, ReportsTheGainOnHeldOutFrames) {
  const auto said = [](const std::vector<double>& base, const std::vector<double>& tuned) {
    return verdict(answer_with(base, tuned));
  };
  EXPECT_EQ(said({50, 60, 70}, {55, 65, 76}), "The tuned options gain on the held-out frames.");
  EXPECT_NE(said({50, 60, 70}, {58, 68, 69}).find("less than two standard errors"),
            std::string::npos);
  EXPECT_NE(said({50, 60, 70}, {58, 55, 70}).find("DO NOT GAIN"), std::string::npos);
  EXPECT_NE(said({50, 60, 70}, {45, 54, 65}).find("LOSE"), std::string::npos);
  EXPECT_NE(tuning_page(answer_with({50, 60, 70}, {45, 54, 65})).find("LOSE"), std::string::npos);
}

TEST(TuningAnswer, ReportsThatTheWorstOfFewFramesIsHeldOut) {
  TuningAnswer answer = answer_with({70, 20}, {70, 21});
  answer.held[1] = "b 7";
  EXPECT_NE(
      tuning_text(answer).find("The worst frame at the start, b 7 (PQ 20.00; the worst tuning "
                               "frame is a 0, PQ 50.00), is held out"),
      std::string::npos);
  EXPECT_NE(tuning_json(answer).find("\"note\": \"The worst frame"), std::string::npos);
  EXPECT_EQ(held_out_note(answer_with({70, 48}, {70, 48})), "");
  answer.frames.assign(9, "a 0");
  answer.tuned.base.scores.assign(9, 50);
  EXPECT_EQ(held_out_note(answer), "");
}

TEST(TuningAnswer, ListsOptionsWithOldAndNewValueAndGain) {
  const std::string text = tuning_text(answer_with({50, 60}, {55, 66}));
  EXPECT_NE(text.find("worth_px        1000         800  5.50"), std::string::npos) << text;
  EXPECT_EQ(tuned_profile(answer_with({50, 60}, {55, 66})),
            "{\n  \"schema\": \"planescope.profile/1\",\n  \"base\": \"refined\",\n"
            "  \"options\": {\n    \"worth_px\": 800\n  }\n}\n");
}

TEST(TuningAnswer, TheProfileKeepsTheStartingOptionsButNotThoseOfTheRecording) {
  TuningAnswer answer = answer_with({50, 60}, {55, 66});
  planes::set_option(answer.base, "profile", "paper");
  planes::set_option(answer.base, "theta_n_in", "9");
  planes::set_option(answer.base, "classifier", "pca");
  planes::set_option(answer.base, "max_range_m", "4");
  planes::set_option(answer.base, "gravity", "0,1,0");
  EXPECT_EQ(
      tuned_profile(answer),
      "{\n  \"schema\": \"planescope.profile/1\",\n  \"base\": \"paper\",\n  \"options\": {\n"
      "    \"classifier\": \"pca\",\n    \"theta_n_in\": 9,\n    \"worth_px\": 800\n  }\n}\n");
}

TEST(TuningAnswer, ThePictureIsSelfContainedAndFollowsTheReadersColors) {
  const std::string svg = pareto_picture(answer_with({50, 60}, {55, 66}));
  EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\""))
      << svg.substr(0, 80);
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_NE(svg.find("prefers-color-scheme:dark"), std::string::npos);
  EXPECT_NE(svg.find(">tuned</text>"), std::string::npos);
}

}  // namespace
}  // namespace planescope::lab
