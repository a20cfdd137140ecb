// Command lines and folders that fault tests run.

#include "faults/commands.hpp"

#include <gtest/gtest.h>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/lab/training/train.hpp"
#include "core/planes/classify/weights.hpp"

namespace planescope::faults {
namespace {

namespace fs = std::filesystem;
using testing_cli::write_text;

void run_well(const Words& words) {
  const testing_cli::Ran ran = testing_cli::run(words);
  ASSERT_EQ(ran.code, 0) << words[0] << ": " << ran.err;
}

Words sample(const fs::path& dir, const std::string& scenes) {
  return {"synth",   "sample",   "-o",   (dir / "rec").string(), "--size",
          "160x120", "--scenes", scenes, "--depth-only",         "--with-gravity"};
}

Words segment(const fs::path& dir) {
  return {"segment", (dir / "rec").string(), "-o", (dir / "out").string()};
}

Words report(const fs::path& dir) {
  return {"report", (dir / "rec").string(), "-o", (dir / "out").string()};
}

Words export_labels(const fs::path& dir, const std::string& to) {
  return {"labels", "export", (dir / "rec").string(), "--format", "npz", "-o", (dir / to).string()};
}

Words import_labels(const fs::path& dir) {
  return {"labels",
          "import",
          (dir / "rec").string(),
          "--format",
          "npz",
          "--from",
          (dir / "npz").string(),
          "--labels",
          (dir / "mine").string()};
}

void make_recording(const fs::path& dir) { run_well(sample(dir, "stairs,boxes")); }

// Earlier results have other options, so that old files differ from new ones.
const Words kCoarse = {"--voxel", "0.04"};
const Words kFigures = {"--no-pictures"};

Words approve(const fs::path& dir) {
  return report(dir) + kFigures +
         Words{"--baseline", (dir / "baseline.json").string(), "--rules",
               (dir / "rules.json").string(), "--approve"};
}

/// A level camera at rest, with its poses.
void make_still(const fs::path& dir) {
  constexpr int kFrames = 4;
  testing_cli::write_depth_folder(dir / "rec", testing_cli::floor_and_wall(), kFrames);
  std::string poses;
  for (int i = 0; i < kFrames; ++i) poses += "1 0 0 0 0 1 0 0 0 0 1 0\n";
  write_text(dir / "poses.txt", poses);
}

const Words kLevel = {"--gravity", "0,1,0"};

Words build_map(const fs::path& dir, const std::string& mesh_voxel_m) {
  const Words mesh = PLANESCOPE_WITH_OPEN3D ? Words{"--mesh", mesh_voxel_m} : Words{};
  return Words{"map",     (dir / "rec").string(),      "-o", (dir / "map").string(),
               "--poses", (dir / "poses.txt").string()} +
         kLevel + mesh;
}

// Times differ from run to run, and pages that show them.
Words tune(const fs::path& dir, const std::string& trials) {
  return {"tune",         (dir / "rec").string(),
          "-o",           (dir / "out").string(),
          "--classifier", "pca",
          "--only",       "pca_neighbours,merge_cost",
          "--trials",     trials};
}

// In the suite, as drawing takes a second, and as all kinds of all commands would take minutes.
const Words kDrawing = {"gl", "egl", "memory"}, kFiles = {"write", "rename"};

}  // namespace

std::vector<Command> main_commands() {
  return {
      {"segment",
       [](const fs::path& dir) {
         make_recording(dir);
         run_well(segment(dir) + kCoarse);
       },
       segment},
      {"report",
       [](const fs::path& dir) {
         make_recording(dir);
         run_well(report(dir) + kFigures + kCoarse);
       },
       [](const fs::path& dir) { return report(dir) + kFigures; }},
      // One of two frames was already finished.
      {"resume",
       [](const fs::path& dir) {
         make_recording(dir);
         run_well(report(dir) + kFigures + Words{"--frames", "0:1"});
       },
       [](const fs::path& dir) { return report(dir) + kFigures + Words{"--resume"}; }},
      // The baseline has the same options, so that it is the same before and after, except for its
      // times, which no rule checks.
      {"approve",
       [](const fs::path& dir) {
         make_recording(dir);
         write_text(dir / "rules.json", R"({"schema": "planescope.rules/1", "rules": [
                {"metric": "planes_lost", "at_most": 0}]})");
         run_well(approve(dir));
         run_well(approve(dir));  // with a baseline to compare with
       },
       approve},
      {"pictures",
       [](const fs::path& dir) {
         make_recording(dir);
         run_well(report(dir) + kFigures + kCoarse);
       },
       [](const fs::path& dir) {
         return report(dir) + Words{"--frames", "0:1"};
       },
       kDrawing},
      {"export",
       [](const fs::path& dir) {
         make_recording(dir);
         fs::create_directories(dir / "npz");
         write_text(dir / "npz" / "000000.npz", "of before");
       },
       [](const fs::path& dir) { return export_labels(dir, "npz"); }},
      // Replaces labels by the algorithm.
      {"import",
       [](const fs::path& dir) {
         make_recording(dir);
         run_well(export_labels(dir, "npz"));
         run_well(import_labels(dir) + Words{"--frames", "0"});
       },
       import_labels},
      {"convert",
       [](const fs::path& dir) {
         make_recording(dir);
         run_well(export_labels(dir, "npz"));
         write_text(dir / "a.ply", "of before");
       },
       [](const fs::path& dir) {
         return Words{"labels", "convert", (dir / "npz" / "000000.npz").string(), "-o",
                      (dir / "a.ply").string()};
       }},
      {"eval", make_recording,
       [](const fs::path& dir) {
         return Words{"eval", (dir / "rec").string(), "--json"};
       }},
      {"synth", [](const fs::path& dir) { fs::create_directories(dir); },
       [](const fs::path& dir) { return sample(dir, "stairs"); }},
      {"train",
       [](const fs::path& dir) {
         make_recording(dir);
         planes::write_weights(
             dir / "start.safetensors",
             lab::random_weights({.name = "tiny", .levels = {{4}, {4}}, .head = {4}}, 1));
         write_text(dir / "out.safetensors", "of before");
       },
       [](const fs::path& dir) {
         return Words{"train",    (dir / "rec").string(),
                      "--recipe", "recordings",
                      "--from",   (dir / "start.safetensors").string(),
                      "--steps",  "4",
                      "--epoch",  "2",
                      "--count",  "1",
                      "-o",       (dir / "out.safetensors").string()};
       },
       {},
       {"out.html"}},
      // Draws and saves labels, and a session.
      {"view",
       [](const fs::path& dir) {
         make_recording(dir);
         const fs::path session = dir / "a.session";
         write_text(dir / "script.json",
                    R"({"actions": ["label.mode", "label.take", "label.save",
                {"do": "label.stroke", "with": "image over 6 60,60 90,70"}, "label.save",
                {"do": "session.save", "with": ")" +
                        session.string() + R"("}]})");
       },
       [](const fs::path& dir) {
         return Words{"view",         (dir / "rec").string(),
                      "--labels",     (dir / "drawn").string(),
                      "--script",     (dir / "script.json").string(),
                      "--screenshot", (dir / "a.png").string(),
                      "--size",       "640x400"};
       },
       kDrawing,
       {"drawn/", "a.png"},
       "a.png"},
      // The older map has another mesh, and a frame more.
      {"map",
       [](const fs::path& dir) {
         make_still(dir);
         run_well(build_map(dir, "0.2") + kCoarse);
       },
       [](const fs::path& dir) {
         return build_map(dir, "0.1") + Words{"--frames", "0:3"};
       },
       kFiles},
      {"tracked",
       [](const fs::path& dir) {
         make_still(dir);
         run_well(build_map(dir, "0.2"));
         run_well(segment(dir) + kLevel + kCoarse);
       },
       [](const fs::path& dir) {
         return segment(dir) + kLevel + Words{"--map", (dir / "map").string()};
       },
       kFiles},
      {"tracks",
       [](const fs::path& dir) {
         make_still(dir);
         run_well(report(dir) + kLevel + kFigures + kCoarse);
       },
       [](const fs::path& dir) { return report(dir) + kLevel + kFigures + Words{"--tracks"}; },
       kFiles},
      {"recast", make_recording,
       [](const fs::path& dir) {
         return Words{"convert", (dir / "rec").string(), "-o", (dir / "out.mcap").string()};
       },
       kFiles},
      {"tune",
       [](const fs::path& dir) {
         make_recording(dir);
         run_well(tune(dir, "2"));
       },
       [](const fs::path& dir) { return tune(dir, "5"); },
       kFiles,
       {"out/index.html", "out/pareto.svg", "out/times.jsonl", "out/tuning.json"}},
  };
}

Command main_command(const std::string& name) {
  for (const Command& command : main_commands())
    if (command.name == name) return command;
  throw std::logic_error("there is no command " + name);
}

}  // namespace planescope::faults
