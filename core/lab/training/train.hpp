#pragma once

// Training of a 3D-GCN: Adam on a cross-entropy that gives more weight to points near the other
// label and optionally balances the two classes.

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/model/parallel.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/classify/gcn_forward.hpp"
#include "core/planes/classify/weights.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::lab {

struct TrainOptions {
  planes::NetworkConfig network;
  std::uint64_t seed = 1;
  int steps = 45000;
  int batch = 4;                // clouds in a step
  double learning_rate = 2e-3;  // of Adam; warms up, then falls to 0 along a cosine
  int warm_up_steps = 50;
  bool balance_classes = false;  // h and v have the same weight in each cloud
  double edge_weight = 4;        // weight of a point that has a neighbor of the other label
  int epoch_steps = 2500;        // steps between validations
};

struct Epoch {
  int step = 0;           // steps done
  double train_loss = 0;  // mean over the epoch's steps, weighted as in training
  std::vector<planes::LabelAccuracy> validation;  // by validation set
};

/// The complete state: continuing from a copy gives the same result as an uninterrupted run.
struct TrainState {
  planes::NetworkWeights weights;
  std::vector<std::vector<float>> mean, variance;  // Adam's moments, by tensor
  int step = 0;
  double loss_sum = 0;  // since the last validation
  std::vector<Epoch> epochs;
};

/// Initial weights as in the official code and PyTorch: uniform within 1 / sqrt(inputs) for the
/// head, 1 / sqrt(outputs) for the graph convolutions.
planes::NetworkWeights random_weights(const planes::NetworkConfig& config, std::uint64_t seed);

/// Begins with random_weights() and moments of 0.
TrainState begin_training(const TrainOptions& options);

/// `draw(number)`: returns the cloud of that number; clouds step * batch .. + batch - 1 make a
/// step. Called from several threads.
using DrawCloud = std::function<planes::LabeledCloud(std::uint64_t number)>;

/// One step; returns its loss. Independent of the number of threads and the instruction set.
double train_step(TrainState& state,
                  const TrainOptions& options,
                  const DrawCloud& draw,
                  int threads,
                  Simd simd = best_simd());

/// Accuracy of a network over all points of the clouds.
planes::LabelAccuracy score_network(const planes::NetworkWeights& weights,
                                    std::span<const planes::LabeledCloud> clouds,
                                    int threads,
                                    Simd simd = best_simd());

/// Gradients of all layers, from those of the logits ([n x out of the last layer], zero in padded
/// columns) and the activations that forward() kept with its winners. On one thread, with sums in
/// the order of the points.
planes::gcn::Layers backward(const planes::gcn::Graph& graph,
                             const planes::gcn::Layers& layers,
                             const planes::gcn::Activations& activations,
                             const planes::gcn::Kernels& kernels,
                             const Buffer& logit_gradients);

}  // namespace planescope::lab
