// Back-propagation through forward(): a maximum hands its gradient to the candidate that won it,
// and relu(x) has slope 0 at x <= 0.

#include "core/lab/training/gcn_backward.hpp"

#include <algorithm>

namespace planescope::lab {
namespace {

struct View {
  float* data = nullptr;
  std::size_t stride = 0;
};
struct ConstView {
  const float* data = nullptr;
  std::size_t stride = 0;
};

Buffer transposed(const float* w, int rows, int columns) {
  Buffer t(std::size_t{1} * rows * columns);
  for (int a = 0; a < rows; ++a)
    for (int b = 0; b < columns; ++b) t[b * rows + a] = w[a * columns + b];
  return t;
}

void add_columns(const float* y, std::size_t n, int columns, float* sums) {
  for (std::size_t i = 0; i < n; ++i)
    for (int c = 0; c < columns; ++c) sums[c] += y[i * columns + c];
}

/// For y = x w: the gradient of w, and that of x added to what is there.
void product_backward(const planes::gcn::Kernels& kernels,
                      std::size_t n,
                      ConstView x,
                      const float* w,
                      int inner,
                      int outer,
                      const float* dy,
                      float* dw,
                      View dx) {
  kernels.outer({.n = n,
                 .x = x.data,
                 .x_stride = x.stride,
                 .y = dy,
                 .y_stride = static_cast<std::size_t>(outer),
                 .inner = inner,
                 .outer = outer,
                 .w = dw});
  const Buffer w_t = transposed(w, inner, outer);
  kernels.product({.begin = 0,
                   .end = n,
                   .x = dy,
                   .x_stride = static_cast<std::size_t>(outer),
                   .inner = outer,
                   .outer = inner,
                   .w = w_t.data(),
                   .y = dx.data,
                   .y_stride = dx.stride,
                   .accumulate = true});
}

struct Backward {
  const planes::gcn::Graph& graph;
  const planes::gcn::Layers& layers;
  const planes::gcn::Activations& a;
  const planes::gcn::Kernels& kernels;
  planes::gcn::Layers gradients;
  std::vector<Buffer> features;  // gradients of Activations::Level::features

  /// Down to the head's first sums, before their ReLU: [n x head[0].out].
  Buffer through_head(const Buffer& logits) {
    const std::size_t n = graph.levels[0].n;
    Buffer dy(logits.size());
    std::copy_n(logits.data(), logits.size(), dy.data());
    for (std::size_t h = layers.head.size() - 1; h > 0; --h) {
      const planes::gcn::HeadLayer& layer = layers.head[h];
      planes::gcn::HeadLayer& gradient = gradients.head[h];
      Buffer dx(n * layer.in, 0);
      const auto stride = static_cast<std::size_t>(layer.in);
      add_columns(dy.data(), n, layer.out, gradient.bias.data());
      product_backward(kernels, n, {a.head[h - 1].data(), stride}, layer.weights.data(), layer.in,
                       layer.out, dy.data(), gradient.weights.data(), {dx.data(), stride});
      for (std::size_t i = 0; i < dx.size(); ++i)
        if (a.head[h - 1][i] <= 0) dx[i] = 0;
      dy = std::move(dx);
    }
    return dy;
  }

  /// From the head's first sums to the features of every level.
  void through_fusion(const Buffer& sums) {
    const planes::gcn::HeadLayer& first = layers.head[0];
    const std::size_t n = graph.levels[0].n;
    add_columns(sums.data(), n, first.out, gradients.head[0].bias.data());
    int row = 0;
    for (std::size_t l = 0; l < graph.levels.size(); ++l) {
      const planes::gcn::GraphLevel& level = graph.levels[l];
      const int width = layers.widths[l];
      Buffer gathered;
      if (l > 0) {
        gathered = Buffer(level.n * first.out, 0);
        for (std::size_t i = 0; i < n; ++i) {
          float* to = gathered.data() + std::size_t{level.nearest[i]} * first.out;
          for (int c = 0; c < first.out; ++c) to[c] += sums[i * first.out + c];
        }
      }
      const std::size_t offset = std::size_t{1} * row * first.out;
      const auto stride = static_cast<std::size_t>(width);
      product_backward(kernels, level.n, {a.levels[l].features.data(), stride},
                       first.weights.data() + offset, width, first.out,
                       (l > 0 ? gathered : sums).data(), gradients.head[0].weights.data() + offset,
                       {features[l].data(), stride});
      row += width;
    }
    if (layers.config.global_feature) through_global(sums, row);
  }

  void through_global(const Buffer& sums, int row) {
    const planes::gcn::HeadLayer& first = layers.head[0];
    const int channels = layers.convolutions.back().out;
    std::vector<float> dy(first.out, 0.0f), dx(channels, 0.0f);
    add_columns(sums.data(), graph.levels[0].n, first.out, dy.data());
    const std::size_t offset = std::size_t{1} * row * first.out;
    const auto stride = static_cast<std::size_t>(channels);
    product_backward(kernels, 1, {a.global.data(), stride}, first.weights.data() + offset, channels,
                     first.out, dy.data(), gradients.head[0].weights.data() + offset,
                     {dx.data(), stride});
    const int width = layers.widths.back();
    for (int c = 0; c < channels; ++c)
      features.back()[std::size_t{a.global_winners[c]} * width + width - channels + c] += dx[c];
  }

