#include "core/lab/training/training_page.hpp"

#include <fmt/format.h>

#include <kainjow/mustache.hpp>

#include "core/report/page/charts.hpp"

namespace planescope::lab {
namespace {

using kainjow::mustache::html_escape;

constexpr const char* kStyle =
    ":root{color-scheme:light dark;--page:#f7f7f5;--ink:#1d2127;--soft:#5a626d;--line:#e2e3e1}\n"
    "@media (prefers-color-scheme:dark){"
    ":root{--page:#131519;--ink:#e5e7ea;--soft:#9aa2ad;--line:#2c3037}}\n"
    "body{margin:2.5rem auto;max-width:56rem;padding:0 1.5rem;background:var(--page);"
    "color:var(--ink);font:15px/1.55 system-ui,sans-serif;font-variant-numeric:tabular-nums}\n"
    "h1{font-size:1.7rem;line-height:1.2;overflow-wrap:anywhere}h2{font-size:1.2rem;margin:2rem 0 "
    ".6rem}\n"
    "dl{display:grid;grid-template-columns:max-content minmax(0,1fr);gap:.2rem 1.4rem}"
    "dt,.soft{color:var(--soft)}dd{margin:0;overflow-wrap:anywhere}\n"
    ".wide{overflow-x:auto}table{border-collapse:collapse;width:100%}"
    "td,th{padding:.2rem .6rem;text-align:right;border-bottom:1px solid var(--line)}"
    "th{font-weight:600;vertical-align:bottom}\n";

report::LineChart chart_over(const std::vector<Epoch>& epochs, const std::string& title) {
  report::LineChart chart{.title = title, .x_name = "steps", .x = {}, .curves = {}};
  for (const Epoch& epoch : epochs) chart.x.push_back(epoch.step);
  return chart;
}

std::string loss_chart(const TrainingSummary& summary) {
  report::LineChart chart = chart_over(summary.epochs, "Loss over the steps of training");
  chart.from_zero = true;
  report::Curve& loss = chart.curves.emplace_back(report::Curve{"training", {}});
  for (const Epoch& epoch : summary.epochs) loss.values.push_back(epoch.train_loss);
  return report::line_chart(chart);
}

std::string edge_chart(const TrainingSummary& summary) {
  report::LineChart chart =
      chart_over(summary.epochs, "Right labels near edges over the steps, per cent");
  for (std::size_t s = 0; s < summary.validation_sets.size(); ++s) {
    report::Curve& curve = chart.curves.emplace_back(report::Curve{summary.validation_sets[s], {}});
    for (const Epoch& epoch : summary.epochs)
      curve.values.push_back(epoch.validation[s].edge_percent());
  }
  return report::line_chart(chart);
}

std::string table(const TrainingSummary& summary) {
  std::string rows = "<tr><th>steps</th><th>loss</th>";
  for (const std::string& name : summary.validation_sets)
    rows += fmt::format("<th>{}</th>", html_escape(name));
  rows += "</tr>\n";
  for (const Epoch& epoch : summary.epochs) {
    rows += fmt::format("<tr><td>{}</td><td>{:.4f}</td>", epoch.step, epoch.train_loss);
    for (const planes::LabelAccuracy& a : epoch.validation)
      rows += fmt::format("<td>{:.2f} / {:.2f}</td>", a.edge_percent(), a.inner_percent());
    rows += "</tr>\n";
  }
  return "<div class=\"wide\"><table>\n" + rows + "</table></div>\n";
}

}  // namespace

std::string training_page(const TrainingSummary& summary) {
  const std::string title = html_escape(summary.title);
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<title>{0}</title>\n<style>\n{1}{2}</style></head><body>\n<h1>{0}</h1>\n<dl>\n",
      title, kStyle, report::line_chart_style());
  for (const auto& [name, value] : summary.facts)
    page += fmt::format("<dt>{}</dt><dd>{}</dd>\n", html_escape(name), html_escape(value));
  page += "</dl>\n";
  if (summary.epochs.empty()) {
    page += "<p>No epoch is complete yet.</p>\n";
  } else {
    page += "<h2>Loss</h2>\n" + loss_chart(summary);
    page += "<h2>Right labels within 2 cm of another label [%]</h2>\n" + edge_chart(summary);
    page +=
        "<h2>Epochs</h2>\n<p class=\"soft\">Right labels within 2 cm of another label / elsewhere "
        "[%]</p>\n" +
        table(summary);
  }
  return page + "</body></html>\n";
}

}  // namespace planescope::lab
