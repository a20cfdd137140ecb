#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "core/lab/experiments/paper_markdown.hpp"
#include "core/lab/experiments/paper_tables.hpp"
#include "core/lab/experiments/printed.hpp"
#include "unit/lab/experiments/made_up_results.hpp"

namespace planescope::lab {
namespace {

const Table* titled(const std::vector<Table>& tables, const std::string& part) {
  const auto found = std::ranges::find_if(
      tables, [&](const Table& t) { return t.title.find(part) != std::string::npos; });
  return found != tables.end() ? &*found : nullptr;
}

/// The row that begins with these words.
std::vector<std::string> row_of(const Table& table, const std::vector<std::string>& words) {
  for (const auto& row : table.rows)
    if (std::equal(words.begin(), words.end(), row.begin())) return row;
  return {};
}

TEST(PaperTables, ShowThePrintedNumbersBesideWhatWasMeasured) {
  const std::vector<Table> tables = paper_tables(made_up_results());
  const Table* noise = titled(tables, "Table III");
  ASSERT_NE(noise, nullptr);
  EXPECT_EQ(row_of(*noise, {"with PC", "printed"}),
            (std::vector<std::string>{"with PC", "printed", "", "0.000", "0.100", "0.260", "1.360",
                                      "100", "100", "101", "102", "0.00", "0.00", "0.00", "0.08"}));
  EXPECT_EQ(row_of(*noise, {"with PC", "refined", "gcn"}),
            (std::vector<std::string>{"with PC", "refined", "gcn", "0.000", "0.100", "0.200",
                                      "0.300", "100.0", "100.0", "100.0", "100.0", "0.01", "0.01",
                                      "0.01", "0.01"}));
}

TEST(PaperTables, LeaveOutWhatWasNotMeasured) {
  const std::vector<Table> tables = paper_tables(made_up_results());
  EXPECT_TRUE(row_of(*titled(tables, "Table III"), {"with PC", "refined", "pca"}).empty());
  EXPECT_TRUE(row_of(*titled(tables, "Table V"), {"RANSAC 0.01", "measured"}).empty());
  const auto table_1 = row_of(*titled(tables, "Table I:"), {"with PC", "refined", "gcn"});
  ASSERT_EQ(table_1.size(), 12u);
  EXPECT_EQ(table_1[3], "-");  // 2048 points
  EXPECT_EQ(table_1[5], "0.000");
  EXPECT_TRUE(paper_tables({}).empty());
  EXPECT_TRUE(stricter_tables({}).empty());
}

TEST(PaperTables, HaveAsManyCellsInARowAsColumns) {
  PaperResults results = made_up_results();
  for (const std::string& set : depth_sets())
    for (const char* setting : {"", "without bow"})
      results.cells.push_back(
          made_up_cell(with_ours(depth_of(set, 1, "d435"), "refined", "gcn", setting), 0.2));
  std::vector<Table> tables = paper_tables(results);
  for (const std::vector<Table>& more :
       {stricter_tables(results), timing_tables(made_up_timings())})
    tables.insert(tables.end(), more.begin(), more.end());
  tables.push_back(claim_table(claims(results)));
  EXPECT_NE(titled(tables, "without terms of its objective, all depth sets"), nullptr);
  for (const Table& table : tables)
    for (const auto& row : table.rows) EXPECT_EQ(row.size(), table.columns.size()) << table.title;
}

TEST(PrintedNumbers, OfStairsWithoutNoiseAreTheSameInBothTables) {
  const auto without_noise = [](const char* table, bool with_labels) {
    return *std::ranges::find_if(printed_cells(), [&](const PrintedCell& cell) {
      return cell.table == table && cell.points == 8192 && cell.noise_cm == 0 &&
             cell.with_labels == with_labels;
    });
  };
  for (const bool with_labels : {true, false}) {
    EXPECT_EQ(without_noise("I", with_labels).alpha_deg,
              without_noise("III", with_labels).alpha_deg);
    EXPECT_EQ(without_noise("I", with_labels).r_p, without_noise("III", with_labels).r_p);
  }
}

TEST(Claims, AreMetByWhatIsAtTheBarAndShowTheTuningSeedAndTheOracle) {
  PaperResults results = made_up_results();
  results.cells.push_back(
      made_up_cell(with_ours(stairs_of(results.tuning_seed, 8192, 0.1), "refined", "gcn"), 0.03));
  const std::vector<Claim> all = claims(results);
  const auto claim = [&](const std::string& set, const std::string& measure) {
    return *std::ranges::find_if(
        all, [&](const Claim& c) { return c.set == set && c.measure == measure; });
  };
  const Claim alpha = claim("stairs of 8192 points, 0.1 cm", "alpha [deg]");
  EXPECT_EQ(alpha.bar, "<= 0.04");
  EXPECT_EQ(alpha.value, 0.1);
  EXPECT_EQ(alpha.tuning, 0.03);
  EXPECT_FALSE(alpha.met);
  EXPECT_EQ(alpha.others.find("the paper 0.1; "), 0u) << alpha.others;
  EXPECT_NE(alpha.others.find("oracle 0.050"), std::string::npos) << alpha.others;
  EXPECT_TRUE(claim("stairs of 8192 points, 0.1 cm", "mean IoU [%]").met) << "98 is at least 98";
  EXPECT_TRUE(std::isnan(claim("stairs of 8192 points, 0.2 cm", "r_p").tuning));
}

TEST(Claims, NameWhatWasMeasuredInTheRunAlone) {
  PaperResults results;
  EXPECT_TRUE(claims(results).empty());
  const CellKey stairs = stairs_of(results.seed, 8192, 0.1);
  results.cells.push_back(made_up_cell(with_ours(stairs, "refined", "gcn"), 0.1));
  const auto others = [&] {
    const std::vector<Claim> all = claims(results);
    return std::ranges::find(all, "mean IoU [%]", &Claim::measure)->others;
  };
  EXPECT_EQ(others(), "");
  results.cells.push_back(made_up_cell(with_rival(stairs, "ransac"), 0.2, 100, 81));
  EXPECT_EQ(others(), "ransac 81.00");
}

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
      << "planescope-lab bench paper --from docs/reproduction --doc docs/reproduction.md";
}

}  // namespace

}  // namespace planescope::lab
