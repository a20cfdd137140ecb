// User-defined profiles, and tuning them.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/io/image/png.hpp"
#include "core/labels/model/label_files.hpp"

namespace fs = std::filesystem;
using namespace planescope;
using namespace planescope::testing_cli;
using Json = nlohmann::json;

namespace {

/// Value of an option as shown by `planescope options` with these arguments.
std::string value_of(std::vector<std::string> typed, const std::string& name) {
  typed.insert(typed.begin(), {"options", "--json"});
  const Ran ran = well(run(typed));
  const Json printed = Json::parse(ran.out);
  for (const Json& option : printed["options"])
    if (option["name"] == name) return option["value"];
  return "no such option";
}

/// A recording with labels of all frames beside it. One pixel is unique in each frame; `first`
/// distinguishes recordings.
void write_labeled(const fs::path& dir, int frames, int first = 0) {
  write_depth_folder(dir, floor_and_wall(), frames);
  for (int i = 0; i < frames; ++i) {
    Image16 depth = floor_and_wall();
    depth.at(0, 0) = static_cast<std::uint16_t>(depth.at(0, 0) - first - i);
    io::write_png(dir / "depth" / fmt::format("{:06}.png", i), depth);
  }
  for (int i = 0; i < frames; ++i) write_true_labels(dir, labels::default_label_dir(dir), i);
}

void write_without_wall(const fs::path& dir, int frame) {
  FrameLabels labels = floor_and_wall_labels(*io::open_recording(dir), frame);
  for (std::size_t i = 0; i < labels.plane.data.size(); ++i)
    if (labels.plane.data[i] == 2) labels.plane.data[i] = labels.hv.data[i] = 0;
  labels.planes.pop_back();
  labels::write_frame_labels(labels::default_label_dir(dir), frame, labels);
}

/// Tunes on the recording `rec` of a folder, into its folder `out`. Labels by PCA are imperfect, so
/// that tuning can improve them.
std::vector<std::string> tune(const fs::path& dir, const std::string& out) {
  return {"tune",         dir / "rec",
          "-o",           dir / out,
          "--gravity",    "0,1,0",
          "--classifier", "pca",
          "--only",       "pca_neighbours,voxel_size_m,merge_cost,worth_px,reach_sigma,use_labels"};
}

Ran run_with(std::vector<std::string> words, const std::vector<std::string>& more) {
  words.insert(words.end(), more.begin(), more.end());
  return run(words);
}

std::vector<std::string> answers(const fs::path& dir) {
  std::vector<std::string> texts;
  for (const char* name : {"journal.jsonl", "profile.json", "tuning.json"})
    texts.push_back(read_text(dir / name));
  return texts;
}

}  // namespace

TEST(ProfileOfOnesOwn, IsUsedAndTheCommandLineOverridesIt) {
  const auto file = scratch() / "mine.json";
  write_text(file, R"({"schema": "planescope.profile/1", "base": "paper",
                      "options": {"theta_n_in": 12, "theta_coplane": 0.9, "criterion4_n2": false}})");
  EXPECT_EQ(value_of({"--profile", file}, "theta_n_in"), "12");
  EXPECT_EQ(value_of({"--profile", file}, "profile"), "paper");
  EXPECT_EQ(value_of({"--profile", file}, "criterion4_n2"), "off");
  const std::vector<std::string> both = {"--set", "theta_n_in=20", "--profile", file};
  EXPECT_EQ(value_of(both, "theta_n_in"), "20");
  EXPECT_EQ(value_of(both, "theta_coplane"), "0.9");
}

