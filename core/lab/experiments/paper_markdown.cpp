#include <fmt/format.h>

#include "core/lab/experiments/paper_tables.hpp"

namespace planescope::lab {

std::string paper_markdown(const PaperResults& results) {
  std::string text = fmt::format(
      "# The paper's experiments\n\n"
      "    {}\n\n"
      "planescope {}, commit {}{}. Weights {} ({}), SHA-256 {}. Seed {}; tuned on seed {}.\n",
      results.command, results.build.version, results.build.commit,
      results.build.modified ? " with changes" : "", results.weights.file, results.weights.network,
      results.weights.sha256, results.seed, results.tuning_seed);
  if (results.quick) text += "\nQuick: fewer frames and cells than the full run has.\n";
  if (results.count > 0) text += fmt::format("\nAt most {} frames of each set.\n", results.count);
  const auto add = [&text](const char* heading, const std::vector<Table>& tables) {
    if (!tables.empty()) text += fmt::format("\n## {}\n\n{}", heading, joined(tables, to_markdown));
  };
  if (const std::vector<Claim> all = claims(results); !all.empty())
    add("Claims", {claim_table(all)});
  add("The paper's tables", paper_tables(results));
  add("Stricter tables", stricter_tables(results));
  return text;
}

}  // namespace planescope::lab
