// 3D-GCN (Lin et al., CVPR 2020): surface convolution, graph convolutions, pooling, and a head over
// the features of all levels. The head's first matrix multiplies each level's features before they
// are spread to all points: the same sums with fewer products.

#include "core/planes/classify/gcn_forward.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/model/parallel.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/classify/gcn.hpp"
#include "core/planes/simd/gcn_kernels.hpp"

namespace planescope::planes::gcn {

namespace {

constexpr std::size_t kTile = 64;  // points processed by two consecutive steps while in cache

void allocate(const Graph& graph, const Layers& layers, bool keep_winners, Activations& a) {
  a.levels.resize(graph.levels.size());
  for (std::size_t l = 0; l < graph.levels.size(); ++l) {
    const std::size_t n = graph.levels[l].n;
    a.levels[l].features.resize(n * layers.widths[l]);
    if (l > 0) a.levels[l].fused.resize(n * layers.head[0].out);
  }
  a.convolutions.resize(layers.convolutions.size());
  for (std::size_t c = 0; c < layers.convolutions.size(); ++c) {
    const ConvolutionLayer& layer = layers.convolutions[c];
    const std::size_t n = graph.levels[layer.level].n;
    const std::size_t supports = static_cast<std::size_t>(layers.config.supports);
    Activations::Convolution& kept = a.convolutions[c];
    if (layer.in > 0) kept.products.resize(n * (supports + 1) * layer.out);
    kept.winners.resize(keep_winners ? n * supports * layer.out : 0);
    if (layer.column > 0 || layer.level == 0) continue;
    a.levels[layer.level].pooled.resize(n * layer.in);
    a.levels[layer.level].winners.resize(keep_winners ? n * layer.in : 0);
  }
  a.head.resize(layers.head.size());
  for (std::size_t h = 0; h < layers.head.size(); ++h)
    a.head[h].resize(graph.levels[0].n * layers.head[h].out);
}

struct Pass {
  const Graph& graph;
  const Layers& layers;
  const Kernels& kernels;
  Activations& a;

  /// Input of a convolution: pooled features, or the output of the previous convolution.
  std::pair<const float*, std::size_t> input(std::size_t c) const {
    const ConvolutionLayer& layer = layers.convolutions[c];
    const Activations::Level& level = a.levels[layer.level];
    if (layer.column == 0) return {level.pooled.data(), static_cast<std::size_t>(layer.in)};
    return {level.features.data() + layer.column - layer.in,
            static_cast<std::size_t>(layers.widths[layer.level])};
  }

  void multiply(std::size_t c, std::size_t begin, std::size_t end) const {
    const ConvolutionLayer& layer = layers.convolutions[c];
    if (layer.in == 0) return;
    const int columns = (layers.config.supports + 1) * layer.out;
    const auto [x, stride] = input(c);
    kernels.product({.begin = begin,
                     .end = end,
                     .x = x,
                     .x_stride = stride,
                     .inner = layer.in,
                     .outer = columns,
                     .w = layer.weights.data(),
                     .bias = layer.bias.data(),
                     .y = a.convolutions[c].products.data(),
                     .y_stride = static_cast<std::size_t>(columns)});
  }

  void convolve(std::size_t c, std::size_t begin, std::size_t end) const {
    const ConvolutionLayer& layer = layers.convolutions[c];
    const GraphLevel& level = graph.levels[layer.level];
    Activations::Convolution& kept = a.convolutions[c];
    const bool surface = layer.in == 0;
    kernels.support({.begin = begin,
                     .end = end,
                     .neighbors = level.neighbors,
                     .directions = level.directions.data(),
                     .rows = level.rows.data(),
                     .supports = layers.config.supports,
                     .channels = layer.out,
                     .kernels = layer.directions.data(),
                     .features = surface ? nullptr : kept.products.data() + layer.out,
                     .center = surface ? nullptr : kept.products.data(),
                     .stride = std::size_t{1} * (layers.config.supports + 1) * layer.out,
                     .out = a.levels[layer.level].features.data() + layer.column,
                     .out_stride = static_cast<std::size_t>(layers.widths[layer.level]),
                     .relu = layer.relu,
                     .winners = kept.winners.empty() ? nullptr : kept.winners.data()});
  }

