#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "app/commands/train.hpp"
#include "app/commands/training_data.hpp"
#include "core/lab/training/checkpoint.hpp"

namespace planescope::app {

nlohmann::ordered_json json_of(const lab::TrainingSetOptions& set);
nlohmann::ordered_json json_of(const lab::AugmentOptions& options);

/// How weights were trained, as a JSON object for their file: nothing in it depends on where, when
/// or with how many threads that was.
std::string training_record(const TrainArgs& args,
                            const TrainingData& data,
                            const lab::TrainState& state,
                            const lab::TrainingPurpose& purpose);

/// What a checkpoint must agree with beyond the trainer's own options.
lab::TrainingPurpose training_purpose(const TrainArgs& args, const LabelledRecordings& recordings);

}  // namespace planescope::app
