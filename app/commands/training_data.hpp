#pragma once

#include <functional>
#include <stop_token>
#include <string>
#include <vector>

#include "app/commands/inputs.hpp"
#include "core/lab/training/training_set.hpp"

namespace planescope::app {

/// The name of the validation set of frames of the recordings.
inline constexpr const char* kRecordingsSet = "recordings";

/// Every fifth labelled frame is kept for validation.
inline bool is_kept_for_validation(std::size_t labelled_frame) { return labelled_frame % 5 == 4; }

/// Frames of the inputs that have truth.
struct LabelledRecordings {
  std::vector<planes::LabelledCloud> train, validation;
  std::vector<std::string> frames;  // Recording::frame_hash() of all of them, in their order
  std::string sha256;               // of all their points and labels; empty without recordings
};

/// What of a frame is learnt from.
struct LabelledFrame {
  planes::LabelledCloud cloud;  // its voxels; empty where it has no truth or none has a label
  std::string sha256;           // Recording::frame_hash()
};
/// Throws Error where gravity is not known.
LabelledFrame make_labelled_frame(const Frame& frame,
                                  const planes::SourceTruth& truth,
                                  std::string sha256,
                                  const planes::PipelineOptions& options);
/// Frames without truth are left out.
LabelledRecordings labelled_recordings(std::vector<LabelledFrame> frames);

/// None where no input is given. Throws Error where the inputs have no label, Cancelled on stop.
LabelledRecordings load_labelled_recordings(const InputArgs& args, const std::stop_token& stop);

/// What a training learns from and what it is scored on.
struct TrainingData {
  lab::TrainingRecipe recipe;
  std::vector<planes::LabelledCloud> synthetic, recordings;  // one of them may be empty
  std::vector<lab::ValidationSet> validation;  // the recordings' own, where there is one, last
  std::vector<std::string> frames;             // LabelledRecordings::frames

  /// Cloud `number` of the training, varied as the recipe has it.
  planes::LabelledCloud draw(std::uint64_t number) const;
};

struct TrainingDataOptions {
  bool synthetic = true;
  int validation_clouds = 12;  // of each kind
  int threads = 1;
};

/// Makes the synthetic clouds and puts the recordings beside them. `progress(done, all)` may throw
/// to stop.
TrainingData make_training_data(const lab::TrainingRecipe& recipe,
                                const TrainingDataOptions& options,
                                LabelledRecordings recordings,
                                const std::function<void(int, int)>& progress);

}  // namespace planescope::app