TEST(ProfileOfOnesOwn, ItsSettingsAreRecordedInPlanesJson) {
  const auto dir = scratch_with_rec();
  write_text(dir / "mine.json", R"({"schema": "planescope.profile/1",
                                    "options": {"theta_n_in": 12}})");
  const auto planes = [&](const std::string& out, const std::vector<std::string>& more) {
    std::vector<std::string> words = {"segment", dir / "rec", "-o",
                                      dir / out, "--gravity", "0,1,0"};
    words.insert(words.end(), more.begin(), more.end());
    well(run(words));
    return read_text(dir / out / "frames/000000/planes.json");
  };
  const std::string by_file = planes("a", {"--profile", dir / "mine.json"});
  EXPECT_EQ(by_file, planes("b", {"--set", "theta_n_in=12"}));
  EXPECT_NE(by_file, planes("c", {}));
}

TEST(ProfileOfOnesOwn, EveryCommandRejectsABadOneInOneLine) {
  const auto dir = scratch_with_rec();
  write_text(dir / "bad.json", R"({"schema": "planescope.profile/1",
                                   "options": {"theta_n_inn": 12}})");
  for (const std::string command : {"view", "info", "segment", "report", "eval", "train"}) {
    expect_refused(run({command, dir / "rec", "--profile", dir / "bad.json"}),
                   "bad.json: unknown option 'theta_n_inn'; did you mean 'theta_n_in'?");
  }
  expect_refused(run({"options", "--profile", dir / "none.json"}));
}

TEST(Tune, TheResultIsTheSameForAnyNumberOfThreadsAndAfterInterruptions) {
  const auto dir = scratch();
  write_labeled(dir / "rec", 4);
  well(run_with(tune(dir, "whole"), {"--threads", "1"}));
  const auto whole = answers(dir / "whole");
  well(run_with(tune(dir, "threads"), {"--threads", "3"}));
  EXPECT_EQ(answers(dir / "threads"), whole);

  const Ran stopped = run_and_signal(tune(dir, "stopped"), SIGINT, dir / "stopped/times.jsonl");
  EXPECT_TRUE(stopped.code == 130 || stopped.code == 0) << stopped.err;
  const std::string begun = read_text(dir / "stopped/journal.jsonl");
  EXPECT_TRUE(whole[0].starts_with(begun));
  well(run(tune(dir, "stopped")));
  EXPECT_EQ(answers(dir / "stopped"), whole);
  for (const char* file : {"index.html", "pareto.svg"})
    EXPECT_TRUE(fs::exists(dir / "whole" / file)) << file;
}

TEST(Tune, ItsProfileReachesTheReportedScore) {
  const auto dir = scratch();
  write_labeled(dir / "rec", 2);
  well(run(tune(dir, "out")));
  const Json answer = Json::parse(read_text(dir / "out/tuning.json"));
  const Ran ran = well(run({"eval", "--json", dir / "rec", "--gravity", "0,1,0", "--profile",
                            dir / "out/profile.json"}));
  const Json eval = Json::parse(ran.out);
  EXPECT_EQ(eval["frames"][0]["pq"], answer["tuning"]["frames"][0]["tuned_pq"]);
  EXPECT_EQ(eval["frames"][1]["pq"], answer["held_out"]["frames"][0]["tuned_pq"]);
}

TEST(Tune, HeldOutFramesDoNotAffectTheSearch) {
  const auto dir = scratch();
  write_labeled(dir / "rec", 4);
  well(run(tune(dir, "out")));
  for (const int held : {1, 3}) write_without_wall(dir / "rec", held);
  well(run(tune(dir, "other")));
  EXPECT_EQ(read_text(dir / "other/journal.jsonl"), read_text(dir / "out/journal.jsonl"));
  EXPECT_EQ(read_text(dir / "other/profile.json"), read_text(dir / "out/profile.json"));
  EXPECT_NE(read_text(dir / "other/tuning.json"), read_text(dir / "out/tuning.json"));
  // A change of the frames used for tuning starts a new search.
  write_without_wall(dir / "rec", 0);
  expect_refused(run(tune(dir, "out")), "belongs to a search with different frames or labels");
}

