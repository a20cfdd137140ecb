// Tests of training: gradients, checkpoints, reproducibility and the training page.

#include "core/lab/training/train.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>

#include "core/lab/rivals/rivals.hpp"
#include "core/lab/synthetic/repeatable.hpp"
#include "core/lab/training/checkpoint.hpp"
#include "core/model/error.hpp"
#include "core/model/random.hpp"
#include "core/planes/classify/weights.hpp"

namespace planescope::lab {
namespace {

// ---- Training ----

/// A floor that meets a wall at x = 0, rotated about z.
planes::LabeledCloud corner(std::uint64_t number) {
  planes::LabeledCloud cloud;
  const double yaw = 6.28 * random_uniform(1, number, 0);
  for (std::uint64_t i = 1; i <= 400; ++i) {
    const double u = random_uniform(2, number, 2 * i), v = random_uniform(2, number, 2 * i + 1);
    const bool wall = i % 2 == 0;
    const double x = wall ? 0 : u, z = wall ? u : 0;
    cloud.points.push_back(
        Vec3d(std::cos(yaw) * x - std::sin(yaw) * v, std::sin(yaw) * x + std::cos(yaw) * v, z)
            .cast<float>());
    cloud.labels.push_back(wall ? Label::v : Label::h);
  }
  return cloud;
}

TrainOptions quick_options() {
  TrainOptions options;
  options.network.levels = {{8, 8}, {16}};
  options.network.head = {16};
  options.steps = 60;
  options.warm_up_steps = 5;
  options.learning_rate = 1e-2;
  options.batch = 3;
  return options;
}

TrainState train(const TrainOptions& options, int steps, int threads, Simd simd = best_simd()) {
  TrainState state = begin_training(options);
  while (state.step < steps) train_step(state, options, corner, threads, simd);
  return state;
}

std::filesystem::path temporary_file(const std::string& name) {
  return std::filesystem::temp_directory_path() / ("planescope_train_" + name);
}

TEST(Training, LearnsToDistinguishAFloorFromAWall) {
  const TrainOptions options = quick_options();
  const std::vector<planes::LabeledCloud> unseen = {corner(1000001), corner(1000002),
                                                    corner(1000003)};
  const planes::LabelAccuracy before = score_network(begin_training(options).weights, unseen, 1);
  const planes::LabelAccuracy after =
      score_network(train(options, options.steps, 2).weights, unseen, 1);
  EXPECT_LT(before.inner_percent(), 90);
  EXPECT_GT(after.inner_percent(), 99);
  EXPECT_GT(after.edge_percent(), 75);
}

TEST(Training, GivesTheSameWeightsForEveryThreadCountAndInstructionSet) {
  const TrainOptions options = quick_options();
  const TrainState expected = train(options, 10, 1, Simd::plain);
  for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512}) {
    if (simd > best_simd()) continue;
    for (const int threads : {1, 2, 7})
      EXPECT_EQ(train(options, 10, threads, simd).weights.tensors, expected.weights.tensors)
          << to_string(simd) << ", " << threads << " threads";
  }
}

TEST(Training, ResumedFromACheckpointGivesTheSameWeights) {
  const TrainOptions options = quick_options();
  const auto path = temporary_file("resume");
  TrainState first = train(options, 7, 2);
  first.epochs.push_back({.step = 7, .train_loss = 1.0 / 3, .validation = {{1, 2, 3, 4}}});
  write_checkpoint(path, first, options, {{"recipe", "a test"}});
  TrainState resumed = read_checkpoint(path, options, {{"recipe", "a test"}});
  EXPECT_EQ(resumed.step, 7);
  EXPECT_EQ(resumed.loss_sum, first.loss_sum);
  ASSERT_EQ(resumed.epochs.size(), 1u);
  EXPECT_EQ(resumed.epochs[0].train_loss, 1.0 / 3);
  EXPECT_EQ(resumed.epochs[0].validation[0].inner, 4u);
  while (resumed.step < 20) train_step(resumed, options, corner, 1);
  const TrainState whole = train(options, 20, 2);
  EXPECT_EQ(resumed.weights.tensors, whole.weights.tensors);
  EXPECT_EQ(resumed.loss_sum, whole.loss_sum);
}

