#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>

#include "core/lab/experiments/paper_page.hpp"
#include "core/lab/experiments/paper_plan.hpp"
#include "core/lab/experiments/printed.hpp"
#include "core/report/page/charts.hpp"

namespace planescope::lab {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr int kPaperPoints = 8192;
constexpr double kLeastShown = 0.005;  // where a logarithmic axis begins

bool has_values(const report::Curve& curve) {
  return std::any_of(curve.values.begin(), curve.values.end(),
                     [](double value) { return !std::isnan(value); });
}

// ---- Against noise ----

struct Contestant {
  const char* name;
  CellKey key;  // of any frames
};
const std::vector<Contestant>& noise_contestants() {
  static const std::vector<Contestant> all = {
      {"paper", with_ours({}, "paper", "gcn")},
      {"paper-closest", with_ours({}, "paper-closest", "gcn")},
      {"refined", with_ours({}, "refined", "gcn")},
      {"region growing", with_rival({}, "region-growing")},
      {"RANSAC 0.01 m", with_rival({}, "ransac")},
      {"RANSAC 0.02 m", with_rival({}, "ransac", kRansacCoarse)},
      {"oracle", with_rival({}, "oracle")},
  };
  return all;
}

/// The same in every plot, 0 for what the paper printed; -1: by its place.
int color_of(const CellKey& contestant) {
  const auto& all = noise_contestants();
  const auto at = std::ranges::find(all, contestant, &Contestant::key);
  return at == all.end() ? -1 : static_cast<int>(at - all.begin()) + 1;
}

std::vector<double> noise_of_stairs(const PaperResults& results) {
  std::vector<double> noise_cm;
  for (const Cell& cell : results.cells)
    if (same_frames(cell.key, stairs_of(results.seed, kPaperPoints, cell.key.noise_cm)))
      noise_cm.push_back(cell.key.noise_cm);
  std::sort(noise_cm.begin(), noise_cm.end());
  noise_cm.erase(std::unique(noise_cm.begin(), noise_cm.end()), noise_cm.end());
  return noise_cm;
}

/// Of the paper's own method, from tables III and V, which agree where both have it.
report::Curve printed_curve(const std::vector<double>& noise_cm,
                            const double PrintedCell::*measure) {
  report::Curve curve{"printed", std::vector<double>(noise_cm.size(), kNone), 0};
  for (std::size_t i = 0; i < noise_cm.size(); ++i)
    for (const PrintedCell& cell : printed_cells())
      if (cell.method == "ours" && cell.with_labels && cell.points == kPaperPoints &&
          cell.noise_cm == noise_cm[i])
        curve.values[i] = cell.*measure;
  return curve;
}

/// `printed` null: the paper does not give it.
report::LineChart noise_chart(const PaperResults& results,
                              const std::string& title,
                              double planes::Metrics::*measure,
                              const double PrintedCell::*printed) {
  const std::vector<double> noise_cm = noise_of_stairs(results);
  report::LineChart chart{.title = title, .x_name = "noise [cm]", .x = noise_cm, .curves = {}};
  if (printed) chart.curves.push_back(printed_curve(noise_cm, printed));
  for (const Contestant& contestant : noise_contestants()) {
    report::Curve curve{contestant.name, {}, color_of(contestant.key)};
    for (const double noise : noise_cm) {
      const CellKey frames = stairs_of(results.seed, kPaperPoints, noise);
      const Cell* cell = results.find(with_method_of(frames, contestant.key));
      curve.values.push_back(cell ? cell->metrics.*measure : kNone);
    }
    if (has_values(curve)) chart.curves.push_back(std::move(curve));
  }
  return chart;
}

// ---- By set ----

/// Every kind of frames that was measured for the tables, each once.
std::vector<CellKey> frames_of(const PaperResults& results, bool clouds) {
  std::vector<CellKey> all;
  for (const Cell& cell : results.cells) {
    const CellKey& key = cell.key;
    const bool wanted = clouds ? key.points == kPaperPoints : key.points == 0;
    const bool tuned = key.seed == results.tuning_seed && key.seed != results.seed;
    if (!wanted || tuned) continue;
    if (std::none_of(all.begin(), all.end(),
                     [&](const CellKey& frames) { return same_frames(frames, key); }))
      all.push_back(key);
  }
  return all;
}

/// Ours as it is meant to be used, and all others, as keys of no frames.
std::vector<CellKey> bar_contestants(const PaperResults& results) {
  std::vector<CellKey> all = {with_ours({}, "refined", "gcn")};
  for (const Cell& cell : results.cells) {
    const CellKey contestant = with_method_of({}, cell.key);
    if (contestant.method != "ours" && std::find(all.begin(), all.end(), contestant) == all.end())
      all.push_back(contestant);
  }
  return all;
}

std::string group_name(const CellKey& frames) {
  if (frames.points > 0) return fmt::format("{}\n{} cm", frames.set, frames.noise_cm);
  return frames.set + "\n" + frames.errors;
}

report::BarChart set_chart(const PaperResults& results,
                           std::span<const CellKey> frames,
                           const std::string& title) {
  report::BarChart chart{.title = title, .groups = {}, .bars = {}, .low = 100};
  for (const CellKey& group : frames) chart.groups.push_back(group_name(group));
  for (const CellKey& contestant : bar_contestants(results)) {
    report::Curve bar{contestant_name(contestant), {}, color_of(contestant)};
    for (const CellKey& group : frames) {
      const Cell* cell = results.find(with_method_of(group, contestant));
      bar.values.push_back(cell ? cell->metrics.mean_iou : kNone);
      if (cell) chart.low = std::min(chart.low, cell->metrics.mean_iou);
    }
    if (has_values(bar)) chart.bars.push_back(std::move(bar));
  }
  // Differences are what matters: the axis begins not far below the least, and says so.
  chart.low = std::max(0.0, 20 * std::floor((chart.low - 10) / 20));
  return chart;
}

}  // namespace

