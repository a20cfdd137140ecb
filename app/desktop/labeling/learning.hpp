#pragma once

// The classifier learns from reviewed frames, is measured on those reviewed since, and says which
// frames it is in doubt about. No thread of its own: jobs call this.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "app/desktop/state/state.hpp"
#include "core/debug/replay/run.hpp"

namespace planescope::desktop {

/// Weights that were trained on a recording's labels, beside them.
std::filesystem::path learnt_weights(const std::filesystem::path& label_dir);

/// The frames to learn from, or to be measured on, and how they are read.
struct LearningSource {
  std::shared_ptr<const io::Recording> recording;
  io::PickedGravity picked;
  std::filesystem::path label_dir;
  std::vector<int> reviewed;  // and saved
  planes::PipelineOptions options;
};
LearningSource learning_source(const State& state);

/// Says what is done of what; may throw to stop.
using LearningProgress = std::function<void(const char* stage, int done, int all)>;

/// Trains the weights that ship on the reviewed frames, beside synthetic clouds, and writes them
/// to learnt_weights(). Throws Error where nothing can be learnt from these frames.
void learn(const LearningSource& source, const Lesson& lesson, const LearningProgress& progress);

/// What the weights beside the labels have learnt, and how much better than the weights that ship
/// they are on frames that they have not learnt from; null where there are no such weights.
/// Throws Error where they cannot be read.
std::shared_ptr<const Learnt> measure_learnt(const LearningSource& source,
                                             const LearningProgress& progress);

/// The share of a frame's points that its classifier is less than 75 % sure of; nothing where its
/// points are not labelled.
std::optional<double> doubt_of(const debug::Subject& subject);

/// Frames that are not reviewed and whose doubt is known, the most doubtful first.
std::vector<int> by_doubt(const State& state);
/// Shows the frame after this one in that order, the first where this one has no place in it;
/// begins the search where nothing is known yet. Throws Error where there is no doubt to know.
void show_doubtful_frame(State& state);

}  // namespace planescope::desktop
