// Reports compared with a baseline and with rules.

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
  const auto dir = scratch_with_rec(2);
  const auto report = [&](const std::string& out, std::vector<std::string> more) {
    return run(report_args({dir / "rec"}, dir / out, more));
  };
  const std::string baseline = (dir / "baseline.json").string();
  well(report("first", {"--baseline", baseline, "--approve"}));
  EXPECT_EQ(read_text(baseline), read_text(dir / "first/report.json"));

  const Ran same = well(report("same", {"--baseline", baseline, "--threads", "1"}));
  // A busy machine may cause a warning about times.
  EXPECT_TRUE(has(same.out, "\n0 errors, "));
  EXPECT_TRUE(has(same.out, " against " + baseline));
  EXPECT_FALSE(has(same.out, "planes_"));

  const Ran tilted = report("tilted", {"--baseline", baseline, "--gravity", "0.1,1,0"});
  EXPECT_EQ(tilted.code, 1);
  EXPECT_TRUE(has(tilted.out, "error  rec frame 0: a plane turned by "));

  const Ran coarse = report("coarse", {"--baseline", baseline, "--voxel", "0.04", "--json"});
  const Json verdict = Json::parse(coarse.out)["verdict"];
  EXPECT_EQ(verdict["differences"], Json({"option voxel_size_m: 0.02 -> 0.04"}));
  EXPECT_EQ(coarse.code, verdict["errors"] > 0 ? 1 : 0);

  const Ran approved =
      report("tilted", {"--baseline", baseline, "--gravity", "0.1,1,0", "--approve"});
  EXPECT_EQ(approved.code, 0) << "it was looked at";
  well(report("again", {"--baseline", baseline, "--gravity", "0.1,1,0"}));
}

TEST(ReportGuard, ApprovingOneRecordingKeepsTheOthers) {
  const auto dir = scratch();
  for (const char* name : {"a", "b"}) write_depth_folder(dir / name, floor_and_wall(), 2);
  const auto baseline = dir / "baseline.json";
  const auto report = [&](std::vector<std::filesystem::path> recordings,
                          std::vector<std::string> more) {
    more.insert(more.end(), {"--baseline", baseline});
    return run(report_args(recordings, dir / "out", more));
  };
  expect_refused(report({dir / "a"}, {}), "no such baseline; add --approve");
  well(report({dir / "a", dir / "b"}, {"--approve"}));
  const Json before = Json::parse(read_text(baseline));

  const Ran part = well(report({dir / "b"}, {}));
  EXPECT_TRUE(has(part.out, "warn   a: in the baseline, not in this report\n0 errors, "));
  well(report({dir / "b"}, {"--approve"}));
  EXPECT_EQ(Json::parse(read_text(baseline))["recordings"].size(), 2u);
  EXPECT_EQ(Json::parse(read_text(baseline))["timings"].size(), before["timings"].size());
  const Ran whole = well(report({dir / "a", dir / "b"}, {}));
  EXPECT_FALSE(has(whole.out, "not in the baseline"));

  expect_refused(report({dir / "b"}, {"--approve", "--voxel", "0.04"}), "option voxel_size_m");
  expect_refused(report({dir / "b"}, {"--approve", "--frames", "0"}), "has 2 frames from b");
  well(report({dir / "b"}, {"--approve-only"}));
  EXPECT_EQ(Json::parse(read_text(baseline))["recordings"].size(), 1u);
}

TEST(ReportGuard, NewProblemsAreReportedAndADamagedFrameEndsWith2) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 4);
  write_depth_folder(dir / "empty", Image16(160, 120));
  const auto depth = dir / "rec" / "depth";
  std::filesystem::copy_file(dir / "empty/depth/000000.png", depth / "000002.png",
                             std::filesystem::copy_options::overwrite_existing);
  const auto report = [&](std::vector<std::string> more) {
    more.insert(more.end(), {"--baseline", dir / "baseline.json"});
    return run(report_args({dir / "rec"}, dir / "out", more));
  };
  EXPECT_TRUE(has(well(report({"--approve"})).err, "warning: frame 2: "));
  const Ran same = well(report({}));
  EXPECT_TRUE(has(same.err, "1 frame is rejected, as in the baseline"));
  EXPECT_TRUE(has(read_text(dir / "out/junit.xml"), "errors=\"0\" skipped=\"1\""));

  std::filesystem::resize_file(depth / "000001.png", 200);
  const Ran damaged = report({});
  EXPECT_EQ(damaged.code, 2) << damaged.err;
  EXPECT_TRUE(has(damaged.err, "error: frame 1: "));
  EXPECT_LT(damaged.err.find("000001.png"), damaged.err.find("as in the baseline"));

  std::filesystem::remove(depth / "000001.png");
  const Ran removed = report({});
  EXPECT_EQ(removed.code, 1);
  EXPECT_TRUE(has(removed.out, "error  rec baseline frame 1: 1 frame of the baseline is missing"));
  EXPECT_FALSE(has(removed.out, "other pixels"));
}

