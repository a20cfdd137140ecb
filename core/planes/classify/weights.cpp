// Reads and writes classifier weights (safetensors), and the shapes of the three networks.

#include "core/planes/classify/weights.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <optional>
#include <span>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"

namespace planescope::planes {

// ---- Files of tensors ----

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

static_assert(std::endian::native == std::endian::little, "tensors are copied byte by byte");

constexpr std::size_t kLengthBytes = 8;
constexpr std::uint64_t kMaxHeaderBytes = 16 << 20;
constexpr const char* kMetadata = "__metadata__";

/// A tensor as described by the header; its byte range is not yet checked.
struct Entry {
  std::string name;
  std::vector<std::size_t> shape;
  std::uint64_t begin = 0, end = 0;  // within the data
};

Entry entry_of(const std::string& name, const JsonPlace& place) {
  Entry entry;
  entry.name = name;
  constexpr const char* kTypes[] = {"F32"};
  place.at("dtype").choice(kTypes);
  place.at("shape").each([&](const JsonPlace& extent) { entry.shape.push_back(extent.count()); });
  const JsonPlace offsets = place.at("data_offsets");
  std::vector<std::uint64_t> range;
  offsets.each([&](const JsonPlace& at) { range.push_back(at.count()); });
  if (range.size() != 2 || range[0] > range[1])
    offsets.fail_kind("its first byte and the byte after its last");
  entry.begin = range[0];
  entry.end = range[1];
  return entry;
}

/// Bytes of a tensor of this shape; nullopt if more than `limit`.
std::optional<std::uint64_t> bytes_of(const std::vector<std::size_t>& shape, std::uint64_t limit) {
  std::uint64_t bytes = sizeof(float);
  if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return 0;
  for (const std::size_t extent : shape) {
    if (extent > limit / bytes) return std::nullopt;
    bytes *= extent;
  }
  return bytes;
}

/// Sorts the entries by position and checks that they fill the data without gap or overlap.
void check_layout(std::vector<Entry>& entries, std::uint64_t data_bytes, const fs::path& path) {
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.begin, a.end, a.name) < std::tie(b.begin, b.end, b.name);
  });
  std::uint64_t filled = 0;
  for (const Entry& entry : entries) {
    const std::string what = path.string() + ": tensor " + shown(entry.name);
    if (entry.end > data_bytes)
      throw Error(
          fmt::format("{} ends at byte {}, but the data has {} bytes: the file is truncated", what,
                      entry.end, data_bytes));
    if (entry.begin != filled)
      throw Error(fmt::format("{} begins at byte {} of the data; expected byte {}", what,
                              entry.begin, filled));
    if (bytes_of(entry.shape, data_bytes) != entry.end - entry.begin)
      throw Error(fmt::format("{} has {} bytes, which do not match shape [{}] in F32", what,
                              entry.end - entry.begin, fmt::join(entry.shape, ", ")));
    filled = entry.end;
  }
  if (filled != data_bytes)
    throw Error(fmt::format("{}: {} bytes of data, but its tensors use {}", path.string(),
                            data_bytes, filled));
}

std::string_view header_of(std::span<const unsigned char> bytes, const fs::path& path) {
  if (bytes.size() < kLengthBytes)
    throw Error(
        fmt::format("{}: {} bytes; expected a safetensors file", path.string(), bytes.size()));
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), kLengthBytes);
  const std::uint64_t most = std::min<std::uint64_t>(bytes.size() - kLengthBytes, kMaxHeaderBytes);
  if (length > most)
    throw Error(
        fmt::format("{}: {}-byte header; expected at most {} bytes (the file is truncated or not a "
                    "safetensors file)",
                    path.string(), length, most));
  return {reinterpret_cast<const char*>(bytes.data()) + kLengthBytes, length};
}

}  // namespace

TensorFile read_safetensors(const fs::path& path) {
  return read_safetensors(read_file_bytes(path), path);
}

