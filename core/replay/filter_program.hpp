#pragma once

// A parsed filter: a flat program for a stack of numbers. Internal to core/replay.

#include <cstdint>
#include <vector>

#include "core/replay/filter_fields.hpp"

namespace planescope {

struct FilterOp {
  enum Code : std::uint8_t {
    constant,
    field,
    option,
    is_plane,   // does the event concern the plane / point of this number?
    has_plane,  // any plane at all
    is_point,
    has_point,  // any point: itself, or in its node
    add,
    subtract,
    multiply,
    divide,
    negate,
    equal,
    different,
    less,
    less_equal,
    greater,
    greater_equal,
    invert,
    and_then,  // if the top is 0 go on at `target`, otherwise drop it
    or_else,   // if the top is not 0 go on at `target`, otherwise drop it
  };
  Code code = constant;
  double number = 0;           // constant, is_plane (from 0), is_point
  FieldValue value = nullptr;  // field
  const OptionInfo* option_info = nullptr;
  std::size_t target = 0;
};

using FilterProgram = std::vector<FilterOp>;

/// A program made ready for one run: options are numbers, points know their nodes.
class BoundFilter {
 public:
  BoundFilter(const FilterProgram& program, const Run& run);
  bool matches(std::int32_t step);

 private:
  struct Track {  // of a point that the filter names
    std::int32_t point;
    std::vector<std::int32_t> nodes;  // that ever held it, ascending
    std::vector<std::int32_t> steps;  // that changed its plane, ascending
  };
  bool concerns(const EventView& event, const Track& track) const;

  const Run& run_;
  FilterProgram program_;
  std::vector<Track> tracks_;
  std::vector<double> stack_;
};

}  // namespace planescope
