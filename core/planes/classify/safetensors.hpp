#pragma once

// The safetensors format (github.com/huggingface/safetensors): the header's length as a
// little-endian u64, a JSON header {name: {dtype, shape, data_offsets}, "__metadata__": {text:
// text}}, then the tensors' data without gaps.

#include <cstddef>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <vector>

namespace planescope::planes {

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

}  // namespace planescope::planes
