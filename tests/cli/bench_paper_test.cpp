// planescope-lab bench paper, with few sets and frames.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <map>

#include "cli/result_lines.hpp"
#include "cli/scene_files.hpp"

using namespace planescope::testing_cli;
namespace fs = std::filesystem;
using Json = nlohmann::json;

namespace {

Ran bench(const fs::path& out, const std::vector<std::string>& more) {
  std::vector<std::string> args = {"planescope-lab", "bench", "paper", "--quick",
                                   "--count",        "1",     "-o",    out.string()};
  args.insert(args.end(), more.begin(), more.end());
  return run(args);
}

const std::vector<std::string> kTables = {"--only", "tables", "--sets", "kerbs,depth_boxes"};

std::vector<std::string> and_more(std::vector<std::string> args,
                                  const std::vector<std::string>& more) {
  args.insert(args.end(), more.begin(), more.end());
  return args;
}

std::string frames_of(const Json& cell) {
  return cell["key"]["set"].get<std::string>() + cell["key"].value("errors", "") +
         std::to_string(cell["key"].value("seed", 0));
}

bool is_ours(const Json& cell, const std::string& labels) {
  const Json& key = cell["key"];
  return key["method"] == "ours" && key["profile"] == "refined" && key["classifier"] == labels &&
         !key.contains("setting");
}

}  // namespace

TEST(BenchPaper, TablesAreConsistent) {
  const fs::path out = scratch() / "out";
  well(bench(out, kTables));
  EXPECT_EQ(files_below(out), std::vector<std::string>{"paper.jsonl"});

  auto results = results_of(read_text(out / "paper.jsonl"));
  EXPECT_EQ(results["run"].at(0)["weights"]["sha256"].get<std::string>().size(), 64u);
  std::map<std::string, Json> oracle, truth;
  for (const Json& cell : results["cell"]) {
    if (cell["key"]["method"] == "oracle") oracle[frames_of(cell)] = cell;
    if (is_ours(cell, "truth")) truth[frames_of(cell)] = cell;
  }
  EXPECT_EQ(truth.size(), 1u) << "kerbs; no labels take part on the boxes' depth";
  EXPECT_EQ(oracle.size(), 4u) << "kerbs; boxes clean, as a D435 sees them, and those tuned on";
  for (const Json& cell : results["cell"]) {
    const std::string name = cell.dump();
    const auto count = [&](const char* value) { return cell[value].get<int>(); };
    // Each true plane is correct, split, part of a larger one or missed; found planes likewise. A
    // plane with an IoU of 0.8 is correct; a merged plane contains at least two.
    EXPECT_LE(count("detected_iou80") + count("over_segmented") + 2 * count("under_segmented") +
                  count("missed"),
              count("planes_truth"))
        << name;
    EXPECT_LE(count("detected_iou80") + 2 * count("over_segmented") + count("under_segmented") +
                  count("noise"),
              count("planes_found"))
        << name;
    EXPECT_NEAR(cell["r_p"].get<double>(), 100.0 * count("planes_found") / count("planes_truth"),
                1e-9);
    EXPECT_LE(cell["point_accuracy"].get<double>(), 100 - cell["r_m"].get<double>() + 1e-9) << name;
    const double iou = cell["mean_iou"];
    if (cell["key"].value("classifier", "") != "truth") {
      EXPECT_LE(iou, oracle.at(frames_of(cell))["mean_iou"].get<double>() + 0.5) << name;
    }
    if (is_ours(cell, "gcn") && truth.contains(frames_of(cell))) {
      EXPECT_LE(iou, truth[frames_of(cell)]["mean_iou"].get<double>() + 2) << name;
    }
  }
}

TEST(BenchPaper, ResultsAreTheSameForAnyThreadCountAndAfterAnInterruption) {
  const fs::path dir = scratch();
  const std::vector<std::string> args = {"--only", "tables", "--sets", "kerbs,depth_slopes"};
  for (const char* threads : {"1", "2"}) {
    well(bench(dir / threads, and_more(args, {"--threads", threads})));
  }
  const std::string whole = read_text(dir / "1/paper.jsonl");
  EXPECT_EQ(whole, read_text(dir / "2/paper.jsonl"));

  // Truncate the log of a complete run, as if it had been interrupted after a few cells.
  auto results = results_of(whole);
  const Json& run_line = results["run"].at(0);
  Json identity;
  for (const char* name :
       {"seed", "tuning_seed", "quick", "count", "version", "commit", "modified"})
    identity[name] = run_line[name];
  identity["weights"] = run_line["weights"]["sha256"];
  std::string log = identity.dump() + '\n';
  const std::size_t first = whole.find(R"({"kind":"cell")");
  log += whole.substr(first, whole.find('\n', first + (whole.size() - first) / 2) + 1 - first);
  fs::create_directories(dir / "cut");
  write_text(dir / "cut/cells.jsonl", log + R"({"kind":"cell","key":{"se)");
  const Ran refused = bench(dir / "cut", args);
  expect_refused(refused, "--resume");
  well(bench(dir / "cut", and_more(args, {"--resume"})));
  EXPECT_EQ(whole, read_text(dir / "cut/paper.jsonl"));
  EXPECT_EQ(files_below(dir / "cut"), std::vector<std::string>{"paper.jsonl"});

  identity["seed"] = 2;
  fs::remove(dir / "cut/paper.jsonl");
  write_text(dir / "cut/cells.jsonl", identity.dump() + '\n');
  const Ran other = bench(dir / "cut", and_more(args, {"--resume"}));
  EXPECT_EQ(other.code, 2);
  EXPECT_NE(other.err.find("seed 2; expected 1"), std::string::npos) << other.err;
}

