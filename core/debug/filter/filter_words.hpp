#pragma once

// Vocabulary of the filter language: tokenizing, names, and their values for an event. Internal
// to core/debug/filter.

#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/debug/filter/filter.hpp"
#include "core/debug/replay/run.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::debug {

/// Nodes and steps of a point named in a filter.
struct PointTrack {
  std::vector<std::int32_t> nodes;  // nodes that ever contained it, ascending
  std::vector<std::int32_t> steps;  // steps that changed its plane, ascending
};

/// An event with the filter's values that are constant for its run.
struct EventView {
  const Run& run;
  std::int32_t step;
  const planes::TraceEvent& event;
  std::span<const double> options = {};     // of ParsedFilter::options
  std::span<const PointTrack> points = {};  // of ParsedFilter::points

  const planes::OctreeNode* node() const {
    return event.node >= 0 ? &run.octree().nodes[event.node] : nullptr;
  }
  /// Facts of the event's node; null for visits, when nothing has been computed yet.
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
  plane,       // planes of an event
  point,       // points of an event
  plane_name,  // P7
};
/// "a number", "a case (I, II, III, or IV)".
const char* to_string(FilterType type);

/// Value of a field that the event lacks: NaN.
inline constexpr double kAbsent = std::numeric_limits<double>::quiet_NaN();

/// A name: a field of events, an option of the run, or a value (III, h, join).
struct FilterSymbol {
  std::string name;
  std::string meaning;
  FilterType type = FilterType::number;
  /// Booleans are 0 or 1; named values are numbers. `plane`, `point`: whether there are any.
  double (*field)(const EventView&) = nullptr;
  const planes::OptionInfo* option = nullptr;
  std::optional<double> value = {};
};
const std::vector<FilterSymbol>& filter_symbols();

/// Null if unknown. If two symbols share a name, returns the one of the wanted type, or the field.
const FilterSymbol* find_filter_symbol(std::string_view name,
                                       std::optional<FilterType> wanted = {});

struct FilterPlace {
  std::size_t begin = 0, end = 0;  // bytes of the text
};
/// Throws a FilterProblem.
[[noreturn]] void fail_filter(const FilterPlace& place, std::string message);

struct FilterToken : FilterPlace {
  enum Kind { name, number, sign } kind = sign;
  std::string_view text;  // view into the parsed text
  double value = 0;       // if a number
};
/// The tokens up to the first error, which is stored in `problem`.
std::vector<FilterToken> filter_tokens(std::string_view text,
                                       std::optional<FilterProblem>& problem);
bool is_comparison(std::string_view sign);

}  // namespace planescope::debug
