#pragma once

// The names of the filter language and what they mean for an event. Internal to core/debug/filter.

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::debug {

/// Where to find a point that a filter names.
struct PointTrack {
  std::vector<std::int32_t> nodes;  // that ever held it, ascending
  std::vector<std::int32_t> steps;  // that changed its plane, ascending
};

/// What there is to know of an event, and what the filter asks of the run, looked up once for all.
struct EventView {
  const Run& run;
  std::int32_t step;
  const planes::TraceEvent& event;
  std::span<const double> options = {};     // of ParsedFilter::options
  std::span<const PointTrack> points = {};  // of ParsedFilter::points

  const planes::OctreeNode* node() const {
    return event.node >= 0 ? &run.octree().nodes[event.node] : nullptr;
  }
  /// What the criteria see of the node; null when it is visited: nothing has been computed yet.
  const NodeFacts* facts() const {
    return event.node >= 0 && event.type != planes::EventType::visit ? &run.facts[event.node]
                                                                     : nullptr;
  }
};

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
/// "a number", "a case (I, II, III or IV)".
const char* to_string(FilterType type);

/// The value of a field that the event does not have: NaN.
inline constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

/// A name: of a field of events, of an option of the run, or of a value (III, h, R1).
struct FilterSymbol {
  std::string name;
  std::string meaning;
  FilterType type = FilterType::number;
  /// Booleans are 0 or 1, names the number of what they name. `plane`, `point`: is there any?
  double (*field)(const EventView&) = nullptr;
  const planes::OptionInfo* option = nullptr;
  std::optional<double> value = {};
};
const std::vector<FilterSymbol>& filter_symbols();

/// Null: unknown. Two may share a name: then the one of the type that is wanted, or the field.
const FilterSymbol* find_filter_symbol(std::string_view name,
                                       std::optional<FilterType> wanted = {});

}  // namespace planescope::debug
