#include <gtest/gtest.h>

#include <algorithm>

#include "core/debug/filter/filter.hpp"

namespace planescope::debug {
namespace {

std::vector<std::string> at_end(const std::string& text) {
  std::vector<std::string> inserts;
  for (const Completion& completion : complete_filter(text, text.size()))
    inserts.push_back(completion.insert);
  return inserts;
}

bool offers(const std::vector<std::string>& completions, const std::string& name) {
  return std::find(completions.begin(), completions.end(), name) != completions.end();
}

TEST(FilterCompletion, OffersWhatStartsWithTheLettersBeforeWhatContainsThem) {
  const auto completions = at_end("de");
  ASSERT_GE(completions.size(), 3u);
  EXPECT_EQ(completions[0], "decide");
  EXPECT_EQ(completions[1], "depth");
  EXPECT_TRUE(offers(completions, "node"));
}

TEST(FilterCompletion, OffersTheValuesOfTheFieldThatIsCompared) {
  EXPECT_EQ(at_end("case=="), (std::vector<std::string>{"I", "II", "III", "IV"}));
  EXPECT_EQ(at_end("visit && label != "), (std::vector<std::string>{"h", "v"}));
  EXPECT_EQ(at_end("case==II"), (std::vector<std::string>{"II", "III"}));
}

TEST(FilterCompletion, OffersThresholdsFirstWhereANumberIsCompared) {
  const auto completions = at_end("mse>0.8*");
  ASSERT_FALSE(completions.empty());
  EXPECT_TRUE(completions[0].starts_with("theta_"));
  EXPECT_FALSE(offers(completions, "visit"));
}

TEST(FilterCompletion, OffersSignsBehindAValue) {
  EXPECT_TRUE(offers(at_end("depth "), ">="));
  EXPECT_EQ(at_end("case "), (std::vector<std::string>{"==", "!="}));
  EXPECT_EQ(at_end("depth>3 "), (std::vector<std::string>{"&&", "||"}));
  EXPECT_EQ(at_end("visit "), (std::vector<std::string>{"&&", "||"}));
}

TEST(FilterCompletion, KeepsOutOfTheWayOfANumberBeingTyped) {
  EXPECT_TRUE(at_end("depth>3").empty());
}

TEST(FilterCompletion, ReplacesTheWholeWordThatTheCursorIsIn) {
  const auto completions = complete_filter("visit && dexx>3", 11);
  ASSERT_FALSE(completions.empty());
  EXPECT_EQ(completions[0].begin, 9u);
  EXPECT_EQ(completions[0].end, 13u);
}

}  // namespace
}  // namespace planescope::debug
