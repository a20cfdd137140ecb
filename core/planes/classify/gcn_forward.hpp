#pragma once

// Forward pass of the 3D-GCN: neighbor graph, layers and activations. Training uses the same parts.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/buffer.hpp"
#include "core/model/parallel.hpp"
#include "core/model/types.hpp"
#include "core/planes/classify/weights.hpp"
#include "core/planes/simd/gcn_kernels.hpp"

namespace planescope::planes::gcn {

// Input graph of a 3D-GCN: neighbors and neighbor directions at every level. Independent of
// the weights.

struct GraphLevel {
  std::size_t n = 0;
  int neighbors = 0;                // k; fewer if the level has too few other points
  std::vector<std::uint32_t> rows;  // [n x k] the nearest other points
  Buffer directions;                // [n x 3 x k] unit vectors to the neighbors; zero for
                                    // coincident points
  // Pooling to the next level, which keeps points 0, rate, 2 rate, ...
  int pool_neighbors = 0;
  std::vector<std::uint32_t> pool_rows;  // [n of the next level x pool_neighbors]
  std::vector<std::uint32_t> nearest;  // per level-0 point: its nearest point of this level; empty
                                       // at level 0
};

/// Points are in the order of a NeighborGrid, so neighbors and pooling do not depend on the order
/// of the input.
struct Graph {
  std::vector<std::uint32_t> order;  // order[i]: input index of level-0 point i
  std::vector<GraphLevel> levels;
};

/// Builds the graph of one or more finite points. Reuses the memory already in `graph`.
void make_graph(std::span<const Vec3f> points,
                const NetworkConfig& config,
                int threads,
                Simd simd,
                Graph& graph);

// Network weights in the kernels' layout: channels zero-padded to whole registers, kernel
// directions of unit length, matrices [in x out].

struct ConvolutionLayer {
  int level = 0;
  int in = 0, out = 0;  // padded; in = 0: the surface convolution
  int column = 0;       // first column of its output among the level's features
  bool relu = true;
  Buffer directions;  // [3 x supports x out]
  Buffer weights;     // [in x (supports + 1) out], center columns first
  Buffer bias;        // [(supports + 1) out]
};

struct HeadLayer {
  int in = 0, out = 0;  // padded
  Buffer weights;       // [in x out]
  Buffer bias;          // [out]
};

/// Also used for gradients.
struct Layers {
  NetworkConfig config;
  std::vector<int> widths;  // features per level: all its convolutions side by side
  std::vector<ConvolutionLayer> convolutions;
  std::vector<HeadLayer> head;  // rows of the first layer: level by level, then the global feature
};

/// Allocates layers with all values zero.
Layers make_layers(const NetworkConfig& config);
Layers make_layers(const NetworkWeights& weights);

/// Converts gradients of the layers to gradients of the tensors, in the order of tensor_specs().
std::vector<std::vector<float>> tensor_gradients(const NetworkWeights& weights,
                                                 const Layers& gradients);

/// All values of a forward pass, as needed by the backward pass. Rows are points in graph order,
/// columns padded channels. `winners`: index of the candidate that attained each maximum.
struct Activations {
  struct Convolution {
    Buffer products;                     // [n x (supports + 1) out]: center, then supports
    std::vector<std::uint16_t> winners;  // [n x supports x out]
  };
  struct Level {
    Buffer pooled;                       // [n x channels], pooled from the previous level
    std::vector<std::uint16_t> winners;  // [n x channels]
    Buffer features;                     // [n x width]
    Buffer fused;                        // [n x head[0].out], the features' contribution to
                                         // the head
  };
  std::vector<Convolution> convolutions;
  std::vector<Level> levels;
  std::vector<float> global;                  // [channels], if the network has a global feature
  std::vector<std::uint32_t> global_winners;  // [channels], points of the last level
  std::vector<Buffer> head;                   // [n x out] of each layer; the last one contains
                                              // the logits
};

/// Runs the network on a graph. `keep_winners` also stores the values for the backward pass. Reuses
/// the memory already in `activations`.
void forward(const Graph& graph,
             const Layers& layers,
             const Kernels& kernels,
             int threads,
             bool keep_winners,
             Activations& activations);

}  // namespace planescope::planes::gcn
