#include "core/lab/bench/result_json.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/model/error.hpp"

namespace planescope::lab {

using Json = nlohmann::ordered_json;

namespace {

std::string dumped(const Json& value, int indent) {
  return value.dump(indent, ' ', false, Json::error_handler_t::replace);
}

Simd parse_simd(const std::string& text) {
  for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512})
    if (to_string(simd) == text) return simd;
  throw Error("instruction set '" + text + "' is not known");
}

}  // namespace

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

void read_run(const nlohmann::json& json,
              std::string& command,
              report::BuildInfo& build,
              planes::WeightsRecord& weights) {
  command = json.at("command");
  build = {json.at("version"), json.at("commit"), json.at("modified")};
  const auto& network = json.at("weights");
  weights = {network.at("file"), network.at("sha256"), network.at("network"), ""};
}

Json machine_json(const Machine& machine) {
  return {{"cpu", machine.cpu}, {"cores", machine.cores}, {"simd", to_string(machine.simd)}};
}

Machine read_machine(const nlohmann::json& json) {
  return {json.at("cpu"), json.at("cores"), parse_simd(json.at("simd"))};
}

std::string json_line(const Json& value) { return dumped(value, -1); }

std::string json_text(const Json& value) { return dumped(value, 1) + "\n"; }

JsonLines::JsonLines(const Json& facts) : text_(dumped(facts, 1)) {
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
