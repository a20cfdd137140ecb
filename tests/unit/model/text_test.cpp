// Tests of text helpers: nearest names, numbers, splitting and one-line messages.

#include "core/model/text.hpp"

#include <gtest/gtest.h>

#include "core/model/error.hpp"

namespace planescope {
namespace {

TEST(Text, TheNearestNameIsTheIntendedOne) {
  const std::vector<std::string> names = {"segment", "report", "info", "eval"};
  EXPECT_EQ(nearest_name("segmnet", names), "segment");
  EXPECT_EQ(nearest_name("reprot", names), "report");
  EXPECT_EQ(nearest_name("inof", names), "info");
  EXPECT_EQ(nearest_name("se", names), "segment");
  EXPECT_EQ(nearest_name("s", names), "");
  EXPECT_EQ(nearest_name("xyzzy", names), "");
  EXPECT_EQ(nearest_name("", names), "");
  EXPECT_EQ(nearest_name("info", {}), "");
}

TEST(Text, ANumberMustBeTheWholeText) {
  EXPECT_EQ(parse_number("1.5e-3", "x"), 1.5e-3);
  EXPECT_EQ(parse_number("+2", "x"), 2);
  EXPECT_EQ(parse_number("-0.25", "x"), -0.25);
  EXPECT_EQ(parse_integer("-7", "x"), -7);
  for (const char* bad : {"", " 1", "1 ", "1,5", "1m", "nan", "inf", "--1", "+-1", "0x10"})
    EXPECT_THROW(parse_number(bad, "x"), Error) << bad;
  for (const char* bad : {"", "1.0", "1e3", "99999999999", "one"})
    EXPECT_THROW(parse_integer(bad, "x"), Error) << bad;
}

TEST(Text, SplittingKeepsEmptyParts) {
  EXPECT_EQ(split("a:b:c", ':'), (std::vector<std::string>{"a", "b", "c"}));
  EXPECT_EQ(split("::", ':'), (std::vector<std::string>{"", "", ""}));
  EXPECT_EQ(split("", ':'), (std::vector<std::string>{""}));
}

TEST(Text, MessagesAboutFilesAreOneLineForAnyName) {
  const std::string text = "a\nb\tc\r\x1b[31m \x7f \xc3\xbc \xff";
  const std::string line = "a b c ?[31m ? \xc3\xbc \xff";
  EXPECT_EQ(one_line(text), line);
  EXPECT_EQ(Error(text).what(), line);
  const std::string topic(1 << 20, 'x'), end(100, 'x');
  EXPECT_EQ(one_line("/a " + topic + " has"), "/a " + end + "..." + end + " has");
}

}  // namespace
}  // namespace planescope
