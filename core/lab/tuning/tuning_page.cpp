#include <fmt/format.h>

#include <algorithm>
#include <kainjow/mustache.hpp>

#include "core/lab/tuning/tuning_answer.hpp"
#include "core/report/page/charts.hpp"

namespace planescope::lab {
namespace {

using kainjow::mustache::html_escape;
using Point = std::pair<double, double>;

Point point_of(const PricedTrial& trial) { return {trial.ms, trial.pq}; }

/// Without the tenth of the trials that is worst, and without that which is slowest: they would
/// take the picture for themselves.
std::vector<PricedTrial> worth_a_look(std::vector<PricedTrial> trials) {
  const std::size_t left_out = trials.size() / 10;
  std::ranges::stable_sort(trials, std::greater<>(), &PricedTrial::pq);
  trials.resize(trials.size() - left_out);
  std::ranges::stable_sort(trials, std::less<>(), &PricedTrial::ms);
  trials.resize(trials.size() - left_out);
  return trials;
}

std::string pareto_chart(const TuningAnswer& answer) {
  report::ScatterChart chart{.title = "Accuracy of the tuning half against time",
                             .x_name = "CPU time of a frame [ms]; upwards: PQ [%]",
                             .groups = {}};
  report::Scatter trials{"trials", {}, 6, 2}, start{"start", {}, 1, 6}, tuned{"tuned", {}, 2, 6};
  report::Scatter front{"best for its time", {}, 0, 3.5, true};
  for (const PricedTrial& trial : worth_a_look(answer.priced))
    trials.points.push_back(point_of(trial));
  for (const PricedTrial& trial : pareto_front(answer.priced))
    front.points.push_back(point_of(trial));
  for (const PricedTrial& trial : answer.priced) {
    if (trial.setting.empty()) start.points = {point_of(trial)};
    if (trial.setting == answer.tuned.best.setting) tuned.points = {point_of(trial)};
  }
  for (report::Scatter* group : {&trials, &front, &start, &tuned})
    if (!group->points.empty()) chart.groups.push_back(std::move(*group));
  return report::scatter_chart(chart);
}

std::string setting_text(const Setting& setting) {
  std::string text;
  for (const auto& [name, value] : setting)
    text += fmt::format("{}--set {}={}", text.empty() ? "" : " ", name, value);
  return text.empty() ? "as at the start" : text;
}

std::string front_table(const TuningAnswer& answer) {
  constexpr const char* kLeft = "style=\"text-align:left;white-space:nowrap\"";
  std::string rows = fmt::format("<tr><th>ms</th><th>PQ</th><th {}>options</th></tr>\n", kLeft);
  for (const PricedTrial& trial : pareto_front(answer.priced))
    rows += fmt::format("<tr><td>{:.1f}</td><td>{:.2f}</td><td {}><code>{}</code></td></tr>\n",
                        trial.ms, trial.pq, kLeft, html_escape(setting_text(trial.setting)));
  return "<div class=\"wide\"><table>\n" + rows + "</table></div>\n";
}

}  // namespace

std::string tuning_page(const TuningAnswer& answer) {
  std::string page = fmt::format("<p><strong>{}</strong></p>\n<pre class=\"wide\">{}</pre>\n",
                                 html_escape(verdict(answer)), html_escape(tuning_text(answer)));
  if (answer.priced.empty()) return report::plain_page("Tuning", page);
  page += fmt::format(
      "<h2>Accuracy against time</h2>\n{}<p class=\"soft\">Each trial of the tuning half, but for "
      "the tenth that is worst and the tenth that is slowest. Frames that were held out took "
      "{:.1f} ms at the start, {:.1f} ms tuned. Those that no other trial beats in both:</p>\n{}",
      pareto_chart(answer), answer.base_ms, answer.tuned_ms, front_table(answer));
  return report::plain_page("Tuning", page);
}

std::string pareto_picture(const TuningAnswer& answer) {
  const std::string chart = pareto_chart(answer);
  const std::size_t body = chart.find('\n') + 1;
  return fmt::format(
      "<svg xmlns=\"http://www.w3.org/2000/svg\" {}<style>svg{{font-family:system-ui,sans-serif;"
      "background:#f7f7f5;color:#1d2127}}\n@media (prefers-color-scheme:dark){{svg{{background:"
      "#131519;color:#e5e7ea}}}}\n{}</style>\n{}",
      chart.substr(5, body - 5), report::line_chart_style(), chart.substr(body));
}

}  // namespace planescope::lab
