#include <gtest/gtest.h>

#include <fstream>

#include "core/lab/experiments/results.hpp"
#include "support/refusal.hpp"
#include "unit/lab/experiments/made_up_results.hpp"

namespace planescope::lab {
namespace {

namespace fs = std::filesystem;

class CellLogTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ =
        fs::path(testing::TempDir()) /
        (std::string("cell_log_") + testing::UnitTest::GetInstance()->current_test_info()->name());
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