TensorFile read_safetensors(std::span<const unsigned char> bytes, const fs::path& path) {
  const std::string_view header = header_of(bytes, path);
  const std::span data = bytes.subspan(kLengthBytes + header.size());

  TensorFile file;
  std::vector<Entry> entries;
  const std::string what = path.string() + ": header";
  const auto json = parse_json<Json>(header, what);
  if (!json.is_object()) throw Error(what + " is not a JSON object");
  read_place(path, json, [&](const JsonPlace&) {
    for (const auto& [name, value] : json.items()) {
      const JsonPlace place(value, name == kMetadata ? name : "tensor " + shown(name));
      if (name != kMetadata) {
        entries.push_back(entry_of(name, place));
        continue;
      }
      if (!value.is_object()) place.fail_kind("an object");
      for (const auto& [key, text] : value.items())
        file.metadata[key] = JsonPlace(text, "metadata " + shown(key)).text();
    }
  });
  check_layout(entries, data.size(), path);
  for (const Entry& entry : entries) {
    const std::span raw = data.subspan(entry.begin, entry.end - entry.begin);
    std::vector<float> values(raw.size() / sizeof(float));
    if (!raw.empty()) std::memcpy(values.data(), raw.data(), raw.size());
    file.tensors.push_back({entry.name, entry.shape, std::move(values)});
  }
  return file;
}

void write_safetensors(const fs::path& path, const TensorFile& file) {
  std::vector<const Tensor*> ordered;
  for (const Tensor& tensor : file.tensors) ordered.push_back(&tensor);
  std::sort(ordered.begin(), ordered.end(),
            [](const Tensor* a, const Tensor* b) { return a->name < b->name; });

  Json json;
  if (!file.metadata.empty()) json[kMetadata] = file.metadata;
  std::size_t offset = 0;
  for (const Tensor* tensor : ordered) {
    const std::size_t end = offset + tensor->values.size() * sizeof(float);
    json[tensor->name] = {
        {"dtype", "F32"}, {"shape", tensor->shape}, {"data_offsets", {offset, end}}};
    offset = end;
  }
  std::string header = json.is_null() ? "{}" : json.dump();
  header.resize((header.size() + 7) / 8 * 8, ' ');

  const std::uint64_t length = header.size();
  std::vector<unsigned char> bytes;
  bytes.reserve(kLengthBytes + header.size() + offset);
  const auto append = [&](const void* from, std::size_t count) {
    const auto* first = static_cast<const unsigned char*>(from);
    bytes.insert(bytes.end(), first, first + count);
  };
  append(&length, kLengthBytes);
  append(header.data(), header.size());
  for (const Tensor* tensor : ordered)
    append(tensor->values.data(), tensor->values.size() * sizeof(float));

  write_file_bytes(path, bytes);
}

// ---- Networks ----

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
            .neighbors = 50,
            .global_feature = true,
            .head = {512, 512}};
  throw Error("unknown network '" + name + "'; expected compact, small, or official");
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

// Network weights as a safetensors file. The metadata holds the information missing from the
// tensors: "format", "version", "config" and "training", the last two as JSON text.

template <typename Fields>
void visit_fields(Fields& fields, Same<NetworkConfig> auto& config) {
  fields("name", config.name);
  fields("levels", config.levels);
  fields.whole("supports", config.supports, kPlain, 1, 16);
  fields.whole("neighbours", config.neighbors, kPlain, 1, 1024);
  fields.whole("pool_rate", config.pool_rate, kPlain, 2, 64);
  fields.whole("pool_neighbours", config.pool_neighbors, kPlain, 1, config.neighbors);
  fields("global_feature", config.global_feature);
  fields("head", config.head);
}

