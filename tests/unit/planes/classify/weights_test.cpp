// Tests of network weights files: layout, compatibility and damaged files.

#include "core/planes/classify/weights.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <nlohmann/json.hpp>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "support/temp_dir.hpp"

namespace planescope::planes {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;
using Bytes = std::vector<unsigned char>;

fs::path scratch_file() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const fs::path dir = temp_dir() / "planescope_weights" / test->name();
  fs::remove_all(dir);
  fs::create_directories(dir);
  return dir / "net.safetensors";
}

NetworkConfig tiny_config() {
  return {
      .name = "tiny", .levels = {{2, 3}, {4}}, .neighbors = 5, .global_feature = true, .head = {3}};
}

std::size_t size_of(const TensorSpec& spec) {
  std::size_t size = 1;
  for (const int extent : spec.shape) size *= static_cast<std::size_t>(extent);
  return size;
}

/// A value that identifies the tensor and the position in it.
float value_at(const std::string& tensor, std::size_t index) {
  float sum = 0;
  for (const char c : tensor) sum = 3 * sum + static_cast<float>(c - '.');
  return sum / 1024 + static_cast<float>(index);
}

NetworkWeights make_weights(const NetworkConfig& config) {
  NetworkWeights weights;
  weights.config = config;
  weights.training = R"({"recipe":"none","seed":1})";
  for (const TensorSpec& spec : tensor_specs(config)) {
    auto& tensor = weights.tensors.emplace_back(size_of(spec));
    for (std::size_t i = 0; i < tensor.size(); ++i) tensor[i] = value_at(spec.name, i);
  }
  return weights;
}

bool same_bits(const NetworkWeights& a, const NetworkWeights& b) {
  if (a.config != b.config || a.training != b.training || a.tensors.size() != b.tensors.size())
    return false;
  for (std::size_t i = 0; i < a.tensors.size(); ++i)
    if (a.tensors[i].size() != b.tensors[i].size() ||
        std::memcmp(a.tensors[i].data(), b.tensors[i].data(),
                    a.tensors[i].size() * sizeof(float)) != 0)
      return false;
  return true;
}

void write_anew(const fs::path& path, const Bytes& bytes) {
  fs::remove(path);
  write_file_bytes(path, bytes);
}

