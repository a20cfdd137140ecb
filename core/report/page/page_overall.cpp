// The page's top and end: whether the report holds, what to look at first, and the totals; how near
// to their thresholds decisions fell; what one needs to make the report again.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/model/json.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/page/charts.hpp"
#include "core/report/page/page.hpp"
#include "core/report/page/signs.hpp"

namespace planescope::report::html {
namespace {

std::string range_text(int fewest, int most) {
  return fewest == most ? std::to_string(most) : fmt::format("{}\u2013{}", fewest, most);
}

/// What told h from v, as HTML.
std::string classifier_text(const Report& report) {
  if (!report.is_ours()) return "the tilt of each plane";
  if (report.weights)
    return fmt::format("the network <code>{}</code> ({})", escaped(report.weights->file),
                       escaped(report.weights->network));
  if (report.classifier == "pca") return "PCA normals";
  return "the ground truth";
}

/// Where gravity is from and what told h from v, as HTML.
std::string gravity_sentence(const Report& report) {
  std::size_t known = 0, unknown = 0;
  for (const ReportRecording& recording : report.recordings)
    for (const ReportFrame& frame : recording.frames)
      if (frame.refused.empty()) ++(frame.gravity.known() ? known : unknown);
  if (unknown == 0)
    return fmt::format("Gravity was {}; h and v were told apart by {}.",
                       gravity_summary(report.recordings), classifier_text(report));
  std::string text = "Gravity was <em>not known</em>";
  if (known > 0)
    text = fmt::format("Gravity was {}; where it was known, h and v were told apart by {}",
                       gravity_summary(report.recordings), classifier_text(report));
  return text + fmt::format("{} {} neither h nor v. To tell them apart, {}.",
                            known > 0 ? "; all other planes" : ", so planes", "are",
                            escaped(planes::kHowToGiveGravity));
}

/// The report in a sentence, as HTML.
std::string summary(const Report& report, const ReportTotals& totals) {
  if (totals.frames_done == 0) return "No frame was processed.";
  std::string text = fmt::format(
      "{} plane{} found in {}, holding {} of the measured points within range. {}",
      range_text(totals.fewest_planes, totals.most_planes), totals.most_planes == 1 ? "" : "s",
      totals.frames_done == 1 ? "one frame" : fmt::format("each of {} frames", totals.frames_done),
      share(totals.points_on_planes, totals.points), gravity_sentence(report));
  if (totals.frames_refused > 0)
    text += fmt::format(" {} frame{} refused.", totals.frames_refused,
                        totals.frames_refused == 1 ? " was" : "s were");
  std::size_t warnings = 0;
  for (const ReportRecording& recording : report.recordings)
    warnings += recording.info.warnings.size();
  if (warnings > 0)
    text += fmt::format(" There {} to read below.",
                        warnings == 1 ? "is a warning" : fmt::format("are {} warnings", warnings));
  return text;
}

double median_pipeline_ms(const Report& report) {
  std::vector<double> values;
  for (const ReportRecording& recording : report.recordings)
    for (const ReportFrame& frame : recording.frames)
      if (const planes::FrameTimings& t = frame.timings; frame.refused.empty())
        values.push_back(planes::paper_ms(t));
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

/// Planes of all compared frames by what became of them.
std::string all_changes(const PagePlan& plan) {
  std::vector<std::string> parts;
  for (const PlaneFate fate : {PlaneFate::lost, PlaneFate::gained, PlaneFate::merged,
                               PlaneFate::split, PlaneFate::moved, PlaneFate::resized}) {
    std::size_t count = 0;
    for (const PageFrame& frame : plan.frames)
      if (frame.is_compared()) count += static_cast<std::size_t>(frame.comparison->count(fate));
    if (count > 0) parts.push_back(fmt::format("{} {}", grouped(count), to_string(fate)));
  }
  return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", "));
}

Data tiles(const PageSource& page, const ReportTotals& totals) {
  Data result{Data::type::list};
  const auto add = [&](const std::string& name, const std::string& value, const std::string& unit) {
    Data tile;
    tile.set("name", name);
    tile.set("value", value);
    tile.set("unit", text_or_false(unit));
    result.push_back(tile);
  };
  add(totals.frames_done == 1 ? "Planes" : "Planes per frame",
      range_text(totals.fewest_planes, totals.most_planes),
      totals.planes_undecided == 0
          ? ""
          : fmt::format("{} of {} undecided", totals.planes_undecided,
                        counted(static_cast<std::size_t>(totals.planes), "plane")));
  add("Points on planes", share(totals.points_on_planes, totals.points), "");
  add("Frames", std::to_string(totals.frames_done),
      totals.frames_refused > 0 ? fmt::format("and {} refused", totals.frames_refused) : "");
  add("Voxel grid to planes", fmt::format("{:.1f}", median_pipeline_ms(page.report)),
      totals.frames_done == 1 ? "ms" : "ms, median");
  if (totals.metrics) {
    add("Mean IoU", fmt::format("{:.1f} %", totals.metrics->mean_iou), "");
    add("Points right", fmt::format("{:.1f} %", totals.metrics->point_accuracy), "");
    if (const double right = totals.metrics->label_accuracy_edge; !std::isnan(right))
      add("h / v right", fmt::format("{:.1f} %", right), "near edges");
    add("Angle error", fmt::format("{:.2f}\u00b0", totals.metrics->alpha_deg), "");
  }
  return result;
}

std::string counts_text(const Judgement& judgement) {
  const std::string errors = counted(static_cast<std::size_t>(judgement.errors()), "error");
  const std::string warnings = counted(static_cast<std::size_t>(judgement.warnings()), "warning");
  if (judgement.notes.empty()) return errors + " and " + warnings;
  return fmt::format("{}, {} and {} on undecided planes", errors, warnings,
                     counted(judgement.notes.size(), "note"));
}

void set_banner(const PageSource& page, Data& data) {
  const Judgement* judgement = page.report.judgement.get();
  if (!judgement) {
    data.set("verdict_class", "open");
    data.set("verdict_mark", "\u2013");
    data.set("verdict", "Nothing to compare against");
    data.set("verdict_text",
             "The figures below say what was found, not whether that is right. "
             "<code>--baseline report.json</code> holds a run against an earlier one.");
    return;
  }
  const bool failed = judgement->errors() > 0;
  data.set("verdict_class", failed ? "failed" : judgement->warnings() > 0 ? "warning" : "passed");
  data.set("verdict_mark", failed ? "\u2715" : "\u2713");
  data.set("verdict", failed ? "Failed" : "Passed");
  std::string text = counts_text(*judgement);
  if (judgement->baseline)
    text += fmt::format(" against <code>{}</code>", escaped(judgement->baseline_file));
  if (page.plan.failed > 0)
    text += fmt::format("; {} of {} failed", page.plan.failed,
                        counted(page.plan.frames.size(), "frame"));
  data.set("verdict_text", text + ".");
}

/// "option voxel_size_m: 0.02 -> 0.04" as its name and what it says.
Data differences_of(const Judgement& judgement) {
  Data list{Data::type::list};
  for (const std::string& difference : judgement.differences()) {
    const std::size_t colon = difference.find(": ");
    const std::size_t arrow = difference.find(" -> ", colon);
    Data row;
    row.set("name", difference.substr(0, colon));
    row.set("before", difference.substr(colon + 2, arrow - colon - 2));
    row.set("now", difference.substr(arrow + 4));
    list.push_back(row);
  }
  return list;
}

std::string doubt_text(const PageSource& page, const PageFrame& frame) {
  if (frame.frame->metrics) return fmt::format("mean IoU {:.1f} %", frame.frame->metrics->mean_iou);
  if (page.report.judgement) return "";
  return signs_of(*frame.frame).text();
}

Data worst_data(const PageSource& page, const PageFrame& frame) {
  constexpr std::size_t kMostReasons = 4;
  Data data;
  data.set("anchor", frame.anchor);
  data.set("title", title_of(page, frame));
  data.set("standing", name_of(frame.standing));
  data.set("has_badge", frame.standing != Standing::none);
  data.set("standing_text", !frame.frame         ? "missing"
                            : frame.is_refused() ? "refused"
                                                 : name_of(frame.standing));
  data.set("thumbnails", thumbnails(page, frame, 1));
  std::vector<std::string> reasons;
  if (frame.is_refused()) reasons.push_back(frame.frame->refused);
  for (const Breach* breach : frame.breaches) reasons.push_back(breach->text());
  if (reasons.empty()) reasons.push_back(doubt_text(page, frame));
  const std::size_t more = reasons.size() > kMostReasons ? reasons.size() - kMostReasons : 0;
  reasons.resize(reasons.size() - more);
  if (more > 0) reasons.push_back(fmt::format("and {} more", more));
  data.set("reasons", list_of("text", reasons));
  return data;
}

Data general_data(const PagePlan& plan, const Judgement* judgement) {
  Data list{Data::type::list};
  const std::vector<std::string> none;
  for (const std::string& line : judgement ? judgement->unguarded() : none) {
    Data row;
    row.set("level", to_string(RuleLevel::warn));
    row.set("class", "warning");
    row.set("where", "");
    row.set("text", line);
    list.push_back(row);
  }
  const auto add = [&](const Breach& breach, const char* level, const char* css_class) {
    Data row;
    row.set("level", level);
    row.set("class", css_class);
    row.set("where", breach.recording.empty() ? "all frames" : breach.recording);
    row.set("text", breach.text());
    list.push_back(row);
  };
  for (const Breach* breach : plan.general)
    add(*breach, to_string(breach->rule.level),
        breach->rule.level == RuleLevel::error ? "failed" : "warning");
  for (const Breach* note : plan.general_notes) add(*note, "note", "note");
  return list;
}

std::string worst_note(const PageSource& page) {
  const std::size_t all = page.plan.frames.size(), shown = page.plan.worst.size();
  if (page.report.judgement) {
    const auto bad = static_cast<std::size_t>(std::ranges::count_if(
        page.plan.frames,
        [](const PageFrame& frame) { return frame.standing > Standing::passed; }));
    return fmt::format("{} of {} break rules or were refused{}.", bad, counted(all, "frame"),
                       bad > shown ? fmt::format("; these are the worst {}", shown) : "");
  }
  return fmt::format("The {} of {} that fare worst: refused ones, then those with the {}.", shown,
                     counted(all, "frame"),
                     page.has_metrics() ? "least IoU with the labels" : "most signs of trouble");
}

std::vector<ValueHistogram> summed(const Report& report) {
  std::vector<ValueHistogram> sums;
  for (const ReportRecording& recording : report.recordings)
    for (const ReportFrame& frame : recording.frames) {
      if (sums.empty()) {
        sums = frame.histograms;
        continue;
      }
      for (std::size_t k = 0; k < std::min(sums.size(), frame.histograms.size()); ++k)
        add_to(sums[k], frame.histograms[k]);
    }
  return sums;
}

std::uint64_t within_threshold(const ValueHistogram& histogram) {
  std::uint64_t count = 0;
  for (std::size_t bin = 0; bin + 1 < histogram.counts.size(); ++bin)
    if (histogram.edge(bin) <= histogram.threshold * (1 + 1e-9)) count += histogram.counts[bin];
  return count;
}

std::string cumulative_chart(const ValueHistogram& histogram) {
  LineChart chart;
  const bool counts = histogram.name == "n_out";
  chart.title =
      fmt::format("{}: share up to each value; {} are within the threshold", title_of(histogram),
                  share(within_threshold(histogram), histogram.total()));
  chart.x_name = counts ? "points" : "times the limit";
  chart.from_zero = true;
  chart.x_mark = histogram.threshold;
  chart.mark_name = counts ? fmt::format("threshold {:.6g}", histogram.threshold) : "limit";
  Curve curve{"%", {}, 0};
  std::uint64_t sum = 0;
  for (std::size_t bin = 0; bin + 1 < histogram.counts.size(); ++bin) {
    sum += histogram.counts[bin];
    chart.x.push_back(histogram.edge(bin));
    curve.values.push_back(100 * static_cast<double>(sum) / static_cast<double>(histogram.total()));
  }
  chart.curves.push_back(std::move(curve));
  return line_chart(chart);
}

/// File, hash and the training record's plain facts, as HTML.
std::string weights_text(const planes::WeightsRecord& weights) {
  std::string text = fmt::format("{} ({}), SHA-256 <code>{}</code>", escaped(weights.file),
                                 escaped(weights.network), escaped(weights.sha256));
  std::string facts;
  const auto training =
      parse_json<nlohmann::ordered_json>(weights.training, weights.file + ": training record");
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
  std::stable_partition(options.begin(), options.end(),
                        [](const ReportOption* option) { return option->changed; });
  std::string of = "method " + report.method;
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
  const Report& baseline = *judgement.baseline;
  data.set(
      "baseline",
      fmt::format(
          "<code>{}</code>: planescope {}, commit <code>{}</code>{}, written {}, <code>{}</code>",
          escaped(judgement.baseline_file), escaped(baseline.version), escaped(baseline.commit),
          baseline.modified ? " with changes" : "", escaped(baseline.created_utc),
          escaped(baseline.command)));
}

}  // namespace

