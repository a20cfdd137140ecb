// paper.json, "planescope.paper/1": everything but times. A cell stands on one line, so that two
// runs are easily compared.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/io/json_file.hpp"
#include "core/lab/experiments/json_lines.hpp"
#include "core/lab/experiments/results.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::lab {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "planescope.paper/1";

Json json_of(const CellKey& key) {
  Json json = {{"set", key.set}};
  if (key.seed != 0) json["seed"] = key.seed;
  if (key.points != 0) json["points"] = key.points;
  if (key.points != 0) json["noise_cm"] = key.noise_cm;
  for (const auto& [name, text] : {std::pair{"errors", &key.errors},
                                   {"method", &key.method},
                                   {"profile", &key.profile},
                                   {"classifier", &key.classifier},
                                   {"setting", &key.setting}})
    if (!text->empty()) json[name] = *text;
  return json;
}

template <typename AnyJson>
CellKey key_of(const AnyJson& json) {
  CellKey key;
  key.set = json.at("set");
  key.seed = json.value("seed", std::uint64_t{0});
  key.points = json.value("points", 0);
  key.noise_cm = json.value("noise_cm", 0.0);
  key.errors = json.value("errors", "");
  key.method = json.value("method", "");
  key.profile = json.value("profile", "");
  key.classifier = json.value("classifier", "");
  key.setting = json.value("setting", "");
  return key;
}

constexpr int kMaxFrames = 1'000'000;

template <typename AnyJson>
Cell cell_of(const AnyJson& json) {
  Cell cell{key_of(json.at("key")), json.at("frames"), {}};
  if (cell.frames < 1 || cell.frames > kMaxFrames)
    throw Error(fmt::format("a cell of {} frames, expected 1 to {}", cell.frames, kMaxFrames));
  planes::visit_values(cell.metrics, [&](const char* name, auto& value) {
    if (planes::is_late_value(name) && !json.contains(name)) return;
    value = json.at(name).template get<std::remove_reference_t<decltype(value)>>();
  });
  return cell;
}

Json json_of(const RealRow& row) {
  return {{"recording", row.recording},
          {"frames", row.frames},
          {"refused", row.refused},
          {"n_m", row.n_m},
          {"n_d", row.n_d},
          {"planes", row.planes}};
}

}  // namespace

std::string cell_line(const Cell& cell) {
  Json json = {{"key", json_of(cell.key)}, {"frames", cell.frames}};
  planes::visit_values(cell.metrics,
                       [&](const char* name, const auto& value) { json[name] = value; });
  return json.dump();
}

Cell parse_cell(const std::string& line) {
  try {
    return cell_of(Json::parse(line));
  } catch (const Json::exception& error) {
    throw Error(std::string("not a cell: ") + error.what());
  }
}

void write_results(const std::filesystem::path& dir, const PaperResults& results) {
  Json facts = run_json(kSchema, results.command, results.build, results.weights);
  facts["seed"] = results.seed;
  facts["tuning_seed"] = results.tuning_seed;
  facts["quick"] = results.quick;
  facts["count"] = results.count;
  std::vector<std::string> real, cells;
  for (const RealRow& row : results.real) real.push_back(json_line(json_of(row)));
  for (const Cell& cell : results.cells) cells.push_back(cell_line(cell));
  JsonLines json(facts);
  json.add("real", real);
  json.add("cells", cells);
  write_file_text(dir / "paper.json", std::move(json).text());
}

PaperResults read_results(const std::filesystem::path& dir) {
  const std::filesystem::path file = dir / "paper.json";
  const auto json = io::read_json_file(file);
  try {
    const std::string schema = json.at("schema");
    if (schema != kSchema)
      throw Error(fmt::format("{}: schema is '{}', expected '{}'", file.string(), schema, kSchema));
    PaperResults results;
    results.command = json.at("command");
    results.build = {json.at("version"), json.at("commit"), json.at("modified")};
    const auto& weights = json.at("weights");
    results.weights = {weights.at("file"), weights.at("sha256"), weights.at("network"), ""};
    results.seed = json.at("seed");
    results.tuning_seed = json.at("tuning_seed");
    results.quick = json.at("quick");
    results.count = json.at("count");
    for (const auto& row : json.at("real"))
      results.real.push_back({row.at("recording"), row.at("frames"), row.at("refused"),
                              row.at("n_m"), row.at("n_d"), row.at("planes")});
    for (const auto& cell : json.at("cells")) results.cells.push_back(cell_of(cell));
    return results;
  } catch (const nlohmann::json::exception& error) {
    throw Error(
        fmt::format("{}: {}, expected results of bench paper", file.string(), error.what()));
  }
}

}  // namespace planescope::lab