std::string error_of(const fs::path& path) {
  try {
    read_weights(path);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

Bytes file_of(const std::string& header, const Bytes& data) {
  Bytes bytes;
  for (int i = 0; i < 8; ++i)
    bytes.push_back(static_cast<unsigned char>(header.size() >> (8 * i) & 255));
  bytes.insert(bytes.end(), header.begin(), header.end());
  bytes.insert(bytes.end(), data.begin(), data.end());
  return bytes;
}

/// Parts of a weights file, for tests that assemble them incorrectly.
struct Parts {
  Json header;
  Bytes data;
};

Parts tiny_parts(const fs::path& path) {
  write_weights(path, make_weights(tiny_config()));
  const Bytes bytes = read_file_bytes(path);
  std::uint64_t length = 0;
  std::memcpy(&length, bytes.data(), 8);
  const auto data = bytes.begin() + 8 + static_cast<std::ptrdiff_t>(length);
  return {Json::parse(bytes.begin() + 8, data), Bytes(data, bytes.end())};
}

std::string error_after(const std::function<void(Parts&)>& change) {
  const fs::path path = scratch_file();
  Parts parts = tiny_parts(path);
  change(parts);
  write_anew(path, file_of(parts.header.dump(), parts.data));
  const std::string error = error_of(path);
  EXPECT_TRUE(error.starts_with(path.string() + ": ")) << error;
  EXPECT_EQ(error.find('\n'), std::string::npos) << error;
  return error;
}

std::string error_after_config(const std::function<void(Json&)>& change) {
  return error_after([&](Parts& parts) {
    Json config = Json::parse(parts.header["__metadata__"]["config"].get<std::string>());
    change(config);
    parts.header["__metadata__"]["config"] = config.dump();
  });
}

bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

TEST(NetworkConfigs, HaveTheDocumentedParameterCounts) {
  EXPECT_EQ(parameter_count(network_config("official")), 1679362U);
  EXPECT_EQ(parameter_count(network_config("small")), 106498U);
  EXPECT_EQ(parameter_count(network_config("compact")), 27714U);
  EXPECT_THROW(network_config("huge"), Error);
}

TEST(Weights, AreReadBackExactly) {
  const fs::path path = scratch_file();
  for (const NetworkConfig& config : {tiny_config(), network_config("compact")}) {
    NetworkWeights weights = make_weights(config);
    weights.tensors[0][0] = -0.0F;
    weights.tensors[0][1] = std::numeric_limits<float>::denorm_min();
    weights.training = "{ \"note\" : \"caf\u00e9 \\\"quoted\\\"\" }";
    write_weights(path, weights);
    EXPECT_TRUE(same_bits(read_weights(path), weights)) << config.name;
  }
}

TEST(Weights, AreWrittenReproduciblyWithAlignedData) {
  const fs::path path = scratch_file();
  write_weights(path, make_weights(tiny_config()));
  const Bytes first = read_file_bytes(path);
  write_weights(path, make_weights(tiny_config()));
  EXPECT_EQ(read_file_bytes(path), first);
  EXPECT_EQ(first[0] % 8, 0);
  EXPECT_EQ(std::distance(fs::directory_iterator(path.parent_path()), {}), 1);  // no other files
}

TEST(Weights, ThatCannotBeWrittenKeepTheOldOnes) {
  const fs::path path = scratch_file();
  fs::create_directories(path / "in the way");
  EXPECT_THROW(write_weights(path, make_weights(tiny_config())), Error);
  EXPECT_TRUE(fs::exists(path / "in the way"));
  EXPECT_EQ(std::distance(fs::directory_iterator(path.parent_path()), {}), 1);
}

// Output of safetensors.torch.save_file(model.state_dict(), path, metadata) with the official code:
// metadata first and unordered, tensors by name, offsets last, padded with spaces to 8 bytes.
TEST(Weights, OfTheOfficialPyTorchCodeLoad) {
  struct Saved {
    const char* name;
    std::vector<int> shape;
  };
  const std::vector<Saved> state_dict = {
      {"conv1d_block.0.bias", {512}},  {"conv1d_block.0.weight", {512, 1792, 1}},
      {"conv1d_block.2.bias", {512}},  {"conv1d_block.2.weight", {512, 512, 1}},
      {"conv1d_block.4.bias", {2}},    {"conv1d_block.4.weight", {2, 512, 1}},
      {"conv_0.directions", {3, 128}}, {"conv_1.bias", {256}},
      {"conv_1.directions", {3, 128}}, {"conv_1.weights", {128, 256}},
      {"conv_2.bias", {512}},          {"conv_2.directions", {3, 256}},
      {"conv_2.weights", {128, 512}},  {"conv_3.bias", {512}},
      {"conv_3.directions", {3, 256}}, {"conv_3.weights", {256, 512}},
      {"conv_4.bias", {1024}},         {"conv_4.directions", {3, 512}},
      {"conv_4.weights", {256, 1024}}};
  std::string header =
      R"({"__metadata__":{"version":"1","config":"{\"name\": \"official\", )"
      R"(\"levels\": [[128, 128], [256, 256], [512]], \"supports\": 1, \"neighbours\": 50, )"
      R"(\"pool_rate\": 4, \"pool_neighbours\": 4, \"global_feature\": true, )"
      R"(\"head\": [512, 512]}","format":"planescope-classifier"})";
  Bytes data;
  for (const Saved& saved : state_dict) {
    const std::size_t count = size_of({saved.name, saved.shape}), begin = data.size();
    for (std::size_t i = 0; i < count; ++i) {
      const auto bits = std::bit_cast<std::uint32_t>(value_at(saved.name, i));
      for (int byte = 0; byte < 4; ++byte)
        data.push_back(static_cast<unsigned char>(bits >> (8 * byte) & 255));
    }
    const Json entry = {
        {"dtype", "F32"}, {"shape", saved.shape}, {"data_offsets", {begin, data.size()}}};
    header += std::string(",\"") + saved.name + "\":" + entry.dump();
  }
  header += "}";
  while (header.size() % 8 != 0) header += ' ';

  const fs::path path = scratch_file();
  write_anew(path, file_of(header, data));
  const NetworkWeights weights = read_weights(path);
  EXPECT_EQ(weights.config, network_config("official"));
  EXPECT_EQ(weights.training, "{}");
  const std::vector<TensorSpec> specs = tensor_specs(weights.config);
  ASSERT_EQ(weights.tensors.size(), specs.size());
  for (std::size_t k = 0; k < specs.size(); ++k) {
    ASSERT_EQ(weights.tensors[k].size(), size_of(specs[k]));
    for (std::size_t i = 0; i < weights.tensors[k].size(); ++i)
      ASSERT_EQ(weights.tensors[k][i], value_at(specs[k].name, i)) << specs[k].name << " " << i;
  }
}

TEST(DamagedWeights, TruncatedAnywhereAreRejected) {
  const fs::path path = scratch_file();
  write_weights(path, make_weights(tiny_config()));
  const Bytes whole = read_file_bytes(path);
  for (std::size_t size = 0; size < whole.size(); size += 7) {
    write_anew(path, Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(size)));
    EXPECT_TRUE(error_of(path).starts_with(path.string() + ": ")) << size;
  }
}

