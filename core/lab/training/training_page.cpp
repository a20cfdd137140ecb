#include "core/lab/training/training_page.hpp"

#include <fmt/format.h>

#include <kainjow/mustache.hpp>

#include "core/report/page/charts.hpp"

namespace planescope::lab {
namespace {

using kainjow::mustache::html_escape;

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
  std::string page = "<dl>\n";
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
  return report::plain_page(summary.title, page);
}

}  // namespace planescope::lab
