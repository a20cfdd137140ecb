#pragma once

#include "core/planes/classify/gcn_forward.hpp"

namespace planescope::lab {

/// Gradients of all layers, given those of the logits ([n x out of the last layer], zero in padded
/// columns) and what forward() kept with its winners. On one thread, sums in the order of the
/// points.
planes::gcn::Layers backward(const planes::gcn::Graph& graph,
                             const planes::gcn::Layers& layers,
                             const planes::gcn::Activations& activations,
                             const planes::gcn::Kernels& kernels,
                             const Buffer& logit_gradients);

}  // namespace planescope::lab