TEST(DamagedWeights, WithAnyByteChangedAreRejectedOrStillValid) {
  const fs::path path = scratch_file();
  write_weights(path, make_weights(tiny_config()));
  const Bytes whole = read_file_bytes(path);
  for (std::size_t at = 0; at < whole.size(); ++at) {
    for (const unsigned mask : {0x01U, 0x10U, 0x80U}) {
      Bytes damaged = whole;
      damaged[at] = static_cast<unsigned char>(damaged[at] ^ mask);
      write_anew(path, damaged);
      try {
        const NetworkWeights read = read_weights(path);
        const std::vector<TensorSpec> specs = tensor_specs(read.config);
        ASSERT_EQ(read.tensors.size(), specs.size());
        for (std::size_t k = 0; k < specs.size(); ++k)
          ASSERT_EQ(read.tensors[k].size(), size_of(specs[k])) << at;
      } catch (const Error& error) {
        ASSERT_TRUE(std::string(error.what()).starts_with(path.string() + ": ")) << error.what();
      }
    }
  }
}

TEST(DamagedWeights, ThatAreMissingOrAFolderAreReported) {
  const fs::path path = scratch_file();
  EXPECT_TRUE(has(error_of(path), "no such file"));
  EXPECT_TRUE(has(error_of(path.parent_path()), path.parent_path().string()));
}

TEST(DamagedWeights, WithAWrongHeaderLengthAreRejected) {
  const fs::path path = scratch_file();
  const Parts parts = tiny_parts(path);
  for (const std::uint64_t length : {std::uint64_t{1} << 24 | 1, std::uint64_t{0} - 1,
                                     std::uint64_t{0} - 8, std::uint64_t{1} << 63}) {
    Bytes bytes = file_of(parts.header.dump(), parts.data);
    std::memcpy(bytes.data(), &length, 8);
    write_anew(path, bytes);
    EXPECT_TRUE(has(error_of(path), std::to_string(length) + "-byte header")) << error_of(path);
  }
}

TEST(DamagedWeights, WithAHeaderThatIsNotAnObjectOrTooDeepAreRejected) {
  const fs::path path = scratch_file();
  const std::string deep(1 << 20, '[');
  for (const std::string& header :
       {std::string(), std::string("[]"), std::string("{\"a\":"), deep,
        std::string("{\"a\":1,\"a\":2}"), std::string("{\"\xff\":1}")}) {
    write_anew(path, file_of(header, {}));
    EXPECT_TRUE(has(error_of(path), "header")) << error_of(path);
  }
}

TEST(DamagedWeights, WithWrongTensorOffsetsAreRejected) {
  const auto offsets = [](Json begin, Json end) {
    return error_after([&](Parts& parts) {
      parts.header["conv_0.directions"]["data_offsets"] = {begin, end};
    });
  };
  const std::uint64_t huge = std::uint64_t{0} - 4;
  EXPECT_TRUE(has(offsets(0, 4), "conv_0.directions"));  // overlaps another
  EXPECT_TRUE(has(offsets(-4, 20), "data_offsets"));     // negative
  EXPECT_TRUE(has(offsets(24, 0), "data_offsets"));      // backwards
  EXPECT_TRUE(has(offsets(0.5, 24), "data_offsets"));    // not an integer
  EXPECT_TRUE(has(offsets(huge, huge + 3), "begins at byte"));
  EXPECT_TRUE(
      has(error_after([](Parts& parts) { parts.data.pop_back(); }), "the file is truncated"));
  EXPECT_TRUE(has(error_after([](Parts& parts) { parts.data.push_back(0); }), "bytes of data"));
  EXPECT_TRUE(has(error_after([](Parts& parts) { parts.header["conv_0.directions"] = 1; }),
                  "\"conv_0.directions\" is 1; expected an object"));
}

TEST(DamagedWeights, WithWrongShapesAreRejected) {
  const auto shape = [](const Json& extents) {
    return error_after([&](Parts& parts) { parts.header["conv_0.directions"]["shape"] = extents; });
  };
  EXPECT_TRUE(has(shape({3, 3}), "do not match shape"));
  EXPECT_TRUE(has(shape({2, 3}), "requires [3, 2]"));
  EXPECT_TRUE(has(shape({6}), "requires [3, 2]"));
  // 2^64 + 24 bytes, and a tensor with a huge dimension but no elements.
  EXPECT_TRUE(has(shape({std::uint64_t{1} << 61, 2, 6}), "do not match shape"));
  EXPECT_TRUE(has(shape({0, std::uint64_t{0} - 1}), "do not match shape"));
  EXPECT_TRUE(has(shape({-3, -2}), "shape[0] is -3; expected a nonnegative whole number"));
  EXPECT_TRUE(has(shape("3x2"), "shape is \"3x2\"; expected a list"));
}

