// The top of the page: whether the report holds, what to look at first, and the totals.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/planes/cloud/gravity.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/page/report_html_pieces.hpp"

namespace planescope::report::html {
namespace {

std::string range_text(int fewest, int most) {
  return fewest == most ? std::to_string(most) : fmt::format("{}\u2013{}", fewest, most);
}

/// What told h from v, as HTML.
std::string classifier_text(const Report& report) {
  if (report.method != planes::Method::ours) return "the tilt of each plane";
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
      range_text(totals.fewest_planes, totals.most_planes), "");
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
  return fmt::format("{} and {}", counted(static_cast<std::size_t>(judgement.errors()), "error"),
                     counted(static_cast<std::size_t>(judgement.warnings()), "warning"));
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
  return fmt::format("{} of the points on planes",
                     share(frame.frame->points_on_planes, frame.frame->counts.kept));
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
  for (const Breach* breach : frame.breaches) reasons.push_back(text_of(*breach));
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
  for (const Breach* breach : plan.general) {
    Data row;
    row.set("level", to_string(breach->rule.level));
    row.set("class", breach->rule.level == RuleLevel::error ? "failed" : "warning");
    row.set("where", breach->recording.empty() ? "all frames" : breach->recording);
    row.set("text", text_of(*breach));
    list.push_back(row);
  }
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
  return fmt::format("The {} of {} that fare worst: refused ones, then those with the least {}.",
                     shown, counted(all, "frame"),
                     page.has_metrics() ? "IoU with the labels" : "points on planes");
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

}  // namespace planescope::report::html
