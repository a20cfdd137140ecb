#include "core/debug/filter/filter.hpp"

#include <cmath>

#include "core/debug/filter/filter_parse.hpp"

namespace planescope::debug {
namespace {

/// Empty where the run has no such point.
PointTrack track_of(double number, const Run& run) {
  PointTrack track;
  const auto count = static_cast<double>(run.segmentation.plane_of.size());
  if (number >= count || number != std::floor(number)) return track;
  const auto point = static_cast<std::int32_t>(number);
  track.nodes = run.timeline.path_of_point(point);
  for (const planes::PointChange& change : run.timeline.changes_of_point(point))
    track.steps.push_back(change.step);
  return track;
}

std::vector<std::int32_t> matching_of(const ParsedFilter& filter,
                                      const Run& run,
                                      std::int32_t first,
                                      std::int32_t last) {
  std::vector<double> options;
  for (const planes::OptionInfo* option : filter.options)
    options.push_back(planes::number_of(*option, run.options));
  std::vector<PointTrack> points;
  for (const double number : filter.points) points.push_back(track_of(number, run));
  std::vector<std::int32_t> steps;
  for (std::int32_t step = first; step <= last; ++step)
    if (filter.formula({run, step, *run.event_at(step), options, points}) != 0)
      steps.push_back(step);
  return steps;
}

}  // namespace

std::optional<Filter> Filter::parse(const std::string& text, FilterProblem& problem) {
  try {
    Filter filter;
    filter.text_ = text;
    filter.parsed_ = std::make_shared<const ParsedFilter>(parse_filter(text));
    return filter;
  } catch (FilterProblem& found) {
    problem = std::move(found);
    return std::nullopt;
  }
}

bool Filter::matches(const Run& run, std::int32_t step) const {
  return !parsed_ || !matching_of(*parsed_, run, step, step).empty();
}

std::vector<std::int32_t> Filter::matching(const Run& run) const {
  static const ParsedFilter kAll = parse_filter("");
  return matching_of(parsed_ ? *parsed_ : kAll, run, 1, run.steps());
}

const std::vector<FilterName>& filter_names() {
  static const std::vector<FilterName> names = [] {
    std::vector<FilterName> all;
    for (const FilterSymbol& symbol : filter_symbols())
      all.push_back({symbol.name, symbol.meaning});
    return all;
  }();
  return names;
}

}  // namespace planescope::debug
