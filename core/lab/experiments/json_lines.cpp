#include "core/lab/experiments/json_lines.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace planescope::lab {

using Json = nlohmann::ordered_json;

Json run_json(const std::string& schema,
              const std::string& command,
              const report::BuildInfo& build,
              const planes::WeightsRecord& weights) {
  return {{"schema", schema},
          {"command", command},
          {"version", build.version},
          {"commit", build.commit},
          {"modified", build.modified},
          {"weights",
           {{"file", weights.file}, {"sha256", weights.sha256}, {"network", weights.network}}}};
}

std::string json_line(const Json& value) {
  return value.dump(-1, ' ', false, Json::error_handler_t::replace);
}

JsonLines::JsonLines(const Json& facts)
    : text_(facts.dump(1, ' ', false, Json::error_handler_t::replace)) {
  text_.resize(text_.size() - 2);  // its end, "\n}"
}

void JsonLines::add(const std::string& name, const std::vector<std::string>& lines) {
  text_ += fmt::format(",\n \"{}\": [", name);
  const char* before = "\n  ";
  for (const std::string& line : lines) {
    text_ += before + line;
    before = ",\n  ";
  }
  text_ += "\n ]";
}

std::string JsonLines::text() && { return std::move(text_) + "\n}\n"; }

}  // namespace planescope::lab