  void through_convolution(std::size_t c) {
    const planes::gcn::ConvolutionLayer& layer = layers.convolutions[c];
    const planes::gcn::GraphLevel& level = graph.levels[layer.level];
    const planes::gcn::Activations::Level& kept = a.levels[layer.level];
    const auto width = static_cast<std::size_t>(layers.widths[layer.level]);
    if (layer.relu)
      for (std::size_t i = 0; i < level.n; ++i)
        for (int ch = 0; ch < layer.out; ++ch)
          if (kept.features[i * width + layer.column + ch] <= 0)
            features[layer.level][i * width + layer.column + ch] = 0;

    const std::size_t columns = std::size_t{1} * (layers.config.supports + 1) * layer.out;
    Buffer products(layer.in > 0 ? level.n * columns : 0, 0);
    through_support(c, products);
    if (layer.in == 0) return;

    planes::gcn::ConvolutionLayer& gradient = gradients.convolutions[c];
    const auto out = static_cast<int>(columns);
    add_columns(products.data(), level.n, out, gradient.bias.data());
    const auto multiply = [&](ConstView x, View dx) {
      product_backward(kernels, level.n, x, layer.weights.data(), layer.in, out, products.data(),
                       gradient.weights.data(), dx);
    };
    if (layer.column > 0) {
      const int before = layer.column - layer.in;
      multiply({kept.features.data() + before, width},
               {features[layer.level].data() + before, width});
      return;
    }
    Buffer pooled(level.n * layer.in, 0);
    const auto stride = static_cast<std::size_t>(layer.in);
    multiply({kept.pooled.data(), stride}, {pooled.data(), stride});
    through_pool(static_cast<std::size_t>(layer.level), layer.in, pooled);
  }

  /// From a convolution's output to its products with the weights, and to its directions.
  void through_support(std::size_t c, Buffer& products) {
    const planes::gcn::ConvolutionLayer& layer = layers.convolutions[c];
    const planes::gcn::GraphLevel& level = graph.levels[layer.level];
    const auto width = static_cast<std::size_t>(layers.widths[layer.level]);
    const int kernels_count = layers.config.supports * layer.out;
    const std::size_t columns = std::size_t{1} * (layers.config.supports + 1) * layer.out;
    const float* u = layer.directions.data();
    float* du = gradients.convolutions[c].directions.data();
    for (std::size_t i = 0; i < level.n; ++i) {
      const float* dy = features[layer.level].data() + i * width + layer.column;
      if (layer.in > 0) std::copy_n(dy, layer.out, products.data() + i * columns);
      if (level.neighbours == 0) continue;
      const std::uint16_t* winners = a.convolutions[c].winners.data() + i * kernels_count;
      for (int sc = 0; sc < kernels_count; ++sc) {
        const float g = dy[sc % layer.out];
        if (g == 0) continue;
        const std::size_t k = static_cast<std::size_t>(level.neighbours);
        const float* to = level.directions.data() + 3 * i * k + winners[sc];
        const float d[3] = {to[0], to[k], to[2 * k]};
        const float along =
            d[0] * u[sc] + d[1] * u[kernels_count + sc] + d[2] * u[2 * kernels_count + sc];
        if (along <= 0) continue;
        float slope = g;
        if (layer.in > 0) {
          const std::size_t value = level.rows[i * k + winners[sc]] * columns + layer.out + sc;
          products[value] += g * along;
          slope *= a.convolutions[c].products[value];
        }
        for (int axis = 0; axis < 3; ++axis) du[axis * kernels_count + sc] += slope * d[axis];
      }
    }
  }

  void through_pool(std::size_t l, int channels, const Buffer& pooled) {
    const planes::gcn::GraphLevel& from = graph.levels[l - 1];
    const auto width = static_cast<std::size_t>(layers.widths[l - 1]);
    float* to = features[l - 1].data() + width - channels;
    for (std::size_t i = 0; i < graph.levels[l].n; ++i)
      for (int c = 0; c < channels; ++c) {
        const std::size_t own = i * static_cast<std::size_t>(layers.config.pool_rate);
        const std::size_t winner =
            from.pool_neighbours == 0
                ? own
                : from.pool_rows[i * from.pool_neighbours + a.levels[l].winners[i * channels + c]];
        to[winner * width + c] += pooled[i * channels + c];
      }
  }
};

}  // namespace

planes::gcn::Layers backward(const planes::gcn::Graph& graph,
                             const planes::gcn::Layers& layers,
                             const planes::gcn::Activations& activations,
                             const planes::gcn::Kernels& kernels,
                             const Buffer& logit_gradients) {
  Backward pass{graph, layers, activations, kernels, planes::gcn::make_layers(layers.config), {}};
  for (std::size_t l = 0; l < graph.levels.size(); ++l)
    pass.features.emplace_back(graph.levels[l].n * layers.widths[l], 0.0f);
  pass.through_fusion(pass.through_head(logit_gradients));
  for (std::size_t c = layers.convolutions.size(); c-- > 0;) pass.through_convolution(c);
  return std::move(pass.gradients);
}

}  // namespace planescope::lab
