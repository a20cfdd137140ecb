#include "core/planes/classify/weights.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/planes/classify/safetensors.hpp"

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

// Network weights as a safetensors file. What the tensors alone do not tell stands in its metadata:
// "format", "version", "config" and "training", the last two JSON objects as text.

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

constexpr const char* kFormat = "planescope-classifier";
constexpr const char* kVersion = "1";

struct Range {
  int min = 1, max = 1;
};
constexpr Range kChannels{1, 4096}, kLevels{1, 8}, kLayers{1, 8}, kHidden{0, 8}, kSupports{1, 16},
    kNeighbours{1, 1024}, kPoolRate{2, 64};

int count_of(const Json& json, const Range& range, const std::string& what) {
  const auto value = json.is_number_integer() ? json.get<std::int64_t>() : std::int64_t{-1};
  if (!json.is_number_integer() || value < range.min || value > range.max)
    throw Error(fmt::format("{} is {}, expected {} to {}", what,
                            json.is_number() ? json.dump() : "no number", range.min, range.max));
  return static_cast<int>(value);
}

const Json& list_of(const Json& json, const Range& size, const std::string& what) {
  if (!json.is_array()) throw Error(what + " is no list");
  count_of(json.size(), size, what + ": its length");
  return json;
}

std::vector<int> channels_of(const Json& json, const Range& layers, const std::string& what) {
  std::vector<int> channels;
  for (const Json& value : list_of(json, layers, what))
    channels.push_back(count_of(value, kChannels, what + ": a channel count"));
  return channels;
}

NetworkConfig config_of(const Json& json, const std::string& what) {
  if (!json.is_object()) throw Error(what + " is no JSON object");
  std::size_t used = 0;
  const auto field = [&](const char* name) -> const Json& {
    const auto found = json.find(name);
    if (found == json.end()) throw Error(what + " does not say '" + name + "'");
    ++used;
    return *found;
  };
  const auto count = [&](const char* name, const Range& range) {
    return count_of(field(name), range, what + ": " + name);
  };
  NetworkConfig config;
  if (const Json& name = field("name"); name.is_string())
    config.name = name.get<std::string>();
  else
    throw Error(what + ": name is no text");
  config.levels.clear();
  for (const Json& level : list_of(field("levels"), kLevels, what + ": levels"))
    config.levels.push_back(channels_of(level, kLayers, what + ": levels"));
  config.supports = count("supports", kSupports);
  config.neighbours = count("neighbours", kNeighbours);
  config.pool_rate = count("pool_rate", kPoolRate);
  config.pool_neighbours = count("pool_neighbours", {1, config.neighbours});
  if (const Json& global = field("global_feature"); global.is_boolean())
    config.global_feature = global.get<bool>();
  else
    throw Error(what + ": global_feature is neither true nor false");
  config.head = channels_of(field("head"), kHidden, what + ": head");
  if (used != json.size())
    throw Error(fmt::format("{} has {} fields, expected {}", what, json.size(), used));
  return config;
}

std::string text_of(const NetworkConfig& config) {
  const nlohmann::ordered_json json = {{"name", config.name},
                                       {"levels", config.levels},
                                       {"supports", config.supports},
                                       {"neighbours", config.neighbours},
                                       {"pool_rate", config.pool_rate},
                                       {"pool_neighbours", config.pool_neighbours},
                                       {"global_feature", config.global_feature},
                                       {"head", config.head}};
  return json.dump();
}

/// A metadata text that must be there.
const std::string& metadata(const TensorFile& file, const char* key, const fs::path& path) {
  const auto found = file.metadata.find(key);
  if (found == file.metadata.end())
    throw Error(
        fmt::format("{}: its metadata has no '{}', expected that of a {} file: "
                    "docs/classifier.md shows how to write one",
                    path.string(), key, kFormat));
  return found->second;
}

void expect_metadata(const TensorFile& file,
                     const char* key,
                     const char* value,
                     const fs::path& path) {
  if (const std::string& found = metadata(file, key, path); found != value)
    throw Error(fmt::format("{}: {} {}, expected \"{}\"", path.string(), key, shown(found), value));
}

/// The values of `spec`, moved out of the file.
std::vector<float> take(TensorFile& file, const TensorSpec& spec, const std::string& what) {
  const auto found = std::find_if(file.tensors.begin(), file.tensors.end(),
                                  [&](const Tensor& tensor) { return tensor.name == spec.name; });
  if (found == file.tensors.end())
    throw Error(fmt::format("{}: no tensor {}, which its configuration asks for", what, spec.name));
  if (!std::equal(
          spec.shape.begin(), spec.shape.end(), found->shape.begin(), found->shape.end(),
          [](int expected, std::size_t is) { return static_cast<std::size_t>(expected) == is; }))
    throw Error(fmt::format("{}: tensor {} is [{}], its configuration asks for [{}]", what,
                            spec.name, fmt::join(found->shape, ", "), fmt::join(spec.shape, ", ")));
  for (std::size_t i = 0; i < found->values.size(); ++i)
    if (!std::isfinite(found->values[i]))
      throw Error(fmt::format("{}: tensor {}: value {} is {}, expected finite numbers", what,
                              spec.name, i, found->values[i]));
  std::vector<float> values = std::move(found->values);
  file.tensors.erase(found);
  return values;
}

}  // namespace

NetworkWeights read_weights(const fs::path& path) {
  return read_weights(read_file_bytes(path), path);
}

NetworkWeights read_weights(std::span<const unsigned char> bytes, const fs::path& path) {
  TensorFile file = read_safetensors(bytes, path);
  expect_metadata(file, "format", kFormat, path);
  expect_metadata(file, "version", kVersion, path);

  NetworkWeights weights;
  const std::string what = path.string() + ": configuration";
  weights.config =
      config_of(parse_json<nlohmann::json>(metadata(file, "config", path), what), what);
  if (const auto training = file.metadata.find("training"); training != file.metadata.end()) {
    const std::string record = path.string() + ": training record";
    if (!parse_json<nlohmann::json>(training->second, record).is_object())
      throw Error(record + " is no JSON object");
    weights.training = training->second;
  }
  for (const TensorSpec& spec : tensor_specs(weights.config))
    weights.tensors.push_back(take(file, spec, path.string()));
  if (!file.tensors.empty())
    throw Error(fmt::format("{}: its configuration has no tensor {}", path.string(),
                            shown(file.tensors[0].name)));
  return weights;
}

void write_weights(const fs::path& path, const NetworkWeights& weights) {
  TensorFile file;
  file.metadata = {{"format", kFormat},
                   {"version", kVersion},
                   {"config", text_of(weights.config)},
                   {"training", weights.training}};
  const std::vector<TensorSpec> specs = tensor_specs(weights.config);
  assert(weights.tensors.size() == specs.size());
  for (std::size_t i = 0; i < specs.size(); ++i)
    file.tensors.push_back(
        {specs[i].name, {specs[i].shape.begin(), specs[i].shape.end()}, weights.tensors[i]});
  write_safetensors(path, file);
}

}  // namespace planescope::planes
