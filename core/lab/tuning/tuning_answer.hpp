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
/// Trials that no other beats in both, the fastest first.
std::vector<PricedTrial> pareto_front(std::vector<PricedTrial> trials);

struct TuningAnswer {
  planes::PipelineOptions base;           // at the start of the search
  std::vector<std::string> frames, held;  // names: searched on, and held out
  Tuned tuned;                            // on the frames
  Trial held_base, held_tuned;            // once, at the end
  double base_ms = 0, tuned_ms = 0;       // of a held-out frame
  std::vector<PricedTrial> priced;        // of the frames: all with known time
  std::size_t trials = 0;                 // all that were ever run
};

/// One sentence: whether the tuned options gain on the held-out frames.
std::string verdict(const TuningAnswer& answer);
/// With few tuning frames and no gain on the held-out ones: notes that the worst labeled frame is
/// held out, so that the search cannot fix it. Otherwise empty.
std::string held_out_note(const TuningAnswer& answer);
/// For a terminal.
std::string tuning_text(const TuningAnswer& answer);
/// planescope.tuning/1: everything except times. Ends with a line end.
std::string tuning_json(const TuningAnswer& answer);
/// A self-contained page.
std::string tuning_page(const TuningAnswer& answer);
/// Accuracy against time, as a separate file. `answer` must have priced trials.
std::string pareto_picture(const TuningAnswer& answer);
/// A file for --profile: the tunable options that differ from the profile at the start of the
/// search, and the method and classifier. Range, gravity and the like belong to the recording.
std::string tuned_profile(const TuningAnswer& answer);

}  // namespace planescope::lab
