#pragma once

#include <cstdint>
#include <vector>

#include "core/model/buffer.hpp"
#include "core/planes/classify/gcn_graph.hpp"
#include "core/planes/classify/gcn_kernels.hpp"
#include "core/planes/classify/gcn_layers.hpp"

namespace planescope::planes::gcn {

/// Everything that a forward pass computes, which the backward pass reads. Rows are points in the
/// graph's order, columns padded channels. `winners`: which of its candidates gave a maximum.
struct Activations {
  struct Convolution {
    Buffer products;                     // [n x (supports + 1) out]: centre, then supports
    std::vector<std::uint16_t> winners;  // [n x supports x out]
  };
  struct Level {
    Buffer pooled;                       // [n x channels], what comes from the level before
    std::vector<std::uint16_t> winners;  // [n x channels]
    Buffer features;                     // [n x width]
    Buffer fused;                        // [n x head[0].out], the features' part in the head
  };
  std::vector<Convolution> convolutions;
  std::vector<Level> levels;
  std::vector<float> global;                  // [channels], where the network has it
  std::vector<std::uint32_t> global_winners;  // [channels], points of the last level
  std::vector<Buffer> head;                   // [n x out] of each layer; the last one's are logits
};

/// The network on a graph. With `keep_winners` what the backward pass needs is kept. `activations`
/// may hold those of another graph, whose memory is used.
void forward(const Graph& graph,
             const Layers& layers,
             const Kernels& kernels,
             int threads,
             bool keep_winners,
             Activations& activations);

}  // namespace planescope::planes::gcn
