#pragma once

// What all files of measured results share: their first facts, and JSON with one line for each
// value of a list, so that two runs are easily compared.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/lab/bench/measuring.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::lab {

/// What measured: the facts that a file of results begins with.
nlohmann::ordered_json run_json(const std::string& schema,
                                const std::string& command,
                                const report::BuildInfo& build,
                                const planes::WeightsRecord& weights);
/// The same, back. Throws nlohmann's exceptions where something is missing.
void read_run(const nlohmann::json& json,
              std::string& command,
              report::BuildInfo& build,
              planes::WeightsRecord& weights);

nlohmann::ordered_json machine_json(const Machine& machine);
/// Throws nlohmann's exceptions where something is missing, Error for an unknown instruction set.
Machine read_machine(const nlohmann::json& json);

/// A value as its line, and a whole file indented by one space; what is not UTF-8 is replaced.
std::string json_line(const nlohmann::ordered_json& value);
std::string json_text(const nlohmann::ordered_json& value);

/// A file: an object of facts, then lists with one line for each value.
class JsonLines {
 public:
  explicit JsonLines(const nlohmann::ordered_json& facts);
  /// `lines`: as json_line() makes them.
  void add(const std::string& name, const std::vector<std::string>& lines);
  std::string text() &&;

 private:
  std::string text_;
};

}  // namespace planescope::lab
