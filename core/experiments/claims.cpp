// What profile refined must reach with labels by gcn on the frames of the printed seed. Its values
// on the frames that it was tuned on stand beside them.

#include <cmath>

#include "core/experiments/cell_figures.hpp"
#include "core/experiments/paper_plan.hpp"
#include "core/experiments/paper_tables.hpp"

namespace planescope {
namespace {

struct Measure {
  const char* name;
  double (*of)(const Metrics&);
  int digits;
};
const Measure kRp = {"r_p", [](const Metrics& m) { return m.r_p; }, 2};
const Measure kRm = {"r_m [%]", [](const Metrics& m) { return m.r_m; }, 3};
const Measure kAlpha = {"alpha [deg]", [](const Metrics& m) { return m.alpha_deg; }, 3};
const Measure kIou = {"mean IoU [%]", [](const Metrics& m) { return m.mean_iou; }, 2};
const Measure kPq = {"PQ [%]", [](const Metrics& m) { return m.pq; }, 2};
const Measure kDetected = {
    "detected at 0.8 [%]",
    [](const Metrics& m) { return percent(m.detected_iou80, m.planes_truth); }, 2};

/// A value is to be at least, above, at most or below a bound, or this near to 100.
struct Bar {
  enum class Kind { at_least, above, at_most, below, near_100 } kind;
  double bound;

