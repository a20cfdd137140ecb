// A recording on the page: its facts, charts over its frames, and a line for each frame.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/report/data/report_files.hpp"
#include "core/report/page/charts.hpp"
#include "core/report/page/page.hpp"

namespace planescope::report::html {
namespace {

const char* const kThumbnails[] = {"overlay", "truth", "cases"};

/// Cells that can be sorted by their values.
PageJson figures_of(const PageSource& page, const ReportFrame& frame) {
  PageJson cells = PageJson::array();
  const auto add = [&](const char* column, const std::string& text, double value,
                       const std::string& more = "") {
    cells.push_back({{"column", column},
                     {"text", text},
                     {"more", more},
                     {"value", std::isnan(value) ? "" : fmt::format("{:.6g}", value)}});
  };
  const auto planes = static_cast<double>(frame.planes.size());
  add("Planes", std::to_string(frame.planes.size()), planes,
      frame.gravity.known() ? fmt::format("{} h, {} v", frame.planes_h, frame.planes_v)
                            : "without h and v");
  add("On planes", share(frame.points_on_planes, frame.counts.kept), frame.percent_on_planes());
  if (!page.has_metrics()) return cells;
  for (const FrameMetric& metric : frame_metrics()) {
    if (!metric.column) continue;
    const double value = metric.value(frame);
    const char* unit = std::string_view(metric.unit) == "%" ? " %" : "\u00b0";
    add(metric.column, std::isnan(value) ? "" : fmt::format("{:.1f}{}", value, unit), value);
  }
  return cells;
}

/// Changes weighted by severity, so that sorting puts lost planes before moved ones.
double weight_of(const FrameComparison& frame) {
  if (frame.fate != FrameFate::compared) return frame.fate == FrameFate::added ? 0.5 : 1e6;
  double weight = 0;
  for (const PlaneComparison& plane : frame.planes)
    weight += plane.fate == PlaneFate::same                                        ? 0
              : plane.fate == PlaneFate::moved || plane.fate == PlaneFate::resized ? 1
                                                                                   : 100;
  return weight;
}

constexpr std::size_t kFewestForTrends = 3;

PageJson facts(const ReportRecording& recording) {
  PageJson result = PageJson::array();
  const auto add = [&](const char* name, const std::string& value) {
    if (!value.empty()) result.push_back({{"name", name}, {"value", value}});
  };
  const io::RecordingInfo& info = recording.info;
  add("Path", "<code>" + escaped(info.path.string()) + "</code>");
  add("Format", escaped(info.format));
  add("Sensor", escaped(info.device));
  add("Frames", recording.frames_asked == recording.frame_count
                    ? std::to_string(recording.frame_count)
                    : fmt::format("{} of {}", recording.frames_asked, recording.frame_count));
  if (info.width > 0) {
    const Intrinsics& k = info.intrinsics;
    add("Depth", escaped(fmt::format("{}\u00d7{}, 1 unit = {:.6g} mm ({})", info.width, info.height,
                                     1000 * info.depth_unit_m, info.depth_unit_source)));
    add("Intrinsics", escaped(fmt::format("fx {:.2f}, fy {:.2f}, cx {:.2f}, cy {:.2f} px ({})",
                                          k.fx, k.fy, k.cx, k.cy, info.intrinsics_source)));
    add("Color", escaped(info.has_color ? info.color_note : "none"));
  }
  add("Gravity", gravity_summary({recording}));
  return result;
}

/// A figure of each of these frames now and, if available, in the baseline; empty: no frame has it.
std::string trend(const FrameMetric& metric,
                  const std::vector<const PageFrame*>& frames,
                  bool has_baseline) {
  const auto value_of = [&](const ReportFrame* frame) {
    return frame && frame->refused.empty() ? metric.value(*frame) : std::nan("");
  };
  LineChart chart;
  chart.title = std::string(metric.chart.name) + " by frame";
  chart.x_name = "frame";
  chart.from_zero = metric.chart.from_zero;
  chart.x_from = frames.front()->frame->index;
  Curve curve_now{"now", {}, 0}, curve_before{"baseline", {}, 1};
  for (const PageFrame* frame : frames) {
    chart.x.push_back(frame->frame->index);
    curve_now.values.push_back(value_of(frame->frame));
    curve_before.values.push_back(
        value_of(frame->comparison ? frame->comparison->baseline : nullptr));
  }
  const bool unless_zero = metric.chart.unless_zero;
  if (std::ranges::all_of(curve_now.values,
                          [&](double v) { return std::isnan(v) || (unless_zero && v == 0); }))
    return "";
  if (has_baseline) chart.curves.push_back(std::move(curve_before));
  chart.curves.push_back(std::move(curve_now));  // on top
  return line_chart(chart);
}

PageJson trends_data(const PageSource& page, std::size_t recording) {
  std::vector<const PageFrame*> frames;
  for (const PageFrame& frame : page.plan.frames)
    if (frame.frame && frame.recording == recording) frames.push_back(&frame);
  std::ranges::stable_sort(frames, {}, [](const PageFrame* f) { return f->frame->index; });
  PageJson list = PageJson::array();
  if (frames.size() < kFewestForTrends) return list;
  for (const FrameMetric& metric : frame_metrics()) {
    if (!metric.chart.heading) continue;
    const std::string svg = trend(metric, frames, page.has_baseline());
    if (!svg.empty()) list.push_back({{"name", metric.chart.heading}, {"svg", svg}});
  }
  return list;
}

}  // namespace

const char* name_of(Standing standing) {
  constexpr const char* kNames[] = {"done", "passed", "warning", "failed"};
  return kNames[static_cast<std::size_t>(standing)];
}

const char* result_of(const PageFrame& frame) {
  return !frame.frame ? "missing" : frame.is_refused() ? "rejected" : name_of(frame.standing);
}

std::string title_of(const PageSource& page, const PageFrame& frame) {
  const int index = frame.frame ? frame.frame->index : frame.comparison->index;
  if (page.report.recordings.size() == 1 && frame.frame) return fmt::format("Frame {}", index);
  return fmt::format("Frame {} of {}", index,
                     frame.frame ? page.recording_of(frame).name : frame.comparison->recording);
}

PageJson thumbnails(const PageSource& page, const PageFrame& frame, std::size_t most) {
  PageJson list = PageJson::array();
  if (!frame.frame) return list;
  const std::string title = title_of(page, frame);
  const auto add = [&](const std::string& source, const std::string& to, const std::string& what) {
    list.push_back(
        {{"source", source}, {"href", to}, {"alt", what + ", " + title}, {"title", what}});
  };
  for (const char* name : kThumbnails) {
    const auto& pictures = frame.frame->pictures;
    const auto picture = std::ranges::find(pictures, name, &ReportPicture::name);
    if (picture == pictures.end() || list.size() == most) continue;
    const std::string source = webp_source(page.dir / thumbnail_of(*picture));
    if (!source.empty())
      add(source, frame.embedded ? "#" + frame.anchor + "/" + picture->name : href(picture->file),
          picture->title);
  }
  if (const PlaneMaps maps = plane_maps(frame); !maps.baseline.empty())
    add(maps.baseline, "#" + frame.anchor, "The baseline\u2019s planes");
  return list;
}

PageJson row_data(const PageSource& page, const PageFrame& frame) {
  const ReportFrame* now = frame.frame;
  const bool several = page.report.recordings.size() > 1 || !now;
  const std::vector<const Breach*>& reasons = frame.breaches.empty() ? frame.notes : frame.breaches;
  PageJson row = {
      {"anchor", frame.anchor},
      {"missing", now == nullptr},
      {"index", now ? now->index : frame.comparison->index},
      {"place", &frame - page.plan.frames.data()},
      {"rank", frame.rank},
      {"name", frame.comparison ? frame.comparison->name : now->name},
      {"recording", !several ? ""
                    : now    ? page.recording_of(frame).name
                             : frame.comparison->recording},
      {"thumbnails", thumbnails(page, frame, std::size(kThumbnails))},
      {"standing", name_of(frame.standing)},
      {"standing_text", result_of(frame)},
      {"reason", frame.is_refused() ? now->refused
                 : !reasons.empty() ? reasons[0]->text()
                                    : ""},
      {"more", reasons.size() > 1 ? fmt::format("and {} more", reasons.size() - 1) : ""},
      {"has_change", page.has_baseline()}};
  if (page.has_baseline()) {
    row["change"] = changes_text(frame);
    row["change_value"] = fmt::format("{:.6g}", weight_of(*frame.comparison));
  }
  if (now && !frame.is_refused())
    row["figures"] = figures_of(page, *now);
  else
    row["no_figures"] = page.has_metrics() ? 6 : 2;
  return row;
}

PageJson recording_data(const PageSource& page, std::size_t index) {
  const ReportRecording& recording = page.report.recordings[index];
  const std::string overview = overview_of(recording);
  const bool is_there = recording.frames.size() > 1 && !overview.empty() &&
                        std::filesystem::exists(page.dir / overview);
  return {{"anchor", fmt::format("r{}", index + 1)},
          {"name", recording.name},
          {"facts", facts(recording)},
          {"warnings", recording.info.warnings},
          {"trends", trends_data(page, index)},
          {"overview", is_there ? href(overview) : ""}};
}

}  // namespace planescope::report::html
