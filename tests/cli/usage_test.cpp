// Tests of help texts, option defaults and usage errors.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "cli/program.hpp"

using namespace planescope::testing_cli;

namespace {

using Words = std::vector<std::string>;

const std::vector<Words> kCommands = {{"view"},  {"info"},    {"segment"}, {"report"},
                                      {"eval"},  {"options"}, {"synth"},   {"synth", "sample"},
                                      {"train"}, {"tune"},    {"labels"}};
const std::vector<Words> kLabCommands = {{"bench"},
                                         {"bench", "paper"},
                                         {"bench", "real"},
                                         {"bench", "classifier"},
                                         {"bench", "desktop"},
                                         {"bench", "speed"},
                                         {"synth"},
                                         {"synth", "stairs"},
                                         {"synth", "set"},
                                         {"synth", "training"},
                                         {"train"}};

/// Checks the help of a command and of all its subcommands; returns their number.
int expect_explained(const std::string& program, const Words& command) {
  const auto typed = [&](const Words& before, const Words& after) {
    Words words = program == "planescope" ? Words{} : Words{program};
    for (const Words& some : {before, command, after})
      words.insert(words.end(), some.begin(), some.end());
    return well(run(words)).out;
  };
  std::string name = program;
  for (const std::string& word : command) name += " " + word;
  const std::string help = typed({}, {"--help"});
  EXPECT_TRUE(has(help, "Usage: " + name + " ")) << help;
  EXPECT_EQ(typed({"help"}, {}), help);
  int count = 1;
  bool lists_commands = false;
  std::istringstream lines(help);
  for (std::string line; std::getline(lines, line);) {
    EXPECT_LE(line.size(), 80U) << name << " --help: " << line;
    if (!line.starts_with(' ')) lists_commands = line.ends_with("ommands:");
    if (!lists_commands || !line.starts_with("  ") || line[2] == ' ') continue;
    Words below = command;
    below.push_back(line.substr(2, line.find(' ', 2) - 2));
    count += expect_explained(program, below);
  }
  return count;
}

}  // namespace

TEST(Usage, TheHelpListsEveryCommand) {
  const Ran product = run({"--help"}), lab = run({"planescope-lab", "--help"});
  EXPECT_EQ(product.code + lab.code, 0);
  EXPECT_EQ(product.err + lab.err, "");
  for (const auto& command : kCommands)
    EXPECT_TRUE(has(product.out, "  " + command[0] + " ")) << command[0];
  for (const auto& command : kLabCommands)
    EXPECT_TRUE(has(lab.out, "  " + command[0] + " ")) << command[0];
}

TEST(Usage, EveryCommandExplainsItselfIn80Columns) {
  EXPECT_EQ(expect_explained("planescope", {}), 25);
  EXPECT_EQ(expect_explained("planescope-lab", {}), 19);
}

TEST(Usage, TheHelpListsFormatsAndTheDefaultSample) {
  for (const char* command :
       {"view", "info", "segment", "report", "eval", "tune", "convert", "map"}) {
    std::string help = well(run({command, "--help"})).out;
    help.erase(std::unique(help.begin(), help.end(),
                           [](char a, char b) { return std::isspace(a) && std::isspace(b); }),
               help.end());
    std::ranges::replace(help, '\n', ' ');
    for (const char* format : {".bag", ".db3", ".mcap", "PNGs", ".raw"})
      EXPECT_TRUE(has(help, format)) << command << " " << format;
    EXPECT_EQ(has(help, ".ply, .pcd"), command != std::string("map")) << help;
    EXPECT_TRUE(has(help, "default: the sample recording")) << help;
  }
}

TEST(Usage, TwoDashesEndTheOptionsAndACommandsNameCanBeARecording) {
  expect_refused(run({"info", "--", "--json"}), "--json: no such file or folder");
  expect_refused(run({"info", "--json", "--", "-o"}), "-o: no such file or folder");
  expect_refused(run({"info", "report"}), "report: no such file or folder");
}

TEST(Usage, AnUnknownOptionThatIsAFileIsOpenedAfterTwoDashes) {
  const std::filesystem::path dir = scratch();
  const std::string file = "-x y.bag";
  std::ofstream(dir / file) << "";
  const auto beside_it = [&] { std::filesystem::current_path(dir); };
  expect_refused(run({file}, beside_it), "type: planescope view -- '-x y.bag'");
  expect_refused(run({"info", file}, beside_it), "type: planescope info -- '-x y.bag'");
  expect_refused(run({"info", "--", file}, beside_it), "-x y.bag: not a ");
  expect_refused(run({"info", "-z.bag"}, beside_it), "see planescope info --help");
}

