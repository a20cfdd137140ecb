#include "core/lab/training/training_page.hpp"

#include <gtest/gtest.h>

#include "core/report/page/charts.hpp"

using namespace planescope;

namespace {

std::size_t count(const std::string& text, const std::string& part) {
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

report::LineChart accuracy_chart() {
  return {.title = "accuracy",
          .x_name = "steps",
          .x = {250, 500, 1000},
          .curves = {{"stairs", {80, 90, 95}}, {"scans", {60, 80, 88}}}};
}

lab::TrainingSummary two_epochs() {
  return {.title = "Training of <own>.safetensors",
          .facts = {{"Recipe", "planescope"}, {"Command", "planescope train -o '<own>'"}},
          .validation_sets = {"stairs 0 cm", "scans"},
          .epochs = {{250, 0.5, {{90, 100, 998, 1000}, {80, 100, 990, 1000}}},
                     {500, 0.25, {{95, 100, 999, 1000}, {85, 100, 995, 1000}}}}};
}

}  // namespace

TEST(LineChart, DrawsEachCurveWithItsNameOverRoundTicks) {
  const std::string svg = report::line_chart(accuracy_chart());
  EXPECT_EQ(count(svg, "class=\"curve0\"") + count(svg, "class=\"curve1\""), 2u);
  for (const char* text : {">stairs<", ">scans<", ">steps<", ">0<", ">200<", ">1000<", ">60<",
                           ">100<", "aria-label=\"accuracy\""})
    EXPECT_NE(svg.find(text), std::string::npos) << text << " in " << svg;
}

TEST(LineChart, BeginsAtZeroWhereItIsAskedTo) {
  report::LineChart chart = accuracy_chart();
  EXPECT_EQ(count(report::line_chart(chart), ">0<"), 1u) << "on the x axis alone";
  chart.from_zero = true;
  EXPECT_EQ(count(report::line_chart(chart), ">0<"), 2u);
}

TEST(LineChart, ShowsASinglePointAndValuesThatAreAllTheSame) {
  report::LineChart chart{.title = "", .x_name = "steps", .x = {3}, .curves = {{"one", {100}}}};
  const std::string point = report::line_chart(chart);
  EXPECT_EQ(point.find("nan"), std::string::npos) << point;
  EXPECT_EQ(point.find("inf"), std::string::npos) << point;
  chart.curves[0].values = {0};
  EXPECT_EQ(report::line_chart(chart).find("nan"), std::string::npos);
}

TEST(TrainingPage, ShowsFactsCurvesAndEveryEpochAndNeedsNothingElse) {
  const std::string page = lab::training_page(two_epochs());
  EXPECT_EQ(count(page, "<svg"), 2u);
  for (const char* text : {"<dt>Recipe</dt><dd>planescope</dd>", "<td>250</td><td>0.5000</td>",
                           "<td>90.00 / 99.80</td>", "<td>85.00 / 99.50</td>", "stairs 0 cm",
                           "prefers-color-scheme:dark"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
  for (const char* text : {"http", "<script", "<link", "<own>"})
    EXPECT_EQ(page.find(text), std::string::npos) << text;
}

TEST(TrainingPage, BeforeTheFirstEpochSaysSo) {
  lab::TrainingSummary summary = two_epochs();
  summary.epochs.clear();
  const std::string page = lab::training_page(summary);
  EXPECT_EQ(page.find("<svg"), std::string::npos);
  EXPECT_NE(page.find("No epoch is complete yet"), std::string::npos);
}
