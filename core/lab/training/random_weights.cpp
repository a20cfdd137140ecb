#include "core/lab/training/random_weights.hpp"

#include <cmath>

#include "core/model/random.hpp"

namespace planescope::lab {

planes::NetworkWeights random_weights(const planes::NetworkConfig& config, std::uint64_t seed) {
  planes::NetworkWeights weights;
  weights.config = config;
  Random random(seed);
  double bound = 0;
  for (const planes::TensorSpec& spec : planes::tensor_specs(config)) {
    // conv_*: one over the root of all columns. conv1d_block.*: of the inputs, for the bias as for
    // the weight before it.
    if (spec.name.starts_with("conv1d_block")) {
      if (spec.shape.size() > 1) bound = 1 / std::sqrt(spec.shape[1]);
    } else {
      const int columns = spec.shape.back();
      const bool after_weights =
          spec.name.ends_with(".directions") && spec.name != "conv_0.directions";
      if (!after_weights) bound = 1 / std::sqrt(columns);
    }
    std::size_t size = 1;
    for (const int extent : spec.shape) size *= static_cast<std::size_t>(extent);
    std::vector<float>& tensor = weights.tensors.emplace_back(size);
    for (float& value : tensor) value = static_cast<float>(random.uniform(-bound, bound));
  }
  return weights;
}

}  // namespace planescope::lab
