#include "core/planes/pipeline/classifiers.hpp"

#include <fmt/format.h>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/classify/gcn.hpp"
#include "core/planes/classify/weights.hpp"

namespace planescope::planes {
namespace {

namespace fs = std::filesystem;

ChosenClassifier from_weights(const fs::path& file, const std::string& name) {
  const NetworkWeights weights = read_weights(file);
  const NetworkConfig& config = weights.config;
  WeightsRecord record;
  record.file = file.filename().string();
  record.sha256 = sha256_hex_of_file(file);
  record.network = fmt::format("{}, {} parameters", config.name, parameter_count(config));
  record.training = weights.training;
  return {make_gcn_classifier(weights, name), std::move(record)};
}

}  // namespace

bool names_weights_file(const std::string& name) {
  std::error_code ignored;
  return name.find_first_of("./") != std::string::npos || fs::exists(name, ignored);
}

ChosenClassifier make_classifier(const PipelineOptions& options, const fs::path& shipped_weights) {
  const std::string& name = options.classifier;
  if (name == "truth") return {};
  if (name == "pca") return {make_pca_classifier(options.pca), std::nullopt};
  if (name == "gcn") return from_weights(shipped_weights, name);
  return from_weights(name, name);
}

}  // namespace planescope::planes
