#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/lab/experiments/paper_markdown.hpp"
#include "unit/lab/experiments/made_up_results.hpp"

namespace planescope::lab {
namespace {

namespace fs = std::filesystem;

TEST(Reproduction, TakesItsFiguresFromTheResults) {
  PaperResults results = made_up_results();
  EXPECT_NE(
      reproduction_page(results, made_up_timings()).find("0.00 / 100, 0.10 / 100, 0.20 / 100"),
      std::string::npos);
  for (Cell& cell : results.cells) cell.metrics.alpha_deg += 5;
  EXPECT_NE(
      reproduction_page(results, made_up_timings()).find("5.00 / 100, 5.10 / 100, 5.20 / 100"),
      std::string::npos);
}

TEST(Reproduction, NamesClaimsThatDoNotHold) {
  const std::string page = reproduction_page(made_up_results(), made_up_timings());
  EXPECT_NE(page.find("- stairs of 8192 points, 0.3 cm: alpha [deg] is 0.300, wanted <= 0.15"),
            std::string::npos);
  EXPECT_EQ(page.find("- stairs of 8192 points, 0.3 cm: r_p"), std::string::npos);
}

TEST(Reproduction, TheCommittedPageFollowsFromTheCommittedRun) {
  const fs::path docs = fs::path(PLANESCOPE_SOURCE_DIR) / "docs";
  if (!fs::exists(docs / "reproduction")) GTEST_SKIP() << "no run is committed";
  std::ifstream file(docs / "reproduction.md");
  std::ostringstream text;
  text << file.rdbuf();
  EXPECT_EQ(text.str(), reproduction_page(read_results(docs / "reproduction"),
                                          read_timings(docs / "reproduction")))
      << "planescope bench paper --from docs/reproduction --doc docs/reproduction.md";
}

}  // namespace
}  // namespace planescope::lab
