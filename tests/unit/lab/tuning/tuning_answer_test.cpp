#include "core/lab/tuning/tuning_answer.hpp"

#include <gtest/gtest.h>

namespace planescope::lab {
namespace {

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

TEST(TuningAnswer, SaysWhetherWhatWasHeldOutGains) {
  const auto said = [](const std::vector<double>& base, const std::vector<double>& tuned) {
    return verdict(answer_with(base, tuned));
  };
  EXPECT_EQ(said({50, 60, 70}, {55, 65, 76}),
            "The tuned options gain on the frames that were held out.");
  EXPECT_NE(said({50, 60, 70}, {58, 68, 69}).find("less than two standard errors"),
            std::string::npos);
  EXPECT_NE(said({50, 60, 70}, {58, 55, 70}).find("DO NOT GAIN"), std::string::npos);
  EXPECT_NE(said({50, 60, 70}, {45, 54, 65}).find("LOSE"), std::string::npos);
  EXPECT_NE(tuning_page(answer_with({50, 60, 70}, {45, 54, 65})).find("LOSE"), std::string::npos);
}

TEST(TuningAnswer, NamesEachOptionWithWhatItWasIsAndIsWorth) {
  const std::string text = tuning_text(answer_with({50, 60}, {55, 66}));
  EXPECT_NE(text.find("worth_px        1000         800  5.50"), std::string::npos) << text;
  EXPECT_EQ(tuned_profile(answer_with({50, 60}, {55, 66})),
            "{\n  \"schema\": \"planescope.profile/1\",\n  \"base\": \"refined\",\n"
            "  \"options\": {\n    \"worth_px\": 800\n  }\n}\n");
}

TEST(TuningAnswer, TheProfileHasWhatTheSearchBeganWithButNothingOfTheRecording) {
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

TEST(TuningAnswer, ThePictureStandsAloneAndFollowsTheReadersColours) {
  const std::string svg = pareto_picture(answer_with({50, 60}, {55, 66}));
  EXPECT_TRUE(svg.starts_with("<svg xmlns=\"http://www.w3.org/2000/svg\" class=\"chart\""))
      << svg.substr(0, 80);
  EXPECT_TRUE(svg.ends_with("</svg>\n"));
  EXPECT_NE(svg.find("prefers-color-scheme:dark"), std::string::npos);
  EXPECT_NE(svg.find(">tuned</text>"), std::string::npos);
}

}  // namespace
}  // namespace planescope::lab