  bool met(double value) const {
    switch (kind) {
      case Kind::at_least:
        return value >= bound;
      case Kind::above:
        return value > bound;
      case Kind::at_most:
        return value <= bound;
      case Kind::below:
        return value < bound;
      case Kind::near_100:
        return std::abs(value - 100) <= bound;
    }
    return false;
  }
  std::string text() const {
    switch (kind) {
      case Kind::at_least:
        return fmt::format(">= {}", bound);
      case Kind::above:
        return fmt::format("> {}", bound);
      case Kind::at_most:
        return fmt::format("<= {}", bound);
      case Kind::below:
        return fmt::format("< {}", bound);
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

  /// `frames(seed)`: the sets that are scored together.
  template <typename Frames>
  void add(const std::string& set,
           const Frames& frames,
           const Measure& measure,
           const Bar& bar,
           std::string others) {
    const auto value = [&](std::uint64_t seed, const CellKey& contestant) -> std::optional<double> {
      std::vector<CellKey> keys = frames(seed);
      for (CellKey& key : keys)
        key = contestant.method == "ours"
                  ? with_ours(key, contestant.profile, contestant.classifier)
                  : with_rival(key, contestant.method);
      const std::optional<Cell> cell = joined_cell(results_, keys);
      return cell ? std::optional(measure.of(cell->metrics)) : std::nullopt;
    };
    const CellKey ours = with_ours({}, "refined", "gcn");
    const std::optional<double> printed = value(results_.seed, ours);
    if (!printed) return;
    if (const auto oracle = value(results_.seed, with_rival({}, "oracle")))
      others += fmt::format("; oracle here {}{}", fixed(*oracle, measure.digits),
                            bar.met(*oracle) ? "" : ", which misses the bar too");
    Claim& claim = claims_.emplace_back();
    claim.frames = frames_of(frames(results_.seed));
    claim.set = set;
    claim.measure = measure.name;
    claim.bar = bar.text();
    claim.value = *printed;
    if (const auto tuning = value(results_.tuning_seed, ours)) claim.tuning = *tuning;
    claim.met = bar.met(*printed);
    claim.others = std::move(others);
  }
  std::vector<Claim> claims() && { return std::move(claims_); }

 private:
  int frames_of(const std::vector<CellKey>& keys) const {
    int frames = 0;
    for (const CellKey& key : keys)
      if (const Cell* cell = results_.find(with_ours(key, "refined", "gcn")))
        frames += cell->frames;
    return frames;
  }

  const PaperResults& results_;
  std::vector<Claim> claims_;
};

void claim_stairs(Claims& claims) {
  struct Noise {
    double cm, alpha;
    const char *paper_alpha, *cgal_alpha, *paper_r_p;
  };
  for (const Noise& noise : {Noise{0, 0.01, "0.00", "0.05", "100"},
                             {0.1, 0.04, "0.10", "0.039", "100"},
                             {0.2, 0.08, "0.26", "0.072", "101"},
                             {0.3, 0.15, "1.36", "0.152", "102"}}) {
    const std::string set = fmt::format("stairs of 8192 points, {} cm", noise.cm);
    const auto frames = [&](std::uint64_t seed) {
      return std::vector<CellKey>{stairs_of(seed, 8192, noise.cm)};
    };
    claims.add(set, frames, kRp, {Kind::near_100, 0.3},
               fmt::format("the paper {}, tuned CGAL region growing 100", noise.paper_r_p));
    claims.add(set, frames, kAlpha, {Kind::at_most, noise.alpha},
               fmt::format("the paper {}, tuned CGAL region growing {}", noise.paper_alpha,
                           noise.cgal_alpha));
    claims.add(set, frames, kRm, {Kind::at_most, 0.05},
               fmt::format("the paper {}, CGAL 0.08 to 0.46", noise.cm == 0.3 ? "0.08" : "0.00"));
    if (noise.cm == 0.1)
      claims.add(set, frames, kIou, {Kind::at_least, 98}, "CGAL 97.4, an oracle 98.8");
    if (noise.cm == 0.3)
      claims.add(set, frames, kIou, {Kind::at_least, 96.5}, "CGAL 96.4, an oracle 97.0");
  }
  const auto few = [](std::uint64_t seed) {
    return std::vector<CellKey>{stairs_of(seed, 2048, 0)};
  };
  claims.add("stairs of 2048 points", few, kRp, {Kind::near_100, 0.5}, "the paper 66");
  claims.add("stairs of 2048 points", few, kRm, {Kind::at_most, 0.1}, "the paper 25.2");
}

void claim_depth(Claims& claims) {
  const auto frames = [](std::uint64_t seed) {
    std::vector<CellKey> keys;
    for (const std::string& set : depth_sets()) keys.push_back(depth_of(set, seed, "d435"));
    return keys;
  };
  const std::string set = "D435-like depth, by voxel";
  claims.add(set, frames, kIou, {Kind::above, 86}, "PEAC tuned 84.7, CGAL 84.6, CAPE 54");
  claims.add(set, frames, kPq, {Kind::above, 88}, "PEAC tuned 87.7, CGAL 84.1, CAPE 64");
  claims.add(set, frames, kDetected, {Kind::above, 88}, "PEAC tuned 86.5, CGAL 86.4, CAPE 51");
  claims.add(set, frames, kAlpha, {Kind::below, 0.3}, "CGAL 0.28, PEAC 0.96");
  claims.add(set, frames, kRm, {Kind::below, 2}, "CGAL 2.2, PEAC 4.2");
}

}  // namespace

std::vector<Claim> claims(const PaperResults& results) {
  Claims claims(results);
  claim_stairs(claims);
  claim_depth(claims);
  return std::move(claims).claims();
}

Table claim_table(std::span<const Claim> claims) {
  Table table{"What is claimed",
              "Profile refined with labels by gcn. Others: printed in the paper, or, of CGAL, PEAC "
              "and CAPE, measured elsewhere on sets like these and not in this run. Bars are for "
              "the sets' full numbers of frames.",
              {"set", "measure", "bar", "met", "others", "frames", "value", "tuning seed"},
              {},
              5};
  for (const Claim& claim : claims)
    table.rows.push_back({claim.set, claim.measure, claim.bar, claim.met ? "yes" : "NO",
                          claim.others, std::to_string(claim.frames), fixed(claim.value, 3),
                          std::isnan(claim.tuning) ? "-" : fixed(claim.tuning, 3)});
  return table;
}

}  // namespace planescope
