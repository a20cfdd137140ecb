#pragma once

// The labelled frames of a search, and what a setting reaches on them.

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
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

}  // namespace planescope::lab
