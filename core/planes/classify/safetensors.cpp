#include "core/planes/classify/safetensors.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <bit>
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
#include "core/model/json.hpp"

namespace planescope::planes {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

static_assert(std::endian::native == std::endian::little, "tensors are copied as they are");

constexpr std::size_t kLengthBytes = 8;
constexpr std::uint64_t kMaxHeaderBytes = 16 << 20;
constexpr const char* kMetadata = "__metadata__";

/// A tensor as the header tells it, its place checked against nothing yet.
struct Entry {
  std::string name;
  std::vector<std::size_t> shape;
  std::uint64_t begin = 0, end = 0;  // within the data
};

/// nullopt where `json` is no list of counts.
std::optional<std::vector<std::uint64_t>> counts_of(const Json& json) {
  if (!json.is_array()) return std::nullopt;
  std::vector<std::uint64_t> counts;
  for (const Json& value : json) {
    if (!value.is_number_unsigned()) return std::nullopt;
    counts.push_back(value.get<std::uint64_t>());
  }
  return counts;
}

Entry entry_of(const std::string& name, const Json& json, const std::string& what) {
  const auto dtype = json.find("dtype"), shape = json.find("shape"),
             offsets = json.find("data_offsets");
  if (!json.is_object() || dtype == json.end() || shape == json.end() || offsets == json.end())
    throw Error(what + ": expected dtype, shape and data_offsets");
  if (*dtype != "F32")
    throw Error(what + ": dtype " +
                (dtype->is_string() ? shown(dtype->get<std::string>()) : "is no text") +
                ", expected \"F32\"");
  const auto extents = counts_of(*shape), range = counts_of(*offsets);
  if (!extents) throw Error(what + ": its shape is not a list of counts");
  if (!range || range->size() != 2 || (*range)[0] > (*range)[1])
    throw Error(what + ": data_offsets are not its first byte and the one after its last");
  return {name, {extents->begin(), extents->end()}, (*range)[0], (*range)[1]};
}

/// Bytes of a tensor of this shape; nullopt beyond `limit`, however far.
std::optional<std::uint64_t> bytes_of(const std::vector<std::size_t>& shape, std::uint64_t limit) {
  std::uint64_t bytes = sizeof(float);
  if (std::find(shape.begin(), shape.end(), 0) != shape.end()) return 0;
  for (const std::size_t extent : shape) {
    if (extent > limit / bytes) return std::nullopt;
    bytes *= extent;
  }
  return bytes;
}

/// In the order of their data, which they must fill without gap or overlap.
void check_layout(std::vector<Entry>& entries, std::uint64_t data_bytes, const fs::path& path) {
  std::sort(entries.begin(), entries.end(), [](const Entry& a, const Entry& b) {
    return std::tie(a.begin, a.end, a.name) < std::tie(b.begin, b.end, b.name);
  });
  std::uint64_t filled = 0;
  for (const Entry& entry : entries) {
    const std::string what = path.string() + ": tensor " + shown(entry.name);
    if (entry.end > data_bytes)
      throw Error(fmt::format("{} ends at byte {} of the data, which has {}: the file is cut", what,
                              entry.end, data_bytes));
    if (entry.begin != filled)
      throw Error(
          fmt::format("{} begins at byte {} of the data, expected {}", what, entry.begin, filled));
    if (bytes_of(entry.shape, data_bytes) != entry.end - entry.begin)
      throw Error(fmt::format("{} has {} bytes, which is not its shape [{}] in F32", what,
                              entry.end - entry.begin, fmt::join(entry.shape, ", ")));
    filled = entry.end;
  }
  if (filled != data_bytes)
    throw Error(fmt::format("{}: {} bytes of data, its tensors have {}", path.string(), data_bytes,
                            filled));
}

std::map<std::string, std::string> metadata_of(const Json& json, const std::string& what) {
  if (!json.is_object()) throw Error(what + ": __metadata__ is no object");
  std::map<std::string, std::string> metadata;
  for (const auto& [key, value] : json.items()) {
    if (!value.is_string()) throw Error(what + ": metadata " + shown(key) + " is no text");
    metadata[key] = value.get<std::string>();
  }
  return metadata;
}

std::string_view header_of(std::span<const unsigned char> bytes, const fs::path& path) {
  if (bytes.size() < kLengthBytes)
    throw Error(
        fmt::format("{}: {} bytes, expected a safetensors file", path.string(), bytes.size()));
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), kLengthBytes);
  const std::uint64_t most = std::min<std::uint64_t>(bytes.size() - kLengthBytes, kMaxHeaderBytes);
  if (length > most)
    throw Error(
        fmt::format("{}: a header of {} bytes, expected at most {}: cut, or no safetensors "
                    "file",
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

  const std::string what = path.string() + ": header";
  const Json json = parse_json<Json>(header, what);
  if (!json.is_object()) throw Error(what + " is no JSON object");
  TensorFile file;
  std::vector<Entry> entries;
  for (const auto& [name, value] : json.items()) {
    if (name == kMetadata)
      file.metadata = metadata_of(value, what);
    else
      entries.push_back(entry_of(name, value, path.string() + ": tensor " + shown(name)));
  }
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

  nlohmann::ordered_json json;
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

}  // namespace planescope::planes