TEST(BenchPaper, TimesRecordingsAndCountsFramesWithoutGravity) {
  const auto dir = scratch_with_rec(2);
  planescope::Image16 nothing = floor_and_wall();
  std::fill(nothing.data.begin(), nothing.data.end(), std::uint16_t{0});
  write_depth_folder(dir / "dark", nothing);
  well(bench(dir / "out", {(dir / "rec").string(), (dir / "dark").string(), "--sets", "kerbs"}));
  auto results = results_of(read_text(dir / "out/paper.jsonl"));
  const auto& real = results["real"];
  ASSERT_EQ(real.size(), 2u);
  EXPECT_EQ(real[0]["recording"], "rec");
  EXPECT_EQ(real[0]["frames"], 2);
  EXPECT_EQ(real[0]["planes"], 2.0);
  EXPECT_EQ(real[1]["frames"], 0);
  EXPECT_EQ(real[1]["refused"], 1);
  auto timings = results_of(read_text(dir / "out/paper.timings.jsonl"));
  EXPECT_GT(timings["real_time"].at(0)["fps"], 0);
  EXPECT_EQ(timings["classifier_time"].size() % 3, 0u);
  EXPECT_GT(timings["method_time"].at(0)["fps"], 0);
  // Both files can be committed: neither contains paths of recordings or results on this machine.
  for (const char* file : {"out/paper.jsonl", "out/paper.timings.jsonl"})
    EXPECT_EQ(read_text(dir / file).find(dir.string()), std::string::npos) << file;

  const std::string tables = typeset(fmt::format(
      "{0}/out/paper.jsonl {0}/out/paper.timings.jsonl --plots {0}/plots", dir.string()));
  for (const char* part : {"Table IV: sizes of real data", "kerbs, 8192 points, 0.2 cm",
                           "Table II: classifier time [ms]", "iou_clouds.svg"})
    EXPECT_NE(tables.find(part), std::string::npos) << part << " in " << tables;
}

TEST(BenchPaper, TheDocumentMatchesTheCommittedRun) {
  const std::string reproduction = PLANESCOPE_SOURCE_DIR "/docs/reproduction";
  const fs::path written = scratch() / "reproduction.md";
  typeset(fmt::format("{0}/paper.jsonl {0}/paper.timings.jsonl --doc {1}", reproduction,
                      written.string()));
  EXPECT_TRUE(read_text(written) == read_text(reproduction + ".md"))
      << "scripts/typeset docs/reproduction/*.jsonl --doc docs/reproduction.md writes it again";
}

TEST(BenchPaper, KeepsItsCellsWhenItIsInterrupted) {
  const fs::path out = scratch() / "out";
  const Ran ran = run_and_signal({"planescope-lab", "bench", "paper", "--only", "tables", "--sets",
                                  "kerbs", "-o", out.string()},
                                 SIGINT, out / "cells.jsonl");
  EXPECT_EQ(ran.code, 130);
  EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  EXPECT_EQ(files_below(out), std::vector<std::string>{"cells.jsonl"});
}

TEST(BenchPaper, RejectsUnknownNamesInOneLine) {
  const fs::path out = scratch() / "out";
  const std::vector<std::pair<std::vector<std::string>, std::string>> bad = {
      {{"planescope-lab", "bench", "paper"}, "-o"},
      {{"planescope-lab", "bench", "paper", "-o", out.string(), "--only", "tabels"}, "tabels"},
      {{"planescope-lab", "bench", "paper", "-o", out.string(), "--sets", "stares"}, "stares"},
      {{"planescope-lab", "bench", "paper", "-o", out.string(), "--count", "0"}, "--count"},
      {{"planescope-lab", "bench", "paper", "-o", out.string(), "--weights", "pca"},
       "is not a network"},
      {{"planescope-lab", "bench", "paper", "-o", out.string(), (out / "none").string()}, "none"}};
  for (const auto& [args, part] : bad) {
    const Ran ran = run(args);
    expect_refused(ran, part);
    EXPECT_FALSE(fs::exists(out)) << part;
  }
}
