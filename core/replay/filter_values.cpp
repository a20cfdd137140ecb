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
    case FilterType::refinement:
      return "a refinement (R1 to R7, or split)";
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
    const std::pair<const char*, const char*> refinements[] = {
        {"R1", "merge by distance"}, {"R2", "explain away"},
        {"R3", "weak candidates"},   {"R4", "fit impure nodes"},
        {"R5", "reassign points"},   {"R6", "refit"},
        {"R7", "second merge"},      {"split", "split disconnected planes"}};
    for (int r = 1; r <= kSplit; ++r)
      all.push_back({refinements[r - 1].first, refinements[r - 1].second, FilterType::refinement,
                     static_cast<double>(r)});
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
