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

// What a 3D-GCN sees of a cloud: which points are whose neighbours, at every level, and in which
// direction. Nothing here depends on weights.

struct GraphLevel {
  std::size_t n = 0;
  int neighbours = 0;               // k, fewer where there are not so many other points
  std::vector<std::uint32_t> rows;  // [n x k] the nearest other points
  Buffer directions;                // [n x 3 x k] unit vectors to them; zero to an equal point
  // The pooling that leads to the next level, which keeps points 0, rate, 2 rate, ...
  int pool_neighbours = 0;
  std::vector<std::uint32_t> pool_rows;  // [n of the next level x pool_neighbours]
  std::vector<std::uint32_t> nearest;  // not at level 0: of each point of level 0 the nearest here
};

/// Points are in the order of a NeighbourGrid, so that neither neighbours nor pooling know in which
/// order the cloud came.
struct Graph {
  std::vector<std::uint32_t> order;  // order[i]: where point i of level 0 was in the input
  std::vector<GraphLevel> levels;
};

/// `points` must be finite, and at least one. `graph` may hold an older one, whose memory is used.
void make_graph(std::span<const Vec3f> points,
                const NetworkConfig& config,
                int threads,
                Simd simd,
                Graph& graph);

// A network's weights as the kernels want them: channels padded with zeros to whole registers,
// kernel directions of unit length, matrices [in x out].

struct ConvolutionLayer {
  int level = 0;
  int in = 0, out = 0;  // padded; in = 0: the surface convolution
  int column = 0;       // where its output begins among the features of its level
  bool relu = true;
  Buffer directions;  // [3 x supports x out]
  Buffer weights;     // [in x (supports + 1) out], the centre's columns first
  Buffer bias;        // [(supports + 1) out]
};

struct HeadLayer {
  int in = 0, out = 0;  // padded
  Buffer weights;       // [in x out]
  Buffer bias;          // [out]
};

/// Also the shape of gradients.
struct Layers {
  NetworkConfig config;
  std::vector<int> widths;  // features of each level, all its convolutions side by side
  std::vector<ConvolutionLayer> convolutions;
  std::vector<HeadLayer> head;  // the first one's rows: level by level, then the global feature
};

/// All zero.
Layers make_layers(const NetworkConfig& config);
Layers make_layers(const NetworkWeights& weights);

/// Gradients of the tensors, by tensor_specs(), from those of the layers.
std::vector<std::vector<float>> tensor_gradients(const NetworkWeights& weights,
                                                 const Layers& gradients);

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
