#pragma once

// All that is known of a run, as plain text: to look things up in, and to compare line by line what
// two versions, or two settings, make of one frame.

#include <fmt/format.h>

#include <cstdint>
#include <iterator>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/debug/replay/run.hpp"

namespace planescope::debug {

/// Every event in words and numbers; the changes of every plane, point and node; which events a
/// fixed list of filters finds; and what core/debug/explain answers about nodes, merges, leftover
/// points and places, of each kind evenly strided where there are many. With `pinned`, a run of the
/// same frame: where the two part. Numbers of planes and nodes have all their digits.
std::string trace_text(const Run& run, const Run* pinned = nullptr);

// The parts of the text; for core/debug/explain alone.

/// Text that is written line by line.
struct TraceLines {
  std::string text;

  template <typename... Values>
  void add(fmt::format_string<Values...> format, Values&&... values) {
    fmt::format_to(std::back_inserter(text), format, std::forward<Values>(values)...);
    text += '\n';
  }
  template <typename... Values>
  void title(fmt::format_string<Values...> format, Values&&... values) {
    text += "\n## ";
    add(format, std::forward<Values>(values)...);
  }
};

/// All digits of a double. "nan" has no sign.
std::string exact(double value);
std::string exact(const Vec3d& v);
std::string exact(const PlaneFit& fit);

/// Ascending numbers, "3-7 9 12-15"; "none".
std::string ranges_of(std::span<const std::int32_t> numbers);

/// At most `most` of `all`, at even distances.
template <typename T>
std::vector<T> strided(const std::vector<T>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<T> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[i * all.size() / most]);
  return some;
}

// What core/debug/explain answers about a run. trace_answers.cpp
void write_histograms(const Run& run, TraceLines& lines);
void write_score(const Run& run, TraceLines& lines);  // nothing without ground truth
void write_nodes(const Run& run, TraceLines& lines);
void write_merges(const Run& run, TraceLines& lines);
void write_leftovers(const Run& run, TraceLines& lines);
void write_lives(const Run& run, TraceLines& lines);
/// Each plane of the result and of the truth, and what is in no plane; beside `pinned` if not null.
void write_regions(const Run& run, const Run* pinned, TraceLines& lines);
void write_comparison(const Run& run, const Run& pinned, TraceLines& lines);
void write_comparison_with_truth(const Run& run, TraceLines& lines);

}  // namespace planescope::debug
