#include <cassert>
#include <cmath>

#include "core/planes/classify/gcn_forward.hpp"
#include "core/planes/classify/gcn_kernels.hpp"

namespace planescope::planes::gcn {
namespace {

int padded(int channels) { return (channels + kLanes - 1) / kLanes * kLanes; }

/// Calls visit(value, entry) for every entry of a [rows x (blocks x columns)] tensor and its place
/// in a matrix whose blocks are padded.
template <typename Tensor, typename Matrix, typename Visit>
void visit_blocks(Tensor& tensor, Matrix& matrix, int rows, int blocks, int columns, Visit visit) {
  const int wide = padded(columns);
  for (int a = 0; a < rows; ++a)
    for (int b = 0; b < blocks; ++b)
      for (int c = 0; c < columns; ++c)
        visit(tensor[(a * blocks + b) * columns + c], matrix[(a * blocks + b) * wide + c]);
}

/// Rows of the head's first matrix that belong to the concatenated features, in their order.
std::vector<int> fused_rows(const NetworkConfig& config) {
  std::vector<int> rows;
  int row = 0;
  const auto append = [&](int channels) {
    for (int c = 0; c < channels; ++c) rows.push_back(row + c);
    row += padded(channels);
  };
  for (const auto& level : config.levels)
    for (const int channels : level) append(channels);
  if (config.global_feature) append(config.levels.back().back());
  return rows;
}

/// Calls visit(value, entry) for every weight and bias and its place in the layers, and
/// visit_directions(tensor, layer) for every tensor of directions.
template <typename Tensors, typename LayersT, typename Visit, typename VisitDirections>
void visit_parameters(Tensors& tensors,
                      LayersT& layers,
                      Visit visit,
                      VisitDirections visit_directions) {
  const NetworkConfig& config = layers.config;
  auto tensor = tensors.begin();
  auto layer = layers.convolutions.begin();
  int in = 0;
  for (const auto& level : config.levels)
    for (const int out : level) {
      if (in > 0) {
        visit_blocks(*tensor++, layer->weights, in, config.supports + 1, out, visit);
        visit_blocks(*tensor++, layer->bias, 1, config.supports + 1, out, visit);
      }
      visit_directions(*tensor++, *layer++, out);
      in = out;
    }
  std::vector<int> rows = fused_rows(config);
  std::vector<int> widths = config.head;
  widths.push_back(2);
  for (std::size_t h = 0; h < widths.size(); ++h) {
    auto& weights = *tensor++;
    auto& bias = *tensor++;
    auto& head = layers.head[h];
    for (int b = 0; b < widths[h]; ++b) {
      for (std::size_t a = 0; a < rows.size(); ++a)
        visit(weights[b * rows.size() + a], head.weights[rows[a] * head.out + b]);
      visit(bias[b], head.bias[b]);
    }
    rows.resize(widths[h]);
    for (int a = 0; a < widths[h]; ++a) rows[a] = a;
  }
  assert(tensor == tensors.end());
}

}  // namespace

Layers make_layers(const NetworkConfig& config) {
  Layers layers;
  layers.config = config;
  int in = 0, fused = 0, last = 0;
  for (std::size_t l = 0; l < config.levels.size(); ++l) {
    int column = 0;
    for (const int channels : config.levels[l]) {
      ConvolutionLayer& layer = layers.convolutions.emplace_back();
      layer.level = static_cast<int>(l);
      layer.in = in;
      layer.out = padded(channels);
      layer.column = column;
      layer.directions = Buffer(std::size_t{3} * config.supports * layer.out, 0);
      const std::size_t columns = std::size_t{1} * (config.supports + 1) * layer.out;
      if (in > 0) {
        layer.weights = Buffer(in * columns, 0);
        layer.bias = Buffer(columns, 0);
      }
      column += layer.out;
      in = last = layer.out;
    }
    layers.widths.push_back(column);
    fused += column;
  }
  layers.convolutions.back().relu = false;
  in = fused + (config.global_feature ? last : 0);
  std::vector<int> widths = config.head;
  widths.push_back(2);
  for (const int width : widths) {
    HeadLayer& layer = layers.head.emplace_back();
    layer.in = in;
    layer.out = padded(width);
    layer.weights = Buffer(std::size_t{1} * layer.in * layer.out, 0);
    layer.bias = Buffer(static_cast<std::size_t>(layer.out), 0);
    in = layer.out;
  }
  return layers;
}

Layers make_layers(const NetworkWeights& weights) {
  Layers layers = make_layers(weights.config);
  visit_parameters(
      weights.tensors, layers, [](float value, float& entry) { entry = value; },
      [&](const std::vector<float>& tensor, ConvolutionLayer& layer, int out) {
        const int supports = weights.config.supports, columns = supports * out;
        for (int s = 0; s < supports; ++s)
          for (int c = 0; c < out; ++c) {
            const float* d = tensor.data() + s * out + c;
            const float length =
                std::sqrt(d[0] * d[0] + d[columns] * d[columns] + d[2 * columns] * d[2 * columns]);
            for (int axis = 0; axis < 3; ++axis)
              layer.directions[(axis * supports + s) * layer.out + c] =
                  length > 0 ? d[axis * columns] / length : 0.0f;
          }
      });
  return layers;
}

std::vector<std::vector<float>> tensor_gradients(const NetworkWeights& weights,
                                                 const Layers& gradients) {
  std::vector<std::vector<float>> result;
  for (const auto& tensor : weights.tensors) result.emplace_back(tensor.size());
  visit_parameters(
      result, gradients, [](float& value, float entry) { value = entry; },
      [&](std::vector<float>& tensor, const ConvolutionLayer& layer, int out) {
        const std::vector<float>& raw = weights.tensors[&tensor - result.data()];
        const int supports = weights.config.supports, columns = supports * out;
        for (int s = 0; s < supports; ++s)
          for (int c = 0; c < out; ++c) {
            // Of u = d / |d|: the part of the gradient across u, over |d|.
            double d[3], g[3], length = 0, along = 0;
            for (int axis = 0; axis < 3; ++axis) {
              d[axis] = raw[axis * columns + s * out + c];
              g[axis] = layer.directions[(axis * supports + s) * layer.out + c];
              length += d[axis] * d[axis];
            }
            length = std::sqrt(length);
            if (length <= 0) continue;
            for (int axis = 0; axis < 3; ++axis) along += g[axis] * d[axis] / length;
            for (int axis = 0; axis < 3; ++axis)
              tensor[axis * columns + s * out + c] =
                  static_cast<float>((g[axis] - along * d[axis] / length) / length);
          }
      });
  return result;
}

}  // namespace planescope::planes::gcn
