#pragma once

// What is written of a training while it goes on: its state, and a page of its curves.

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/lab/training/train.hpp"

namespace planescope::lab {

/// What a training was asked to do beyond its options, by name: it can be resumed only with the
/// same.
using TrainingPurpose = std::map<std::string, std::string>;

/// All of a training's state, so that it can go on where it was stopped and end in the same bytes.
/// Replaces the file as a whole or not at all.
void write_checkpoint(const std::filesystem::path& path,
                      const TrainState& state,
                      const TrainOptions& options,
                      const TrainingPurpose& purpose);

/// Throws Error where the file is damaged, or belongs to a training with other options or another
/// purpose: the message names the first that differs.
TrainState read_checkpoint(const std::filesystem::path& path,
                           const TrainOptions& options,
                           const TrainingPurpose& purpose);

/// What a training's page says.
struct TrainingSummary {
  std::string title;                                       // of the page
  std::vector<std::pair<std::string, std::string>> facts;  // name, value
  std::vector<std::string> validation_sets;                // names, as in Epoch::validation
  std::vector<Epoch> epochs;
};

/// One HTML page that needs nothing beside it: the loss and the edge accuracy of every validation
/// set over the steps as SVG curves, and the same as a table.
std::string training_page(const TrainingSummary& summary);

}  // namespace planescope::lab
