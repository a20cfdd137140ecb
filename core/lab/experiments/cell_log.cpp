#include "core/lab/experiments/cell_log.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::lab {
namespace {

using Json = nlohmann::ordered_json;

/// Everything that must agree for cells to belong to one run.
Json identity_of(const PaperResults& run) {
  return {{"schema", "planescope.paper.cells/1"},
          {"seed", run.seed},
          {"tuning_seed", run.tuning_seed},
          {"quick", run.quick},
          {"count", run.count},
          {"weights", run.weights.sha256},
          {"version", run.build.version},
          {"commit", run.build.commit},
          {"modified", run.build.modified}};
}

void check_same_run(const std::string& line, const Json& expected, const std::string& file) {
  const Json found = Json::parse(line, nullptr, false);
  if (!found.is_object()) throw Error(file + ": its first line does not tell a run");
  for (const auto& [name, value] : expected.items()) {
    const Json other = found.value(name, Json());
    if (other != value)
      throw Error(
          fmt::format("{}: is of a run with {} {}, expected {}; give another -o, or remove "
                      "the file",
                      file, name, other.dump(), value.dump()));
  }
}

/// The lines that were written completely.
std::vector<std::string> whole_lines(const std::filesystem::path& file) {
  const auto bytes = read_file_bytes(file);
  std::vector<std::string> lines;
  auto begin = bytes.begin();
  for (auto it = bytes.begin(); it != bytes.end(); ++it) {
    if (*it != '\n') continue;
    lines.emplace_back(begin, it);
    begin = it + 1;
  }
  return lines;
}

}  // namespace

CellLog::CellLog(const std::filesystem::path& dir, const PaperResults& run, bool resume)
    : file_(dir / "cells.jsonl") {
  const Json identity = identity_of(run);
  std::vector<std::string> lines;
  if (std::filesystem::exists(file_)) {
    if (!resume)
      throw Error(
          fmt::format("{}: holds a run that is not done, go on with it by --resume or give "
                      "another -o",
                      dir.string()));
    lines = whole_lines(file_);
    if (!lines.empty()) check_same_run(lines[0], identity, file_.string());
  }
  for (std::size_t i = 1; i < lines.size(); ++i) {
    try {
      cells_.push_back(parse_cell(lines[i]));
    } catch (const Error& error) {
      throw Error(fmt::format("{}, line {}: {}", file_.string(), i + 1, error.what()));
    }
  }
  // Rewritten without a line that was cut off.
  std::string text = identity.dump() + "\n";
  for (const Cell& cell : cells_) text += cell_line(cell) + "\n";
  write_file_text(file_, text, Durable::yes);
}

void CellLog::append(std::span<const Cell> cells) {
  std::ofstream file(file_, std::ios::app | std::ios::binary);
  for (const Cell& cell : cells) file << cell_line(cell) << '\n';
  file.flush();
  if (!file) throw Error(file_.string() + ": not all of it could be written (disk full?)");
  cells_.insert(cells_.end(), cells.begin(), cells.end());
}

void CellLog::finish() {
  std::error_code ignored;
  std::filesystem::remove(file_, ignored);
}

}  // namespace planescope::lab
