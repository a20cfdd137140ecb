#pragma once

// The labelled frames of a search and what a setting reaches on them; and the journal of trials as
// they are made, so that a search can be stopped at any moment and go on.

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
  planes::PipelineOptions options;  // to begin with: those of the search, and its recording's own
};

/// A trial, and the CPU time of a frame [ms]: of labelling and planes, by one thread.
struct TimedTrial {
  Trial trial;
  double ms = 0;
};

class TuningSet {
 public:
  /// `classifier` null: truth labels the points, or nothing does.
  TuningSet(std::vector<TuningFrame> frames, std::shared_ptr<const planes::Classifier> classifier);

  const std::vector<TuningFrame>& frames() const { return frames_; }

  /// Panoptic quality [%] of each setting on each frame, handed to `take` in the order of the
  /// settings as soon as they are there. A frame that cannot be run with a setting has 0. The same
  /// for any number of threads. What is thrown by `take`, or by `progress(frames done, all)`, stops
  /// the rest.
  void score(std::span<const Setting> settings,
             int threads,
             const std::function<void(const TimedTrial&)>& take,
             const std::function<void(int, int)>& progress = {}) const;

 private:
  struct Scored {
    double pq = 0, ms = 0;
  };
  struct Labelled;  // a frame up to its labels, with the options to begin with
  Scored score_one(std::size_t frame, const Setting& setting) const;
  const Labelled& labelled(std::size_t frame) const;

  std::vector<TuningFrame> frames_;
  std::vector<planes::SourceTruth> planes_;  // of the frames, without h and v
  std::shared_ptr<const planes::Classifier> classifier_;
  std::vector<std::shared_ptr<Labelled>> labelled_;  // of the first frames
};

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
