#include "core/lab/tuning/tuning_journal.hpp"

#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"

namespace planescope::lab {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kJournalSchema = "planescope.tuning-journal/1";

/// Whole lines; a last one that was cut is taken off the file.
std::vector<std::string> whole_lines(const fs::path& file) {
  std::vector<std::string> lines;
  std::uintmax_t bytes = 0;
  {
    std::ifstream in = open_to_read(file);
    for (std::string line; std::getline(in, line) && !in.eof(); bytes += line.size() + 1)
      lines.push_back(line);
  }
  std::error_code failed;
  if (fs::file_size(file) != bytes) fs::resize_file(file, bytes, failed);
  if (failed) throw Error(file.string() + ": cannot be written: " + failed.message());
  return lines;
}

void append(const fs::path& file, const Json& json) {
  std::ofstream out(file, std::ios::app | std::ios::binary);
  out << json.dump() + '\n' << std::flush;
  if (!out) throw Error(file.string() + ": cannot be written");
}

Json purpose_json(const TuningPurpose& purpose) {
  Json json;
  json["schema"] = kJournalSchema;
  for (const auto& [name, value] : purpose) json[name] = value;
  return json;
}

Trial trial_of(const Json& json) {
  Trial trial;
  trial.setting = json.at("set").get<Setting>();
  trial.scores = json.at("scores").get<std::vector<double>>();
  return trial;
}

}  // namespace

TuningJournal::TuningJournal(const fs::path& dir, const TuningPurpose& purpose)
    : file_(dir / "journal.jsonl"), times_file_(dir / "times.jsonl") {
  const bool begun = fs::exists(file_) && read(purpose);
  if (!begun) append(file_, purpose_json(purpose));
  if (begun && fs::exists(times_file_)) read_times();
}

bool TuningJournal::read(const TuningPurpose& purpose) {
  const std::vector<std::string> lines = whole_lines(file_);
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const std::string where = fmt::format("{}, line {}", file_.string(), i + 1);
    const auto json = parse_json<Json>(lines[i], where);
    try {
      if (i > 0) {
        Trial trial = trial_of(json);
        if (!trials_.empty() && trial.scores.size() != trials_[0].scores.size())
          throw Error(fmt::format("{}: found {} scores, expected {}", where, trial.scores.size(),
                                  trials_[0].scores.size()));
        place_.emplace(trial.setting, trials_.size());
        trials_.push_back(std::move(trial));
      } else {
        if (json.at("schema") != kJournalSchema)
          throw Error(fmt::format("{}: its schema is not {}", where, kJournalSchema));
        for (const auto& [name, value] : purpose)
          if (json.at(name) != value)
            throw Error(fmt::format(
                "{}: is of a search with other {}: take another folder, or remove it to begin anew",
                file_.string(), name));
      }
    } catch (const Json::exception& problem) {
      throw Error(where + ": is no trial that can be read: " + json_problem(problem));
    }
  }
  return !lines.empty();
}

/// Times are of no account: what cannot be read of them is not known.
void TuningJournal::read_times() {
  for (const std::string& line : whole_lines(times_file_)) {
    const Json json = Json::parse(line, nullptr, false);
    if (!json.is_object() || !json.contains("trial") || !json.contains("ms")) continue;
    if (json["trial"].is_number_unsigned() && json["ms"].is_number())
      ms_[json["trial"].get<std::size_t>()] = json["ms"].get<double>();
  }
}

std::optional<Trial> TuningJournal::find(const Setting& setting) const {
  const auto at = place_.find(setting);
  if (at == place_.end()) return std::nullopt;
  return trials_[at->second];
}

std::optional<double> TuningJournal::time_of(const Setting& setting) const {
  const auto at = place_.find(setting);
  const auto ms = at == place_.end() ? ms_.end() : ms_.find(at->second);
  if (ms == ms_.end()) return std::nullopt;
  return ms->second;
}

void TuningJournal::add(const Trial& trial, double ms) {
  append(file_, {{"set", trial.setting}, {"scores", trial.scores}});
  append(times_file_, {{"trial", trials_.size()}, {"ms", std::round(ms * 1000) / 1000}});
  ms_[trials_.size()] = ms;
  place_.emplace(trial.setting, trials_.size());
  trials_.push_back(trial);
}

}  // namespace planescope::lab
