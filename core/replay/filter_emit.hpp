#pragma once

// Types of what the parser reads, and the program that follows. Internal to core/replay.

#include <optional>
#include <string_view>

#include "core/replay/filter_program.hpp"
#include "core/replay/filter_tokens.hpp"

namespace planescope {

/// Thrown while parsing; parse_filter() returns it.
struct FilterFailed {
  FilterProblem problem;
};
[[noreturn]] void fail_filter(std::size_t begin, std::size_t end, std::string message);
[[noreturn]] void fail_filter(const FilterToken& token, std::string message);

/// What has been read: its type and place. The code of a plane or point is left to the comparison.
struct FilterTerm {
  FilterType type = FilterType::number;
  std::size_t begin = 0, end = 0;
  std::optional<double> constant = {};  // a number or the name of a value, on its own
};

/// Checks types and writes code.
class FilterEmitter {
 public:
  explicit FilterEmitter(std::string_view text) : text_(text) {}

  FilterTerm constant(const FilterToken& token, FilterType type, double value);
  FilterTerm named(const FilterToken& token, FilterType wanted = FilterType::boolean);
  void compare(const FilterTerm& left, const FilterToken& sign, const FilterTerm& right);
  void emit(FilterOp::Code code) { program_.push_back({.code = code}); }
  /// A jump whose target is the place of land() after it.
  std::size_t jump(FilterOp::Code code);
  void land(std::size_t jump) { program_[jump].target = program_.size(); }

  void need_number(const FilterTerm& term) const;
  void need_boolean(const FilterTerm& term) const;
  std::string text_of(const FilterTerm& term) const;
  FilterProgram take() { return std::move(program_); }

 private:
  void compare_identity(const FilterTerm& field, const FilterToken& sign, const FilterTerm& other);
  void need_equality(const FilterTerm& term, const FilterToken& sign) const;

  std::string_view text_;
  FilterProgram program_;
};

}  // namespace planescope
