// The page's top and end: the verdict, frames to review first, and totals; decisions near their
// thresholds; facts to reproduce the report.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ranges>

#include "core/model/json.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/page/charts.hpp"
#include "core/report/page/page.hpp"

namespace planescope::report::html {
namespace {

std::string range_text(int fewest, int most) {
  return fewest == most ? std::to_string(most) : fmt::format("{}\u2013{}", fewest, most);
}

/// The classifier of h and v, as HTML.
std::string classifier_text(const Report& report) {
  if (!report.is_ours()) return "the tilt of each plane";
  if (report.weights)
    return fmt::format("the network <code>{}</code> ({})", escaped(report.weights->file),
                       escaped(report.weights->network));
  if (report.classifier == "pca") return "PCA normals";
  return "the ground truth";
}

/// The source of gravity and the classifier of h and v, as HTML.
std::string gravity_sentence(const Report& report) {
  std::size_t known = 0, unknown = 0;
  for (const ReportRecording& recording : report.recordings)
    for (const ReportFrame& frame : recording.frames)
      if (frame.refused.empty()) ++(frame.gravity.known() ? known : unknown);
  if (unknown == 0)
    return fmt::format("Gravity was {}; h and v were distinguished by {}.",
                       gravity_summary(report.recordings), classifier_text(report));
  std::string text = "Gravity was <em>unknown</em>";
  if (known > 0)
    text = fmt::format("Gravity was {}; where it was known, h and v were distinguished by {}",
                       gravity_summary(report.recordings), classifier_text(report));
  return text + fmt::format("{} {} neither h nor v. To distinguish them, {}.",
                            known > 0 ? "; all other planes" : ", so planes", "are",
                            escaped(planes::kHowToGiveGravity));
}

/// The report in a sentence, as HTML.
std::string summary(const Report& report, const ReportTotals& totals) {
  if (totals.frames_done == 0) return "No frame was processed.";
  std::string text = fmt::format(
      "{} plane{} in {}, covering {} of the points within range. {}",
      range_text(totals.fewest_planes, totals.most_planes), totals.most_planes == 1 ? "" : "s",
      totals.frames_done == 1 ? "one frame" : fmt::format("each of {} frames", totals.frames_done),
      share(totals.points_on_planes, totals.points), gravity_sentence(report));
  if (totals.frames_refused > 0)
    text += fmt::format(" {} frame{} rejected.", totals.frames_refused,
                        totals.frames_refused == 1 ? " was" : "s were");
  std::size_t warnings = 0;
  for (const ReportRecording& recording : report.recordings)
    warnings += recording.info.warnings.size();
  if (warnings > 0)
    text += fmt::format(" There {} below.",
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

/// Planes of all compared frames, counted by fate.
std::string all_changes(const PagePlan& plan) {
  return changes_text([&](PlaneFate fate) {
    std::size_t count = 0;
    for (const PageFrame& frame : plan.frames)
      if (frame.is_compared()) count += static_cast<std::size_t>(frame.comparison->count(fate));
    return count;
  });
}

PageJson tiles(const PageSource& page, const ReportTotals& totals) {
  PageJson result = PageJson::array();
  const auto add = [&](const char* name, const std::string& value, const std::string& unit = "") {
    result.push_back({{"name", name}, {"value", value}, {"unit", unit}});
  };
  add(totals.frames_done == 1 ? "Planes" : "Planes per frame",
      range_text(totals.fewest_planes, totals.most_planes),
      totals.planes_undecided == 0
          ? ""
          : fmt::format("{} of {} undecided", totals.planes_undecided,
                        counted(static_cast<std::size_t>(totals.planes), "plane")));
  add("Points on planes", share(totals.points_on_planes, totals.points));
  add("Frames", std::to_string(totals.frames_done),
      totals.frames_refused > 0 ? fmt::format("and {} rejected", totals.frames_refused) : "");
  add("Voxel grid to planes", fmt::format("{:.1f}", median_pipeline_ms(page.report)),
      totals.frames_done == 1 ? "ms" : "ms, median");
  if (totals.metrics) {
    add("Mean IoU", fmt::format("{:.1f} %", totals.metrics->mean_iou));
    add("Points correct", fmt::format("{:.1f} %", totals.metrics->point_accuracy));
    if (const double right = totals.metrics->label_accuracy_edge; !std::isnan(right))
      add("h / v correct", fmt::format("{:.1f} %", right), "near edges");
    add("Angle error", fmt::format("{:.2f}\u00b0", totals.metrics->alpha_deg));
  }
  return result;
}

std::string counts_text(const Judgement& judgement) {
  const std::string errors = counted(static_cast<std::size_t>(judgement.errors()), "error");
  const std::string warnings = counted(static_cast<std::size_t>(judgement.warnings()), "warning");
  if (judgement.notes.empty()) return errors + " and " + warnings;
  return fmt::format("{}, {}, and {} on undecided planes", errors, warnings,
                     counted(judgement.notes.size(), "note"));
}

void set_banner(const PageSource& page, PageJson& data) {
  const Judgement* judgement = page.report.judgement.get();
  const auto set = [&](const char* css_class, const char* mark, const char* verdict,
                       const std::string& text) {
    data["verdict_class"] = css_class;
    data["verdict_mark"] = mark;
    data["verdict"] = verdict;
    data["verdict_text"] = text;
  };
  if (!judgement)
    return set(
        "open", "\u2013", "Nothing to compare against",
        "The figures below are not evaluated. Use <code>--baseline report.json</code> to compare "
        "a run with an earlier one.");
  std::string text = counts_text(*judgement);
  if (judgement->baseline)
    text += fmt::format(" against <code>{}</code>", escaped(judgement->baseline_file));
  if (page.plan.failed > 0)
    text += fmt::format("; {} of {} failed", page.plan.failed,
                        counted(page.plan.frames.size(), "frame"));
  if (judgement->errors() > 0) return set("failed", "\u2715", "Failed", text + ".");
  set(judgement->warnings() > 0 ? "warning" : "passed", "\u2713", "Passed", text + ".");
}

/// Splits "option voxel_size_m: 0.02 -> 0.04" into name and values.
PageJson differences_of(const Judgement& judgement) {
  PageJson list = PageJson::array();
  for (const std::string& difference : judgement.differences()) {
    const std::size_t colon = difference.find(": ");
    const std::size_t arrow = difference.find(" -> ", colon);
    list.push_back({{"name", difference.substr(0, colon)},
                    {"before", difference.substr(colon + 2, arrow - colon - 2)},
                    {"now", difference.substr(arrow + 4)}});
  }
  return list;
}

std::string doubt_text(const PageSource& page, const PageFrame& frame) {
  if (frame.frame->metrics) return fmt::format("mean IoU {:.1f} %", frame.frame->metrics->mean_iou);
  if (page.report.judgement) return "";
  return signs_of(*frame.frame).text();
}

PageJson worst_data(const PageSource& page, const PageFrame& frame) {
  constexpr std::size_t kMostReasons = 4;
  std::vector<std::string> reasons;
  if (frame.is_refused()) reasons.push_back(frame.frame->refused);
  for (const Breach* breach : frame.breaches) reasons.push_back(breach->text());
  if (reasons.empty()) reasons.push_back(doubt_text(page, frame));
  const std::size_t more = reasons.size() > kMostReasons ? reasons.size() - kMostReasons : 0;
  reasons.resize(reasons.size() - more);
  if (more > 0) reasons.push_back(fmt::format("and {} more", more));
  return {{"anchor", frame.anchor},
          {"title", title_of(page, frame)},
          {"standing", name_of(frame.standing)},
          {"has_badge", frame.standing != Standing::none},
          {"standing_text", result_of(frame)},
          {"thumbnails", thumbnails(page, frame, 1)},
          {"reasons", reasons}};
}

PageJson general_data(const PagePlan& plan, const Judgement* judgement) {
  PageJson list = PageJson::array();
  const auto add = [&](const char* level, const char* css_class, const std::string& where,
                       const std::string& text) {
    list.push_back({{"level", level}, {"class", css_class}, {"where", where}, {"text", text}});
  };
  const auto where = [](const Breach& breach) {
    return breach.recording.empty() ? std::string("all frames") : breach.recording;
  };
  if (judgement)
    for (const std::string& line : judgement->unguarded()) add("warn", "warning", "", line);
  for (const Breach* breach : plan.general)
    add(to_string(breach->rule.level),
        breach->rule.level == RuleLevel::error ? "failed" : "warning", where(*breach),
        breach->text());
  for (const Breach* note : plan.general_notes) add("note", "note", where(*note), note->text());
  return list;
}

const char* worst_title(const Report& report) {
  return report.judgement ? "Worst frames" : "Frames to look at first";
}

std::string worst_note(const PageSource& page) {
  const std::size_t all = page.plan.frames.size(), shown = page.plan.worst.size();
  if (page.report.judgement) {
    const auto bad = static_cast<std::size_t>(std::ranges::count_if(
        page.plan.frames,
        [](const PageFrame& frame) { return frame.standing > Standing::passed; }));
    return fmt::format("{} of {} break rules or were rejected{}.", bad, counted(all, "frame"),
                       bad > shown ? fmt::format("; these are the worst {}", shown) : "");
  }
  return fmt::format("{} of {}: rejected frames first, then those with the {}.", shown,
                     counted(all, "frame"),
                     page.has_metrics() ? "lowest IoU with the labels" : "most signs of trouble");
}

/// The worst failed frames, then the sections of the page.
PageJson contents_data(const PageSource& page) {
  constexpr std::size_t kMostFailed = 24;
  std::vector<const PageFrame*> failed;
  for (const PageFrame& frame : page.plan.frames)
    if (frame.standing == Standing::failed) failed.push_back(&frame);
  std::ranges::sort(failed, {}, &PageFrame::rank);
  PageJson links = PageJson::array(), sections = PageJson::array();
  for (const PageFrame* frame : failed | std::views::take(kMostFailed))
    links.push_back({{"anchor", frame->anchor}, {"title", title_of(page, *frame)}});
  const auto add = [&](const std::string& anchor, const std::string& text) {
    sections.push_back({{"anchor", anchor}, {"title", text}});
  };
  if (!page.plan.worst.empty()) add("worst", worst_title(page.report));
  add("totals", "Totals");
  add("frames", "Table of frames");
  for (std::size_t r = 0; r < page.report.recordings.size(); ++r)
    add(fmt::format("r{}", r + 1), page.report.recordings[r].name);
  add("record", "Reproduce this report");
  const std::size_t more = failed.size() - links.size();
  return {{"failed", std::move(links)},
          {"more", more > 0 ? fmt::format("and {} more in the table", more) : ""},
          {"sections", std::move(sections)}};
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

/// File, hash and basic facts of the training record, as HTML.
std::string weights_text(const planes::WeightsRecord& weights) {
  std::string text = fmt::format("{} ({}), SHA-256 <code>{}</code>", escaped(weights.file),
                                 escaped(weights.network), escaped(weights.sha256));
  std::string facts;
  const auto training = parse_json<PageJson>(weights.training, weights.file + ": training record");
  for (const auto& [name, value] : training.items()) {
    if (value.is_structured()) continue;
    facts += facts.empty() ? ", trained with " : ", ";
    facts += name + " " + (value.is_string() ? value.get<std::string>() : value.dump());
  }
  return text + escaped(facts);
}

void set_options(const Report& report, PageJson& data) {
  std::string of = "method " + report.method;
  PageJson changed = PageJson::array(), others = PageJson::array();
  for (const ReportOption& option : report.options) {
    (option.changed ? changed : others)
        .push_back({{"name", option.name},
                    {"value", option.value},
                    {"unit", option.unit},
                    {"meaning", option.meaning},
                    {"changed", option.changed}});
    if (option.name == "profile") of = "profile " + option.value;
  }
  data["options_of"] = of;
  data["changed_text"] =
      changed.empty() ? "unchanged" : counted(changed.size(), "option") + " changed, listed first";
  changed.insert(changed.end(), others.begin(), others.end());
  data["options"] = std::move(changed);
}

PageJson hashes_of(const Report& report) {
  PageJson hashes = PageJson::array();
  const auto add = [&](const std::string& name, const std::string& sha256) {
    if (!sha256.empty()) hashes.push_back({{"name", name}, {"sha256", sha256}});
  };
  for (const ReportRecording& recording : report.recordings) {
    add(recording.name, recording.sha256);
    for (const ReportFrame& frame : recording.frames)
      add(fmt::format("{}, frame {}", recording.name, frame.index), frame.sha256);
  }
  return hashes;
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

void set_rules(const Judgement& judgement, PageJson& data) {
  for (const Rule& rule : judgement.rules) {
    if (rule.level == RuleLevel::off) continue;
    const auto broken = std::ranges::count(judgement.breaches, rule, &Breach::rule);
    const bool idle = std::ranges::count(judgement.idle, rule, &IdleRule::rule) > 0;
    const char* bad = rule.level == RuleLevel::error && !idle ? "failed" : "warning";
    data["rules"].push_back(
        {{"metric", rule.metric},
         {"meaning", find_metric(rule.metric).meaning},
         {"frames", frames_of(rule)},
         {"limits", limits_of(rule)},
         {"level", to_string(rule.level)},
         {"broken", broken > 0 ? counted(static_cast<std::size_t>(broken), "time")
                    : idle     ? "not applied"
                               : "no"},
         {"class", broken > 0 || idle ? bad : ""}});
  }
  if (!judgement.baseline) return;
  const Report& baseline = *judgement.baseline;
  data["baseline"] = fmt::format(
      "<code>{}</code>: planescope {}, commit <code>{}</code>{}, written {}, <code>{}</code>",
      escaped(judgement.baseline_file), escaped(baseline.version), escaped(baseline.commit),
      baseline.modified ? " with uncommitted changes" : "", escaped(baseline.created_utc),
      escaped(baseline.command));
}

PageJson histograms_data(const Report& report) {
  PageJson list = PageJson::array();
  for (const ValueHistogram& histogram : summed(report)) {
    if (histogram.total() == 0) continue;
    list.push_back({{"title", title_of(histogram)},
                    {"says", fmt::format("{} of {} within the threshold",
                                         share(within_threshold(histogram), histogram.total()),
                                         grouped(histogram.total()))},
                    {"svg", cumulative_chart(histogram)}});
  }
  return list;
}

/// One phrase per case of the paper's figure.
PageJson cases_data(const Report& report) {
  constexpr const char* kMeanings[] = {"", "mixed labels (fails Criterion 1): divided",
                                       "too few points (fails Criterion 2): unassigned",
                                       "one label but not planar (fails Criterion 3): divided",
                                       "planar: a candidate; its outliers are unassigned"};
  PageJson cases = PageJson::array();
  for (int c = 1; c <= 4; ++c)
    cases.push_back({{"numeral", planes::to_string(static_cast<planes::Case>(c))},
                     {"color", safe_color(report.case_colors[c])},
                     {"meaning", kMeanings[c]}});
  return cases;
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
  if (least <= 1) result += fmt::format(" (confidence at least {:.2f})", least);
  return result;
}

void set_verdict(const PageSource& page, PageJson& data) {
  const ReportTotals totals = totals_of(page.report);
  const Judgement* judgement = page.report.judgement.get();
  set_banner(page, data);
  if (judgement) data["differences"] = differences_of(*judgement);
  data["general"] = general_data(page.plan, judgement);
  data["partial"] = page.report.partial;
  data["frames_done"] = totals.frames_done + totals.frames_refused;
  data["frames_asked"] = totals.frames_asked;
  data["renderer_error"] = page.report.renderer_error;
  data["summary"] = summary(page.report, totals);
  if (page.has_baseline()) data["changes"] = all_changes(page.plan);
  data["tiles"] = tiles(page, totals);
  for (const PageFrame* frame : page.plan.worst) data["worst"].push_back(worst_data(page, *frame));
  data["worst_title"] = worst_title(page.report);
  data["worst_note"] = worst_note(page);
  if (page.plan.frames.size() > kFramesAllOpen) data["contents"] = contents_data(page);
}

PageJson end_data(const PageSource& page) {
  const Report& report = page.report;
  PageJson data = {{"histograms", histograms_data(report)},
                   {"command", report.command + " -o DIR"},
                   {"version", report.version},
                   {"commit", report.commit},
                   {"modified", report.modified},
                   {"method", report.method},
                   {"is_ours", report.is_ours()},
                   {"classifier", report.classifier.empty() ? "none" : report.classifier},
                   {"weights", report.weights ? weights_text(*report.weights) : "none"},
                   {"renderer", report.renderer.empty() ? "none" : report.renderer},
                   {"created", report.created_utc},
                   {"hashes", hashes_of(report)},
                   {"cases", cases_data(report)}};
  set_options(report, data);
  if (report.judgement) set_rules(*report.judgement, data);
  return data;
}

}  // namespace planescope::report::html
