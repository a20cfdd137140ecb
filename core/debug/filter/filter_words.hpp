#pragma once

// The words of the filter language: how a text is split into them, which names there are, and what
// these mean for an event. Internal to core/debug/filter.

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

/// Where to find a point that a filter names.
struct PointTrack {
  std::vector<std::int32_t> nodes;  // that ever held it, ascending
  std::vector<std::int32_t> steps;  // that changed its plane, ascending
};

/// An event, with what a filter needs to know of its run, looked up once per run.
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

/// A name: of a field of events, of an option of the run, or of a value (III, h, join).
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

struct FilterPlace {
  std::size_t begin = 0, end = 0;  // bytes of the text
};
/// Throws a FilterProblem.
[[noreturn]] void fail_filter(const FilterPlace& place, std::string message);

struct FilterToken : FilterPlace {
  enum Kind { name, number, sign } kind = sign;
  std::string_view text;  // of the text given
  double value = 0;       // of a number
};
/// The tokens up to the first error, which `problem` then describes.
std::vector<FilterToken> filter_tokens(std::string_view text,
                                       std::optional<FilterProblem>& problem);
bool is_comparison(std::string_view sign);

}  // namespace planescope::debug