TEST(Training, RejectsTheCheckpointOfAnotherTraining) {
  const auto path = temporary_file("other");
  const TrainOptions options = quick_options();
  const TrainingPurpose purpose = {{"recipe", "a test"}};
  write_checkpoint(path, begin_training(options), options, purpose);
  const auto message = [&](const TrainOptions& wanted, const TrainingPurpose& wanted_purpose) {
    try {
      read_checkpoint(path, wanted, wanted_purpose);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string("was taken");
  };
  EXPECT_EQ(message(options, purpose), "was taken");
  TrainOptions longer = options;
  longer.steps = 61;
  EXPECT_EQ(message(longer, purpose),
            path.string() + ": belongs to a different training run: steps 60; expected 61");
  EXPECT_EQ(
      message(options, {{"recipe", "another"}}),
      path.string() + ": belongs to a different training run: recipe a test; expected another");
}

TEST(Training, RejectsADamagedCheckpoint) {
  const auto path = temporary_file("damaged");
  const TrainOptions options = quick_options();
  EXPECT_THROW(read_checkpoint(temporary_file("nowhere"), options, {}), Error);
  TrainState state = begin_training(options);
  state.step = options.steps + 1;
  write_checkpoint(path, state, options, {});
  EXPECT_THROW(read_checkpoint(path, options, {}), Error) << "more steps than there are";
  state.step = 2;
  state.epochs = {{.step = 1, .train_loss = 1, .validation = {{}}},
                  {.step = 2, .train_loss = 1, .validation = {}}};
  write_checkpoint(path, state, options, {});
  EXPECT_THROW(read_checkpoint(path, options, {}), Error) << "not all epochs have the same sets";
  state.epochs.clear();
  write_checkpoint(path, state, options, {});
  planes::TensorFile file = planes::read_safetensors(path);
  file.metadata["progress"] = R"({"step": 4294967296, "loss_sum": 0, "epochs": []})";
  planes::write_safetensors(path, file);
  EXPECT_THROW(read_checkpoint(path, options, {}), Error) << "0 in its lowest bits";
  state.mean[0][0] = std::numeric_limits<float>::infinity();
  write_checkpoint(path, state, options, {});
  EXPECT_THROW(read_checkpoint(path, options, {}), Error) << "not finite";
  std::filesystem::resize_file(path, std::filesystem::file_size(path) - 5);
  EXPECT_THROW(read_checkpoint(path, options, {}), Error) << "cut";
}

TEST(Training, DoesNotLearnFromPointsOfUnknownLabel) {
  const TrainOptions options = quick_options();
  const auto unknown = [](std::uint64_t number) {
    planes::LabeledCloud cloud = corner(number);
    cloud.labels.assign(cloud.points.size(), Label::unknown);
    return cloud;
  };
  TrainState state = begin_training(options);
  EXPECT_EQ(train_step(state, options, unknown, 1), 0);
  EXPECT_EQ(state.weights.tensors, begin_training(options).weights.tensors);
}

// ---- Gradients, compared with finite differences of the plain network in double precision ----

/// A curved sheet with noise: no two distances are equal.
std::vector<Vec3f> sheet(int count) {
  Random random(3);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) {
    const double u = random.uniform(), v = random.uniform();
    points.emplace_back(u, v, u > 0.5 ? u - 0.5 + 0.02 * random.normal() : 0.02 * random.normal());
  }
  return points;
}