/// Changes a baseline as if all of its planes had been found with a small margin. Version 3 has no
/// margins.
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

TEST(ReportGuard, NotesChangesOfUndecidedPlanesAndEndsWithZero) {
  const auto dir = scratch_with_rec();
  const std::string baseline = (dir / "baseline.json").string();
  const auto report = [&](const std::string& out, std::vector<std::string> more) {
    more.insert(more.end(), {"--baseline", baseline});
    return run(report_args({dir / "rec"}, dir / out, more));
  };
  well(report("first", {"--approve"}));
  make_undecided(baseline, true);
  const Ran noted = well(report("noted", {"--gravity", "0.1,1,0"}));
  EXPECT_TRUE(has(noted.out, "note   rec frame 0: a plane turned by "));
  EXPECT_TRUE(has(noted.out, "0 errors, "));
  make_undecided(baseline, false);
  const Ran failed = report("failed", {"--gravity", "0.1,1,0"});
  EXPECT_EQ(failed.code, 1) << "all planes of an earlier version are decided";
  EXPECT_TRUE(has(failed.out, "error  rec frame 0: a plane turned by "));
}

TEST(ReportGuard, WarnsAboutUnappliedRulesAndNewRecordings) {
  const auto dir = scratch_with_rec(2);
  write_depth_folder(dir / "new", floor_and_wall());
  write_text(dir / "rules.json",
             R"({"schema": "planescope.rules/1", "rules": [
               {"metric": "planes_lost", "at_most": 0},
               {"metric": "planes", "recording": "rce", "at_least": 2}]})");
  const std::string rules = (dir / "rules.json").string();
  const Ran forgotten = well(run(report_args({dir / "rec"}, dir / "out", {"--rules", rules})));
  EXPECT_TRUE(has(forgotten.out,
                  "warn   planes_lost: rule not applied: no baseline\n"
                  "warn   planes of rce: rule not applied: no recording with this name\n"
                  "0 errors, 2 warnings\n"));
  std::filesystem::copy(dir / "out/report.json", dir / "baseline.json");
  const Ran more = well(run(report_args({dir / "rec", dir / "new"}, dir / "more",
                                        {"--baseline", dir / "baseline.json"})));
  EXPECT_TRUE(has(more.out, "warn   new: not in the baseline\n0 errors, "));
  EXPECT_EQ(read_report(dir / "more")["verdict"]["unguarded"], Json({"new: not in the baseline"}));
  EXPECT_TRUE(has(read_text(dir / "more/index.html"), "new: not in the baseline"));
}

TEST(ReportGuard, FailsIfNoFrameIsInTheBaseline) {
  const auto dir = scratch_with_rec();
  std::filesystem::copy(dir / "rec", dir / "renamed", std::filesystem::copy_options::recursive);
  const auto report = [&](const std::string& rec, std::vector<std::string> more) {
    more.insert(more.end(), {"--baseline", dir / "baseline.json"});
    return run(report_args({dir / rec}, dir / "out", more));
  };
  well(report("rec", {"--approve"}));
  const Ran failed = report("renamed", {});
  EXPECT_EQ(failed.code, 1);
  EXPECT_TRUE(has(failed.out,
                  "error  all frames: 0 frames are compared with the baseline; the rule "
                  "frames_compared requires at least 1 frame\n"
                  "warn   renamed: not in the baseline\n"
                  "warn   rec: in the baseline, not in this report\n"
                  "1 error, 2 warnings against "))
      << failed.out;
  EXPECT_TRUE(has(read_text(dir / "out/junit.xml"), "0 frames are compared with the baseline"));
  EXPECT_TRUE(has(well(report("renamed", {"--approve"})).out, "0 errors, "));
  well(report("renamed", {}));
}

