#include "core/lab/experiments/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <concepts>
#include <fstream>
#include <nlohmann/json.hpp>
#include <string_view>

#include "core/lab/bench/result_json.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::lab {

const Cell* PaperResults::find(const CellKey& key) const {
  const auto found = std::ranges::find(cells, key, &Cell::key);
  return found != cells.end() ? &*found : nullptr;
}

std::string to_text(const report::BuildInfo& build) {
  return fmt::format("planescope {}, commit {}{}", build.version, build.commit,
                     build.modified ? " with changes" : "");
}

std::string to_text(const planes::WeightsRecord& weights) {
  return fmt::format("{} ({}), SHA-256 {}", weights.file, weights.network, weights.sha256);
}

// ---- The fields of each document, told once for writing and reading ----

namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kResultsSchema = "planescope.paper/1";
constexpr const char* kTimingsSchema = "planescope.paper.timings/1";

template <typename Type, typename Document>
concept Is = std::same_as<std::remove_const_t<Type>, Document>;

void visit_fields(Is<CellKey> auto& key, auto&& fields) {
  fields("set", key.set);
  fields.optional("seed", key.seed, key.seed != 0);
  fields.optional("points", key.points, key.points != 0);
  fields.optional("noise_cm", key.noise_cm, key.points != 0);
  fields.optional("errors", key.errors, !key.errors.empty());
  fields.optional("method", key.method, !key.method.empty());
  fields.optional("profile", key.profile, !key.profile.empty());
  fields.optional("classifier", key.classifier, !key.classifier.empty());
  fields.optional("setting", key.setting, !key.setting.empty());
}

void visit_fields(Is<Cell> auto& cell, auto&& fields) {
  fields.nested("key", cell.key);
  fields("frames", cell.frames);
  planes::visit_values(cell.metrics, [&](const char* name, auto& value) {
    if constexpr (std::floating_point<std::remove_cvref_t<decltype(value)>>)
      if (std::string_view(name).starts_with("label_accuracy"))
        return fields.optional(name, value, !std::isnan(value), std::nan(""));  // without labels
    if (planes::is_late_value(name))
      fields.optional(name, value, true);
    else
      fields(name, value);
  });
}

void visit_fields(Is<RealRow> auto& row, auto&& fields) {
  fields("recording", row.recording);
  fields("frames", row.frames);
  fields("refused", row.refused);
  fields("n_m", row.n_m);
  fields("n_d", row.n_d);
  fields("planes", row.planes);
}

void visit_fields(Is<ClassifierTiming> auto& timing, auto&& fields) {
  fields("classifier", timing.classifier);
  fields("points", timing.points);
  fields("threads", timing.threads);
  fields("median_ms", timing.median_ms);
}

void visit_fields(Is<RealTiming> auto& timing, auto&& fields) {
  fields("recording", timing.recording);
  fields("frames", timing.frames);
  fields("t_d_ms", timing.t_d_ms);
  fields("t_c_ms", timing.t_c_ms);
  fields("t_b_ms", timing.t_b_ms);
  fields("t_s_ms", timing.t_s_ms);
  fields("fps", timing.fps);
}

/// Clouds only: they have no errors of a depth camera.
void visit_fields(Is<MethodTiming> auto& timing, auto&& fields) {
  fields("set", timing.key.set);
  fields("seed", timing.key.seed);
  fields("points", timing.key.points);
  fields("noise_cm", timing.key.noise_cm);
  fields("method", timing.key.method);
  fields("profile", timing.key.profile);
  fields("classifier", timing.key.classifier);
  fields("setting", timing.key.setting);
  fields("fps", timing.fps);
}

struct Writer {
  Json json;

  void operator()(const char* name, const auto& value) { json[name] = value; }
  template <typename Value>
  void optional(const char* name, const Value& value, bool is_written, const Value& = {}) {
    if (is_written) json[name] = value;
  }
  void nested(const char* name, const auto& document) {
    Writer inner;
    visit_fields(document, inner);
    json[name] = std::move(inner.json);
  }
};

/// Throws nlohmann's exceptions where a field is missing or of another type.
struct Reader {
  const nlohmann::json& json;

  void operator()(const char* name, auto& value) const { json.at(name).get_to(value); }
  template <typename Value>
  void optional(const char* name, Value& value, bool, const Value& missing = {}) const {
    value = json.value(name, missing);
  }
  void nested(const char* name, auto& document) const {
    visit_fields(document, Reader{json.at(name)});
  }
};

