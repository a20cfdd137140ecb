#include "core/planes/classify/weights.hpp"

#include "core/model/error.hpp"

namespace planescope::planes {
namespace {

/// The layers as (in, out) channels of each convolution; in = 0 for the surface convolution.
std::vector<std::pair<int, int>> convolutions(const NetworkConfig& config) {
  std::vector<std::pair<int, int>> layers;
  int in = 0;
  for (const auto& level : config.levels)
    for (const int out : level) {
      layers.emplace_back(in, out);
      in = out;
    }
  return layers;
}

}  // namespace

NetworkConfig network_config(const std::string& name) {
  if (name == "compact") return {};
  if (name == "small")
    return {.name = name,
            .levels = {{32, 32}, {64, 64}, {128}},
            .global_feature = true,
            .head = {128, 128}};
  if (name == "official")
    return {.name = name,
            .levels = {{128, 128}, {256, 256}, {512}},
            .neighbours = 50,
            .global_feature = true,
            .head = {512, 512}};
  throw Error("network '" + name + "' is unknown, expected compact, small or official");
}

std::vector<TensorSpec> tensor_specs(const NetworkConfig& config) {
  std::vector<TensorSpec> specs;
  int fused = 0, index = 0, last = 0;
  for (const auto& [in, out] : convolutions(config)) {
    const std::string layer = "conv_" + std::to_string(index++);
    if (in > 0) {
      specs.push_back({layer + ".weights", {in, (config.supports + 1) * out}});
      specs.push_back({layer + ".bias", {(config.supports + 1) * out}});
    }
    specs.push_back({layer + ".directions", {3, config.supports * out}});
    fused += out;
    last = out;
  }
  int in = fused + (config.global_feature ? last : 0);
  std::vector<int> widths = config.head;
  widths.push_back(2);
  for (std::size_t i = 0; i < widths.size(); ++i) {
    const std::string layer = "conv1d_block." + std::to_string(2 * i);  // ReLU between
    specs.push_back({layer + ".weight", {widths[i], in, 1}});
    specs.push_back({layer + ".bias", {widths[i]}});
    in = widths[i];
  }
  return specs;
}

std::size_t parameter_count(const NetworkConfig& config) {
  std::size_t count = 0;
  for (const TensorSpec& spec : tensor_specs(config)) {
    std::size_t size = 1;
    for (const int extent : spec.shape) size *= static_cast<std::size_t>(extent);
    count += size;
  }
  return count;
}

}  // namespace planescope::planes
