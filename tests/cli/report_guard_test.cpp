// Reports that are held to a baseline and to rules.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/report_run.hpp"
#include "cli/scene_files.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
using Json = nlohmann::json;

TEST(ReportGuard, PassesAnUnchangedRunAndFailsAWorseOne) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 2);
  const auto report = [&](const std::string& out, std::vector<std::string> more) {
    return run(report_args({dir / "rec"}, dir / out, more));
  };
  const std::string baseline = (dir / "baseline.json").string();
  const Ran first = report("first", {"--baseline", baseline, "--approve"});
  ASSERT_EQ(first.code, 0) << first.err;
  EXPECT_EQ(read_text(baseline), read_text(dir / "first/report.json"));

  const Ran same = report("same", {"--baseline", baseline, "--threads", "1"});
  EXPECT_EQ(same.code, 0) << same.err;
  // A busy machine may add a warning about the time.
  EXPECT_NE(same.out.find("\n0 errors, "), std::string::npos) << same.out;
  EXPECT_NE(same.out.find(" against " + baseline), std::string::npos) << same.out;
  EXPECT_EQ(same.out.find("planes_"), std::string::npos) << same.out;

  const Ran tilted = report("tilted", {"--baseline", baseline, "--gravity", "0.1,1,0"});
  EXPECT_EQ(tilted.code, 1);
  EXPECT_NE(tilted.out.find("error  rec frame 0: a plane turned by "), std::string::npos)
      << tilted.out;

  const Ran coarse = report("coarse", {"--baseline", baseline, "--voxel", "0.04", "--json"});
  const Json verdict = Json::parse(coarse.out)["verdict"];
  EXPECT_EQ(verdict["differences"], Json({"option voxel_size_m: 0.02 -> 0.04"}));
  EXPECT_EQ(coarse.code, verdict["errors"] > 0 ? 1 : 0);

  const Ran approved =
      report("tilted", {"--baseline", baseline, "--gravity", "0.1,1,0", "--approve"});
  EXPECT_EQ(approved.code, 0) << "it was looked at";
  EXPECT_EQ(report("again", {"--baseline", baseline, "--gravity", "0.1,1,0"}).code, 0);
}

/// As if the run had found all of the baseline's planes by a small margin; of version 3, it does
/// not tell.
void make_undecided(const std::string& baseline, bool tells) {
  Json json = Json::parse(read_text(baseline));
  if (!tells) json["schema"] = "planescope.report/3";
  for (Json& frame : json["recordings"][0]["frames"])
    for (Json& plane : frame["planes"])
      if (tells) {
        plane["margin"] = 0.02;
        plane["undecided"] = true;
      } else {
        plane.erase("margin");
        plane.erase("undecided");
      }
  write_text(baseline, json.dump());
}

TEST(ReportGuard, NotesWhatUndecidedPlanesChangeAndEndsWithZero) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  const std::string baseline = (dir / "baseline.json").string();
  const auto report = [&](const std::string& out, std::vector<std::string> more) {
    more.insert(more.end(), {"--baseline", baseline});
    return run(report_args({dir / "rec"}, dir / out, more));
  };
  ASSERT_EQ(report("first", {"--approve"}).code, 0);
  make_undecided(baseline, true);
  const Ran noted = report("noted", {"--gravity", "0.1,1,0"});
  EXPECT_EQ(noted.code, 0) << noted.out << noted.err;
  EXPECT_NE(noted.out.find("note   rec frame 0: a plane turned by "), std::string::npos)
      << noted.out;
  EXPECT_NE(noted.out.find("0 errors, "), std::string::npos) << noted.out;
  make_undecided(baseline, false);
  const Ran failed = report("failed", {"--gravity", "0.1,1,0"});
  EXPECT_EQ(failed.code, 1) << "all planes of an earlier version are decided";
  EXPECT_NE(failed.out.find("error  rec frame 0: a plane turned by "), std::string::npos)
      << failed.out;
}

TEST(ReportGuard, WarnsOfWhatNothingIsHeldTo) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 2);
  write_depth_folder(dir / "new", floor_and_wall());
  write_text(dir / "rules.json",
             R"({"schema": "planescope.rules/1", "rules": [
               {"metric": "planes_lost", "at_most": 0},
               {"metric": "planes", "recording": "rce", "at_least": 2}]})");
  const std::string rules = (dir / "rules.json").string();
  const Ran forgotten = run(report_args({dir / "rec"}, dir / "out", {"--rules", rules}));
  EXPECT_EQ(forgotten.code, 0) << forgotten.err;
  EXPECT_NE(
      forgotten.out.find(
          "warn   planes_lost: this rule holds nothing, it needs a baseline\n"
          "warn   planes of rce: this rule holds nothing, there is no recording of this name\n"
          "0 errors, 2 warnings\n"),
      std::string::npos)
      << forgotten.out;
  std::filesystem::copy(dir / "out/report.json", dir / "baseline.json");
  const Ran more = run(report_args({dir / "rec", dir / "new"}, dir / "more",
                                   {"--baseline", (dir / "baseline.json").string()}));
  EXPECT_EQ(more.code, 0) << more.err;
  EXPECT_NE(more.out.find("warn   new: is not in the baseline\n0 errors, "), std::string::npos)
      << more.out;
  EXPECT_EQ(read_report(dir / "more")["verdict"]["unguarded"],
            Json({"new: is not in the baseline"}));
  EXPECT_NE(read_text(dir / "more/index.html").find("new: is not in the baseline"),
            std::string::npos);
}

