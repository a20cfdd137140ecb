#pragma once

// Trains a classifier on reviewed frames, evaluates it on frames reviewed since, and finds frames
// about which it is in doubt. Called by jobs; starts no threads.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "app/desktop/state/state.hpp"
#include "core/debug/replay/run.hpp"

namespace planescope::desktop {

/// Weights trained on a recording's labels, stored beside them.
std::filesystem::path learnt_weights(const std::filesystem::path& label_dir);

/// Frames for training or evaluation, and how to read them.
struct LearningSource {
  std::shared_ptr<const io::Recording> recording;
  io::PickedGravity picked;
  std::filesystem::path label_dir;
  std::vector<int> reviewed;  // reviewed and saved
  planes::PipelineOptions options;
};
LearningSource learning_source(const State& state);

/// Reports progress; may throw to stop.
using LearningProgress = std::function<void(const char* stage, int done, int all)>;

/// Fine-tunes the bundled weights on the reviewed frames plus synthetic clouds, and writes them to
/// learnt_weights(). Throws Error if nothing can be learned from these frames.
void learn(const LearningSource& source, const Lesson& lesson, const LearningProgress& progress);

/// Evaluates the weights beside the labels: their training record, and their gain over the bundled
/// weights on frames that were not used for training. Null if there are no such weights. Throws
/// Error if they are unreadable.
std::shared_ptr<const Learnt> measure_learnt(const LearningSource& source,
                                             const LearningProgress& progress);

/// Fraction of a frame's points for which the classifier is less than 75 % sure; nullopt if its
/// points are not labeled.
std::optional<double> doubt_of(const debug::Subject& subject);

/// Unreviewed frames with known doubt, most doubtful first.
std::vector<int> by_doubt(const State& state);
/// Shows the next frame in that order, or the first if this frame is not in it; starts the search
/// if nothing is known yet. Throws Error if doubt is not available.
void show_doubtful_frame(State& state);

}  // namespace planescope::desktop
