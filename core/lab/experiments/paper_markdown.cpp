#include "core/lab/experiments/paper_markdown.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/lab/bench/table.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/paper_tables.hpp"
#include "core/lab/experiments/printed.hpp"

namespace planescope::lab {

// ---- paper.md ----

std::string paper_markdown(const PaperResults& results) {
  std::string text = fmt::format(
      "# The paper's experiments\n\n"
      "    {}\n\n"
      "{}. Weights {}. Seed {}; tuned on seed {}.\n",
      results.command, to_text(results.build), to_text(results.weights), results.seed,
      results.tuning_seed);
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

// ---- docs/reproduction.md ----

namespace {

constexpr double kNoiseCm[] = {0.0, 0.1, 0.2, 0.3};
constexpr const char* kOfStairs = "--only tables --sets stairs";

/// "0.04 / 100, 2.80 / 118, ...": alpha and r_p of ours on the stairs, noise by noise.
std::string along_noise(const PaperResults& results,
                        const std::string& profile,
                        const std::string& labels) {
  std::string text;
  for (const double noise : kNoiseCm) {
    const Cell* cell =
        results.find(with_ours(stairs_of(results.seed, 8192, noise), profile, labels));
    if (!text.empty()) text += ", ";
    text += cell ? fmt::format("{:.2f} / {:.0f}", cell->metrics.alpha_deg, cell->metrics.r_p) : "-";
  }
  return text;
}

std::string printed_along_noise(bool with_labels) {
  std::string text;
  for (const PrintedCell& cell : printed_cells())
    if (cell.table == "III" && cell.with_labels == with_labels)
      text += fmt::format("{}{:.2f} / {:.0f}", text.empty() ? "" : ", ", cell.alpha_deg, cell.r_p);
  return text;
}

std::string ransac_alpha(const PaperResults& results) {
  const Cell* cell = results.find(with_rival(stairs_of(results.seed, 8192, 0.1), "ransac"));
  return cell ? fixed(cell->metrics.alpha_deg, 2) : "-";
}

/// The command that measures some of the run again.
std::string again(const PaperResults& results, const char* part) {
  return fmt::format("    {} {} -o DIR\n\n", results.command, part);
}

std::string run_text(const PaperResults& results, const PaperTimings& timings) {
  return fmt::format(
      R"(# Reproducing the paper's experiments

Sun et al. 2023, "Multi-Resolution Planar Region Extraction", Section V, measured again with
planescope. Written by `planescope-lab bench paper --from docs/reproduction --doc docs/reproduction.md`
from the run in [reproduction/](reproduction/); change nothing here by hand.

## The run

    {} -o DIR

`PLANESCOPE_DATA=FOLDER scripts/paper -o DIR` builds and runs it, and tells where the page with all
plots and pictures is. The figures below come out again to the last digit for the same seeds and
weights, on any machine and with any number of threads; only times do not. Each chapter names
the part of the run that its figures come from: it writes them to `DIR/paper.md` and
`DIR/paper.timings.md`.

- {}
- weights {}
- seed {} for the tables; seed {}, which is there to tune on, stands beside it in the claims
- times: {}

)",
      results.command, to_text(results.build), to_text(results.weights), results.seed,
      results.tuning_seed, to_text(timings.machine));
}

std::string readings_text(const PaperResults& results) {
  return fmt::format(
      R"(## Where the printed numbers do not follow from the text

{}The noise table is where the text and the numbers part. Mean angle alpha [deg] / planes found per
true plane r_p [%] at 0.0, 0.1, 0.2 and 0.3 cm of noise, 8192 points:

| | with pointwise classification |
|---|---|
| printed | {} |
| profile `paper`, true labels | {} |
| profile `paper`, labels by the network | {} |
| profile `paper-closest`, true labels | {} |
| profile `paper-closest`, labels by the network | {} |
| profile `refined`, labels by the network | {} |

`paper` is the text as written, with its parameters. Where the text cannot be meant as it stands we
took what its prose needs: Criterion 3 holds where e_n is at most its threshold (printed: at least);
the plane equation has n_z (z - mu_z) (printed: z); e_n is the smallest eigenvalue of the scatter,
which is not divided by N although it is called a mean. Even with perfect labels noise breaks the
planes apart: candidates of five points in cells of 2.5 to 5 cm have normals that are wrong by 5 to
10 degrees, and Criterion 4 asks for 8.6.

`paper-closest` is the reading that comes closest to the printed table: the octree's cube stands on
the cloud's lower corner, Criterion 4 goes without its line on the candidate's own normal and asks
for an offset of at most 2 cm instead, a candidate has at least 10 inliers, and leftovers join a
plane within 1 cm.

Without classification (one label for all points) the printed row is {};
`paper` gives {},
`paper-closest` {}.
What that row did with the criteria that need labels the text does not say.

RANSAC as described takes the largest plane away first. On shallow steps that can be a slanted one
through all of them, which has more points within 1 cm than any tread: alpha is {} deg at 0.10 cm of
noise, printed 0.11.

`refined` is planescope's default; [method.md](method.md) tells what it does otherwise and why.

)",
      again(results, kOfStairs), printed_along_noise(true), along_noise(results, "paper", "truth"),
      along_noise(results, "paper", "gcn"), along_noise(results, "paper-closest", "truth"),
      along_noise(results, "paper-closest", "gcn"), along_noise(results, "refined", "gcn"),
      printed_along_noise(false), along_noise(results, "paper", "none"),
      along_noise(results, "paper-closest", "none"), ransac_alpha(results));
}

std::string claims_text(const PaperResults& results) {
  const std::vector<Claim> all = claims(results);
  if (all.empty()) return "";
  const auto met = std::ranges::count_if(all, &Claim::met);
  std::string text = fmt::format(
      "## What is claimed\n\n{}{} of {} hold.",
      again(results, "--only tables --sets stairs,depth_stairs,depth_boxes,depth_slopes"), met,
      all.size());
  if (met < static_cast<std::ptrdiff_t>(all.size())) {
    text +=
        " These do not; the page's figure of failures shows the planes that are lost, "
        "[real.md](real.md#where-it-still-fails) tells why, and the oracle (every point to its "
        "nearest true plane) bounds what geometry alone can tell:\n";
    for (const Claim& claim : all)
      if (!claim.met)
        text += fmt::format("\n- {}: {} is {:.3f}, wanted {} ({})", claim.set, claim.measure,
                            claim.value, claim.bar, claim.others);
  }
  return text + "\n\n" + to_markdown(claim_table(all)) + "\n";
}

}  // namespace

std::string reproduction_page(const PaperResults& results, const PaperTimings& timings) {
  std::string text = run_text(results, timings) + readings_text(results) + claims_text(results);
  const auto add = [&text](const char* heading, const std::string& command,
                           const std::vector<Table>& tables) {
    if (!tables.empty())
      text += fmt::format("## {}\n\n{}{}\n", heading, command, joined(tables, to_markdown));
  };
  add("The paper's tables",
      again(results, kOfStairs) +
          "Table IV's recordings are read from where `PLANESCOPE_DATA` points.\n\n",
      paper_tables(results));
  add("Times", again(results, "--only timings"), timing_tables(timings));
  add("Stricter tables",
      again(results, "--only tables --sets NAME") +
          "NAME is the set that a table's title begins with, "
          "`depth_stairs,depth_boxes,depth_slopes` for\nall depth sets; without `--sets` it is all "
          "of them. icl_nuim needs `PLANESCOPE_DATA`.\n\n",
      stricter_tables(results));
  text.pop_back();
  return text;
}

}  // namespace planescope::lab
