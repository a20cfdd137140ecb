#pragma once

// The labeled frames of a search and the scores of settings on them, and the journal of trials,
// with which a search can be stopped at any time and resumed.

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "core/lab/tuning/tuning_search.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::lab {

struct TuningFrame {
  std::string name;
  std::string hash;  // of the frame and its labels
  Frame frame;
  planes::SourceTruth truth;
  planes::PipelineOptions options;  // at the start: those of the search, and its recording's own
};

/// A trial, and the CPU time of a frame [ms]: labeling and planes, on one thread.
struct TimedTrial {
  Trial trial;
  double ms = 0;
};

class TuningSet {
 public:
  /// `classifier` null: points have true labels or none.
  TuningSet(std::vector<TuningFrame> frames, std::shared_ptr<const planes::Classifier> classifier);

  const std::vector<TuningFrame>& frames() const { return frames_; }

  /// Computes panoptic quality [%] of each setting on each frame. Passes it to `take` in the order
  /// of the settings as soon as it is available. A frame that cannot be run with a setting has 0.
  /// Independent of the number of threads. Exceptions from `take` or `progress(frames done, all)`
  /// stop the rest.
  void score(std::span<const Setting> settings,
             int threads,
             const std::function<void(const TimedTrial&)>& take,
             const std::function<void(int, int)>& progress = {}) const;

 private:
  struct Scored {
    double pq = 0, ms = 0;
  };
  struct Labeled;  // a frame up to its labels, with the options at the start
  Scored score_one(std::size_t frame, const Setting& setting) const;
  const Labeled& labeled(std::size_t frame) const;

  std::vector<TuningFrame> frames_;
  std::vector<planes::SourceTruth> planes_;  // of the frames, without h and v
  std::shared_ptr<const planes::Classifier> classifier_;
  std::vector<std::shared_ptr<Labeled>> labeled_;  // of the first frames
};

/// Identity of a search, by name: it can be resumed only with the same values.
using TuningPurpose = std::vector<std::pair<std::string, std::string>>;

/// DIR/journal.jsonl: the purpose, then a line for each trial, in the order of the trials; the same
/// bytes for any number of threads and of interruptions. DIR/times.jsonl: the time of each.
class TuningJournal {
 public:
  /// Reads an existing journal, or begins one. Drops an incomplete last line. Throws Error if the
  /// journal is damaged, cannot be written, or has another purpose: the message names the first
  /// difference.
  TuningJournal(const std::filesystem::path& dir, const TuningPurpose& purpose);

  std::optional<Trial> find(const Setting& setting) const;
  /// CPU time of a frame [ms]; nullopt if unknown.
  std::optional<double> time_of(const Setting& setting) const;
  /// Appends the trial. Throws Error.
  void add(const Trial& trial, double ms);

  const std::vector<Trial>& trials() const { return trials_; }

 private:
  bool read(const TuningPurpose& purpose);  // returns whether a journal exists
  void read_times();

  std::filesystem::path file_, times_file_;
  std::vector<Trial> trials_;
  std::map<Setting, std::size_t> place_;
  std::map<std::size_t, double> ms_;
};

}  // namespace planescope::lab
