#pragma once

// Charts for pages, as SVG elements. The page defines their colors and text with
// line_chart_style().

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace planescope::report {

struct Curve {
  std::string name;
  std::vector<double> values;  // one per x of the chart; NaN: skipped, the curve continues
  int color = -1;              // index in the style; -1: by position in the chart
};

struct LineChart {
  std::string title;  // for screen readers
  std::string x_name;
  std::vector<double> x;              // ascending, not below x_from
  double x_from = 0;                  // start of the axis
  std::vector<Curve> curves;          // at least one
  std::optional<double> x_mark = {};  // a vertical line there ...
  std::string mark_name = {};         // ... and its label
  bool from_zero = false;             // else the y axis spans only the values
};

/// The chart as an SVG element, with names beside the curves' colors.
std::string line_chart(const LineChart& chart);

/// Points of one kind.
struct Scatter {
  std::string name;
  std::vector<std::pair<double, double>> points;  // x, y
  int color = 0;                                  // index in the style
  double radius_px = 3.5;
  bool joined = false;  // by a line, in order
};

struct ScatterChart {
  std::string title;  // for screen readers
  std::string x_name;
  std::vector<Scatter> groups;  // later ones on top; at least one point
};

/// The chart as an SVG element.
std::string scatter_chart(const ScatterChart& chart);

/// CSS for a page with charts, light or dark like the reader's system.
std::string line_chart_style();

/// A self-contained HTML page, light or dark like the reader's system, with the style of charts.
/// `body`: HTML below the title, which is escaped here.
std::string plain_page(const std::string& title, const std::string& body);

}  // namespace planescope::report