std::vector<Plot> noise_plots(const PaperResults& results) {
  if (noise_of_stairs(results).empty()) return {};
  report::LineChart alpha = noise_chart(results, "Angle error alpha against noise, degrees",
                                        &planes::Metrics::alpha_deg, &PrintedCell::alpha_deg);
  report::LineChart r_p =
      noise_chart(results, "Planes found of planes there against noise, per cent",
                  &planes::Metrics::r_p, &PrintedCell::r_p);
  report::LineChart r_m = noise_chart(results, "Points in no plane against noise, per cent",
                                      &planes::Metrics::r_m, &PrintedCell::r_m);
  const report::LineChart iou =
      noise_chart(results, "Mean IoU against noise, per cent", &planes::Metrics::mean_iou, nullptr);
  alpha.log_from = r_m.log_from = kLeastShown;
  r_p.log_from = 50;
  std::vector<Plot> plots = {
      {"\u03b1 [\u00b0]", "Mean angle to the true normals: lower is better. Less stands at 0.005.",
       report::line_chart(alpha)},
      {"r_p [%]", "Planes found of planes there: 100 is right.", report::line_chart(r_p)},
      {"r_m [%]", "Points in no plane: lower is better. Less stands at 0.005.",
       report::line_chart(r_m)}};
  if (!iou.curves.empty())
    plots.push_back({"Mean IoU [%]", "Of the true planes: higher is better. The paper gives none.",
                     report::line_chart(iou)});
  return plots;
}

std::vector<Plot> set_plots(const PaperResults& results) {
  constexpr std::size_t kMostGroups = 6;  // as many names as fit side by side
  std::vector<Plot> plots;
  for (const bool clouds : {true, false}) {
    const std::vector<CellKey> frames = frames_of(results, clouds);
    const std::size_t parts = (frames.size() + kMostGroups - 1) / kMostGroups;
    for (std::size_t k = 0; k < parts; ++k) {
      const std::size_t begin = k * frames.size() / parts, end = (k + 1) * frames.size() / parts;
      const auto part = std::span(frames).subspan(begin, end - begin);
      std::string title = clouds ? "Mean IoU on clouds [%]" : "Mean IoU on depth images [%]";
      if (parts > 1) title += fmt::format(", {} of {}", k + 1, parts);
      const report::BarChart chart = set_chart(results, part, title);
      if (chart.bars.empty()) continue;
      const std::string note = clouds ? "Scored by point; below, the noise on every coordinate."
                                      : "Scored by voxel; below, the camera's errors.";
      plots.push_back({title, fmt::format("{} The axis begins at {:.0f}.", note, chart.low),
                       report::bar_chart(chart)});
    }
  }
  return plots;
}

}  // namespace planescope::lab