TEST(Usage, TwoDashesAloneOpenTheWindowAsNothingDoes) {
  const auto without_display = [] { unsetenv("DISPLAY"), unsetenv("WAYLAND_DISPLAY"); };
  const Ran nothing = run({}, without_display), dashes = run({"--"}, without_display);
  EXPECT_EQ(dashes.code, 3);
  EXPECT_EQ(dashes.code, nothing.code);
  EXPECT_EQ(dashes.err, nothing.err);
}

TEST(Usage, OneOptionIsExplained) {
  const std::string text = well(run({"options", "theta_n_in", "--profile", "paper"})).out;
  for (const char* part :
       {"theta_n_in: Criterion 2", "whole number, at least 3", "stage       criteria",
        "5 (refined)", "options.theta_n_in", "--set theta_n_in="})
    EXPECT_TRUE(has(text, part)) << part << "\n" << text;
  const auto json = nlohmann::json::parse(well(run({"options", "theta_r_out", "--json"})).out);
  ASSERT_EQ(json["options"].size(), 1U);
  EXPECT_EQ(json["options"][0]["min"], 0);
  EXPECT_EQ(json["options"][0]["max"], 1);
  EXPECT_EQ(json["options"][0]["defaults"]["paper"], "0.05");
  EXPECT_TRUE(has(well(run({"options", "use_labels"})).out, "on or off"));
}

TEST(Usage, AListIsOneArgumentAndARecordingMayFollow) {
  const Ran ran = run({"planescope-lab", "bench", "classifier", "--only", "frames", "/nowhere"});
  EXPECT_EQ(ran.code, 2);
  EXPECT_TRUE(has(ran.err, "/nowhere: no such file"));
}

TEST(Usage, TheVersionIsOneLineWithTheCommit) {
  const Ran ran = well(run({"--version"}));
  EXPECT_EQ(ran.out.rfind("planescope ", 0), 0u);
  EXPECT_TRUE(has(ran.out, ", commit "));
  EXPECT_EQ(ran.out.find('\n'), ran.out.size() - 1);
}

