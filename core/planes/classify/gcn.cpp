#include "core/planes/classify/gcn.hpp"

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/planes/classify/classifier.hpp"
#include "core/planes/classify/gcn_forward.hpp"

namespace planescope::planes {

struct Gcn::Layers {
  gcn::Layers layers;
  Simd simd;

  // Buffers of earlier calls, one for each that ran at the same time: a cloud's features take
  // megabytes, which would otherwise be mapped and cleared anew every time.
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
        const double lead = double{logits[2 * i]} - logits[2 * i + 1];  // of h over v
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
