// Verdict on a report: broken rules and differences from the baseline, as text and JSON.

#include "core/report/compare/judgement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <ranges>

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
  return fmt::format("{} frame {}", breach.recording, breach.frame);
}

/// Of each recording the frames that the baseline has not.
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
      lines.push_back(fmt::format("{}: {} not in the baseline", count.recording,
                                  count.added == count.all ? "is" : counted(count.added, "frame")));
  return lines;
}

Json breach_json(const Breach& breach) {
  return {{"level", to_string(breach.rule.level)},
          {"metric", breach.rule.metric},
          {"recording", breach.recording.empty() ? Json() : Json(breach.recording)},
          {"frame", breach.frame < 0 ? Json() : Json(breach.frame)},
          {"value", breach.value},
          {"message", breach.text()}};
}

}  // namespace

int Judgement::errors() const {
  return static_cast<int>(std::ranges::count(
      breaches, RuleLevel::error, [](const Breach& breach) { return breach.rule.level; }));
}

int Judgement::warnings() const {
  return static_cast<int>(breaches.size() + idle.size() + added.size()) - errors();
}

std::vector<std::string> Judgement::unguarded() const {
  std::vector<std::string> lines;
  for (const IdleRule& rule : idle) lines.push_back(rule.text());
  lines.insert(lines.end(), added.begin(), added.end());
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
                         bool may_be_first)
    : baseline_file_(std::move(baseline)) {
  is_first_ = may_be_first && !std::filesystem::exists(baseline_file_);
  if (!baseline_file_.empty() && !is_first_) baseline_ = read_report(baseline_file_);
  if (baseline_ && baseline_->partial)
    throw Error(baseline_file_.string() +
                ": is of a run that was stopped, expected a whole report");
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
  judgement->notes = noted_changes(rules_, judgement->comparison);
  const bool has_baseline = judgement->baseline.has_value();
  if (!is_first_) judgement->idle = idle_rules(rules_, judgement->comparison, has_baseline);
  if (has_baseline) judgement->added = added_frames(judgement->comparison);
  return judgement;
}

void ReportGuard::approve(const std::filesystem::path& report_json) const {
  write_file_bytes(baseline_file_, read_file_bytes(report_json), Durable::yes);
}

}  // namespace planescope::report
