// Tests of line charts.

#include "core/report/page/charts.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "support/has.hpp"

using namespace planescope;

namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

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

}  // namespace

TEST(LineChart, DrawsEachCurveWithItsNameOverRoundTicks) {
  const std::string svg = report::line_chart(accuracy_chart());
  EXPECT_EQ(count(svg, "class=\"curve0\"") + count(svg, "class=\"curve1\""), 2u);
  for (const char* text : {">stairs<", ">scans<", ">steps<", ">0<", ">200<", ">1000<", ">60<",
                           ">100<", "aria-label=\"accuracy\""})
    EXPECT_NE(svg.find(text), std::string::npos) << text << " in " << svg;
}

TEST(LineChart, StartsAtZeroOnRequest) {
  report::LineChart chart = accuracy_chart();
  EXPECT_EQ(count(report::line_chart(chart), ">0<"), 1u) << "on the x axis alone";
  chart.from_zero = true;
  EXPECT_EQ(count(report::line_chart(chart), ">0<"), 2u);
}

TEST(LineChart, ShowsASinglePointAndConstantValues) {
  report::LineChart chart{.title = "", .x_name = "steps", .x = {3}, .curves = {{"one", {100}}}};
  const std::string point = report::line_chart(chart);
  EXPECT_EQ(point.find("nan"), std::string::npos) << point;
  EXPECT_EQ(point.find("inf"), std::string::npos) << point;
  chart.curves[0].values = {0};
  EXPECT_EQ(report::line_chart(chart).find("nan"), std::string::npos);
}

TEST(LineChart, ContinuesAfterAMissingValue) {
  const std::string svg = report::line_chart(
      {.title = "", .x_name = "", .x = {0, 1, 2}, .curves = {{"a", {1, kNone, 3}}}});
  EXPECT_FALSE(has(svg, "nan"));
  EXPECT_EQ(count(svg, "class=\"curve0\""), 1u);
}
