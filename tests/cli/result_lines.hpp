#pragma once

// Results of planescope-lab, as lines of JSON.

#include <map>
#include <nlohmann/json.hpp>
#include <sstream>
#include <string>
#include <vector>

#include "cli/program.hpp"

namespace planescope::testing_cli {

/// Groups lines by kind.
inline std::map<std::string, std::vector<nlohmann::json>> results_of(const std::string& text) {
  std::map<std::string, std::vector<nlohmann::json>> results;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    const nlohmann::json json = nlohmann::json::parse(line);
    results[json["kind"]].push_back(json);
  }
  return results;
}

}  // namespace planescope::testing_cli