TEST(Usage, UnknownNamesAreReportedInOneLineWithTheNearestName) {
  const std::vector<std::pair<std::vector<std::string>, std::string>> cases = {
      {{"segmnt"}, "did you mean 'segment'?"},
      {{"--josn"}, "--josn"},
      {{"segment", "--profil", "paper"}, "did you mean '--profile'?"},
      {{"segment", "--xyzzy"}, "--xyzzy"},
      {{"options", "--set", "theta_nin=5"}, "did you mean 'theta_n_in'?"},
      {{"options", "--set", "theta_n_in"}, "is not NAME=VALUE"},
      {{"options", "--set", "theta_n_in=many"}, "'many' is not a whole number"},
      {{"options", "--set", "theta_r_out=2"}, "out of range"},
      {{"options", "--set", "use_labels=perhaps"}, "unknown value 'perhaps'; expected on or off"},
      {{"options", "--set", "r1_merge_by_distance=on"},
       "option r1_merge_by_distance was removed in 0.2; see merge_cost"},
      {{"options", "--set", "merge_partner=worst"}, "first or best"},
      {{"options", "--set", "worth=3"}, "did you mean 'worth_px'?"},
      {{"options", "--profile", "polished"}, "expected paper, paper-closest, refined, or the path"},
      {{"segment", "--foot", "big"},
       "'big' is not a size; expected RADIUS or LENGTHxWIDTH in meters"},
      {{"segment", "--foot", "0.2x-1"}, "expected RADIUS or LENGTHxWIDTH in meters"},
      {{"segment", "--also", "pdf"}, "expected one of geojson, "},
      {{"options", "--threads", "0"}, "--threads"},
      {{"options", "--threads", "two"}, "--threads"},
      {{"options", "--classifier", "gcm"}, "expected gcn, pca, truth, or a weights file"},
      {{"options", "--method", "hough"}, "expected one of 'ours', "},
      {{"options", "--set", "worth_px=-2"}, "out of range"},
      {{"planescope-lab", "bench", "classifier", "--set", "method=region-growing"},
       "supports only method ours"},
      {{"planescope-lab", "bench", "desktop", "--method", "ransac"}, "unknown option '--method'"},
      {{"planescope-lab", "bench", "desktop", "--set", "method=region-growing"},
       "supports only method ours"},
      {{"report", "--baseline", "b.json", "merge", "a", "-o", "out"}, "--baseline after merge"},
      {{"options", "--gravity", "down"}, "down"},
      {{"options", "--gravity", "0,0,0"}, "0,0,0"},
      {{"options", "extra"}, "unknown option 'extra'"},
      {{"options", "theta_n_ou"}, "did you mean 'theta_n_out'?"},
      {{"options", "flat", "extra"}, "unexpected argument 'extra'"},
      {{"help", "segmnt"}, "did you mean 'segment'?"},
      {{"help", "labels", "expo"}, "did you mean 'export'?"},
      {{"help", "labels", "xyzzy"}, "expected one of check, stats, compare"},
      {{"help", "info", "x"}, "expected no more arguments"},
      {{"info", "--frames", "1:2:0"}, "step"},
      {{"info", "--frames", "a"}, "not a whole number"},
      {{"info", "--intrinsics", "1,2,3"}, "FX,FY,CX,CY"},
      {{"info", "--depth-unit", "-1"}, "--depth-unit"},
      {{"segment"}, "-o DIR|FILE.mcap"},
      {{"map"}, "-o DIR|FILE.mcap"},
      {{"report", "merge", "--frames", "1"}, "see planescope report merge --help"},
      {{"report", "--init", "--frames", "1"}, "remove --frames"},
      {{"segment", "-o"}, "out"},
      {{"synth"}, "synth: expected one of sample"},
      {{"planescope-lab"}, "expected one of bench, synth, train"},
      {{"train", "-o", "w.safetensors"}, "planescope-lab train"},
      {{"synth", "sample"}, "-o DIR"},
      {{"planescope-lab", "synth", "set", "cookies", "-o", "out"},
       "expected one of stairs, side_walls"},
      {{"planescope-lab", "synth", "set", "ramps"}, "-o DIR"},
      {{"planescope-lab", "synth", "set", "ramps", "-o", "out", "--errors", "d435"},
       "--errors: ramps contains point clouds"},
      {{"planescope-lab", "synth", "set", "depth_boxes", "-o", "out", "--noise", "1"},
       "depth_boxes contains depth"},
      {{"planescope-lab", "synth", "set", "depth_boxes", "-o", "out", "--errors", "much"},
       "clean, noise, d435"},
      {{"planescope-lab", "bench"},
       "bench: expected one of paper, real, steady, outlines, map, stairs, classifier"},
      {{"planescope-lab", "bench", "classifier", "--only", "spede"},
       "accuracy, gravity, chain, speed, frames"},
      {{"planescope-lab", "bench", "classifier", "--count", "0"}, "--count"},
      {{"options", "--threads", "08", "--voxel", "x"}, "voxel_size_m"},  // 08 is eight
      {{"planescope-lab", "bench", "classifier", "--weights", "pca"}, "not a network"},
  };
  for (const auto& [args, expected] : cases) {
    const Ran ran = run(args);
    expect_refused(ran, expected);
    EXPECT_EQ(ran.out, "");
  }
}

TEST(Usage, OptionsShowTheValuesUsedByACommand) {
  const Ran ran = well(run({"options", "--json", "--profile", "paper", "--set", "theta_n_in=7",
                            "--max-range", "3", "--gravity", "0,1,0"}));
  const auto json = nlohmann::json::parse(ran.out);
  std::map<std::string, std::string> values;
  for (const auto& option : json["options"]) {
    values[option["name"]] = option["value"];
    EXPECT_NE(option["meaning"], "") << option["name"];
    EXPECT_NE(option["unit"], "") << option["name"];
  }
  EXPECT_EQ(values["profile"], "paper");
  EXPECT_EQ(values["theta_n_in"], "7");
  EXPECT_EQ(values["max_range_m"], "3");
  EXPECT_EQ(values["range_for_clouds"], "on");
  EXPECT_EQ(values["gravity"], "0,1,0");
  EXPECT_EQ(values["criterion4_n2"], "on");
}

TEST(Usage, EveryValueShownCanBeSet) {
  const Ran shown = run({"options", "--json"});
  std::vector<std::string> args = {"options", "--json"};
  const auto json = nlohmann::json::parse(shown.out);
  for (const auto& option : json["options"]) {
    args.push_back("--set");
    args.push_back(option["name"].get<std::string>() + "=" + option["value"].get<std::string>());
  }
  const Ran again = well(run(args));
  EXPECT_EQ(again.out, shown.out);
}
