// What profile refined must reach with labels by gcn on the frames of the printed seed. Its values
// on the frames that it was tuned on stand beside them.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/lab/bench/table.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/paper_tables.hpp"
#include "core/lab/experiments/printed.hpp"

namespace planescope::lab {
namespace {

struct Measure {
  const char* name;
  double (*of)(const planes::Metrics&);
  int digits;
};
const Measure kRp = {"r_p", [](const planes::Metrics& m) { return m.r_p; }, 2};
const Measure kRm = {"r_m [%]", [](const planes::Metrics& m) { return m.r_m; }, 3};
const Measure kAlpha = {"alpha [deg]", [](const planes::Metrics& m) { return m.alpha_deg; }, 3};
const Measure kIou = {"mean IoU [%]", [](const planes::Metrics& m) { return m.mean_iou; }, 2};

/// A value is to be at least or at most a bound, or this near to 100.
struct Bar {
  enum class Kind { at_least, at_most, near_100 } kind;
  double bound;

  bool met(double value) const {
    switch (kind) {
      case Kind::at_least:
        return value >= bound;
      case Kind::at_most:
        return value <= bound;
      case Kind::near_100:
        return std::abs(value - 100) <= bound;
    }
    return false;
  }
  std::string text() const {
    switch (kind) {
      case Kind::at_least:
        return fmt::format(">= {}", bound);
      case Kind::at_most:
        return fmt::format("<= {}", bound);
      case Kind::near_100:
        return fmt::format("100 +- {}", bound);
    }
    return "";
  }
};
using Kind = Bar::Kind;

class Claims {
 public:
  explicit Claims(const PaperResults& results) : results_(results) {}

  /// `frames(seed)`: the stairs that are scored; `of_paper`: the measure in the paper's tables,
  /// null where they lack it.
  template <typename Frames>
  void add(const std::string& set,
           const Frames& frames,
           const Measure& measure,
           const Bar& bar,
           double PrintedCell::*of_paper = nullptr) {
    const auto value = [&](const CellKey& key) -> std::optional<double> {
      const Cell* cell = results_.find(key);
      return cell ? std::optional(measure.of(cell->metrics)) : std::nullopt;
    };
    const CellKey printed = frames(results_.seed);
    const Cell* cell = results_.find(with_ours(printed, "refined", "gcn"));
    if (!cell) return;
    Claim& claim = claims_.emplace_back();
    claim.frames = cell->frames;
    claim.set = set;
    claim.measure = measure.name;
    claim.bar = bar.text();
    claim.value = measure.of(cell->metrics);
    if (const auto tuning = value(with_ours(frames(results_.tuning_seed), "refined", "gcn")))
      claim.tuning = *tuning;
    claim.met = bar.met(claim.value);

    std::vector<std::string> others;
    for (const PrintedCell& paper : printed_cells())
      if (of_paper && paper.method == "ours" && paper.with_labels && paper.table != "V" &&
          paper.points == printed.points && paper.noise_cm == printed.noise_cm && others.empty())
        others.push_back(fmt::format("the paper {}", paper.*of_paper));
    for (const planes::Method method : planes::all_methods())
      if (const auto rival = value(with_rival(printed, planes::to_string(method))))
        others.push_back(
            fmt::format("{} {}", planes::to_string(method), fixed(*rival, measure.digits)));
    if (const auto oracle = value(with_rival(printed, "oracle")))
      others.push_back(fmt::format("oracle {}{}", fixed(*oracle, measure.digits),
                                   bar.met(*oracle) ? "" : ", which misses the bar too"));
    claim.others = fmt::format("{}", fmt::join(others, "; "));
  }
  std::vector<Claim> claims() && { return std::move(claims_); }

 private:
  const PaperResults& results_;
  std::vector<Claim> claims_;
};

}  // namespace

std::vector<Claim> claims(const PaperResults& results) {
  Claims claims(results);
  struct Noise {
    double cm, alpha;
  };
  for (const Noise& noise : {Noise{0, 0.01}, {0.1, 0.04}, {0.2, 0.08}, {0.3, 0.15}}) {
    const std::string set = fmt::format("stairs of 8192 points, {} cm", noise.cm);
    const auto frames = [&](std::uint64_t seed) { return stairs_of(seed, 8192, noise.cm); };
    claims.add(set, frames, kRp, {Kind::near_100, 0.3}, &PrintedCell::r_p);
    claims.add(set, frames, kAlpha, {Kind::at_most, noise.alpha}, &PrintedCell::alpha_deg);
    claims.add(set, frames, kRm, {Kind::at_most, 0.05}, &PrintedCell::r_m);
    if (noise.cm == 0.1) claims.add(set, frames, kIou, {Kind::at_least, 98});
    if (noise.cm == 0.3) claims.add(set, frames, kIou, {Kind::at_least, 96.5});
  }
  const auto few = [](std::uint64_t seed) { return stairs_of(seed, 2048, 0); };
  claims.add("stairs of 2048 points", few, kRp, {Kind::near_100, 0.5}, &PrintedCell::r_p);
  claims.add("stairs of 2048 points", few, kRm, {Kind::at_most, 0.1}, &PrintedCell::r_m);
  return std::move(claims).claims();
}

Table claim_table(std::span<const Claim> claims) {
  Table table{"What is claimed",
              "Profile refined with labels by gcn. Others: printed in the paper, or measured in "
              "this run. Bars are for the sets' full numbers of frames. On depth: real.md.",
              {"set", "measure", "bar", "met", "others", "frames", "value", "tuning seed"},
              {},
              5};
  for (const Claim& claim : claims)
    table.rows.push_back({claim.set, claim.measure, claim.bar, claim.met ? "yes" : "NO",
                          claim.others, std::to_string(claim.frames), fixed(claim.value, 3),
                          std::isnan(claim.tuning) ? "-" : fixed(claim.tuning, 3)});
  return table;
}

}  // namespace planescope::lab