void expect_gradients(const planes::NetworkConfig& config, int points_count) {
  const std::vector<Vec3f> points = sheet(points_count);
  const planes::NetworkWeights weights = random_weights(config, 5);
  planes::gcn::Graph graph;
  planes::gcn::make_graph(points, config, 1, best_simd(), graph);
  std::vector<Vec3f> sorted;
  for (const std::uint32_t i : graph.order) sorted.push_back(points[i]);

  // The loss is a random linear function of the logits.
  Random random(11);
  const planes::gcn::Layers layers = planes::gcn::make_layers(weights);
  const auto width = static_cast<std::size_t>(layers.head.back().out);
  Buffer slopes(points.size() * width, 0);
  for (std::size_t i = 0; i < points.size(); ++i)
    for (std::size_t c = 0; c < 2; ++c)
      slopes[i * width + c] = static_cast<float>(random.uniform(-1, 1));

  const planes::gcn::Kernels& kernels = planes::gcn::kernels(best_simd());
  planes::gcn::Activations a;
  planes::gcn::forward(graph, layers, kernels, 1, /*keep_winners=*/true, a);
  const auto gradients =
      planes::gcn::tensor_gradients(weights, backward(graph, layers, a, kernels, slopes));

  PlainNetwork<double> network{config, {}};
  for (const auto& tensor : weights.tensors)
    network.tensors.emplace_back(tensor.begin(), tensor.end());
  const PlainGraph plain = make_plain_graph(sorted, config);
  const auto loss = [&] {
    const auto logits = plain_forward(network, plain, sorted);
    double sum = 0;
    for (std::size_t i = 0; i < logits.size(); ++i)
      for (std::size_t c = 0; c < 2; ++c) sum += logits[i][c] * double{slopes[i * width + c]};
    return sum;
  };

  const std::vector<planes::TensorSpec> specs = planes::tensor_specs(config);
  for (std::size_t t = 0; t < specs.size(); ++t) {
    SCOPED_TRACE(specs[t].name);
    double largest = 0;
    for (const float g : gradients[t]) largest = std::max(largest, std::abs(double{g}));
    EXPECT_GT(largest, 0) << "nothing reaches this tensor";
    for (int draw = 0; draw < 12; ++draw) {
      const int i = random.integer(0, static_cast<int>(network.tensors[t].size()) - 1);
      // The step is so small that almost no maximum or ReLU changes its branch.
      constexpr double kStep = 1e-6;
      double& value = network.tensors[t][i];
      const double kept = value;
      value = kept + kStep;
      const double above = loss();
      value = kept - kStep;
      const double below = loss();
      value = kept;
      EXPECT_NEAR(gradients[t][i], (above - below) / (2 * kStep), 2e-3 * largest + 1e-6)
          << "entry " << i;
    }
  }
}

TEST(GcnGradient, OfCompactMatchesFiniteDifferences) {
  expect_gradients(planes::network_config("compact"), 300);
}

TEST(GcnGradient, OfEveryKindOfLayerMatchesFiniteDifferences) {
  planes::NetworkConfig config;
  config.levels = {{20, 7}, {17}, {18, 5}};
  config.supports = 2;
  config.neighbors = 6;
  config.pool_rate = 3;
  config.pool_neighbors = 4;
  config.global_feature = true;
  config.head = {19, 10};
  expect_gradients(config, 200);
}

TEST(GcnGradient, WithoutAHiddenLayerMatchesFiniteDifferences) {
  planes::NetworkConfig config;
  config.levels = {{8}};
  config.head = {};
  expect_gradients(config, 60);
}

// ---- The page ----

TrainingSummary two_epochs() {
  return {.title = "Training of <own>.safetensors",
          .facts = {{"Recipe", "planescope"}, {"Command", "planescope train -o '<own>'"}},
          .validation_sets = {"stairs 0 cm", "scans"},
          .epochs = {{250, 0.5, {{90, 100, 998, 1000}, {80, 100, 990, 1000}}},
                     {500, 0.25, {{95, 100, 999, 1000}, {85, 100, 995, 1000}}}}};
}

TEST(TrainingPage, ShowsFactsCurvesAndEveryEpochAndIsSelfContained) {
  const std::string page = training_page(two_epochs());
  EXPECT_NE(page.find("<svg"), page.rfind("<svg")) << "two curves";
  for (const char* text : {"<dt>Recipe</dt><dd>planescope</dd>", "<td>250</td><td>0.5000</td>",
                           "<td>90.00 / 99.80</td>", "<td>85.00 / 99.50</td>", "stairs 0 cm",
                           "prefers-color-scheme:dark"})
    EXPECT_NE(page.find(text), std::string::npos) << text;
  for (const char* text : {"http", "<script", "<link", "<own>"})
    EXPECT_EQ(page.find(text), std::string::npos) << text;
}

TEST(TrainingPage, BeforeTheFirstEpochSaysSo) {
  TrainingSummary summary = two_epochs();
  summary.epochs.clear();
  const std::string page = training_page(summary);
  EXPECT_EQ(page.find("<svg"), std::string::npos);
  EXPECT_NE(page.find("No epoch is complete yet"), std::string::npos);
}

}  // namespace
}  // namespace planescope::lab
