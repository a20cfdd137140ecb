#pragma once

// Filter language for events: `case==III && depth>=5 && mse>0.8*theta_mse`, `plane==7`,
// `point==1234`, `merge && offset>0.02`, `truth.mixed`. Syntax: docs/filter.md.

#include <cstddef>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// Error in the text of a filter, and its position: bytes [begin, end).
struct FilterProblem {
  std::size_t begin = 0, end = 0;
  std::string message;
};

struct ParsedFilter;

class Filter {
 public:
  /// Empty text matches every event. On error, returns nullopt and sets `problem`.
  static std::optional<Filter> parse(const std::string& text, FilterProblem& problem);

  const std::string& text() const { return text_; }
  /// Whether the event that led to `step` (1 <= step <= steps()) matches.
  bool matches(const Run& run, std::int32_t step) const;
  /// All steps that match, ascending.
  std::vector<std::int32_t> matching(const Run& run) const;

 private:
  std::string text_;
  std::shared_ptr<const ParsedFilter> parsed_;
};

/// A completion at the cursor: replaces bytes [begin, end) of the text. Best first.
struct Completion {
  std::size_t begin = 0, end = 0;
  std::string insert;
  std::string meaning;
};
std::vector<Completion> complete_filter(const std::string& text, std::size_t cursor);

/// Every name in the language, for docs and completion.
struct FilterName {
  std::string name;
  std::string meaning;
};
const std::vector<FilterName>& filter_names();

}  // namespace planescope::debug
