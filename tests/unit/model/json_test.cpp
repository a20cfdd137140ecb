// Tests of the JSON field visitor and the JSON parser.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "core/model/json_fields.hpp"
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

enum class Fruit : std::uint8_t { apple, pear };
constexpr std::array<const char*, 2> names_of(Fruit) { return {"apple", "pear"}; }

struct Leaf {
  int id = 0;
  std::string note;
  bool operator==(const Leaf&) const = default;
};
void visit_fields(auto& fields, Same<Leaf> auto& leaf) {
  fields("id", leaf.id);
  fields.with_default("note", leaf.note, "");
}

struct Tree {
  double height_m = 0;
  Fruit fruit = Fruit::apple;
  Vec3d place = Vec3d::Zero();
  std::optional<double> age;
  std::vector<Leaf> leaves;
  std::array<double, 2> limits{};
  int shift = 0;
  std::uint32_t seed = 0;
  bool operator==(const Tree&) const = default;
};
void visit_fields(auto& fields, Same<Tree> auto& tree) {
  fields("height_m", tree.height_m, kRounded);
  fields("fruit", tree.fruit);
  fields("place", tree.place);
  fields("age", tree.age);
  fields("leaves", tree.leaves);
  fields("limits", tree.limits);
  fields("shift", tree.shift, kSigned);
  fields("seed", tree.seed, kOptional);
}

Tree some_tree() {
  return {2.5, Fruit::pear, {1, 0, -2}, {}, {{3, "green"}, {4, ""}}, {0.25, 0.5}, -7, 4294967295u};
}

}  // namespace

TEST(JsonFields, AreWrittenInOrderAndReadBack) {
  const Tree tree = some_tree();
  const nlohmann::ordered_json json = json_of(tree);
  EXPECT_EQ(json.dump(),
            R"({"height_m":2.5,"fruit":"pear","place":[1.0,0.0,-2.0],"age":null,)"
            R"("leaves":[{"id":3,"note":"green"},{"id":4}],"limits":[0.25,0.5],"shift":-7,)"
            R"("seed":4294967295})");
  Tree read;
  read.age = 1;
  read_fields(JsonPlace(json), read);
  EXPECT_EQ(read, tree);
}

TEST(JsonFields, ReportWhereWhatWasFoundAndWhatWasExpected) {
  const auto refused = [](const char* change, const std::string& expected) {
    nlohmann::ordered_json json = json_of(some_tree());
    json.merge_patch(nlohmann::ordered_json::parse(change));
    expect_refused(
        [&] {
          read_place("tree.json", json, [](const JsonPlace& place) {
            Tree tree;
            read_fields(place, tree);
          });
        },
        "tree.json: " + expected);
  };
  refused(R"({"height_m": null})", "the file has no \"height_m\"");
  refused(R"({"height_m": "tall"})", "height_m is \"tall\"; expected a number");
  refused(R"({"fruit": "plum"})", "fruit is \"plum\"; expected one of apple, pear");
  refused(R"({"place": [1, 2]})", "place is [1,2]; expected three numbers");
  refused(R"({"leaves": [{"id": 1}, {"id": -1}]})",
          "leaves[1].id is -1; expected a whole number from 0 to");
  refused(R"({"limits": [1, 2, 3]})", "limits is [1,2,3]; expected 2 values");
  refused(R"({"seed": 4294967296})", "seed is 4294967296; expected a whole number from 0 to");
}

TEST(JsonFields, OfAnEarlierVersionAreRejectedInOneLine) {
  const auto schema = [](const char* found) {
    const nlohmann::ordered_json json = {{"schema", found}};
    return JsonPlace(json).schema({"planescope.tree/2", "planescope.tree/3"});
  };
  EXPECT_EQ(schema("planescope.tree/3"), "planescope.tree/3");
  expect_refused([&] { schema("planescope.tree/1"); },
                 "planescope.tree/1 is no longer supported; expected planescope.tree/2 or "
                 "planescope.tree/3");
  expect_refused([&] { schema("planescope.tree/4"); },
                 "schema is \"planescope.tree/4\"; expected planescope.tree/2 or");
}

TEST(JsonText, IsReadUpToSixtyFourLevelsAndRejectedBeyond) {
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

TEST(JsonText, ReportsWhereItIsDamaged) {
  expect_refused([] { parse_json<Json>("{\"a\": 1,\n\"b\": }", "b.json"); },
                 "b.json: not valid JSON: parse error at line 2, column 6");
  expect_refused([] { parse_json<Json>("", "empty.json"); }, "empty.json: not valid JSON");
  expect_refused([] { parse_json<Json>("[1e999]", "big.json"); }, "big.json: not valid JSON");
}

TEST(JsonText, RejectsDuplicateKeysInOneObjectOnly) {
  EXPECT_EQ(parse_json<Json>(R"({"a": {"b": 1}, "b": 2, "c": [{"b": 3}, {"b": 4}]})", "x").size(),
            3U);
  expect_refused([] { parse_json<Json>(R"({"a": {"b": 1, "c": 2, "b": 3}})", "x.json"); },
                 "x.json: \"b\" appears twice in one object");
}

TEST(JsonText, AWholeNumberMustFitItsType) {
  EXPECT_EQ(whole_number(Json(7), 0, 7, "x"), 7);
  EXPECT_EQ(whole_int(Json(-2147483648LL), "x"), -2147483647 - 1);
  for (const char* text : {"8", "-1", "1.5", "7.0", "1e300", "4294967296", "18446744073709551615",
                           "\"1\"", "null", "[1]"})
    expect_refused([&] { whole_number(Json::parse(text), 0, 7, "x"); },
                   "expected a whole number from 0 to 7");
  expect_refused([] { whole_int(Json(4294967297LL), "its id"); }, "its id is 4294967297; expected");
}

TEST(JsonText, MayContainComments) {
  EXPECT_EQ(parse_json<Json>("{\"a\": 1 /* metres */} // the end", "x").at("a"), 1);
}
