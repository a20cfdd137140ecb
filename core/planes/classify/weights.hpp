#pragma once

// The weights of a 3D-GCN as a safetensors file: tensor names, shapes and layouts are those of the
// official PyTorch code's state_dict. The format (github.com/huggingface/safetensors): the header's
// length as a little-endian u64, a JSON header {name: {dtype, shape, data_offsets}, "__metadata__":
// {text: text}}, then the tensors' data without gaps.

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace planescope::planes {

// ---- Files of tensors ----

struct Tensor {
  std::string name;
  std::vector<std::size_t> shape;  // row-major
  std::vector<float> values;
};

struct TensorFile {
  std::map<std::string, std::string> metadata;
  std::vector<Tensor> tensors;
};

/// Tensors in the order of their data. Throws Error where the file is missing, cut, larger than its
/// header says, or contradicts itself, and where a tensor is not F32.
TensorFile read_safetensors(const std::filesystem::path& path);
/// The same of a file's content; `path` is what errors call it.
TensorFile read_safetensors(std::span<const unsigned char> bytes,
                            const std::filesystem::path& path);
/// As the Python library lays such a file out: tensors ordered by name, the header padded with
/// spaces so that data begins at a multiple of 8. Replaces the file as a whole or not at all.
void write_safetensors(const std::filesystem::path& path, const TensorFile& file);

// ---- Networks ----

/// A 3D-GCN for segmentation (Lin et al., CVPR 2020). The first convolution of the first level is
/// the surface convolution; between levels lies a pooling layer. All convolutions but the last are
/// followed by ReLU. Default: `compact`.
struct NetworkConfig {
  std::string name = "compact";
  std::vector<std::vector<int>> levels = {{32, 32}, {64, 64}};  // channels out of each convolution
  int supports = 1;                                             // of every kernel
  int neighbours = 16;          // of every convolution, the point itself not among them
  int pool_rate = 4;            // one point in so many goes on to the next level
  int pool_neighbours = 4;      // whose features it takes the maximum with
  bool global_feature = false;  // the maximum over all points of the last features, for every point
  std::vector<int> head = {64};  // widths of the hidden layers after the concatenation
  bool operator==(const NetworkConfig&) const = default;
};

/// "compact", "small" (the official structure at a quarter of its width) or "official". Throws
/// Error naming these.
NetworkConfig network_config(const std::string& name);

struct TensorSpec {
  std::string name;        // as in the official state_dict: conv_1.weights, conv1d_block.0.bias
  std::vector<int> shape;  // row-major
};
/// Every tensor of a network, in the order of the network: conv_0.directions, conv_1.weights,
/// conv_1.bias, conv_1.directions, ..., conv1d_block.0.weight, conv1d_block.0.bias, ...
std::vector<TensorSpec> tensor_specs(const NetworkConfig& config);
std::size_t parameter_count(const NetworkConfig& config);

struct NetworkWeights {
  NetworkConfig config;
  std::vector<std::vector<float>> tensors;  // by tensor_specs(config)
  std::string training = "{}";              // how they were trained, a JSON object
};

/// Throws Error where the file is missing, cut, larger than it says, contradicts itself or its
/// configuration, or holds values that are not finite.
NetworkWeights read_weights(const std::filesystem::path& path);
/// The same of a file's content; `path` is what errors call it.
NetworkWeights read_weights(std::span<const unsigned char> bytes,
                            const std::filesystem::path& path);
/// Replaces the file as a whole or not at all.
void write_weights(const std::filesystem::path& path, const NetworkWeights& weights);

}  // namespace planescope::planes