TEST(DamagedWeights, OfOtherTypesOrTensorsAreRejected) {
  EXPECT_TRUE(has(error_after([](Parts& parts) { parts.header["conv_1.bias"]["dtype"] = "F16"; }),
                  R"("conv_1.bias".dtype is "F16"; expected one of F32)"));
  EXPECT_TRUE(has(error_after([](Parts& parts) {
                    const Json moved = parts.header["conv_1.bias"];
                    parts.header.erase("conv_1.bias");
                    parts.header["conv_9.bias"] = moved;
                  }),
                  "tensor conv_1.bias is missing"));
  EXPECT_TRUE(has(error_after([](Parts& parts) {
                    parts.header["extra\n"] = {
                        {"dtype", "F32"},
                        {"shape", {1}},
                        {"data_offsets", {parts.data.size(), parts.data.size() + 4}}};
                    parts.data.resize(parts.data.size() + 4);
                  }),
                  R"(tensor "extra\n" is not part of its configuration)"));
}

TEST(DamagedWeights, ThatAreNotFiniteAreRejected) {
  for (const std::uint32_t bits : {0x7F800000U, 0xFF800000U, 0x7FC00000U})
    EXPECT_TRUE(has(error_after([&](Parts& parts) { std::memcpy(&parts.data[4], &bits, 4); }),
                    "value 1 is"));
}

TEST(DamagedWeights, WithoutOurMetadataReportWhatToAdd) {
  EXPECT_TRUE(
      has(error_after([](Parts& parts) { parts.header.erase("__metadata__"); }), "no 'format'"));
  for (const char* key : {"format", "version", "config"})
    EXPECT_TRUE(
        has(error_after([&](Parts& parts) { parts.header["__metadata__"].erase(key); }), key));
  EXPECT_TRUE(has(error_after([](Parts& parts) { parts.header["__metadata__"]["format"] = "pt"; }),
                  R"(format "pt"; expected "planescope-classifier")"));
  EXPECT_TRUE(has(error_after([](Parts& parts) { parts.header["__metadata__"]["version"] = "2"; }),
                  R"(version "2"; expected "1")"));
  EXPECT_TRUE(has(error_after([](Parts& parts) { parts.header["__metadata__"]["version"] = 1; }),
                  R"(metadata "version" is 1; expected text)"));
  EXPECT_TRUE(has(error_after([](Parts& parts) { parts.header["__metadata__"] = "all"; }),
                  R"(__metadata__ is "all"; expected an object)"));
  EXPECT_TRUE(has(error_after([](Parts& parts) { parts.header["__metadata__"]["training"] = "3"; }),
                  "training record is not a JSON object"));
}

TEST(DamagedWeights, WithAnAbsurdConfigurationAreRejected) {
  const auto set = [](const char* key, const Json& value) {
    return error_after_config([&](Json& config) { config[key] = value; });
  };
  EXPECT_TRUE(has(set("levels", Json::parse("[[2,5000],[4]]")),
                  "levels[0][1] is 5000; expected a whole number from 1 to 4096"));
  EXPECT_TRUE(
      has(set("levels", Json::parse("[[2,3],[]]")), "levels[1] is []; expected 1 to 8 layers"));
  EXPECT_TRUE(has(set("levels", Json::array()), "levels is []; expected 1 to 8 levels"));
  EXPECT_TRUE(
      has(set("levels", Json(std::vector<std::vector<int>>(9, {2}))), "expected 1 to 8 levels"));
  EXPECT_TRUE(has(set("levels", 3), "levels is 3; expected a list"));
  EXPECT_TRUE(has(set("head", Json::parse("[3.5]")), "head[0] is 3.5; expected"));
  EXPECT_TRUE(has(set("supports", 17), "supports is 17; expected a whole number from 1 to 16"));
  EXPECT_TRUE(has(set("neighbours", 0), "neighbours is 0; expected a whole number from 1 to 1024"));
  EXPECT_TRUE(has(set("neighbours", std::uint64_t{0} - 1), "neighbours is 18446744073709551615"));
  EXPECT_TRUE(has(set("pool_rate", 1), "pool_rate is 1; expected a whole number from 2 to 64"));
  EXPECT_TRUE(has(set("pool_neighbours", "4"), R"(pool_neighbours is "4"; expected)"));
  EXPECT_TRUE(has(set("global_feature", 1), "global_feature is 1; expected true or false"));
  EXPECT_TRUE(has(set("name", 1), "name is 1; expected text"));
  EXPECT_TRUE(has(set("dropout", 1), "has an unknown key, \"dropout\"; expected one of name"));
  EXPECT_TRUE(has(error_after_config([](Json& config) { config.erase("supports"); }),
                  R"(has no "supports")"));
  // does not match the tensors
  EXPECT_TRUE(has(set("levels", Json::parse("[[2,3],[5]]")), "tensor"));
}

}  // namespace
}  // namespace planescope::planes
