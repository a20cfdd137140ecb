#include "core/experiments/paper_plots.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/report/bar_chart.hpp"
#include "core/report/line_chart.hpp"

namespace planescope {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kPaperPoints = 8192;

/// A line of a plot: cells that differ in set and noise only.
struct Contestant {
  std::string name;
  std::string method, profile, classifier, setting;

  bool made(const CellKey& key) const {
    return key.method == method && key.profile == profile && key.classifier == classifier &&
           key.setting == setting;
  }
};

const std::vector<Contestant>& paper_contestants() {
  static const std::vector<Contestant> all = {
      {"paper", "ours", "paper", "gcn", ""},
      {"paper-closest", "ours", "paper-closest", "gcn", ""},
      {"refined", "ours", "refined", "gcn", ""},
      {"region growing", "region-growing", "", "", ""},
      {"RANSAC 0.01 m", "ransac", "", "", ""},
      {"RANSAC 0.02 m", "ransac", "", "", "theta_pf 0.02"},
      {"oracle", "oracle", "", "", ""},
  };
  return all;
}

/// The paper's own rows, tables III and V ("ours"): of both, noise and values.
struct Printed {
  double noise_cm, alpha_deg, r_p, r_m;
};
constexpr Printed kPrinted[] = {{0, 0, 100, 0},       {0.05, 0.04, 100, 0}, {0.1, 0.10, 100, 0},
                                {0.15, 0.17, 101, 0}, {0.2, 0.26, 101, 0},  {0.3, 1.36, 102, 0.08}};

/// Every method that is on the stricter tables, by what stands in the cells: the best of ours, then
/// the others as they come.
std::vector<Contestant> all_contestants(const PaperResults& results) {
  std::vector<Contestant> all = {{"ours, refined", "ours", "refined", "gcn", ""}};
  const auto add = [&](const CellKey& key) {
    const bool known =
        std::any_of(all.begin(), all.end(), [&](const Contestant& c) { return c.made(key); });
    if (known) return;
    const std::string name = key.setting.empty() ? key.method : key.method + " " + key.setting;
    all.push_back({name, key.method, key.profile, key.classifier, key.setting});
  };
  for (const Cell& cell : results.cells)
    if (cell.key.method != "ours" && cell.key.method != "oracle") add(cell.key);
  all.push_back({"oracle", "oracle", "", "", ""});
  return all;
}

bool is_evaluated(const PaperResults& results, const CellKey& key) {
  return key.seed == results.seed || key.seed == 0;
}

class NoisePlot {
 public:
  explicit NoisePlot(const PaperResults& results) {
    for (const Cell& cell : results.cells)
      if (cell.key.set == "stairs" && cell.key.points == kPaperPoints &&
          is_evaluated(results, cell.key))
        cells_.push_back(&cell);
    for (const Cell* cell : cells_) noise_cm_.push_back(cell->key.noise_cm);
    std::sort(noise_cm_.begin(), noise_cm_.end());
    noise_cm_.erase(std::unique(noise_cm_.begin(), noise_cm_.end()), noise_cm_.end());
  }

  bool empty() const { return noise_cm_.empty(); }

  /// `printed` null: the paper does not give it.
  LineChart chart(const std::string& title,
                  double Metrics::*measure,
                  const double Printed::*printed) const {
    LineChart chart{.title = title, .x_name = "noise [cm]", .x = noise_cm_, .curves = {}};
    if (printed) {
      Curve& curve = chart.curves.emplace_back(Curve{"printed", {}});
      for (const double noise : noise_cm_) curve.values.push_back(printed_value(noise, printed));
    }
    for (const Contestant& contestant : paper_contestants()) {
      Curve curve{contestant.name, {}};
      for (const double noise : noise_cm_)
        curve.values.push_back(value(contestant, noise, measure));
      const bool measured = !std::all_of(curve.values.begin(), curve.values.end(),
                                         [](double value) { return std::isnan(value); });
      if (measured) chart.curves.push_back(std::move(curve));
    }
    return chart;
  }

 private:
  static double printed_value(double noise_cm, const double Printed::*printed) {
    for (const Printed& row : kPrinted)
      if (std::abs(row.noise_cm - noise_cm) < 1e-9) return row.*printed;
    return kNone;
  }
  double value(const Contestant& contestant, double noise_cm, double Metrics::*measure) const {
    for (const Cell* cell : cells_)
      if (contestant.made(cell->key) && cell->key.noise_cm == noise_cm)
        return cell->metrics.*measure;
    return kNone;
  }

