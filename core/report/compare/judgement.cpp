// Verdict on a report: broken rules and differences from the baseline, as text and JSON.

#include "core/report/compare/judgement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <nlohmann/json.hpp>
#include <ranges>
#include <utility>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"
#include "core/report/data/report_json.hpp"

namespace planescope::report {
namespace {

using Json = nlohmann::ordered_json;

std::string where(const Breach& breach) {
  if (breach.recording.empty()) return "all frames";
  if (breach.frame < 0) return breach.recording;
  return fmt::format("{} {}{}", breach.recording, breach.is_missing ? "baseline " : "",
                     frame_text(breach.frame, breach.name));
}

/// Frames of each recording that are not in the baseline.
std::vector<std::string> added_frames(const ReportComparison& comparison) {
  struct Count {
    std::string recording;
    int added = 0, all = 0;
  };
  std::vector<Count> counts;
  for (const FrameComparison& frame : comparison.frames) {
    auto count = std::ranges::find(counts, frame.recording, &Count::recording);
    if (count == counts.end()) count = counts.insert(count, {frame.recording});
    ++count->all;
    count->added += frame.fate == FrameFate::added;
  }
  std::vector<std::string> lines;
  for (const Count& count : counts)
    if (count.added > 0)
      lines.push_back(
          fmt::format("{}: {}not in the baseline", count.recording,
                      count.added == count.all ? "" : counted(count.added, "frame") + " "));
  return lines;
}

Json breach_json(const Breach& breach) {
  return {{"level", to_string(breach.rule.level)},
          {"metric", breach.rule.metric},
          {"recording", breach.recording.empty() ? Json() : Json(breach.recording)},
          {"frame", breach.frame < 0 ? Json() : Json(breach.frame)},
          {"name", breach.name.empty() ? Json() : Json(breach.name)},
          {"value", breach.value},
          {"message", breach.text()}};
}

}  // namespace

int Judgement::errors() const {
  return static_cast<int>(std::ranges::count(
      breaches, RuleLevel::error, [](const Breach& breach) { return breach.rule.level; }));
}

int Judgement::warnings() const {
  return static_cast<int>(breaches.size() + unguarded().size()) - errors();
}

std::vector<std::string> Judgement::unguarded() const {
  std::vector<std::string> lines;
  for (const IdleRule& rule : idle) lines.push_back(rule.text());
  lines.insert(lines.end(), added.begin(), added.end());
  for (const std::string& part : comparison.left_out)
    lines.push_back(part + ": in the baseline, not in this report");
  return lines;
}

std::vector<std::string> Judgement::differences() const {
  return baseline ? comparison.differences : std::vector<std::string>();
}

std::string Judgement::text() const {
  std::string text;
  const auto add = [&](const auto& items, const auto& line_of) {
    constexpr std::size_t kMostLines = 20;
    for (const auto& item : items | std::views::take(kMostLines)) text += line_of(item) + "\n";
    if (items.size() > kMostLines)
      text += fmt::format("... and {} more\n", items.size() - kMostLines);
  };
  for (const std::string& difference : differences()) text += "differs: " + difference + "\n";
  add(breaches, [](const Breach& breach) {
    return fmt::format("{:5}  {}: {}", to_string(breach.rule.level), where(breach), breach.text());
  });
  add(unguarded(), [](const std::string& line) { return "warn   " + line; });
  add(notes,
      [](const Breach& note) { return fmt::format("note   {}: {}", where(note), note.text()); });
  const std::string noted = notes.empty() ? "" : ", " + counted(notes.size(), "note");
  const std::string against = baseline ? " against " + baseline_file : "";
  return text + fmt::format("{}, {}{}{}\n", counted(errors(), "error"),
                            counted(warnings(), "warning"), noted, against);
}

std::string frame_text(int index, const std::string& name) {
  const bool is_number = name == std::to_string(index) || name == fmt::format("{:06}", index);
  return fmt::format("frame {}{}", index, name.empty() || is_number ? "" : " (" + name + ")");
}

bool is_known_refusal(const Report& report, const ReportFrame& frame) {
  if (!report.judgement || frame.unreadable) return false;
  const auto same =
      std::ranges::find(report.judgement->comparison.frames, &frame, &FrameComparison::now);
  return same != report.judgement->comparison.frames.end() &&
         same->fate == FrameFate::both_refused && same->baseline->refused == frame.refused;
}

Json judgement_json(const Judgement& judgement) {
  Json json = {{"baseline", judgement.baseline ? Json(judgement.baseline_file) : Json()},
               {"differences", judgement.differences()},
               {"errors", judgement.errors()},
               {"warnings", judgement.warnings()},
               {"unguarded", judgement.unguarded()},
               {"breaches", Json::array()},
               {"notes", Json::array()}};
  for (const Breach& breach : judgement.breaches) json["breaches"].push_back(breach_json(breach));
  for (const Breach& note : judgement.notes) json["notes"].push_back(breach_json(note));
  return json;
}

ReportGuard::ReportGuard(std::filesystem::path baseline,
                         const std::filesystem::path& rules,
                         bool approves)
    : baseline_file_(std::move(baseline)), approves_(approves) {
  const bool is_there = std::filesystem::exists(baseline_file_);
  if (!baseline_file_.empty() && !is_there && !approves)
    throw Error(baseline_file_.string() +
                ": no such baseline; add --approve to make this report the first baseline");
  is_first_ = approves && !is_there;
  if (!baseline_file_.empty() && !is_first_) baseline_ = read_report(baseline_file_);
  if (baseline_ && baseline_->partial)
    throw Error(baseline_file_.string() + ": from an interrupted run; expected a complete report");
  if (!rules.empty())
    rules_ = read_rules(rules);
  else if (baseline_)
    rules_ = built_in_rules();
}

std::shared_ptr<const Judgement> ReportGuard::judge(const Report& report) {
  if (!is_on()) return nullptr;
  const auto judgement = std::make_shared<Judgement>();
  judgement->baseline_file = baseline_file_.string();
  judgement->baseline = std::move(baseline_);
  judgement->rules = rules_;
  const Report none;
  judgement->comparison =
      compare_reports(judgement->baseline ? *judgement->baseline : none, report);
  judgement->breaches = broken_rules(rules_, judgement->comparison);
  // A report of new recordings may be added to a baseline.
  if (approves_)
    std::erase_if(judgement->breaches,
                  [](const Breach& breach) { return breach.rule.metric == "frames_compared"; });
  judgement->notes = noted_changes(rules_, judgement->comparison);
  const bool has_baseline = judgement->baseline.has_value();
  if (!is_first_) judgement->idle = idle_rules(rules_, judgement->comparison, has_baseline);
  if (has_baseline) judgement->added = added_frames(judgement->comparison);
  return judgement;
}

void ReportGuard::check_merge(const Report& report) const {
  if (!baseline_) return;
  const ReportComparison comparison = compare_reports(*baseline_, report);
  const bool keeps_others = std::ranges::any_of(baseline_->recordings, [&](const auto& recording) {
    return !std::ranges::count(report.recordings, recording.name, &ReportRecording::name);
  });
  const auto refuse = [&](const std::string& why) {
    throw Error(fmt::format(
        "--approve: {} {}; include all its recordings, or use --approve-only to replace it",
        baseline_file_.string(), why));
  };
  if (keeps_others) read_report_head(baseline_file_);  // throws if an earlier version wrote it
  for (const std::string& difference : comparison.differences)
    if (keeps_others && !difference.starts_with("version"))
      refuse("has recordings that were processed differently (" + difference + ")");
  for (const ReportRecording& recording : report.recordings) {
    const auto before =
        std::ranges::find(baseline_->recordings, recording.name, &ReportRecording::name);
    if (before != baseline_->recordings.end() && recording.frames_asked < recording.frame_count &&
        std::cmp_less(recording.frames_asked, before->frames.size()))
      refuse(fmt::format("has {} from {}, but this report has {}",
                         counted(before->frames.size(), "frame"), recording.name,
                         recording.frames_asked));
  }
}

void ReportGuard::approve(const std::filesystem::path& report_json, bool only) const {
  const auto replace = [&] {
    write_file_bytes(baseline_file_, read_file_bytes(report_json), Durable::yes);
  };
  if (only || is_first_) return replace();
  Json merged = read_json<Json>(report_json), before = read_json<Json>(baseline_file_);
  std::map<std::size_t, std::size_t> place_now;  // new index of remaining recordings, by old index
  for (std::size_t r = 0; r < before["recordings"].size(); ++r) {
    const Json& kept = before["recordings"][r];
    const auto is_same = [&](const Json& recording) { return recording["name"] == kept["name"]; };
    if (std::ranges::any_of(merged["recordings"], is_same)) continue;
    place_now[r] = merged["recordings"].size();
    merged["recordings"].push_back(kept);
  }
  if (place_now.empty()) return replace();
  for (Json timing : before["timings"])
    if (const auto place = place_now.find(timing["recording"]); place != place_now.end()) {
      timing["recording"] = place->second;
      merged["timings"].push_back(timing);
    }
  // These figures describe only this report and are never compared.
  merged.erase("totals");
  merged.erase("verdict");
  write_file_text(baseline_file_, json_text(merged), Durable::yes);
}

}  // namespace planescope::report
