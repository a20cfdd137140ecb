#pragma once

// The review queue and decisions on its items.

#include <filesystem>
#include <memory>
#include <vector>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// Inputs of a queue: labels, and the run or another annotator's folder.
struct ReviewSides {
  std::shared_ptr<const LabelFrame> frame;
  std::shared_ptr<const FrameLabels> labels;
  std::shared_ptr<const debug::Run> run;  // null: use `folder`
  std::filesystem::path folder;
  double smallest_cm2 = 0;  // smaller regions are excluded

  bool operator==(const ReviewSides&) const = default;
};
/// Throws Error if the folder has no labels for this frame.
std::shared_ptr<const ReviewQueue> make_queue(const ReviewSides& sides);

/// Shows a new queue. The first queue of a frame starts at its largest item. Later ones keep the
/// chosen item if it still exists; the views move on only after a decision.
void take_queue(State& state, const std::shared_ptr<const ReviewQueue>& queue);
/// Moves both views to an item; -1: none.
void choose_item(State& state, int item);
/// Decides on the chosen item and chooses the next undecided one. Throws Error if none is chosen or
/// its labels have changed since the queue was built.
void decide(State& state, ReviewDecision decision);

/// Whether the item is an undecided thin strip. Slivers come after all other undecided items.
bool is_sliver(const labels::Disagreement& item);
struct Slivers {
  int count = 0;
  std::size_t pixels = 0;
};
Slivers slivers_of(const ReviewQueue& queue);
/// Decides on all slivers in one undo step, except on locked or hidden planes. Throws Error if
/// there are none, or if labels have changed.
void decide_slivers(State& state, ReviewDecision decision);

/// A decision. If its region no longer differs, it is not in the queue.
struct Decided {
  ReviewNote note;
  int item = -1;  // index in the queue; -1: none
};
/// Latest first.
std::vector<Decided> decided_items(const FrameLabels& labels, const ReviewQueue& queue);

const char* to_string(DisagreementKind kind);
const char* past_tense(ReviewDecision decision);  // "kept"

}  // namespace planescope::desktop
