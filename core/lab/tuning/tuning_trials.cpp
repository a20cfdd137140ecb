// Scores tuning settings on labeled frames, and keeps a journal of trials for resuming.

#include "core/lab/tuning/tuning_trials.hpp"

#include <fmt/format.h>
#include <time.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <mutex>
#include <nlohmann/json.hpp>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::lab {

// ---- Frames ----

namespace {

constexpr std::size_t kMostKept = 64;  // frames with labels: some 20 MB each

double thread_cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

/// Whether this setting changes points or their labels.
bool changes_points(const Setting& setting) {
  return std::ranges::any_of(setting, [](const auto& one) {
    const std::string& section = planes::find_option(one.first).section;
    return section == "cloud" || section == "classifier";
  });
}

planes::PreparedFrame prepared(const TuningFrame& frame,
                               const planes::PipelineOptions& options,
                               const planes::Classifier* classifier) {
  std::shared_ptr<const planes::Classifier> pca;
  if (options.classifier == "pca") pca = planes::make_pca_classifier(options.pca);
  const planes::FrameTruth on_points =
      planes::truth_on_points(frame.truth.values, planes::measured_sources(frame.frame));
  return planes::prepare_frame(frame.frame, options, pca ? pca.get() : classifier, &on_points);
}

}  // namespace

struct TuningSet::Labeled {
  std::once_flag once;
  planes::PreparedFrame prepared;
  double ms = 0;
};

TuningSet::TuningSet(std::vector<TuningFrame> frames,
                     std::shared_ptr<const planes::Classifier> classifier)
    : frames_(std::move(frames)), classifier_(std::move(classifier)) {
  for (TuningFrame& frame : frames_) {
    frame.options.threads = 1;
    // Points near another label take most of the scoring time and say nothing about planes.
    planes::SourceTruth& planes = planes_.emplace_back(frame.truth);
    std::ranges::fill(planes.values.label, std::uint8_t{0});
  }
  for (std::size_t i = 0; i < std::min(frames_.size(), kMostKept); ++i)
    labeled_.push_back(std::make_shared<Labeled>());
}

const TuningSet::Labeled& TuningSet::labeled(std::size_t frame) const {
  Labeled& labeled = *labeled_[frame];
  std::call_once(labeled.once, [&] {
    const double begin = thread_cpu_ms();
    labeled.prepared = prepared(frames_[frame], frames_[frame].options, classifier_.get());
    labeled.ms = thread_cpu_ms() - begin;
  });
  return labeled;
}

TuningSet::Scored TuningSet::score_one(std::size_t index, const Setting& setting) const {
  const TuningFrame& frame = frames_[index];
  const planes::PipelineOptions options = with_setting(frame.options, setting);
  try {
    planes::FrameResult result;
    Scored scored;
    if (index < labeled_.size() && !changes_points(setting)) {
      const Labeled& labeled = this->labeled(index);
      static_cast<planes::PreparedFrame&>(result) = labeled.prepared;
      scored.ms = labeled.ms;
    } else {
      const double begin = thread_cpu_ms();
      static_cast<planes::PreparedFrame&>(result) = prepared(frame, options, classifier_.get());
      scored.ms = thread_cpu_ms() - begin;
    }
    const double begin = thread_cpu_ms();
    planes::FoundRegions found = planes::find_regions(frame.frame, result, options);
    scored.ms += thread_cpu_ms() - begin;
    result.segmentation = std::move(found.segmentation);
    result.plane_of = std::move(found.plane_of);
    scored.pq = planes::score_frame(result, planes_[index]).pq;
    if (!std::isfinite(scored.pq)) scored.pq = 0;
    return scored;
  } catch (const Error& error) {
    if (setting.empty()) throw Error(frame.name + ": " + error.what());
    return {};
  }
}

void TuningSet::score(std::span<const Setting> settings,
                      int threads,
                      const std::function<void(const TimedTrial&)>& take,
                      const std::function<void(int, int)>& progress) const {
  const auto frames = static_cast<int>(frames_.size());
  const int count = static_cast<int>(settings.size()) * frames;
  std::vector<Scored> scored(static_cast<std::size_t>(count));
  TimedTrial timed;
  work_in_order(
      count, threads,
      [&](int i) {
        const auto k = static_cast<std::size_t>(i);
        scored[k] = score_one(k % frames_.size(), settings[k / frames_.size()]);
      },
      [&](int i) {
        const auto k = static_cast<std::size_t>(i);
        timed.trial.scores.push_back(scored[k].pq);
        timed.ms += scored[k].ms / frames;
        if (progress) progress(i + 1, count);
        if (timed.trial.scores.size() < frames_.size()) return;
        timed.trial.setting = settings[k / frames_.size()];
        take(timed);
        timed = {};
      });
}

// ---- Journal ----

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kJournalSchema = "planescope.tuning-journal/1";

/// Complete lines; truncates an incomplete last one from the file.
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
          throw Error(fmt::format("{}: found {} scores; expected {}", where, trial.scores.size(),
                                  trials_[0].scores.size()));
        place_.emplace(trial.setting, trials_.size());
        trials_.push_back(std::move(trial));
      } else {
        if (json.at("schema") != kJournalSchema)
          throw Error(fmt::format("{}: unknown schema; expected {}", where, kJournalSchema));
        for (const auto& [name, value] : purpose)
          if (json.at(name) != value)
            throw Error(
                fmt::format("{}: belongs to a search with different {}; use a different folder, or "
                            "delete it to start over",
                            file_.string(), name));
      }
    } catch (const Json::exception& problem) {
      throw Error(where + ": not a valid trial: " + json_problem(problem));
    }
  }
  return !lines.empty();
}

/// Times are optional: ignores invalid ones.
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