Json json_of(const auto& document) {
  Writer writer;
  visit_fields(document, writer);
  return std::move(writer.json);
}

template <typename Document>
Json list_of(const std::vector<Document>& documents) {
  Json list = Json::array();
  for (const Document& document : documents) list.push_back(json_of(document));
  return list;
}

template <typename Document>
void read_list(const nlohmann::json& json, std::vector<Document>& documents) {
  for (const auto& entry : json) visit_fields(documents.emplace_back(), Reader{entry});
}

void check_cell(const Cell& cell) {
  constexpr int kMaxFrames = 1'000'000;
  if (cell.frames < 1 || cell.frames > kMaxFrames)
    throw Error(fmt::format("a cell of {} frames, expected 1 to {}", cell.frames, kMaxFrames));
}

template <typename Document>
std::vector<std::string> lines_of(const std::vector<Document>& documents) {
  std::vector<std::string> lines;
  for (const Document& document : documents) lines.push_back(json_line(json_of(document)));
  return lines;
}

/// `read(json)` makes it of a file's content. Throws Error where the file is no such document.
template <typename Read>
auto read_document(const std::filesystem::path& file,
                   const char* expected_schema,
                   const char* expected,
                   const Read& read) {
  const nlohmann::json json = read_json<nlohmann::json>(file);
  try {
    const std::string schema = json.at("schema");
    if (schema != expected_schema)
      throw Error(
          fmt::format("{}: schema is '{}', expected '{}'", file.string(), schema, expected_schema));
    return read(json);
  } catch (const nlohmann::json::exception& error) {
    throw Error(fmt::format("{}: {}, expected {}", file.string(), error.what(), expected));
  }
}

}  // namespace

// ---- Files ----

void write_results(const std::filesystem::path& dir, const PaperResults& results) {
  Json facts = run_json(kResultsSchema, results.command, results.build, results.weights);
  facts["seed"] = results.seed;
  facts["tuning_seed"] = results.tuning_seed;
  facts["quick"] = results.quick;
  facts["count"] = results.count;
  JsonLines json(facts);
  json.add("real", lines_of(results.real));
  json.add("cells", lines_of(results.cells));
  write_file_text(dir / "paper.json", std::move(json).text());
}

PaperResults read_results(const std::filesystem::path& dir) {
  const auto read = [](const nlohmann::json& json) {
    PaperResults results;
    read_run(json, results.command, results.build, results.weights);
    json.at("seed").get_to(results.seed);
    json.at("tuning_seed").get_to(results.tuning_seed);
    json.at("quick").get_to(results.quick);
    json.at("count").get_to(results.count);
    read_list(json.at("real"), results.real);
    read_list(json.at("cells"), results.cells);
    std::ranges::for_each(results.cells, check_cell);
    return results;
  };
  return read_document(dir / "paper.json", kResultsSchema, "results of bench paper", read);
}

void write_timings(const std::filesystem::path& dir, const PaperTimings& timings) {
  const Json json = {{"schema", kTimingsSchema},
                     {"command", timings.command},
                     {"machine", machine_json(timings.machine)},
                     {"threads", timings.threads},
                     {"classifiers", list_of(timings.classifiers)},
                     {"real", list_of(timings.real)},
                     {"methods", list_of(timings.methods)}};
  write_file_text(dir / "paper.timings.json", json_text(json));
}

PaperTimings read_timings(const std::filesystem::path& dir) {
  const auto read = [](const nlohmann::json& json) {
    PaperTimings timings;
    timings.command = json.at("command");
    timings.machine = read_machine(json.at("machine"));
    timings.threads = json.at("threads");
    read_list(json.at("classifiers"), timings.classifiers);
    read_list(json.at("real"), timings.real);
    read_list(json.at("methods"), timings.methods);
    return timings;
  };
  return read_document(dir / "paper.timings.json", kTimingsSchema, "timings of bench paper", read);
}

std::string cell_line(const Cell& cell) { return json_line(json_of(cell)); }

Cell parse_cell(const std::string& line) {
  try {
    const nlohmann::json json = parse_json<nlohmann::json>(line, "a cell");
    Cell cell;
    visit_fields(cell, Reader{json});
    check_cell(cell);
    return cell;
  } catch (const nlohmann::json::exception& error) {
    throw Error(std::string("not a cell: ") + error.what());
  }
}

// ---- Cells as they are measured ----

namespace {

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
  const auto found = parse_json<Json>(line, file + ": its first line");
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
