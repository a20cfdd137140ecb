#pragma once

// The trials of a search as they are made, so that it can be stopped at any moment and go on.

#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/lab/tuning/tuning_search.hpp"

namespace planescope::lab {

/// What a search is of, by name: it can go on only with the same.
using TuningPurpose = std::vector<std::pair<std::string, std::string>>;

/// DIR/journal.jsonl: the purpose, then a line for each trial, in the order in which they were
/// made; the same bytes whatever the number of threads, and however often it was stopped.
/// DIR/times.jsonl: what each took.
class TuningJournal {
 public:
  /// Reads what is there, or begins. A last line that was cut is dropped. Throws Error where the
  /// journal is damaged, cannot be written, or is of another purpose: the message names the first
  /// that differs.
  TuningJournal(const std::filesystem::path& dir, const TuningPurpose& purpose);

  std::optional<Trial> find(const Setting& setting) const;
  /// CPU time of a frame [ms]; nothing where it is not known.
  std::optional<double> time_of(const Setting& setting) const;
  /// Appends the trial. Throws Error.
  void add(const Trial& trial, double ms);

  const std::vector<Trial>& trials() const { return trials_; }

 private:
  bool read(const TuningPurpose& purpose);  // whether anything is there
  void read_times();

  std::filesystem::path file_, times_file_;
  std::vector<Trial> trials_;
  std::map<Setting, std::size_t> place_;
  std::map<std::size_t, double> ms_;
};

}  // namespace planescope::lab
