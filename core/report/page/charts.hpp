#pragma once

// Charts of pages, as SVG elements. Colours and text follow the page: it defines
// line_chart_style().

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace planescope::report {

struct Curve {
  std::string name;
  std::vector<double> values;  // one for each of the chart's x; NaN: none, the curve goes on after
  int color = -1;              // one of the style's; -1: by its place in the chart
};

struct LineChart {
  std::string title;  // read out where the chart is not seen
  std::string x_name;
  std::vector<double> x;              // ascending, not below x_from
  double x_from = 0;                  // where the axis begins
  std::vector<Curve> curves;          // at least one
  std::optional<double> x_mark = {};  // a vertical line there ...
  std::string mark_name = {};         // ... and what it means
  bool from_zero = false;             // else the y axis spans the values alone
};

/// The chart as an SVG element, its names beside the curves' colours.
std::string line_chart(const LineChart& chart);

/// Points of one kind.
struct Scatter {
  std::string name;
  std::vector<std::pair<double, double>> points;  // x, y
  int color = 0;                                  // one of the style's
  double radius_px = 3.5;
  bool joined = false;  // by a line, in their order
};

struct ScatterChart {
  std::string title;  // read out where the chart is not seen
  std::string x_name;
  std::vector<Scatter> groups;  // later ones above; with one point at least
};

/// The chart as an SVG element.
std::string scatter_chart(const ScatterChart& chart);

/// CSS for a page with charts, light and dark as the reader's system is.
std::string line_chart_style();

/// One HTML page that needs nothing beside it, light and dark as the reader's system is, with the
/// style of charts. `body`: HTML below the title, which is escaped here.
std::string plain_page(const std::string& title, const std::string& body);

}  // namespace planescope::report
