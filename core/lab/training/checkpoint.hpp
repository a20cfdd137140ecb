#pragma once

// Output of a running training: its state, and a page of its curves.

#include <filesystem>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "core/lab/training/train.hpp"

namespace planescope::lab {

/// Settings of a training beyond its options, by name. It can be resumed only with the same
/// settings.
using TrainingPurpose = std::map<std::string, std::string>;

/// Writes all of a training's state, so that it can be resumed and end in the same bytes. Replaces
/// the file completely or not at all.
void write_checkpoint(const std::filesystem::path& path,
                      const TrainState& state,
                      const TrainOptions& options,
                      const TrainingPurpose& purpose);

/// Throws Error if the file is damaged, or belongs to a training with other options or another
/// purpose: the message names the first difference.
TrainState read_checkpoint(const std::filesystem::path& path,
                           const TrainOptions& options,
                           const TrainingPurpose& purpose);

/// Content of a training's page.
struct TrainingSummary {
  std::string title;                                       // of the page
  std::vector<std::pair<std::string, std::string>> facts;  // name, value
  std::vector<std::string> validation_sets;                // names, as in Epoch::validation
  std::vector<Epoch> epochs;
};

/// A self-contained HTML page: the loss and the edge accuracy of every validation set over the
/// steps as SVG curves, and as a table.
std::string training_page(const TrainingSummary& summary);

}  // namespace planescope::lab