namespace {

constexpr const char* kFormat = "planescope-classifier";
constexpr const char* kVersion = "1";

/// Checks the convolutions of a level, or the hidden layers of the head.
void check_layers(const std::vector<int>& channels, std::size_t least, const JsonPlace& place) {
  if (channels.size() < least || channels.size() > 8)
    place.fail_kind(fmt::format("{} to 8 layers", least));
  place.each([](const JsonPlace& count) { count.whole(1, 4096); });
}

NetworkConfig config_of(const JsonPlace& place) {
  place.has_only({"name", "levels", "supports", "neighbours", "pool_rate", "pool_neighbours",
                  "global_feature", "head"});
  NetworkConfig config;
  read_fields(place, config);
  if (config.levels.empty() || config.levels.size() > 8)
    place.at("levels").fail_kind("1 to 8 levels");
  auto level = config.levels.begin();
  place.at("levels").each([&](const JsonPlace& layers) { check_layers(*level++, 1, layers); });
  check_layers(config.head, 0, place.at("head"));
  return config;
}

/// Returns a required metadata text.
const std::string& metadata(const TensorFile& file, const char* key, const fs::path& path) {
  const auto found = file.metadata.find(key);
  if (found == file.metadata.end())
    throw Error(
        fmt::format("{}: metadata has no '{}'; expected the metadata of a {} file; "
                    "docs/classifier.md shows how to write one",
                    path.string(), key, kFormat));
  return found->second;
}

void expect_metadata(const TensorFile& file,
                     const char* key,
                     const char* value,
                     const fs::path& path) {
  if (const std::string& found = metadata(file, key, path); found != value)
    throw Error(fmt::format("{}: {} {}; expected \"{}\"", path.string(), key, shown(found), value));
}

/// Moves the values of `spec` out of the file.
std::vector<float> extract(TensorFile& file, const TensorSpec& spec, const std::string& what) {
  const auto found = std::find_if(file.tensors.begin(), file.tensors.end(),
                                  [&](const Tensor& tensor) { return tensor.name == spec.name; });
  if (found == file.tensors.end())
    throw Error(fmt::format("{}: tensor {} is missing, but its configuration requires it", what,
                            spec.name));
  if (!std::equal(
          spec.shape.begin(), spec.shape.end(), found->shape.begin(), found->shape.end(),
          [](int expected, std::size_t is) { return static_cast<std::size_t>(expected) == is; }))
    throw Error(fmt::format("{}: tensor {} has shape [{}], but its configuration requires [{}]",
                            what, spec.name, fmt::join(found->shape, ", "),
                            fmt::join(spec.shape, ", ")));
  for (std::size_t i = 0; i < found->values.size(); ++i)
    if (!std::isfinite(found->values[i]))
      throw Error(fmt::format("{}: tensor {}: value {} is {}; expected finite numbers", what,
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
  const std::string config = path.string() + ": configuration";
  const auto json = parse_json<Json>(metadata(file, "config", path), config);
  weights.config = read_place(config, json, config_of);
  if (const auto training = file.metadata.find("training"); training != file.metadata.end()) {
    const std::string record = path.string() + ": training record";
    if (!parse_json<Json>(training->second, record).is_object())
      throw Error(record + " is not a JSON object");
    weights.training = training->second;
  }
  for (const TensorSpec& spec : tensor_specs(weights.config))
    weights.tensors.push_back(extract(file, spec, path.string()));
  if (!file.tensors.empty())
    throw Error(fmt::format("{}: tensor {} is not part of its configuration", path.string(),
                            shown(file.tensors[0].name)));
  return weights;
}

void write_weights(const fs::path& path, const NetworkWeights& weights) {
  TensorFile file;
  file.metadata = {{"format", kFormat},
                   {"version", kVersion},
                   {"config", json_of(weights.config).dump()},
                   {"training", weights.training}};
  const std::vector<TensorSpec> specs = tensor_specs(weights.config);
  assert(weights.tensors.size() == specs.size());
  for (std::size_t i = 0; i < specs.size(); ++i)
    file.tensors.push_back(
        {specs[i].name, {specs[i].shape.begin(), specs[i].shape.end()}, weights.tensors[i]});
  write_safetensors(path, file);
}

}  // namespace planescope::planes
