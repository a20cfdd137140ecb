// Profiles of one's own, and the search for them.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
using Json = nlohmann::json;

namespace {

/// Value of an option as `planescope options` shows it with these words typed.
std::string value_of(std::vector<std::string> typed, const std::string& name) {
  typed.insert(typed.begin(), {"options", "--json"});
  const Ran ran = run(typed);
  EXPECT_EQ(ran.code, 0) << ran.err;
  const Json printed = Json::parse(ran.out);
  for (const Json& option : printed["options"])
    if (option["name"] == name) return option["value"];
  return "no such option";
}

}  // namespace

TEST(ProfileOfOnesOwn, IsTakenAndWhatIsTypedBesideItWins) {
  const auto file = scratch() / "mine.json";
  write_text(file, R"({"schema": "planescope.profile/1", "base": "paper",
                      "options": {"theta_n_in": 12, "theta_coplane": 0.9, "r7_second_merge": true}})");
  EXPECT_EQ(value_of({"--profile", file.string()}, "theta_n_in"), "12");
  EXPECT_EQ(value_of({"--profile", file.string()}, "profile"), "paper");
  EXPECT_EQ(value_of({"--profile", file.string()}, "r7_second_merge"), "on");
  const std::vector<std::string> both = {"--set", "theta_n_in=20", "--profile", file.string()};
  EXPECT_EQ(value_of(both, "theta_n_in"), "20");
  EXPECT_EQ(value_of(both, "theta_coplane"), "0.9");
}

TEST(ProfileOfOnesOwn, WhatItSetsIsRecordedInThePlanes) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  write_text(dir / "mine.json", R"({"schema": "planescope.profile/1",
                                    "options": {"theta_n_in": 12}})");
  const auto planes = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> words = {
        "segment", (dir / "rec").string(), "-o", (dir / out).string(), "--gravity", "0,1,0"};
    words.insert(words.end(), more.begin(), more.end());
    const Ran ran = run(words);
    EXPECT_EQ(ran.code, 0) << ran.err;
    return read_text(dir / out / "frames/000000/planes.json");
  };
  const std::string by_file = planes("a", {"--profile", (dir / "mine.json").string()});
  EXPECT_EQ(by_file, planes("b", {"--set", "theta_n_in=12"}));
  EXPECT_NE(by_file, planes("c", {}));
}

TEST(ProfileOfOnesOwn, ABadOneIsRefusedInOneLineByEveryCommand) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  write_text(dir / "bad.json", R"({"schema": "planescope.profile/1",
                                   "options": {"theta_n_inn": 12}})");
  for (const std::string command : {"view", "info", "segment", "report", "eval", "train"}) {
    const Ran ran =
        run({command, (dir / "rec").string(), "--profile", (dir / "bad.json").string()});
    EXPECT_EQ(ran.code, 2) << command;
    EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
    EXPECT_NE(ran.err.find("bad.json: option 'theta_n_inn' is unknown, did you mean 'theta_n_in'?"),
              std::string::npos)
        << ran.err;
  }
  const Ran missing = run({"options", "--profile", (dir / "none.json").string()});
  EXPECT_EQ(missing.code, 2);
  EXPECT_TRUE(is_one_line(missing.err)) << missing.err;
}
