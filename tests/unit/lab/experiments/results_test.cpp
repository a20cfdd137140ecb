#include "core/lab/experiments/results.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "support/refusal.hpp"
#include "support/temp_dir.hpp"
#include "unit/lab/experiments/made_up_results.hpp"

namespace planescope::lab {
namespace {

namespace fs = std::filesystem;

fs::path fresh_dir() {
  const fs::path dir = temp_dir() / testing::UnitTest::GetInstance()->current_test_info()->name();
  fs::remove_all(dir);
  fs::create_directories(dir);
  return dir;
}

std::string text_of(const fs::path& file) {
  std::ifstream stream(file);
  std::ostringstream text;
  text << stream.rdbuf();
  return text.str();
}

TEST(PaperResults, ComeBackFromTheirFileToTheSameBytes) {
  PaperResults results = made_up_results();
  results.cells[0].metrics.alpha_deg = 1.0 / 3;
  results.cells[0].key.setting = "without bow";
  const fs::path once = fresh_dir(), again = once / "again";
  fs::create_directories(again);
  write_results(once, results);
  const PaperResults read = read_results(once);
  write_results(again, read);
  EXPECT_EQ(text_of(once / "paper.json"), text_of(again / "paper.json"));
  ASSERT_EQ(read.cells.size(), results.cells.size());
  EXPECT_EQ(read.cells[0].key, results.cells[0].key);
  EXPECT_EQ(read.cells[0].metrics.alpha_deg, 1.0 / 3);
  EXPECT_EQ(read.real[0].n_m, 100000.5);
}

TEST(PaperResults, OfADepthSetKnowTheirErrorsAndNoPoints) {
  const Cell cell = made_up_cell(with_rival(depth_of("depth_boxes", 7, "d435"), "ransac"), 1);
  EXPECT_EQ(parse_cell(cell_line(cell)).key, cell.key);
  EXPECT_EQ(cell_line(cell).find("noise_cm"), std::string::npos);
}

TEST(PaperResults, FindsACellByItsWholeKey) {
  const PaperResults results = made_up_results();
  const CellKey key = with_ours(stairs_of(1, 8192, 0.2), "refined", "gcn");
  ASSERT_NE(results.find(key), nullptr);
  EXPECT_EQ(results.find(key)->metrics.alpha_deg, 0.2);
  EXPECT_EQ(results.find(with_ours(stairs_of(2, 8192, 0.2), "refined", "gcn")), nullptr);
}

TEST(PaperResults, ThatAreDamagedAreRefusedByTheirFilesName) {
  const fs::path dir = fresh_dir();
  std::ofstream(dir / "paper.json") << R"({"schema": "planescope.paper/1"})";
  expect_refused([&] { read_results(dir); }, "paper.json");
  std::ofstream(dir / "paper.json") << R"({"schema": "other"})";
  expect_refused([&] { read_results(dir); }, "expected 'planescope.paper/1'");
}

TEST(PaperTimings, ComeBackFromTheirFileToTheSameBytes) {
  const fs::path once = fresh_dir(), again = once / "again";
  fs::create_directories(again);
  write_timings(once, made_up_timings());
  write_timings(again, read_timings(once));
  EXPECT_EQ(text_of(once / "paper.timings.json"), text_of(again / "paper.timings.json"));
}

class CellLogTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = temp_dir() / (std::string("cell_log_") +
                         testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(dir_);
    fs::create_directories(dir_);
  }
  fs::path dir_;
  PaperResults run_ = made_up_results();
};

TEST_F(CellLogTest, KeepsCellsForARunThatGoesOn) {
  CellLog(dir_, run_, false).append(run_.cells);
  const CellLog resumed(dir_, run_, true);
  ASSERT_EQ(resumed.cells().size(), run_.cells.size());
  EXPECT_EQ(resumed.cells().back().key, run_.cells.back().key);
}

TEST_F(CellLogTest, ForgetsACellThatWasCutOffInItsMiddle) {
  CellLog(dir_, run_, false).append(std::span(run_.cells).first(2));
  std::ofstream(dir_ / "cells.jsonl", std::ios::app) << R"({"key":{"set":"sta)";
  CellLog resumed(dir_, run_, true);
  EXPECT_EQ(resumed.cells().size(), 2u);
  resumed.append(std::span(run_.cells).subspan(2, 1));
  EXPECT_EQ(CellLog(dir_, run_, true).cells().size(), 3u);
}

TEST_F(CellLogTest, RefusesARunThatIsNotDoneUnlessToldToGoOn) {
  CellLog(dir_, run_, false).append(run_.cells);
  expect_refused([&] { CellLog(dir_, run_, false); }, "--resume");
}

TEST_F(CellLogTest, RefusesToMixRuns) {
  CellLog(dir_, run_, false).append(run_.cells);
  run_.seed = 2;
  expect_refused([&] { CellLog(dir_, run_, true); }, "seed 1, expected 2");
}

TEST_F(CellLogTest, IsGoneWhenTheRunIsOver) {
  CellLog log(dir_, run_, false);
  log.append(run_.cells);
  log.finish();
  EXPECT_TRUE(CellLog(dir_, run_, false).cells().empty());
}

}  // namespace

}  // namespace planescope::lab
