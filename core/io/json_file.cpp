#include "core/io/json_file.hpp"

#include <nlohmann/json.hpp>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io {

nlohmann::json read_json_file(const std::filesystem::path& path) {
  const auto bytes = read_file_bytes(path, std::uintmax_t{64} << 20);
  auto json = nlohmann::json::parse(bytes.begin(), bytes.end(), nullptr, false, true);
  if (json.is_discarded()) throw Error(path.string() + ": not valid JSON");
  return json;
}

}  // namespace planescope::io