TEST(ReportGuard, ANameOfInvalidTextMatchesTheBaseline) {
  const auto dir = scratch();
  const auto recording = dir / "rec\xff";
  write_depth_folder(recording, floor_and_wall());
  const std::string baseline = (dir / "baseline.json").string();
  well(run(report_args({recording}, dir / "a", {"--baseline", baseline, "--approve"})));
  well(run(report_args({recording}, dir / "b", {"--baseline", baseline})));
}

TEST(ReportGuard, CreatesAFolderForTheFirstBaseline) {
  const auto dir = scratch_with_rec();
  const auto baseline = dir / "ci" / "planes" / "baseline.json";
  well(run(report_args({dir / "rec"}, dir / "out", {"--baseline", baseline, "--approve"})));
  EXPECT_EQ(read_text(baseline), read_text(dir / "out/report.json"));
}

TEST(ReportGuard, AnUnwritableBaselineIsReportedBeforeTheRun) {
  const auto dir = scratch_with_rec();
  write_text(dir / "file", "no folder");
  for (const auto& baseline : {dir / "file" / "baseline.json", dir / "rec"}) {
    expect_refused(
        run(report_args({dir / "rec"}, dir / "out", {"--baseline", baseline, "--approve"})));
    EXPECT_FALSE(std::filesystem::exists(dir / "out"));
  }
}

TEST(ReportGuard, ChecksAReportAgainstCustomRules) {
  const auto dir = scratch_with_rec();
  const auto with_rule = [&](const std::string& rule) {
    std::ofstream(dir / "rules.json")
        << R"({"schema": "planescope.rules/1", "rules": [)" << rule << "]}";
    return run(report_args({dir / "rec"}, dir / "out", {"--rules", dir / "rules.json"}));
  };
  well(with_rule(R"({"metric": "planes", "at_least": 2})"));
  well(with_rule(R"({"metric": "planes", "at_least": 3, "level": "warn"})"));
  EXPECT_EQ(with_rule(R"({"metric": "planes", "at_least": 3})").code, 1);
  expect_refused(with_rule(R"({"metric": "plans", "at_least": 3})"));
}

TEST(ReportGuard, ChecksFootholdsAgainstTheBaseline) {
  const auto dir = scratch_with_rec();
  write_text(dir / "rules.json", R"({"schema": "planescope.rules/1", "rules": [
               {"metric": "steppable_area_change", "at_least": -0.001}]})");
  const auto report = [&](const std::string& out, std::vector<std::string> more) {
    more.insert(more.end(), {"--baseline", dir / "baseline.json", "--rules", dir / "rules.json"});
    return run(report_args({dir / "rec"}, dir / out, more));
  };
  well(report("first", {"--foot", "0.05", "--approve"}));
  const Json frame = read_report(dir / "first")["recordings"][0]["frames"][0];
  ASSERT_GT(frame["steppable_area_m2"], 0.01);
  int steppable = 0;
  for (const Json& plane : frame["planes"]) steppable += plane["foot"]["steppable"].get<bool>();
  EXPECT_EQ(steppable, 1) << "the floor, and not the wall";
  EXPECT_TRUE(has(read_text(dir / "first/index.html"), "Surfaces to stand on"));
  well(report("same", {"--foot", "0.05"}));
  const Ran narrow = report("narrow", {"--foot", "0.05", "--set", "foot_min_area_m2=9"});
  EXPECT_EQ(narrow.code, 1) << narrow.out;
  EXPECT_TRUE(has(narrow.out, "is no longer steppable: "));
  EXPECT_TRUE(has(read_text(dir / "narrow/index.html"), "is no longer steppable: "));
  const Ran footless = well(report("footless", {}));
  EXPECT_TRUE(has(footless.out, "rule not applied: at least one of the runs has no foot"));
  expect_refused(report("wrong", {"--foot", "wide"}));
}

TEST(ReportGuard, ABrokenBaselineIsReportedBeforeAnythingIsWritten) {
  const auto dir = scratch_with_rec();
  for (const char* text : {"", "{", "[]", R"({"schema": "planescope.report/99"})"}) {
    std::ofstream(dir / "baseline.json") << text;
    expect_refused(
        run(report_args({dir / "rec"}, dir / "out", {"--baseline", dir / "baseline.json"})),
        "baseline.json");
    EXPECT_FALSE(std::filesystem::exists(dir / "out"));
  }
  EXPECT_EQ(run(report_args({dir / "rec"}, dir / "out", {"--approve"})).code, 2);
  EXPECT_EQ(run(report_args({dir / "rec"}, dir / "out", {"--baseline", "/nowhere.json"})).code, 2);
}
