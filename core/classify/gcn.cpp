#include "core/classify/gcn.hpp"

#include <algorithm>
#include <cmath>

#include "core/classify/finite.hpp"
#include "core/classify/gcn_forward.hpp"

namespace planescope {

struct Gcn::Layers {
  gcn::Layers layers;
  Simd simd;
};

Gcn::Gcn(const NetworkWeights& weights, Simd simd)
    : layers_(new Layers{gcn::make_layers(weights), simd}) {}
Gcn::~Gcn() = default;
Gcn::Gcn(Gcn&&) noexcept = default;

const NetworkConfig& Gcn::config() const { return layers_->layers.config; }

std::vector<float> Gcn::forward(std::span<const Vec3f> points, int threads) const {
  std::vector<float> logits(2 * points.size());
  if (points.empty()) return logits;
  const gcn::Graph graph = gcn::make_graph(points, config(), threads, layers_->simd);
  const gcn::Activations a = gcn::forward(graph, layers_->layers, gcn::kernels(layers_->simd),
                                          threads, /*keep_winners=*/false);
  const auto width = static_cast<std::size_t>(layers_->layers.head.back().out);
  for (std::size_t i = 0; i < points.size(); ++i)
    std::copy_n(a.head.back().data() + i * width, 2, logits.data() + 2 * graph.order[i]);
  return logits;
}

namespace {

class GcnClassifier final : public Classifier {
 public:
  GcnClassifier(const NetworkWeights& weights, std::string name)
      : network_(weights), name_(std::move(name)) {}

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
                                                const std::string& name) {
  return std::make_unique<GcnClassifier>(weights, name);
}

}  // namespace planescope
