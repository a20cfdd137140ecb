// Training of the 3D-GCN: backpropagation, Adam steps, and scoring of the network.

#include "core/lab/training/train.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/model/random.hpp"
#include "core/planes/classify/gcn.hpp"

namespace planescope::lab {

// ---- Backpropagation through forward(): a maximum passes its gradient to the winning candidate,
// and relu(x) has slope 0 at x <= 0 ----

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

/// For y = x w: computes the gradient of w, and adds that of x to the existing values.
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

  /// Back to the head's first sums, before their ReLU: [n x head[0].out].
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
      if (level.neighbors == 0) continue;
      const std::uint16_t* winners = a.convolutions[c].winners.data() + i * kernels_count;
      for (int sc = 0; sc < kernels_count; ++sc) {
        const float g = dy[sc % layer.out];
        if (g == 0) continue;
        const std::size_t k = static_cast<std::size_t>(level.neighbors);
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
            from.pool_neighbors == 0
                ? own
                : from.pool_rows[i * from.pool_neighbors + a.levels[l].winners[i * channels + c]];
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

// ---- Initial weights ----

planes::NetworkWeights random_weights(const planes::NetworkConfig& config, std::uint64_t seed) {
  planes::NetworkWeights weights;
  weights.config = config;
  Random random(seed);
  double bound = 0;
  for (const planes::TensorSpec& spec : planes::tensor_specs(config)) {
    // conv_*: 1 / sqrt(columns). conv1d_block.*: 1 / sqrt(inputs), for the bias as for the weight
    // before it.
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

// ---- Training steps ----

namespace {

constexpr double kBeta1 = 0.9, kBeta2 = 0.999, kEpsilon = 1e-8;  // Adam's usual constants

double learning_rate(const TrainOptions& options, int step) {
  if (step < options.warm_up_steps)
    return options.learning_rate * (step + 1) / options.warm_up_steps;
  const double progress = static_cast<double>(step - options.warm_up_steps) /
                          std::max(1, options.steps - options.warm_up_steps);
  return options.learning_rate * 0.5 * (1 + std::cos(std::numbers::pi * progress));
}

/// Per point in the graph's order; they sum to 1, or are all 0 without labels.
std::vector<float> point_weights(const planes::gcn::Graph& graph,
                                 const std::vector<Label>& labels,
                                 const TrainOptions& options) {
  const planes::gcn::GraphLevel& level = graph.levels[0];
  std::vector<float> weights(level.n, 0.0f);
  double sums[3] = {};
  for (std::size_t i = 0; i < level.n; ++i) {
    if (labels[i] == Label::unknown) continue;
    bool edge = false;
    for (int k = 0; k < level.neighbors; ++k) {
      const Label other = labels[level.rows[i * level.neighbors + k]];
      edge |= other != Label::unknown && other != labels[i];
    }
    weights[i] = static_cast<float>(edge ? options.edge_weight : 1);
    sums[static_cast<int>(labels[i])] += weights[i];
  }
  const double total = sums[1] + sums[2];
  const int classes = (sums[1] > 0) + (sums[2] > 0);
  for (std::size_t i = 0; i < level.n; ++i) {
    const double own = sums[static_cast<int>(labels[i])];
    if (weights[i] > 0)
      weights[i] /= static_cast<float>(options.balance_classes ? own * classes : total);
  }
  return weights;
}

struct CloudGradient {
  double loss = 0;
  std::vector<std::vector<float>> tensors;
};

CloudGradient cloud_gradient(const planes::LabeledCloud& cloud,
                             const planes::NetworkWeights& weights,
                             const planes::gcn::Layers& layers,
                             const TrainOptions& options,
                             Simd simd) {
  CloudGradient result;
  const planes::gcn::Kernels& kernels = planes::gcn::kernels(simd);
  planes::gcn::Graph graph;
  planes::gcn::make_graph(cloud.points, weights.config, 1, simd, graph);
  planes::gcn::Activations a;
  planes::gcn::forward(graph, layers, kernels, 1, /*keep_winners=*/true, a);

  const Buffer& logits = a.head.back();
  const auto width = static_cast<std::size_t>(layers.head.back().out);
  std::vector<Label> labels(graph.order.size());
  for (std::size_t i = 0; i < labels.size(); ++i) labels[i] = cloud.labels[graph.order[i]];
  const std::vector<float> point_weight = point_weights(graph, labels, options);
  Buffer gradient(logits.size(), 0);
  for (std::size_t i = 0; i < labels.size(); ++i) {
    if (point_weight[i] == 0) continue;
    // Cross-entropy of two classes: softplus of the wrong logit minus the right one.
    const std::size_t right = labels[i] == Label::h ? 0 : 1, wrong = 1 - right;
    const double ahead = double{logits[i * width + wrong]} - logits[i * width + right];
    const double p_wrong = 1 / (1 + std::exp(-ahead));
    result.loss += point_weight[i] * (ahead > 30 ? ahead : std::log1p(std::exp(ahead)));
    const auto slope = static_cast<float>(point_weight[i] * p_wrong);
    gradient[i * width + wrong] = slope;
    gradient[i * width + right] = -slope;
  }
  result.tensors =
      planes::gcn::tensor_gradients(weights, backward(graph, layers, a, kernels, gradient));
  return result;
}

}  // namespace

TrainState begin_training(const TrainOptions& options) {
  TrainState state;
  state.weights = random_weights(options.network, options.seed);
  for (const auto& tensor : state.weights.tensors) {
    state.mean.emplace_back(tensor.size(), 0.0f);
    state.variance.emplace_back(tensor.size(), 0.0f);
  }
  return state;
}

double train_step(
    TrainState& state, const TrainOptions& options, const DrawCloud& draw, int threads, Simd simd) {
  const auto batch = static_cast<std::size_t>(options.batch);
  const planes::gcn::Layers layers = planes::gcn::make_layers(state.weights);
  std::vector<CloudGradient> gradients(batch);
  parallel_for(
      batch, threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t b = begin; b < end; ++b) {
          const planes::LabeledCloud cloud = draw(std::uint64_t{1} * state.step * batch + b);
          gradients[b] = cloud_gradient(cloud, state.weights, layers, options, simd);
        }
      },
      1);

  double loss = 0;
  for (const CloudGradient& gradient : gradients) loss += gradient.loss;
  loss /= static_cast<double>(batch);
  if (!std::isfinite(loss))
    throw Error("training: the loss at step " + std::to_string(state.step) +
                " is not a finite number; use a smaller learning rate or different weights");

  const double rate = learning_rate(options, state.step);
  const double correction1 = 1 - std::pow(kBeta1, state.step + 1);
  const double correction2 = 1 - std::pow(kBeta2, state.step + 1);
  const double step_size = rate * std::sqrt(correction2) / correction1;
  for (std::size_t t = 0; t < state.weights.tensors.size(); ++t)
    for (std::size_t i = 0; i < state.weights.tensors[t].size(); ++i) {
      double g = 0;
      for (const CloudGradient& gradient : gradients) g += gradient.tensors[t][i];
      g /= static_cast<double>(batch);
      float& m = state.mean[t][i];
      float& v = state.variance[t][i];
      m = static_cast<float>(kBeta1 * m + (1 - kBeta1) * g);
      v = static_cast<float>(kBeta2 * v + (1 - kBeta2) * g * g);
      state.weights.tensors[t][i] -= static_cast<float>(
          step_size * m / (std::sqrt(double{v}) + kEpsilon * std::sqrt(correction2)));
    }
  ++state.step;
  state.loss_sum += loss;
  return loss;
}

planes::LabelAccuracy score_network(const planes::NetworkWeights& weights,
                                    std::span<const planes::LabeledCloud> clouds,
                                    int threads,
                                    Simd simd) {
  const auto classifier = planes::make_gcn_classifier(weights, weights.config.name, simd);
  std::vector<planes::LabelAccuracy> accuracies(clouds.size());
  parallel_for(
      clouds.size(), threads,
      [&](std::size_t begin, std::size_t end) {
        for (std::size_t c = begin; c < end; ++c)
          accuracies[c] =
              planes::label_accuracy(clouds[c], classifier->classify(clouds[c].points, 1).labels);
      },
      1);
  planes::LabelAccuracy sum;
  for (const planes::LabelAccuracy& accuracy : accuracies) sum += accuracy;
  return sum;
}

}  // namespace planescope::lab
