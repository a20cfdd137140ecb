#pragma once

#include "core/planes/classify/gcn_forward.hpp"

namespace planescope::gcn {

/// Gradients of all layers, given those of the logits ([n x out of the last layer], zero in padded
/// columns) and what forward() kept with its winners. On one thread, sums in the order of the
/// points.
Layers backward(const Graph& graph,
                const Layers& layers,
                const Activations& activations,
                const Kernels& kernels,
                const Buffer& logit_gradients);

}  // namespace planescope::gcn
