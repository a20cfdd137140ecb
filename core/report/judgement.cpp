#include "core/report/judgement.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/base/file_bytes.hpp"
#include "core/base/file_descriptor.hpp"

namespace planescope {
namespace {

using Json = nlohmann::ordered_json;

std::string where(const Breach& breach) {
  if (breach.recording.empty()) return "all frames";
  if (breach.frame < 0) return breach.recording;
  return fmt::format("{} frame {}", breach.recording, breach.frame);
}

}  // namespace

int Judgement::errors() const {
  return static_cast<int>(std::ranges::count(
      breaches, RuleLevel::error, [](const Breach& breach) { return breach.rule.level; }));
}

std::vector<std::string> Judgement::differences() const {
  return baseline ? comparison.differences : std::vector<std::string>();
}

std::string Judgement::text() const {
  constexpr std::size_t kMostLines = 20;
  std::string text;
  for (const std::string& difference : differences()) text += "differs: " + difference + "\n";
  for (std::size_t i = 0; i < std::min(breaches.size(), kMostLines); ++i)
    text += fmt::format("{:5}  {}: {}\n", to_string(breaches[i].rule.level), where(breaches[i]),
                        breaches[i].text());
  if (breaches.size() > kMostLines)
    text += fmt::format("... and {} more\n", breaches.size() - kMostLines);
  const std::string against = baseline ? " against " + baseline_file : "";
  return text + fmt::format("{} errors, {} warnings{}\n", errors(), warnings(), against);
}

Json judgement_json(const Judgement& judgement) {
  Json json = {{"baseline", judgement.baseline ? Json(judgement.baseline_file) : Json()},
               {"differences", judgement.differences()},
               {"errors", judgement.errors()},
               {"warnings", judgement.warnings()},
               {"breaches", Json::array()}};
  for (const Breach& breach : judgement.breaches)
    json["breaches"].push_back(
        {{"level", to_string(breach.rule.level)},
         {"metric", breach.rule.metric},
         {"recording", breach.recording.empty() ? Json() : Json(breach.recording)},
         {"frame", breach.frame < 0 ? Json() : Json(breach.frame)},
         {"value", breach.value},
         {"message", breach.text()}});
  return json;
}

ReportGuard::ReportGuard(std::filesystem::path baseline,
                         const std::filesystem::path& rules,
                         bool may_be_first)
    : baseline_file_(std::move(baseline)) {
  const bool is_first = may_be_first && !std::filesystem::exists(baseline_file_);
  if (!baseline_file_.empty() && !is_first) baseline_ = read_report(baseline_file_);
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
  judgement->now = recorded(report);
  judgement->rules = rules_;
  const RecordedReport none;
  judgement->comparison =
      compare_reports(judgement->baseline ? *judgement->baseline : none, judgement->now);
  judgement->breaches = broken_rules(rules_, judgement->comparison);
  return judgement;
}

void ReportGuard::approve(const std::filesystem::path& report_json) const {
  replace_file(baseline_file_, read_file_bytes(report_json));
}

}  // namespace planescope
