#pragma once

#include <cstdint>

#include "core/planes/classify/weights.hpp"

namespace planescope::lab {

/// Weights drawn as the official code and PyTorch draw them: uniform within one over the root of
/// how many terms a layer sums, or puts out.
planes::NetworkWeights random_weights(const planes::NetworkConfig& config, std::uint64_t seed);

}  // namespace planescope::lab
