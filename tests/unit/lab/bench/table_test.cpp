#include "core/lab/bench/table.hpp"

#include <gtest/gtest.h>

namespace planescope::lab {
namespace {

const Table kTable{"Sizes", "In metres.", {"what", "long", "wide"}, {{"a", "1.5", "10.25"}}, 1};

TEST(Table, IsAlignedInText) {
  EXPECT_EQ(to_text(kTable),
            "Sizes\n"
            "what  long   wide\n"
            "a      1.5  10.25\n"
            "In metres.\n");
}

TEST(Table, IsAMarkdownTableUnderAHeading) {
  EXPECT_EQ(to_markdown(kTable),
            "### Sizes\n\n"
            "| what | long |  wide |\n"
            "|---|---:|---:|\n"
            "| a    |  1.5 | 10.25 |\n"
            "\nIn metres.\n");
}

/// "row,column row,column" of what is best.
std::string marked(const Table& table) {
  const std::vector<std::vector<bool>> best = best_cells(table);
  std::string text;
  for (std::size_t r = 0; r < best.size(); ++r)
    for (std::size_t c = 0; c < best[r].size(); ++c)
      if (best[r][c]) text += std::to_string(r) + "," + std::to_string(c) + " ";
  return text;
}

TEST(BestCells, AreTheLeastTheMostOrTheNearestToAHundredAsTheColumnAsks) {
  EXPECT_EQ(
      marked({.title = "",
              .note = "",
              .columns = {"method", "alpha 0.1 cm", "r_p", "IoU", "frames"},
              .rows = {{"a", "0.10", "102.0", "97.1", "1"}, {"b", "0.04", "97.0", "96.0", "2"}},
              .names = 1}),
      "0,2 0,3 1,1 ");
}

TEST(BestCells, AreSharedByThoseThatShowTheSame) {
  EXPECT_EQ(marked({"", "", {"method", "r_m"}, {{"a", "0.00"}, {"b", "0.00"}, {"c", "0.10"}}, 1}),
            "0,1 1,1 ");
}

TEST(BestCells, LeaveOutPrintedNumbersTheOracleTrueLabelsAndWhatIsMissing) {
  EXPECT_EQ(marked({"",
                    "",
                    {"", "profile", "labels", "alpha"},
                    {{"with PC", "printed", "", "0.00"},
                     {"with PC", "refined", "truth", "0.01"},
                     {"oracle", "", "", "0.01"},
                     {"with PC", "refined", "pca", "-"},
                     {"with PC", "refined", "gcn", "0.05"},
                     {"with PC", "paper", "gcn", "2.00"}},
                    3}),
            "4,3 ");
}

TEST(BestCells, NeedSomethingToBeBetterThan) {
  EXPECT_EQ(marked({"", "", {"method", "IoU"}, {{"a", "90"}, {"oracle", "99"}}, 1}), "");
}

TEST(BestCells, StandInRowsWhereMethodsAreColumns) {
  EXPECT_EQ(marked({"Mean IoU of every method on every set",
                    "",
                    {"frames", "ours refined gcn", "ransac", "oracle"},
                    {{"stairs", "97.0", "95.0", "99.0"}, {"kerbs", "80.0", "-", "99.0"}},
                    1}),
            "0,1 ");
}

}  // namespace

}  // namespace planescope::lab
