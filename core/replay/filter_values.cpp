#include <algorithm>

#include "core/replay/filter_fields.hpp"

namespace planescope {

const char* to_string(FilterType type) {
  switch (type) {
    case FilterType::number:
      return "a number";
    case FilterType::boolean:
      return "true or false";
    case FilterType::node_case:
      return "a case (I, II, III or IV)";
    case FilterType::label:
      return "a label (h or v)";
    case FilterType::stage:
      return "a stage (criteria, merge, assign, R1 to R8, or split)";
    case FilterType::plane:
    case FilterType::plane_name:
      return "a plane";
    case FilterType::point:
      return "a point";
  }
  return "?";
}

const std::vector<FilterValue>& filter_values() {
  static const std::vector<FilterValue> values = [] {
    std::vector<FilterValue> all;
    const char* cases[] = {"impure", "too few inliers", "not planar", "a plane"};
    for (int c = 1; c <= 4; ++c)
      all.push_back({to_string(static_cast<Case>(c)), cases[c - 1], FilterType::node_case,
                     static_cast<double>(c)});
    all.push_back({"h", "level, like treads", FilterType::label, 1});
    all.push_back({"v", "upright, like risers", FilterType::label, 2});
    for (const Stage stage : stages()) {
      const RefinementInfo* refinement = refinement_of(stage);
      all.push_back({to_string(stage), refinement ? refinement->title : "a stage of the paper",
                     FilterType::stage, static_cast<double>(stage)});
    }
    return all;
  }();
  return values;
}

const FilterValue* find_filter_value(std::string_view name) {
  const auto found = std::find_if(filter_values().begin(), filter_values().end(),
                                  [&](const FilterValue& value) { return value.name == name; });
  return found == filter_values().end() ? nullptr : &*found;
}

}  // namespace planescope
