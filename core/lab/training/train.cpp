#include "core/lab/training/train.hpp"

#include <cmath>
#include <numbers>

#include "core/lab/training/gcn_backward.hpp"
#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/model/random.hpp"
#include "core/planes/classify/gcn.hpp"

namespace planescope::lab {

// ---- Initial weights ----

planes::NetworkWeights random_weights(const planes::NetworkConfig& config, std::uint64_t seed) {
  planes::NetworkWeights weights;
  weights.config = config;
  Random random(seed);
  double bound = 0;
  for (const planes::TensorSpec& spec : planes::tensor_specs(config)) {
    // conv_*: one over the root of all columns. conv1d_block.*: of the inputs, for the bias as for
    // the weight before it.
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
    for (int k = 0; k < level.neighbours; ++k) {
      const Label other = labels[level.rows[i * level.neighbours + k]];
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

CloudGradient cloud_gradient(const planes::LabelledCloud& cloud,
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
    // Cross-entropy of two classes: softplus of how far the wrong logit is ahead.
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
          const planes::LabelledCloud cloud = draw(std::uint64_t{1} * state.step * batch + b);
          gradients[b] = cloud_gradient(cloud, state.weights, layers, options, simd);
        }
      },
      1);

  double loss = 0;
  for (const CloudGradient& gradient : gradients) loss += gradient.loss;
  loss /= static_cast<double>(batch);
  if (!std::isfinite(loss))
    throw Error("training: the loss of step " + std::to_string(state.step) +
                " is not a finite number, expected a smaller learning rate or other weights");

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
                                    std::span<const planes::LabelledCloud> clouds,
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
