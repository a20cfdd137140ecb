#pragma once

// The names of the filter language and what they mean for an event. Internal to core/replay.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/pipeline/options_table.hpp"
#include "core/replay/event_view.hpp"

namespace planescope {

enum class FilterType : std::uint8_t {
  number,
  boolean,
  node_case,
  label,
  stage,
  plane,       // the planes that an event concerns
  point,       // the points that it concerns
  plane_name,  // P7
};
/// "a number", "a case (I, II, III, IV)".
const char* to_string(FilterType type);

/// kAbsent: the event has no such field. Booleans are 0 or 1, names the number of what they name.
using FieldValue = double (*)(const EventView&);

struct FilterField {
  std::string name;
  std::string meaning;
  FilterType type = FilterType::number;
  FieldValue value = nullptr;          // null: an option, or one of plane and point
  const OptionInfo* option = nullptr;  // its number in the run's options
  std::vector<std::string> aliases = {};
};
const std::vector<FilterField>& filter_fields();
const FilterField* find_filter_field(std::string_view name);  // null: unknown

/// Names of values: I, h, R1 ...
struct FilterValue {
  std::string name;
  std::string meaning;
  FilterType type = FilterType::number;
  double value = 0;
};
const std::vector<FilterValue>& filter_values();
const FilterValue* find_filter_value(std::string_view name);

}  // namespace planescope
