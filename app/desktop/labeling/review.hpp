#pragma once

// The review's queue as it is worked through.

#include <filesystem>
#include <memory>
#include <vector>

#include "app/desktop/state/state.hpp"

namespace planescope::desktop {

/// What a queue is made of: labels, and the run or another annotator's folder.
struct ReviewSides {
  std::shared_ptr<const LabelFrame> frame;
  std::shared_ptr<const FrameLabels> labels;
  std::shared_ptr<const debug::Run> run;  // null: `folder`
  std::filesystem::path folder;
  double smallest_cm2 = 0;  // regions below it are no question

  bool operator==(const ReviewSides&) const = default;
};
/// Throws Error where the folder has no labels of this very frame.
std::shared_ptr<const ReviewQueue> make_queue(const ReviewSides& sides);

/// Shows a new queue. The first one of a frame begins at its largest item. After an earlier one,
/// the chosen item stays chosen if it is still there; the views go on only after a decision.
void take_queue(State& state, const std::shared_ptr<const ReviewQueue>& queue);
/// Moves both views there; -1: none.
void choose_item(State& state, int item);
/// Decides on the chosen item, and chooses the next undecided one. Throws Error where none is
/// chosen, or where its labels are no longer what the queue was made of.
void decide(State& state, ReviewDecision decision);

/// An undecided thin strip: the queue has them after all other undecided items.
bool is_sliver(const labels::Disagreement& item);
struct Slivers {
  int count = 0;
  std::size_t pixels = 0;
};
Slivers slivers_of(const ReviewQueue& queue);
/// Decides on all slivers as one step of undo; those on locked or hidden planes are left. Throws
/// Error where there is none, or where labels have changed since.
void decide_slivers(State& state, ReviewDecision decision);

/// A decision; its region may no longer differ, and then is no item of the queue.
struct Decided {
  ReviewNote note;
  int item = -1;  // of the queue, or -1
};
/// The latest first.
std::vector<Decided> decided_items(const FrameLabels& labels, const ReviewQueue& queue);

const char* to_string(DisagreementKind kind);
const char* past_tense(ReviewDecision decision);  // "kept"

}  // namespace planescope::desktop
