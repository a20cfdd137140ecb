#pragma once

// The result of a tuning search: its gain, the changed options, and accuracy against time.

#include <string>
#include <vector>

#include "core/lab/tuning/tuning_search.hpp"

namespace planescope::lab {

/// A trial with its time: mean panoptic quality [%], mean CPU time of a frame [ms].
struct PricedTrial {
  Setting setting;
  double pq = 0, ms = 0;
};
/// Those that no other beats in both, the quickest first.
std::vector<PricedTrial> pareto_front(std::vector<PricedTrial> trials);

struct TuningAnswer {
  planes::PipelineOptions base;           // that the search began with
  std::vector<std::string> frames, held;  // names: searched on, and held out
  Tuned tuned;                            // on the frames
  Trial held_base, held_tuned;            // once, in the end
  double base_ms = 0, tuned_ms = 0;       // of a frame that was held out
  std::vector<PricedTrial> priced;        // of the frames: all whose time is known
  std::size_t trials = 0;                 // all that were ever made
};

/// One sentence: whether the tuned options gain on the held-out frames.
std::string verdict(const TuningAnswer& answer);
/// With few tuning frames and no gain on the held-out ones: that the worst labeled frame is held
/// out, so that the search cannot fix it. Otherwise empty.
std::string held_out_note(const TuningAnswer& answer);
/// For a terminal.
std::string tuning_text(const TuningAnswer& answer);
/// planescope.tuning/1: all but times. It ends with a line end.
std::string tuning_json(const TuningAnswer& answer);
/// One page that needs nothing beside it.
std::string tuning_page(const TuningAnswer& answer);
/// Accuracy against time, a file of its own. `answer` has priced trials.
std::string pareto_picture(const TuningAnswer& answer);
/// As --profile takes it: what differs from the profile that the search began with, of the options
/// that tuning may change, and the method and classifier. Range, gravity and such are the
/// recording's.
std::string tuned_profile(const TuningAnswer& answer);

}  // namespace planescope::lab
