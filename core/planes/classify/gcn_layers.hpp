#pragma once

// A network's weights as the kernels want them: channels padded with zeros to whole registers,
// kernel directions of unit length, matrices [in x out].

#include <vector>

#include "core/model/buffer.hpp"
#include "core/planes/classify/weights.hpp"

namespace planescope::planes::gcn {

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

}  // namespace planescope::planes::gcn