TEST(Tune, AListAssignsHalvesAndOptionsToRecordings) {
  const auto dir = scratch();
  write_labeled(dir / "a", 2);
  write_labeled(dir / "b", 2, 10);
  write_text(dir / "list.txt",
             "# two recordings\n"
             "tuning a --gravity 0,1,0 --frames 0\n"
             "held-out b --gravity 0,1,0 --labels b.labels\n");
  const std::vector<std::string> words = {"tune",     "--list", dir / "list.txt", "-o", dir / "out",
                                          "--trials", "3"};
  well(run(words));
  const Json answer = Json::parse(read_text(dir / "out/tuning.json"));
  ASSERT_EQ(answer["tuning"]["frames"].size(), 1u);
  EXPECT_EQ(answer["tuning"]["frames"][0]["name"], "a 0");
  EXPECT_EQ(answer["held_out"]["frames"].size(), 2u);
  EXPECT_EQ(answer["trials"], 3);

  for (const auto& [line, why] : std::vector<std::pair<std::string, std::string>>{
           {"half a", "line 1: HALF: unknown value 'half'; expected tuning, held-out, or -"},
           {"tuning", "line 1: expected HALF RECORDING OPTIONS"},
           {"tuning a --set x=1", "line 1: unknown option '--set'"},
           {"tuning a\n- b", "line 2: some lines name a half and others use -"}}) {
    write_text(dir / "list.txt", line + "\n");
    expect_refused(run(words), "list.txt, " + why);
  }
}

TEST(Tune, AFrameInBothHalvesIsRejectedEvenAsACopy) {
  const auto dir = scratch();
  write_labeled(dir / "a", 3);
  fs::copy(dir / "a", dir / "copy", fs::copy_options::recursive);
  fs::copy(dir / "a.labels", dir / "copy.labels", fs::copy_options::recursive);
  write_text(dir / "list.txt", "tuning a --frames :2\nheld-out copy --frames 1:\n");
  expect_refused(run({"tune", "--list", dir / "list.txt", "-o", dir / "out"}),
                 "copy 1: has the same data as a 1 in the other half");
  EXPECT_FALSE(fs::exists(dir / "out"));
}

TEST(Tune, ImpossibleSearchesAreReportedInOneLine) {
  const auto dir = scratch_with_rec(2);
  const auto tried = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"tune", dir / "rec", "-o", dir / "out"};
    words.insert(words.end(), more.begin(), more.end());
    return run(words);
  };
  expect_refused(tried({}), "found 0 labeled frames to tune on and 0 to hold out");
  expect_refused(tried({"--only", "theta_n_inn"}), "did you mean 'theta_n_in'?");
  expect_refused(tried({"--only", "max_range_m"}), "--only max_range_m: not tunable");
  expect_refused(tried({"--hold-out", "1"}), "expected at least 2");
  expect_refused(tried({"--list", "x.txt"}), "; remove ");
  EXPECT_FALSE(fs::exists(dir / "out"));
}

TEST(ProfileOfOnesOwn, TheWindowComparesItWithTheCommandLine) {
  const auto dir = scratch_with_rec();
  write_text(dir / "mine.json", R"({"schema": "planescope.profile/1", "base": "paper",
                                    "options": {"theta_n_in": 12}})");
  write_text(dir / "s.json", R"({"actions": [{"expect": {"pinned": true, "profile": "paper"}},
      {"state": ")" + (dir / "b.json").string() +
                                 R"("},
      "option.undo", {"expect": {"profile": "refined"}}]})");
  const std::vector<std::string> view = {"view",     dir / "rec",    "--gravity", "0,1,0",
                                         "--set",    "theta_n_in=7", "--fresh",   "--offscreen",
                                         "--script", dir / "s.json", "--compare"};
  const Ran ran = run_with(view, {dir / "mine.json"});
  if (ran.code == 3) GTEST_SKIP() << ran.err;
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(Json::parse(read_text(dir / "b.json"))["options"]["theta_n_in"], "12");
  expect_refused(run_with(view, {"fined"}), "unknown profile 'fined'");
}
