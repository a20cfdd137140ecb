#include "core/model/json.hpp"

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/refusal.hpp"

using namespace planescope;
using Json = nlohmann::json;

namespace {

std::string nested(int levels, const std::string& open, const std::string& close) {
  std::string text;
  for (int i = 0; i < levels; ++i) text += open;
  for (int i = 0; i < levels; ++i) text += close;
  return text;
}

}  // namespace

TEST(JsonText, IsReadFromWithinSixtyFourLevelsAndRefusedBelow) {
  EXPECT_TRUE(parse_json<Json>(nested(65, "[", "]"), "deep.json").is_array());
  for (const int levels : {66, 150000}) {
    expect_refused([&] { parse_json<Json>(nested(levels, "[", "]"), "deep.json"); },
                   "deep.json: JSON nested deeper than 64 levels");
    expect_refused(
        [&] { parse_json<nlohmann::ordered_json>(nested(levels, "{\"a\":", "}"), "deep.json"); },
        "deep.json: JSON nested deeper than 64 levels");
    expect_refused([&] { parse_json<Json>(nested(levels, "[", ""), "open.json"); },
                   "open.json: JSON nested deeper than 64 levels");
  }
}

TEST(JsonText, SaysWhereItIsDamaged) {
  expect_refused([] { parse_json<Json>("{\"a\": 1,\n\"b\": }", "b.json"); },
                 "b.json: not valid JSON: parse error at line 2, column 6");
  expect_refused([] { parse_json<Json>("", "empty.json"); }, "empty.json: not valid JSON");
  expect_refused([] { parse_json<Json>("[1e999]", "big.json"); }, "big.json: not valid JSON");
}

TEST(JsonText, RefusesAKeyThatIsThereTwiceInOneObjectOnly) {
  EXPECT_EQ(parse_json<Json>(R"({"a": {"b": 1}, "b": 2, "c": [{"b": 3}, {"b": 4}]})", "x").size(),
            3U);
  expect_refused([] { parse_json<Json>(R"({"a": {"b": 1, "c": 2, "b": 3}})", "x.json"); },
                 "x.json: has \"b\" twice in one object");
}

TEST(JsonText, AWholeNumberIsOneThatItsTypeHolds) {
  EXPECT_EQ(whole_number(Json(7), 0, 7, "x"), 7);
  EXPECT_EQ(whole_int(Json(-2147483648LL), "x"), -2147483647 - 1);
  for (const char* text : {"8", "-1", "1.5", "7.0", "1e300", "4294967296", "18446744073709551615",
                           "\"1\"", "null", "[1]"})
    expect_refused([&] { whole_number(Json::parse(text), 0, 7, "x"); },
                   "expected a whole number from 0 to 7");
  expect_refused([] { whole_int(Json(4294967297LL), "its id"); }, "its id is 4294967297, expected");
}

TEST(JsonText, MayHoldComments) {
  EXPECT_EQ(parse_json<Json>("{\"a\": 1 /* metres */} // the end", "x").at("a"), 1);
}
