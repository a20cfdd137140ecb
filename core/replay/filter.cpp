#include "core/replay/filter.hpp"

#include "core/replay/filter_parse.hpp"

namespace planescope {

struct Filter::Program {
  FilterProgram ops;
};

std::optional<Filter> Filter::parse(const std::string& text, FilterProblem& problem) {
  std::optional<FilterProgram> ops = parse_filter(text, problem);
  if (!ops) return std::nullopt;
  Filter filter;
  filter.text_ = text;
  filter.program_ = std::make_shared<const Program>(Program{std::move(*ops)});
  return filter;
}

bool Filter::matches(const Run& run, std::int32_t step) const {
  return !program_ || BoundFilter(program_->ops, run).matches(step);
}

std::vector<std::int32_t> Filter::matching(const Run& run) const {
  static const FilterProgram kAll;
  BoundFilter bound(program_ ? program_->ops : kAll, run);
  std::vector<std::int32_t> steps;
  for (std::int32_t step = 1; step <= run.steps(); ++step)
    if (bound.matches(step)) steps.push_back(step);
  return steps;
}

const std::vector<FilterName>& filter_names() {
  static const std::vector<FilterName> names = [] {
    std::vector<FilterName> all;
    for (const FilterField& field : filter_fields()) all.push_back({field.name, field.meaning});
    for (const FilterValue& value : filter_values()) all.push_back({value.name, value.meaning});
    return all;
  }();
  return names;
}

}  // namespace planescope
