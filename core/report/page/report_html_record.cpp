// What one needs to make the report again.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/report/page/report_html_pieces.hpp"

namespace planescope::report::html {
namespace {

/// File, hash and the training record's plain facts, as HTML.
std::string weights_text(const planes::WeightsRecord& weights) {
  std::string text = fmt::format("{} ({}), SHA-256 <code>{}</code>", escaped(weights.file),
                                 escaped(weights.network), escaped(weights.sha256));
  std::string facts;
  const auto training = nlohmann::ordered_json::parse(weights.training);
  for (const auto& [name, value] : training.items()) {
    if (value.is_structured()) continue;
    facts += facts.empty() ? ", trained with " : ", ";
    facts += name + " " + (value.is_string() ? value.get<std::string>() : value.dump());
  }
  return text + escaped(facts);
}

void set_options(const Report& report, Data& data) {
  std::vector<const ReportOption*> options;
  for (const ReportOption& option : report.options) options.push_back(&option);
  std::ranges::stable_partition(options,
                                [](const ReportOption* option) { return option->changed; });
  std::string of = std::string("method ") + planes::to_string(report.method);
  std::size_t changed = 0;
  Data rows{Data::type::list};
  for (const ReportOption* option : options) {
    Data row;
    row.set("name", option->name);
    row.set("value", option->value);
    row.set("unit", option->unit);
    row.set("meaning", option->meaning);
    row.set("changed", option->changed);
    rows.push_back(row);
    changed += option->changed;
    if (option->name == "profile") of = "profile " + option->value;
  }
  data.set("options", rows);
  data.set("options_of", of);
  data.set("changed_text",
           changed == 0 ? "unchanged" : counted(changed, "option") + " changed, which stand first");
}

void set_hashes(const Report& report, Data& data) {
  Data hashes{Data::type::list};
  const auto add = [&](const std::string& name, const std::string& sha256) {
    if (sha256.empty()) return;
    Data row;
    row.set("name", name);
    row.set("sha256", sha256);
    hashes.push_back(row);
  };
  for (const ReportRecording& recording : report.recordings) {
    add(recording.name, recording.sha256);
    for (const ReportFrame& frame : recording.frames)
      add(fmt::format("{}, frame {}", recording.name, frame.index), frame.sha256);
  }
  data.set("has_hashes", hashes.is_non_empty_list());
  data.set("hashes", hashes);
}

std::string limits_of(const Rule& rule) {
  std::string text;
  if (!std::isinf(rule.at_least)) text = fmt::format("at least {:.6g}", rule.at_least);
  if (!std::isinf(rule.at_most))
    text += fmt::format("{}at most {:.6g}", text.empty() ? "" : ", ", rule.at_most);
  return text;
}

std::string frames_of(const Rule& rule) {
  std::string text = rule.scope == RuleScope::frame       ? "each frame"
                     : rule.scope == RuleScope::recording ? "each recording"
                                                          : "all frames";
  if (!rule.recording.empty()) text += " of " + rule.recording;
  if (rule.frame >= 0) text += fmt::format(", number {}", rule.frame);
  return text;
}

void set_rules(const Judgement& judgement, Data& data) {
  Data rows{Data::type::list};
  for (const Rule& rule : judgement.rules) {
    if (rule.level == RuleLevel::off) continue;
    const auto broken = std::ranges::count_if(
        judgement.breaches, [&](const Breach& breach) { return breach.rule == rule; });
    const auto& metrics = rule_metrics();
    const auto metric = std::ranges::find(metrics, rule.metric, &RuleMetric::name);
    Data row;
    row.set("metric", rule.metric);
    row.set("meaning", metric == metrics.end() ? "" : std::string(metric->meaning));
    row.set("frames", frames_of(rule));
    row.set("limits", limits_of(rule));
    row.set("level", to_string(rule.level));
    const bool idle = std::ranges::count(judgement.idle, rule, &IdleRule::rule) > 0;
    row.set("broken", broken > 0 ? counted(static_cast<std::size_t>(broken), "time")
                      : idle     ? "holds nothing"
                                 : "held");
    const char* bad = rule.level == RuleLevel::error && !idle ? "failed" : "warning";
    row.set("class", broken > 0 || idle ? Data(bad) : Data(false));
    rows.push_back(row);
  }
  data.set("has_rules", rows.is_non_empty_list());
  data.set("rules", rows);
  if (!judgement.baseline) return;
  const RecordedReport& baseline = *judgement.baseline;
  data.set(
      "baseline",
      fmt::format(
          "<code>{}</code>: planescope {}, commit <code>{}</code>{}, written {}, <code>{}</code>",
          escaped(judgement.baseline_file), escaped(baseline.version), escaped(baseline.commit),
          baseline.modified ? " with changes" : "", escaped(baseline.created_utc),
          escaped(baseline.command)));
}

}  // namespace

void set_record(const PageSource& page, Data& data) {
  const Report& report = page.report;
  data.set("command", report.command + " -o DIR");
  data.set("version", report.version);
  data.set("commit", report.commit);
  data.set("modified", report.modified);
  data.set("method", planes::to_string(report.method));
  data.set("is_ours", report.method == planes::Method::ours);
  data.set("classifier", report.classifier.empty() ? "none" : report.classifier);
  data.set("weights", report.weights ? weights_text(*report.weights) : "none");
  data.set("renderer", report.renderer.empty() ? "none" : report.renderer);
  data.set("created", report.created_utc);
  set_options(report, data);
  set_hashes(report, data);
  data.set("has_rules", false);
  data.set("baseline", false);
  if (report.judgement) set_rules(*report.judgement, data);
  Data cases{Data::type::list};
  for (const planes::Case c :
       {planes::Case::I, planes::Case::II, planes::Case::III, planes::Case::IV}) {
    Data entry;
    entry.set("numeral", planes::to_string(c));
    entry.set("color", safe_color(report.case_colors[static_cast<int>(c)]));
    entry.set("meaning", case_meaning(c));
    cases.push_back(entry);
  }
  data.set("cases", cases);
}

}  // namespace planescope::report::html
