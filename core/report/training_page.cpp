#include "core/report/training_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kainjow/mustache.hpp>

namespace planescope {
namespace {

using kainjow::mustache::html_escape;

// Distinct for all kinds of colour vision (Okabe and Ito).
constexpr const char* kColors[] = {"#0072b2", "#d55e00", "#009e73", "#cc79a7",
                                   "#e69f00", "#56b4e9", "#555555"};

struct Curve {
  std::string name;
  std::vector<double> values;  // by epoch
};

constexpr int kWidth = 720, kHeight = 300, kLeft = 56, kRight = 150, kTop = 16, kBottom = 36;

/// A step of 1, 2 or 5 times a power of ten that cuts `span` into at most five.
double tick_step(double span) {
  const double power = std::pow(10, std::floor(std::log10(std::max(span, 1e-9) / 5)));
  for (const double factor : {1, 2, 5, 10})
    if (span / (factor * power) <= 5) return factor * power;
  return 10 * power;
}

std::string chart(const std::string& unit,
                  const std::vector<Epoch>& epochs,
                  const std::vector<Curve>& curves) {
  double low = 1e300, high = -1e300;
  for (const Curve& curve : curves)
    for (const double value : curve.values) {
      low = std::min(low, value);
      high = std::max(high, value);
    }
  const double step = tick_step(high - low);
  low = std::floor(low / step) * step;
  high = std::max(low + step, std::ceil(high / step) * step);
  const int last = std::max(1, epochs.back().step);
  const auto x = [&](int at) {
    return kLeft + static_cast<double>(at) / last * (kWidth - kLeft - kRight);
  };
  const auto y = [&](double value) {
    return kTop + (high - value) / (high - low) * (kHeight - kTop - kBottom);
  };
  std::string svg = fmt::format(
      "<svg viewBox=\"0 0 {} {}\" role=\"img\" aria-label=\"{} over training steps\">\n", kWidth,
      kHeight, html_escape(unit));
  for (double tick = low; tick < high + step / 2; tick += step)
    svg += fmt::format(
        "<line class=\"grid\" x1=\"{}\" x2=\"{}\" y1=\"{:.1f}\" y2=\"{:.1f}\"/>"
        "<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:.4g}</text>\n",
        kLeft, kWidth - kRight, y(tick), y(tick), kLeft - 6, y(tick) + 4, tick);
  for (int part = 0; part <= 4; ++part)
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n",
                       x(last * part / 4), kHeight - kBottom + 18, last * part / 4);
  svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">steps</text>\n",
                     x(last / 2), kHeight - 4);
  for (std::size_t c = 0; c < curves.size(); ++c) {
    const char* color = kColors[c % std::size(kColors)];
    std::string path;
    for (std::size_t e = 0; e < epochs.size(); ++e)
      path += fmt::format("{}{:.1f} {:.1f}", e == 0 ? "M" : "L", x(epochs[e].step),
                          y(curves[c].values[e]));
    const double legend = kTop + 12 + 18.0 * static_cast<double>(c);
    svg += fmt::format(
        "<path d=\"{}\" stroke=\"{}\"/>"
        "<path d=\"M{} {}h16\" stroke=\"{}\"/><text x=\"{}\" y=\"{}\">{}</text>\n",
        path, color, kWidth - kRight + 10, legend - 4, color, kWidth - kRight + 32, legend,
        html_escape(curves[c].name));
  }
  return svg + "</svg>\n";
}

std::string table(const TrainingSummary& summary) {
  std::string rows = "<tr><th>steps</th><th>loss</th>";
  for (const std::string& name : summary.validation_sets)
    rows += fmt::format("<th>{}<br>edge / inner %</th>", html_escape(name));
  rows += "</tr>\n";
  for (const Epoch& epoch : summary.epochs) {
    rows += fmt::format("<tr><td>{}</td><td>{:.4f}</td>", epoch.step, epoch.train_loss);
    for (const LabelAccuracy& a : epoch.validation)
      rows += fmt::format("<td>{:.2f} / {:.2f}</td>", a.edge_percent(), a.inner_percent());
    rows += "</tr>\n";
  }
  return "<table>" + rows + "</table>\n";
}

constexpr const char* kStyle =
    "body{font:15px/1.5 system-ui,sans-serif;max-width:60rem;margin:2rem auto;padding:0 1rem;"
    "color:#222}table{border-collapse:collapse;font-variant-numeric:tabular-nums}"
    "td,th{padding:.15rem .7rem;text-align:right;border-bottom:1px solid #ddd}"
    ".facts td,.facts th{text-align:left}svg{width:100%;height:auto}svg text{font-size:12px}"
    "svg path{fill:none;stroke-width:2}.grid{stroke:#ddd}";

}  // namespace

std::string training_page(const TrainingSummary& summary) {
  std::string page = fmt::format(
      "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width\"><title>{0}</title>\n"
      "<style>{1}</style>\n<h1>{0}</h1>\n<table class=\"facts\">",
      html_escape(summary.title), kStyle);
  for (const auto& [name, value] : summary.facts)
    page += fmt::format("<tr><th>{}</th><td>{}</td></tr>\n", html_escape(name), html_escape(value));
  page += "</table>\n";
  if (summary.epochs.empty()) return page + "<p>No epoch is complete yet.</p></html>\n";
  Curve loss{"training", {}};
  std::vector<Curve> edges;
  for (const std::string& name : summary.validation_sets) edges.push_back({name, {}});
  for (const Epoch& epoch : summary.epochs) {
    loss.values.push_back(epoch.train_loss);
    for (std::size_t s = 0; s < edges.size(); ++s)
      edges[s].values.push_back(epoch.validation[s].edge_percent());
  }
  page += "<h2>Loss</h2>\n" + chart("loss", summary.epochs, {loss});
  page += "<h2>Label accuracy within 2 cm of another label [%]</h2>\n" +
          chart("edge accuracy in per cent", summary.epochs, edges);
  return page + "<h2>Epochs</h2>\n" + table(summary) + "</html>\n";
}

}  // namespace planescope