  /// Max-pools the last features over the neighbors of each kept point. A point without neighbors
  /// keeps its own features.
  void pool(std::size_t l, std::size_t begin, std::size_t end) const {
    const GraphLevel& from = graph.levels[l - 1];
    Activations::Level& to = a.levels[l];
    const std::size_t stride = static_cast<std::size_t>(layers.widths[l - 1]);
    const auto layer = std::find_if(layers.convolutions.begin(), layers.convolutions.end(),
                                    [&](const auto& c) { return c.level == static_cast<int>(l); });
    const int channels = layer->in;
    const float* features = a.levels[l - 1].features.data() + stride - channels;
    for (std::size_t i = begin; i < end; ++i) {
      float* out = to.pooled.data() + i * channels;
      const std::uint32_t* row = from.pool_rows.data() + i * from.pool_neighbors;
      const std::size_t own = i * static_cast<std::size_t>(layers.config.pool_rate);
      std::copy_n(features + (from.pool_neighbors > 0 ? row[0] : own) * stride, channels, out);
      for (int j = 1; j < from.pool_neighbors; ++j) {
        const float* in = features + row[j] * stride;
        for (int c = 0; c < channels; ++c) out[c] = std::max(out[c], in[c]);
      }
      if (to.winners.empty()) continue;
      for (int c = 0; c < channels; ++c) {
        int winner = 0;
        while (winner < from.pool_neighbors && features[row[winner] * stride + c] != out[c])
          ++winner;
        to.winners[i * channels + c] = static_cast<std::uint16_t>(winner);
      }
    }
  }

  /// Multiplies a level's features by their rows of the head's first matrix.
  void fuse(std::size_t l, std::size_t begin, std::size_t end) const {
    const HeadLayer& first = layers.head[0];
    int row = 0;
    for (std::size_t m = 0; m < l; ++m) row += layers.widths[m];
    kernels.product({.begin = begin,
                     .end = end,
                     .x = a.levels[l].features.data(),
                     .x_stride = static_cast<std::size_t>(layers.widths[l]),
                     .inner = layers.widths[l],
                     .outer = first.out,
                     .w = first.weights.data() + row * first.out,
                     .bias = l == 0 ? first.bias.data() : nullptr,
                     .y = l == 0 ? a.head[0].data() : a.levels[l].fused.data(),
                     .y_stride = static_cast<std::size_t>(first.out)});
  }

  /// Max-pools the last features over all points and multiplies by their rows of the head's first
  /// matrix.
  std::vector<float> fuse_global() const {
    const HeadLayer& first = layers.head[0];
    std::vector<float> fused(first.out, 0.0f);
    if (!layers.config.global_feature) return fused;
    const int channels = layers.convolutions.back().out;
    const std::size_t stride = static_cast<std::size_t>(layers.widths.back());
    const float* features = a.levels.back().features.data() + stride - channels;
    a.global.assign(features, features + channels);
    a.global_winners.assign(channels, 0);
    for (std::size_t i = 1; i < graph.levels.back().n; ++i)
      for (int c = 0; c < channels; ++c)
        if (features[i * stride + c] > a.global[c]) {
          a.global[c] = features[i * stride + c];
          a.global_winners[c] = static_cast<std::uint32_t>(i);
        }
    kernels.product({.begin = 0,
                     .end = 1,
                     .x = a.global.data(),
                     .inner = channels,
                     .outer = first.out,
                     .w = first.weights.data() + std::size_t{1} * (first.in - channels) * first.out,
                     .y = fused.data()});
    return fused;
  }

