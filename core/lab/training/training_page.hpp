#pragma once

#include <string>
#include <utility>
#include <vector>

#include "core/lab/training/train.hpp"

namespace planescope::lab {

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
