#pragma once

// JSON that is an object of facts, then lists with one line for each value, so that two runs are
// easily compared. Internal to core/lab/experiments.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/lab/experiments/results.hpp"

namespace planescope::lab {

/// What measured: the facts that every such file begins with.
nlohmann::ordered_json run_json(const std::string& schema,
                                const std::string& command,
                                const report::BuildInfo& build,
                                const planes::WeightsRecord& weights);

/// A value as its line; what is not UTF-8 is replaced.
std::string json_line(const nlohmann::ordered_json& value);

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