  /// Computes each point's logits from the sums of all levels.
  void conclude(const std::vector<float>& global, std::size_t begin, std::size_t end) const {
    const std::size_t width = static_cast<std::size_t>(layers.head[0].out);
    for (std::size_t i = begin; i < end; ++i) {
      float* sum = a.head[0].data() + i * width;
      for (std::size_t l = 1; l < graph.levels.size(); ++l) {
        const float* part = a.levels[l].fused.data() + graph.levels[l].nearest[i] * width;
        for (std::size_t c = 0; c < width; ++c) sum[c] += part[c];
      }
      for (std::size_t c = 0; c < width; ++c) sum[c] += global[c];
      if (layers.head.size() == 1) continue;
      for (std::size_t c = 0; c < width; ++c) sum[c] = std::max(sum[c], 0.0f);
    }
    for (std::size_t h = 1; h < layers.head.size(); ++h) {
      const HeadLayer& layer = layers.head[h];
      kernels.product({.begin = begin,
                       .end = end,
                       .x = a.head[h - 1].data(),
                       .x_stride = static_cast<std::size_t>(layer.in),
                       .inner = layer.in,
                       .outer = layer.out,
                       .w = layer.weights.data(),
                       .bias = layer.bias.data(),
                       .y = a.head[h].data(),
                       .y_stride = static_cast<std::size_t>(layer.out),
                       .relu = h + 1 < layers.head.size()});
    }
  }
};

}  // namespace

void forward(const Graph& graph,
             const Layers& layers,
             const Kernels& kernels,
             int threads,
             bool keep_winners,
             Activations& a) {
  allocate(graph, layers, keep_winners, a);
  const Pass pass{graph, layers, kernels, a};
  const std::size_t n = graph.levels[0].n;
  std::vector<float> global;
  run_team(std::min<int>(threads, static_cast<int>(n / 256)), [&](TeamMember& member) {
    const auto tiles = [&](std::size_t count, const auto& body) {
      const auto [first, last] = member.share(count);
      for (std::size_t begin = first; begin < last; begin += kTile)
        body(begin, std::min(last, begin + kTile));
      member.meet();
    };
    std::size_t c = 0;
    for (std::size_t l = 0; l < graph.levels.size(); ++l) {
      const std::size_t count = graph.levels[l].n;
      const std::size_t end_c = c + layers.config.levels[l].size();
      if (l > 0)
        tiles(count, [&](std::size_t begin, std::size_t end) {
          pass.pool(l, begin, end);
          pass.multiply(c, begin, end);
        });
      for (; c < end_c; ++c)
        tiles(count, [&](std::size_t begin, std::size_t end) {
          pass.convolve(c, begin, end);
          if (c + 1 < end_c)
            pass.multiply(c + 1, begin, end);
          else
            pass.fuse(l, begin, end);
        });
    }
    if (member.rank() == 0) global = pass.fuse_global();
    member.meet();
    tiles(n, [&](std::size_t begin, std::size_t end) { pass.conclude(global, begin, end); });
  });
}

}  // namespace planescope::planes::gcn

namespace planescope::planes {

struct Gcn::Layers {
  gcn::Layers layers;
  Simd simd;

  // Reusable buffers, one per concurrent call: features take megabytes, which would otherwise be
  // mapped and zeroed on every call.
  struct Workspace {
    gcn::Graph graph;
    gcn::Activations activations;
  };
  mutable std::mutex mutex;
  mutable std::vector<std::unique_ptr<Workspace>> idle;

  std::unique_ptr<Workspace> take() const {
    const std::lock_guard lock(mutex);
    if (idle.empty()) return std::make_unique<Workspace>();
    std::unique_ptr<Workspace> workspace = std::move(idle.back());
    idle.pop_back();
    return workspace;
  }
  void give_back(std::unique_ptr<Workspace> workspace) const {
    const std::lock_guard lock(mutex);
    idle.push_back(std::move(workspace));
  }
};

Gcn::Gcn(const NetworkWeights& weights, Simd simd)
    : layers_(new Layers{gcn::make_layers(weights), simd, {}, {}}) {}
Gcn::~Gcn() = default;

std::vector<float> Gcn::forward(std::span<const Vec3f> points, int threads) const {
  std::vector<float> logits(2 * points.size());
  if (points.empty()) return logits;
  auto workspace = layers_->take();
  auto& [graph, activations] = *workspace;
  const gcn::Layers& layers = layers_->layers;
  const Simd simd = layers_->simd;
  gcn::make_graph(points, layers.config, threads, simd, graph);
  gcn::forward(graph, layers, gcn::kernels(simd), threads, /*keep_winners=*/false, activations);
  const auto width = static_cast<std::size_t>(layers.head.back().out);
  for (std::size_t i = 0; i < points.size(); ++i)
    std::copy_n(activations.head.back().data() + i * width, 2, logits.data() + 2 * graph.order[i]);
  layers_->give_back(std::move(workspace));
  return logits;
}

namespace {

class GcnClassifier final : public Classifier {
 public:
  GcnClassifier(const NetworkWeights& weights, std::string name, Simd simd)
      : network_(weights, simd), name_(std::move(name)) {}

  std::string name() const override { return name_; }

  Classification classify(std::span<const Vec3f> points, int threads) const override {
    return classify_finite(points, [&](std::span<const Vec3f> finite) {
      const std::vector<float> logits = network_.forward(finite, threads);
      Classification result;
      for (std::size_t i = 0; i < finite.size(); ++i) {
        const double lead = double{logits[2 * i]} - logits[2 * i + 1];  // h minus v
        result.labels.push_back(lead >= 0 ? Label::h : Label::v);
        result.margins.push_back(static_cast<float>(std::tanh(std::abs(lead) / 2)));
      }
      return result;
    });
  }

 private:
  Gcn network_;
  std::string name_;
};

}  // namespace

std::unique_ptr<Classifier> make_gcn_classifier(const NetworkWeights& weights,
                                                const std::string& name,
                                                Simd simd) {
  return std::make_unique<GcnClassifier>(weights, name, simd);
}

}  // namespace planescope::planes