  std::vector<const Cell*> cells_;
  std::vector<double> noise_cm_;
};

/// A set as the stricter tables have it: clouds under one noise, depth images under one error.
struct Group {
  std::string name;
  CellKey of;

  bool holds(const CellKey& key) const {
    return key.set == of.set && key.errors == of.errors && key.noise_cm == of.noise_cm &&
           key.points == of.points && key.seed == of.seed;
  }
};

std::vector<Group> groups_of(const PaperResults& results, bool depth) {
  std::vector<Group> groups;
  for (const Cell& cell : results.cells) {
    const CellKey& key = cell.key;
    if (!is_evaluated(results, key) || key.errors.empty() == depth) continue;
    if (!depth && key.set == "stairs" && key.points != kPaperPoints) continue;
    const bool known =
        std::any_of(groups.begin(), groups.end(), [&](const Group& g) { return g.holds(key); });
    if (known) continue;
    const std::string below = depth ? key.errors : fmt::format("{:.6g} cm", key.noise_cm);
    groups.push_back({key.set + "\n" + below, key});
  }
  return groups;
}

double iou_of(const PaperResults& results, const Group& group, const Contestant& contestant) {
  for (const Cell& cell : results.cells)
    if (group.holds(cell.key) && contestant.made(cell.key)) return cell.metrics.mean_iou;
  return kNone;
}

PaperPlot set_plot(const PaperResults& results,
                   std::span<const Group> groups,
                   const std::string& title,
                   const std::string& note) {
  BarChart chart{.title = title, .groups = {}, .bars = {}};
  for (const Group& group : groups) chart.groups.push_back(group.name);
  for (const Contestant& contestant : all_contestants(results)) {
    Curve bar{contestant.name, {}};
    for (const Group& group : groups) bar.values.push_back(iou_of(results, group, contestant));
    const bool measured = !std::all_of(bar.values.begin(), bar.values.end(),
                                       [](double value) { return std::isnan(value); });
    if (measured) chart.bars.push_back(std::move(bar));
  }
  if (chart.bars.empty()) return {};
  return {title, note, bar_chart(chart)};
}

}  // namespace

std::vector<PaperPlot> noise_plots(const PaperResults& results) {
  const NoisePlot plot(results);
  if (plot.empty()) return {};
  std::vector<PaperPlot> plots;
  const auto add = [&](const std::string& title, const std::string& note, const LineChart& chart) {
    if (!chart.curves.empty()) plots.push_back({title, note, line_chart(chart)});
  };
  LineChart alpha = plot.chart("Angle error alpha against noise, degrees", &Metrics::alpha_deg,
                               &Printed::alpha_deg);
  alpha.log_from = 0.005;
  add("α [°]", "Mean angle of the planes' normals, lower is better; smaller ones stand at 0.005.",
      alpha);
  LineChart r_p = plot.chart("Planes found of planes there, per cent, against noise", &Metrics::r_p,
                             &Printed::r_p);
  r_p.log_from = 50;
  add("r_p [%]", "Planes found of planes there: 100 is right.", r_p);
  LineChart r_m =
      plot.chart("Points in no plane, per cent, against noise", &Metrics::r_m, &Printed::r_m);
  r_m.log_from = 0.005;
  add("r_m [%]", "Points in no plane, lower is better; smaller ones stand at 0.005.", r_m);
  add("Mean IoU [%]", "Of the true planes, higher is better. The paper gives none.",
      plot.chart("Mean IoU against noise, per cent", &Metrics::mean_iou, nullptr));
  return plots;
}

std::vector<PaperPlot> set_plots(const PaperResults& results) {
  constexpr std::size_t kMostGroups = 9;  // names stay apart
  std::vector<PaperPlot> plots;
  for (const bool depth : {false, true}) {
    const std::vector<Group> groups = groups_of(results, depth);
    for (std::size_t begin = 0; begin < groups.size(); begin += kMostGroups) {
      const auto part =
          std::span(groups).subspan(begin, std::min(kMostGroups, groups.size() - begin));
      PaperPlot plot =
          depth ? set_plot(results, part, "Mean IoU on depth images [%]", "Scored by voxel.")
                : set_plot(results, part, "Mean IoU on clouds [%]", "Scored by point.");
      if (!plot.svg.empty()) plots.push_back(std::move(plot));
    }
  }
  return plots;
}

}  // namespace planescope
