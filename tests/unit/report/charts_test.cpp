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

}  // namespace

TEST(BarChart, DrawsABarForEachValueThereIsAndSaysIt) {
  const std::string svg =
      report::bar_chart({.title = "IoU",
                         .groups = {"stairs\n0.1 cm", "kerbs & ramps"},
                         .bars = {{"ours", {97.5, 80}}, {"ransac", {95, kNone}}}});
  EXPECT_EQ(count(svg, "<title>"), 3u);
  for (const char* text : {"<title>ours, stairs 0.1 cm: 97.50</title>",
                           "<title>ours, kerbs &amp; ramps: 80.00</title>", ">0.1 cm</text>",
                           ">ransac</text>", "aria-label=\"IoU\""})
    EXPECT_TRUE(has(svg, text)) << text << " in " << svg;
  EXPECT_FALSE(has(svg, "nan"));
}

TEST(LineChart, GoesOnAfterAValueThatIsMissing) {
  const std::string svg = report::line_chart(
      {.title = "", .x_name = "", .x = {0, 1, 2}, .curves = {{"a", {1, kNone, 3}}}});
  EXPECT_FALSE(has(svg, "nan"));
  EXPECT_EQ(count(svg, "class=\"curve0\""), 1u);
}

TEST(LineChart, OnALogarithmicAxisEqualFactorsAreEquallyFarApart) {
  const std::string svg = report::line_chart(
      {.title = "", .x_name = "", .x = {1, 10, 100}, .curves = {{"a", {1, 2, 3}}}, .log_x = true});
  for (const char* at : {"cx=\"52.0\"", "cx=\"318.0\"", "cx=\"584.0\"", ">100<"})
    EXPECT_TRUE(has(svg, at)) << at;
}

TEST(LineChart, PutsWhatIsLessThanALogarithmicAxisShowsAtItsBeginning) {
  const auto chart = [](double value) {
    return report::line_chart(
        {.title = "", .x_name = "", .x = {0, 1}, .curves = {{"a", {value, 10}}}, .log_from = 0.01});
  };
  EXPECT_EQ(chart(0), chart(0.01));
  EXPECT_NE(chart(0), chart(0.1));
  for (const char* tick : {">0.01<", ">0.1<", ">1<", ">10<"})
    EXPECT_TRUE(has(chart(0), tick)) << tick;
}
