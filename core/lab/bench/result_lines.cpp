// Writes the results of an experiment as JSON lines.

#include "core/lab/bench/result_lines.hpp"

#include <nlohmann/json.hpp>

#include "core/model/json.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::lab {

std::string result_line(const char* kind, const nlohmann::ordered_json& fields) {
  nlohmann::ordered_json line = {{"kind", kind}};
  line.update(fields);
  return json_text(line, -1);
}

ResultLines::ResultLines(const std::string& experiment,
                         const std::string& command,
                         const planes::WeightsRecord& weights,
                         const Json& facts) {
  const report::BuildInfo build = report::build_info();
  Json run = {{"experiment", experiment},
              {"command", command},
              {"version", build.version},
              {"commit", build.commit},
              {"modified", build.modified}};
  if (!weights.file.empty())
    run["weights"] = {
        {"file", weights.file}, {"sha256", weights.sha256}, {"network", weights.network}};
  run.update(facts);
  add("run", run);
}

void ResultLines::add(const char* kind, const Json& fields) { text_ += result_line(kind, fields); }

nlohmann::ordered_json with_metrics(nlohmann::ordered_json fields, const planes::Metrics& metrics) {
  planes::visit_values(metrics, [&](const char* name, const auto& value) { fields[name] = value; });
  return fields;
}

nlohmann::ordered_json machine_json(const Machine& machine) {
  return {{"cpu", machine.cpu}, {"cores", machine.cores}, {"simd", to_string(machine.simd)}};
}

}  // namespace planescope::lab
