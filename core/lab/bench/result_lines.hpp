#pragma once

// The numbers of an experiment as JSON lines: the first tells the run, each of the others one
// measurement. scripts/typeset makes tables, plots and documents of them.

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "core/lab/bench/measuring.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

class ResultLines {
 public:
  using Json = nlohmann::ordered_json;

  /// `command` measures the same again; `weights`: of the network, an empty file where there is
  /// none; `facts`: more members of the first line.
  ResultLines(const std::string& experiment,
              const std::string& command,
              const planes::WeightsRecord& weights,
              const Json& facts);

  /// {"kind": kind, ...fields}.
  void add(const char* kind, const Json& fields);
  /// Lines that are there already.
  void append(const std::string& lines) { text_ += lines; }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

/// One line of JSON with its end. What is not UTF-8 is replaced.
std::string result_line(const char* kind, const nlohmann::ordered_json& fields);

/// `fields` and all values of the metrics, NaN as null.
nlohmann::ordered_json with_metrics(nlohmann::ordered_json fields, const planes::Metrics& metrics);

nlohmann::ordered_json machine_json(const Machine& machine);

}  // namespace planescope::lab