bool PageSource::has_metrics() const {
  return std::ranges::any_of(
      plan.frames, [](const PageFrame& frame) { return frame.frame && frame.frame->metrics; });
}

std::string gravity_summary(const std::vector<ReportRecording>& recordings) {
  std::vector<std::string> sources;
  double least = 2;
  for (const ReportRecording& recording : recordings) {
    for (const ReportFrame& frame : recording.frames) {
      if (!frame.refused.empty()) continue;
      std::string text = gravity_text(frame.gravity);
      if (frame.gravity.source == GravitySource::estimate) {
        least = std::min(least, frame.gravity.confidence);
        text = "<em>estimated</em> from the scene";
      } else if (frame.gravity.source == GravitySource::carried) {
        least = std::min(least, frame.gravity.confidence);
        text = "<em>carried</em> from other frames";
      }
      if (std::find(sources.begin(), sources.end(), text) == sources.end()) sources.push_back(text);
    }
  }
  std::string result = fmt::format("{}", fmt::join(sources, " or "));
  if (least <= 1) result += fmt::format(" (confidence {:.2f} at least)", least);
  return result;
}

void set_verdict(const PageSource& page, Data& data) {
  const ReportTotals totals = totals_of(page.report);
  set_banner(page, data);
  const Judgement* judgement = page.report.judgement.get();
  const Data differences = judgement ? differences_of(*judgement) : Data{Data::type::list};
  data.set("has_differences", differences.is_non_empty_list());
  data.set("differences", differences);
  const Data general = general_data(page.plan, judgement);
  data.set("has_general", general.is_non_empty_list());
  data.set("general", general);
  data.set("partial", page.report.partial);
  data.set("frames_done", std::to_string(totals.frames_done + totals.frames_refused));
  data.set("frames_asked", std::to_string(totals.frames_asked));
  data.set("renderer_error", text_or_false(page.report.renderer_error));
  data.set("summary", summary(page.report, totals));
  data.set("changes", page.has_baseline() ? Data(all_changes(page.plan)) : Data(false));
  data.set("tiles", tiles(page, totals));
  Data worst{Data::type::list};
  for (const PageFrame* frame : page.plan.worst) worst.push_back(worst_data(page, *frame));
  data.set("has_worst", !page.plan.worst.empty());
  data.set("worst_title", judgement ? "The worst frames" : "Frames to look at first");
  data.set("worst_note", worst_note(page));
  data.set("worst", worst);
}

void set_histograms(const PageSource& page, Data& data) {
  Data list{Data::type::list};
  for (const ValueHistogram& histogram : summed(page.report)) {
    if (histogram.total() == 0) continue;
    Data one;
    one.set("title", title_of(histogram));
    one.set("says", fmt::format("{} of {} within the threshold",
                                share(within_threshold(histogram), histogram.total()),
                                grouped(histogram.total())));
    one.set("svg", cumulative_chart(histogram));
    list.push_back(one);
  }
  data.set("has_histograms", list.is_non_empty_list());
  data.set("histograms", list);
}

void set_record(const PageSource& page, Data& data) {
  const Report& report = page.report;
  data.set("command", report.command + " -o DIR");
  data.set("version", report.version);
  data.set("commit", report.commit);
  data.set("modified", report.modified);
  data.set("method", report.method);
  data.set("is_ours", report.is_ours());
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
