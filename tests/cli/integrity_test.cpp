// Damaged frames, outputs inside recordings, and recordings that have changed since.

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "core/model/json.hpp"

namespace planescope::testing_cli {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

/// A recording `walk` of twelve frames, with labels of all of them.
struct Integrity : testing::Test {
  const fs::path dir = scratch();
  const fs::path walk = dir / "walk";
  const fs::path third = walk / "depth" / "000002.png";

  void SetUp() override {
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    well(run({"synth", "sequence", "-o", walk, "--size", "160x120", "--frames", "12"}));
  }
  /// eval's frames, by name.
  Json scores() {
    Json by_name;
    const Json eval = Json::parse(run({"eval", walk, "--json"}).out);
    for (const Json& frame : eval["frames"]) {
      by_name[frame["name"].get<std::string>()] = frame;
      by_name[frame["name"].get<std::string>()].erase("frame");
    }
    return by_name;
  }
};

TEST_F(Integrity, EveryCommandSkipsCountsAndNamesADamagedFrame) {
  fs::resize_file(third, 500);
  const std::vector<std::vector<std::string>> commands = {
      {"info"},
      {"eval"},
      {"segment", "-o", dir / "segment"},
      {"segment", "-o", dir / "planes.mcap"},
      {"map", "-o", dir / "map"},
      {"report", "-o", dir / "report", "--no-pictures"},
      {"tune", "-o", dir / "tune", "--trials", "2"},
      {"labels check"},
      {"labels stats"},
      {"labels export", "--format", "ply", "-o", dir / "ply"},
      {"convert", "-o", dir / "converted"},
      {"convert", "-o", dir / "converted.mcap"},
      {"train", "--recipe", "recordings", "--steps", "1", "-o", dir / "w.safetensors"},
      {"planescope-lab bench steady", "--only", "focal", "--frames", "1:4", "-o", dir / "steady"},
      {"view", "--offscreen", "--size", "800x500", "--state", dir / "state.json"}};
  for (const std::vector<std::string>& command : commands) {
    std::vector<std::string> args;
    std::istringstream words(command[0]);
    for (std::string word; words >> word;) args.push_back(word);
    args.push_back(walk);
    args.insert(args.end(), command.begin() + 1, command.end());
    const Ran ran = run(args);
    EXPECT_EQ(ran.code, 2) << command[0] << ran.err;
    EXPECT_TRUE(has(ran.out + ran.err, "000002.png: the PNG is truncated")) << command[0];
    EXPECT_TRUE(has(ran.err, "skipped 1 of ") || has(ran.out, "1 damaged") ||
                has(ran.out, "11 of 12 frames") || has(ran.out, "11 frames"))
        << command[0] << ran.out << ran.err;
  }
  for (const char* made : {"segment/frames/000005/planes.json", "planes.mcap", "map/map.json",
                           "report/report.json", "tune/profile.json", "ply/000005.ply",
                           "converted/depth/000005.png", "converted.mcap", "w.safetensors"})
    EXPECT_TRUE(fs::exists(dir / made)) << made;
  EXPECT_FALSE(fs::exists(dir / "segment/frames/000002"));
  EXPECT_EQ(files_below(dir / "converted.labels"), files_below(dir / "converted.mcap.labels"));
}

TEST_F(Integrity, AFrameThatIsNoFileKeepsTheNumbersOfTheOthers) {
  Json expected = scores();
  ASSERT_EQ(expected.size(), 12u);
  expected.erase("000002");
  for (const std::string what : {"a link to a missing file", "a folder", "a pipe or device"}) {
    fs::remove_all(third);
    if (what == "a folder")
      fs::create_directory(third);
    else if (what == "a pipe or device")
      mkfifo(third.c_str(), 0600);
    else
      fs::create_symlink("nowhere.png", third);
    EXPECT_EQ(scores(), expected) << what;
    const Ran info = run({"info", walk});
    EXPECT_EQ(info.code, 2);
    EXPECT_TRUE(has(info.err, "frame 2: " + third.string() + ": is " + what)) << info.err;
    EXPECT_TRUE(has(info.out, "12, 1 damaged"));
  }
}

TEST_F(Integrity, NothingIsWrittenIntoARecording) {
  const std::vector<std::string> before = files_below(walk);
  fs::create_directory_symlink(walk / "depth", dir / "link");
  const auto refused = [&](std::vector<std::string> args) {
    expect_refused(run(args), "; expected a path outside it, such as ");
    EXPECT_EQ(files_below(walk), before) << args[0] << " " << args.back();
  };
  for (const fs::path& out : {walk, walk / "depth", walk / "new", dir / "link", dir / "link/new",
                              walk / "../walk/depth/", walk / "planes.mcap"}) {
    refused({"segment", walk, "-o", out});
    refused({"map", walk, "-o", out});
    refused({"convert", walk, "-o", out});
    if (out.extension() == ".mcap") continue;
    refused({"report", walk, "--no-pictures", "-o", out});
    refused({"tune", walk, "--trials", "1", "-o", out});
    refused({"labels", "export", walk, "--format", "ply", "-o", out});
  }
  for (const char* option : {"--screenshot", "--state"})
    refused({"view", walk, option, walk / "depth" / "000099.png"});
  refused({"view", third, "--screenshot", third});
  refused({"train", walk, "--recipe", "recordings", "-o", walk / "w.safetensors"});
}

TEST_F(Integrity, ADanglingLinkAsOutputIsOneClearLine) {
  fs::create_symlink("nowhere", dir / "out");
  for (const char* command : {"segment", "map", "report", "tune"})
    expect_refused(run({command, walk, "-o", dir / "out"}), "out is a link to nowhere");
  EXPECT_FALSE(fs::exists(dir / "nowhere"));
}

TEST_F(Integrity, LabelsFollowTheirFramesWhenOneIsRemoved) {
  Json expected = scores();
  expected.erase("000002");
  fs::remove(third);
  EXPECT_EQ(scores(), expected);
  const Ran eval = well(run({"eval", walk}));
  EXPECT_TRUE(has(eval.err, "000003 to frame 2 and 8 more; no frame matches 000002")) << eval.err;
  for (const std::vector<std::string>& command : std::vector<std::vector<std::string>>{
           {"labels", "export", walk, "--format", "ply", "-o", dir / "ply"},
           {"labels", "stats", walk, "--json"},
           {"report", walk, "--no-pictures", "-o", dir / "report"},
           {"tune", walk, "--trials", "1", "-o", dir / "tune"},
           {"info", walk}})
    if (const Ran ran = run(command); command[1] != "stats") {
      EXPECT_EQ(ran.code, 0) << command[0] << ran.err;
      EXPECT_TRUE(has(ran.err, "000003 to frame 2")) << command[0] << ran.err;
    }
  EXPECT_EQ(files_below(dir / "ply").size(), 11u);
  well(run({"convert", walk, "-o", dir / "converted"}));
  EXPECT_FALSE(has(well(run({"eval", dir / "converted"})).err, "to frame"));
}

TEST_F(Integrity, LabelsOfOtherPixelsAreStillRefused) {
  fs::copy_file(walk / "depth" / "000004.png", third, fs::copy_options::overwrite_existing);
  expect_refused(run({"eval", walk}), "000002.json: created for a depth image with SHA-256");
}

TEST_F(Integrity, AReportsLinkFollowsItsFrame) {
  well(run({"report", walk, "--no-pictures", "-o", dir / "report"}));
  fs::remove(third);
  well(run({"view", "--open", (dir / "report/report.json").string() + "#f4/p1", "--offscreen",
            "--size", "800x500", "--state", dir / "state.json"}));
  EXPECT_EQ(read_json<Json>(dir / "state.json")["frame"], 3);
  expect_refused(run({"view", "--open", (dir / "report/report.json").string() + "#f2/p1",
                      "--offscreen", "--size", "800x500"}),
                 "not the recording used for");
}

}  // namespace
}  // namespace planescope::testing_cli
