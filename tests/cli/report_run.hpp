#pragma once

// Helpers of report tests: the command line, and report.json checked against its schema.

#include <gtest/gtest.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "cli/program.hpp"
#include "support/json_schema.hpp"

namespace planescope::testing_cli {

inline std::vector<std::string> report_args(const std::vector<std::filesystem::path>& inputs,
                                            const std::filesystem::path& out,
                                            const std::vector<std::string>& more) {
  std::vector<std::string> args{"report"};
  for (const auto& input : inputs) args.push_back(input.string());
  args.insert(args.end(), {"-o", out.string()});
  args.insert(args.end(), more.begin(), more.end());
  return args;
}

/// Reads report.json and checks it against its schema.
inline nlohmann::json read_report(const std::filesystem::path& out) {
  const nlohmann::json json = nlohmann::json::parse(read_text(out / "report.json"));
  std::ifstream schema(PLANESCOPE_SOURCE_DIR "/assets/schemas/report.schema.json");
  EXPECT_EQ(schema_error(nlohmann::json::parse(schema), json), "");
  return json;
}

}  // namespace planescope::testing_cli
