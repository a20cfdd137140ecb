#pragma once

#include <filesystem>

#include "core/classify/train.hpp"

namespace planescope {

/// All of a training's state, so that it can go on where it was stopped and end in the same bytes.
/// Replaces the file as a whole or not at all. `purpose`: what the training was asked to do, which
/// a checkpoint can be continued with only.
void write_checkpoint(const std::filesystem::path& path,
                      const TrainState& state,
                      const TrainOptions& options,
                      const std::string& purpose);

/// Throws Error where the file is damaged, or belongs to a training with other options.
TrainState read_checkpoint(const std::filesystem::path& path,
                           const TrainOptions& options,
                           const std::string& purpose);

}  // namespace planescope
