#pragma once

// Weights of a 3D-GCN as a safetensors file, with the tensor names, shapes and layouts of the
// official PyTorch state_dict. File format (github.com/huggingface/safetensors): the header length
// as a little-endian u64, a JSON header {name: {dtype, shape, data_offsets}, "__metadata__": {text:
// text}}, then the tensor data without gaps.

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

/// Returns tensors in the order of their data. Throws Error if the file is missing, truncated,
/// larger than its header specifies or inconsistent, or if a tensor is not F32.
TensorFile read_safetensors(const std::filesystem::path& path);
/// Parses the content of a file; `path` appears in error messages only.
TensorFile read_safetensors(std::span<const unsigned char> bytes,
                            const std::filesystem::path& path);
/// Uses the Python library's layout: tensors sorted by name, header padded with spaces so that the
/// data begins at a multiple of 8. Replaces the file atomically.
void write_safetensors(const std::filesystem::path& path, const TensorFile& file);

// ---- Networks ----

/// A 3D-GCN for segmentation (Lin et al., CVPR 2020). The first convolution of the first level is
/// the surface convolution; a pooling layer connects successive levels. ReLU follows every
/// convolution except the last. Default: `compact`.
struct NetworkConfig {
  std::string name = "compact";
  /// Output channels of each convolution, by level.
  std::vector<std::vector<int>> levels = {{32, 32}, {64, 64}};
  int supports = 1;              // per kernel
  int neighbors = 16;            // per convolution, excluding the point itself
  int pool_rate = 4;             // one in this many points continues to the next level
  int pool_neighbors = 4;        // neighbors in each max pooling
  bool global_feature = false;   // append the maximum of the last features over all points to
                                 // every point
  std::vector<int> head = {64};  // widths of the hidden layers after the concatenation
  bool operator==(const NetworkConfig&) const = default;
};

/// Returns the "compact", "small" (the official structure at a quarter of its width) or "official"
/// configuration. Throws Error for other names.
NetworkConfig network_config(const std::string& name);

struct TensorSpec {
  std::string name;        // as in the official state_dict: conv_1.weights, conv1d_block.0.bias
  std::vector<int> shape;  // row-major
};
/// All tensors in network order: conv_0.directions, conv_1.weights, conv_1.bias, conv_1.directions,
/// ..., conv1d_block.0.weight, conv1d_block.0.bias, ...
std::vector<TensorSpec> tensor_specs(const NetworkConfig& config);
std::size_t parameter_count(const NetworkConfig& config);

struct NetworkWeights {
  NetworkConfig config;
  std::vector<std::vector<float>> tensors;  // in the order of tensor_specs(config)
  std::string training = "{}";              // training record, a JSON object
};

/// Throws Error if the file is missing, truncated, larger than specified, inconsistent with itself
/// or its configuration, or contains non-finite values.
NetworkWeights read_weights(const std::filesystem::path& path);
/// Parses the content of a file; `path` appears in error messages only.
NetworkWeights read_weights(std::span<const unsigned char> bytes,
                            const std::filesystem::path& path);
/// Replaces the file atomically.
void write_weights(const std::filesystem::path& path, const NetworkWeights& weights);

}  // namespace planescope::planes
