#pragma once

// The classifier that --classifier names, made once per command.

#include <filesystem>
#include <memory>
#include <optional>
#include <string>

#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {

/// Which weights a classifier has, and how they were trained.
struct WeightsRecord {
  std::string file;      // its name without folders
  std::string sha256;    // of the file
  std::string network;   // "compact, 27714 parameters"
  std::string training;  // a JSON object: how the weights were trained
};

struct ChosenClassifier {
  std::shared_ptr<const Classifier> classifier;  // null: truth
  std::optional<WeightsRecord> weights;          // where it is a network
};

/// Whether `name` is a weights file rather than the name of a classifier: something with a '.' or
/// '/' in it, or a file that is there.
bool names_weights_file(const std::string& name);

/// gcn | pca | truth | FILE. `shipped_weights`: those of gcn. Throws Error where weights cannot be
/// read; there is no fallback.
ChosenClassifier make_classifier(const PipelineOptions& options,
                                 const std::filesystem::path& shipped_weights);

}  // namespace planescope::planes
