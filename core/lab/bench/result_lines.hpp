#pragma once

// The numbers of an experiment as JSON lines: the first describes the run, each other line one
// measurement. scripts/typeset makes tables, plots and documents from them.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/lab/bench/measuring.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

class ResultLines {
 public:
  using Json = nlohmann::ordered_json;

  /// `command` reproduces the measurement; `weights`: of the network, with an empty file if there
  /// is none; `facts`: more members of the first line.
  ResultLines(const std::string& experiment,
              const std::string& command,
              const planes::WeightsRecord& weights,
              const Json& facts);

  /// {"kind": kind, ...fields}.
  void add(const char* kind, const Json& fields);
  /// Appends existing lines.
  void append(const std::string& lines) { text_ += lines; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// One line of JSON including its line end. Replaces invalid UTF-8.
std::string result_line(const char* kind, const nlohmann::ordered_json& fields);

/// `fields` and all values of the metrics, NaN as null.
nlohmann::ordered_json with_metrics(nlohmann::ordered_json fields, const planes::Metrics& metrics);

nlohmann::ordered_json machine_json(const Machine& machine);

}  // namespace planescope::lab