TEST(ReportGuard, ANameThatIsNoTextIsTheBaselinesAllTheSame) {
  const auto dir = scratch();
  const auto recording = dir / "rec\xff";
  write_depth_folder(recording, floor_and_wall());
  const std::string baseline = (dir / "baseline.json").string();
  ASSERT_EQ(run(report_args({recording}, dir / "a", {"--baseline", baseline, "--approve"})).code,
            0);
  const Ran again = run(report_args({recording}, dir / "b", {"--baseline", baseline}));
  EXPECT_EQ(again.code, 0) << again.out << again.err;
}

TEST(ReportGuard, AFolderForTheFirstBaselineIsMade) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  const auto baseline = dir / "ci" / "planes" / "baseline.json";
  const Ran ran =
      run(report_args({dir / "rec"}, dir / "out", {"--baseline", baseline.string(), "--approve"}));
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(read_text(baseline), read_text(dir / "out/report.json"));
}

TEST(ReportGuard, WhereTheBaselineCannotBeKeptIsFoundBeforeAnythingIsRun) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  write_text(dir / "file", "no folder");
  for (const auto& baseline : {dir / "file" / "baseline.json", dir / "rec"}) {
    const Ran ran = run(
        report_args({dir / "rec"}, dir / "out", {"--baseline", baseline.string(), "--approve"}));
    EXPECT_EQ(ran.code, 2);
    EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
    EXPECT_FALSE(std::filesystem::exists(dir / "out"));
  }
}

TEST(ReportGuard, HoldsAReportToRulesOfItsOwn) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  const auto with_rule = [&](const std::string& rule) {
    std::ofstream(dir / "rules.json")
        << R"({"schema": "planescope.rules/1", "rules": [)" << rule << "]}";
    return run(report_args({dir / "rec"}, dir / "out", {"--rules", (dir / "rules.json").string()}));
  };
  EXPECT_EQ(with_rule(R"({"metric": "planes", "at_least": 2})").code, 0);
  EXPECT_EQ(with_rule(R"({"metric": "planes", "at_least": 3, "level": "warn"})").code, 0);
  EXPECT_EQ(with_rule(R"({"metric": "planes", "at_least": 3})").code, 1);
  const Ran wrong = with_rule(R"({"metric": "plans", "at_least": 3})");
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(is_one_line(wrong.err)) << wrong.err;
}

TEST(ReportGuard, HoldsAReportToWhereAFootMayGo) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  write_text(dir / "rules.json", R"({"schema": "planescope.rules/1", "rules": [
               {"metric": "steppable_area_change", "at_least": -0.001}]})");
  const auto report = [&](const std::string& out, std::vector<std::string> more) {
    more.insert(more.end(), {"--baseline", (dir / "baseline.json").string(), "--rules",
                             (dir / "rules.json").string()});
    return run(report_args({dir / "rec"}, dir / out, more));
  };
  ASSERT_EQ(report("first", {"--foot", "0.05", "--approve"}).code, 0);
  const Json frame = read_report(dir / "first")["recordings"][0]["frames"][0];
  ASSERT_GT(frame["steppable_area_m2"], 0.01);
  int steppable = 0;
  for (const Json& plane : frame["planes"]) steppable += plane["foot"]["steppable"].get<bool>();
  EXPECT_EQ(steppable, 1) << "the floor, and not the wall";
  EXPECT_NE(read_text(dir / "first/index.html").find("What one can stand on"), std::string::npos);
  EXPECT_EQ(report("same", {"--foot", "0.05"}).code, 0);
  const Ran narrow = report("narrow", {"--foot", "0.05", "--set", "foot_min_area_m2=9"});
  EXPECT_EQ(narrow.code, 1) << narrow.out;
  EXPECT_NE(narrow.out.find("is no longer steppable: "), std::string::npos) << narrow.out;
  EXPECT_NE(read_text(dir / "narrow/index.html").find("is no longer steppable: "),
            std::string::npos);
  const Ran footless = report("footless", {});
  EXPECT_EQ(footless.code, 0);
  EXPECT_NE(footless.out.find("this rule holds nothing, a foot is not given to both"),
            std::string::npos)
      << footless.out;
  const Ran wrong = report("wrong", {"--foot", "wide"});
  EXPECT_EQ(wrong.code, 2);
  EXPECT_TRUE(is_one_line(wrong.err)) << wrong.err;
}

TEST(ReportGuard, ABrokenBaselineIsFoundBeforeAnythingIsWritten) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  for (const char* text : {"", "{", "[]", R"({"schema": "planescope.report/99"})"}) {
    std::ofstream(dir / "baseline.json") << text;
    const Ran ran = run(
        report_args({dir / "rec"}, dir / "out", {"--baseline", (dir / "baseline.json").string()}));
    EXPECT_EQ(ran.code, 2) << text;
    EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
    EXPECT_NE(ran.err.find("baseline.json"), std::string::npos) << ran.err;
    EXPECT_FALSE(std::filesystem::exists(dir / "out"));
  }
  EXPECT_EQ(run(report_args({dir / "rec"}, dir / "out", {"--approve"})).code, 2);
  EXPECT_EQ(run(report_args({dir / "rec"}, dir / "out", {"--baseline", "/nowhere.json"})).code, 2);
}
