#include "app/desktop/debugger/plane_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

PlaneRow row_of(const debug::Run& run, const planes::FramePlanes& found, std::size_t k) {
  const planes::PlaneSummary& summary = found.summaries[k];
  PlaneRow row;
  row.id = summary.id;
  row.plane = run.timeline.plane_of_number(summary.id);
  row.label = summary.label;
  row.area_m2 = found.outlines[k].area_m2;
  row.tilt_deg = summary.tilt_deg;
  row.rms_m = summary.rms_m;
  row.points = summary.points;
  row.support = found.footholds[k].surface.support;
  row.foot = found.footholds[k].space.has_value();
  row.steppable = found.footholds[k].steppable;
  row.margin = summary.margin;
  row.undecided = summary.undecided;
  return row;
}

bool fits(const PlaneRow& row, const std::vector<std::string>& words) {
  std::vector<std::string> texts = cells_of(row);
  if (row.label != Label::unknown)
    texts.emplace_back(row.label == Label::h ? "horizontal level" : "vertical upright");
  if (row.foot) texts.emplace_back(row.steppable ? "steppable" : "not steppable");
  if (row.undecided) texts.emplace_back("undecided");
  return std::ranges::all_of(words, [&](const std::string& word) {
    return std::ranges::any_of(texts, [&](const std::string& text) {
      return lower_case(text).find(word) != std::string::npos;
    });
  });
}

/// What is not known stands last, whichever way the rest runs.
double key_of(const PlaneRow& row, PlaneColumn column) {
  switch (column) {
    case PlaneColumn::id:
      return row.id;
    case PlaneColumn::label:
      return static_cast<double>(row.label);
    case PlaneColumn::area:
      return row.area_m2;
    case PlaneColumn::tilt:
      return row.tilt_deg;
    case PlaneColumn::rms:
      return row.rms_m;
    case PlaneColumn::points:
      return static_cast<double>(row.points);
    case PlaneColumn::support:
      return row.support;
    case PlaneColumn::steppable:
      return row.foot ? row.steppable : std::numeric_limits<double>::quiet_NaN();
    case PlaneColumn::margin:
      return std::isfinite(row.margin) ? row.margin : std::numeric_limits<double>::quiet_NaN();
  }
  return 0;
}

void sort(std::vector<PlaneRow>& rows, PlaneColumn column, bool descending) {
  std::ranges::stable_sort(rows, [&](const PlaneRow& a, const PlaneRow& b) {
    const double x = key_of(a, column), y = key_of(b, column);
    if (std::isnan(x) || std::isnan(y)) return !std::isnan(x) && std::isnan(y);
    return descending ? x > y : x < y;
  });
}

std::string number(double value) { return std::isfinite(value) ? fmt::format("{}", value) : ""; }

}  // namespace

std::vector<std::string> cells_of(const PlaneRow& row) {
  const auto known = [](double value, const std::string& text) {
    return std::isnan(value) ? std::string("–") : text;
  };
  return {fmt::format("P{}", row.id),
          to_string(row.label, "–"),
          fmt::format("{:.3f} m²", row.area_m2),
          known(row.tilt_deg, fmt::format("{:.1f}°", row.tilt_deg)),
          fmt::format("{:.1f} mm", 1000 * row.rms_m),
          std::to_string(row.points),
          known(row.support, fmt::format("{:.0f} %", 100 * row.support)),
          row.foot ? (row.steppable ? "yes" : "no") : "–",
          std::isfinite(row.margin) ? fmt::format("{:.2g}{}", row.margin, row.undecided ? " ~" : "")
                                    : "–"};
}

std::vector<PlaneRow> plane_rows(const State& state) {
  const RunPlanes* planes = state.planes();
  if (!planes) return {};
  const std::vector<std::string> words = words_of(lower_case(state.view.planes.filter));
  std::vector<PlaneRow> rows;
  for (std::size_t k = 0; k < planes->found.summaries.size(); ++k) {
    const PlaneRow row = row_of(*planes->of->run, planes->found, k);
    if (fits(row, words)) rows.push_back(row);
  }
  sort(rows, state.view.planes.sorted_by, state.view.planes.descending);
  return rows;
}

std::string planes_csv(const std::vector<PlaneRow>& rows) {
  std::string text = "id,class,area_m2,tilt_deg,rms_m,points,support,steppable,margin,undecided\n";
  for (const PlaneRow& row : rows)
    text += fmt::format("{},{},{},{},{},{},{},{},{},{}\n", row.id, to_string(row.label, ""),
                        number(row.area_m2), number(row.tilt_deg), number(row.rms_m), row.points,
                        number(row.support), row.foot ? (row.steppable ? "true" : "false") : "",
                        number(row.margin), row.undecided);
  return text;
}

}  // namespace planescope::desktop
