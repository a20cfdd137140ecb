// A recording: its facts, how its frames go, and a line for each of them.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/report/data/report_files.hpp"
#include "core/report/page/charts.hpp"
#include "core/report/page/page.hpp"

namespace planescope::report::html {
namespace {

const char* const kThumbnails[] = {"overlay", "truth", "cases"};

/// A cell that can be sorted by its value.
Data cell(const std::string& text, double value) {
  Data data;
  data.set("text", text);
  data.set("more", false);
  data.set("value", std::isnan(value) ? std::string() : fmt::format("{:.6g}", value));
  return data;
}

Data figures_of(const PageSource& page, const ReportFrame& frame) {
  Data cells{Data::type::list};
  Data planes = cell(std::to_string(frame.planes.size()), double(frame.planes.size()));
  planes.set("more", frame.gravity.known()
                         ? fmt::format("{} h, {} v", frame.planes_h, frame.planes_v)
                         : std::string("without h and v"));
  cells.push_back(planes);
  cells.push_back(
      cell(share(frame.points_on_planes, frame.counts.kept), frame.percent_on_planes()));
  if (!page.has_metrics()) return cells;
  const auto metric = [&](double planes::Metrics::*field, const char* unit) {
    const double value = frame.metrics ? *frame.metrics.*field : std::nan("");
    cells.push_back(std::isnan(value) ? cell("", value)
                                      : cell(fmt::format("{:.1f}{}", value, unit), value));
  };
  metric(&planes::Metrics::mean_iou, " %");
  metric(&planes::Metrics::pq, " %");
  metric(&planes::Metrics::point_accuracy, " %");
  metric(&planes::Metrics::alpha_deg, "\u00b0");
  return cells;
}

/// Kinds of changes are weighted by what they cost: sorting puts lost planes before moved ones.
double weight_of(const FrameComparison& frame) {
  if (frame.fate != FrameFate::compared) return frame.fate == FrameFate::added ? 0.5 : 1e6;
  double weight = 0;
  for (const PlaneComparison& plane : frame.planes)
    weight += plane.fate == PlaneFate::same                                        ? 0
              : plane.fate == PlaneFate::moved || plane.fate == PlaneFate::resized ? 1
                                                                                   : 100;
  return weight;
}

void add_thumbnail(Data& list,
                   const std::string& source,
                   const std::string& href_of,
                   const std::string& alt,
                   const std::string& title) {
  Data data;
  data.set("source", source);
  data.set("href", href_of);
  data.set("alt", alt);
  data.set("title", title);
  list.push_back(data);
}

constexpr std::size_t kFewestForTrends = 3;

Data facts(const ReportRecording& recording) {
  Data result{Data::type::list};
  const auto add = [&](const std::string& name, const std::string& value) {
    if (value.empty()) return;
    Data fact;
    fact.set("name", name);
    fact.set("value", value);
    result.push_back(fact);
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
    add("Colour", escaped(info.has_color ? info.color_note : "none"));
  }
  add("Gravity", gravity_summary({recording}));
  return result;
}

using FrameFigure = double (*)(const ReportFrame&);

/// A value of each frame now and, where there is one, in the baseline.
class Trends {
 public:
  Trends(const PageSource& page, std::size_t recording) : page_(page) {
    for (const PageFrame& frame : page.plan.frames)
      if (frame.frame && frame.recording == recording) frames_.push_back(&frame);
    std::ranges::stable_sort(frames_, {}, [](const PageFrame* f) { return f->frame->index; });
  }
  std::size_t size() const { return frames_.size(); }

  std::string chart(const std::string& name, FrameFigure figure, bool from_zero) const {
    LineChart chart;
    chart.title = name + " by frame";
    chart.x_name = "frame";
    chart.from_zero = from_zero;
    chart.x_from = frames_.front()->frame->index;
    Curve curve_now{"now", {}, 0}, curve_before{"baseline", {}, 1};
    for (const PageFrame* frame : frames_) {
      chart.x.push_back(frame->frame->index);
      curve_now.values.push_back(frame->is_refused() ? std::nan("") : figure(*frame->frame));
      const ReportFrame* baseline = frame->comparison ? frame->comparison->baseline : nullptr;
      curve_before.values.push_back(baseline && baseline->refused.empty() ? figure(*baseline)
                                                                          : std::nan(""));
    }
    if (std::ranges::all_of(curve_now.values, [](double v) { return std::isnan(v); })) return "";
    if (page_.has_baseline()) chart.curves.push_back(std::move(curve_before));
    chart.curves.push_back(std::move(curve_now));  // on top
    return line_chart(chart);
  }
  template <double planes::Metrics::*kField>
  std::string metric_chart(const std::string& name) const {
    return chart(
        name, [](const ReportFrame& f) { return f.metrics ? (*f.metrics).*kField : std::nan(""); },
        false);
  }
  template <auto kField>
  std::string tracks_chart(const std::string& name, bool from_zero) const {
    return chart(
        name,
        [](const ReportFrame& f) {
          return f.tracks ? static_cast<double>((*f.tracks).*kField) : std::nan("");
        },
        from_zero);
  }

 private:
  const PageSource& page_;
  std::vector<const PageFrame*> frames_;
};

Data trends_data(const PageSource& page, std::size_t recording) {
  Data list{Data::type::list};
  const Trends trends(page, recording);
  if (trends.size() < kFewestForTrends) return list;
  const auto add = [&](const char* name, const std::string& svg) {
    if (svg.empty()) return;
    Data data;
    data.set("name", name);
    data.set("svg", svg);
    list.push_back(data);
  };
  add("Planes", trends.chart(
                    "Planes", [](const ReportFrame& f) { return double(f.planes.size()); }, true));
  add("Points on planes [%]", trends.chart(
                                  "Points on planes",
                                  [](const ReportFrame& f) {
                                    return f.counts.kept > 0 ? f.percent_on_planes() : std::nan("");
                                  },
                                  false));
  add("Mean IoU with the labels [%]", trends.metric_chart<&planes::Metrics::mean_iou>("Mean IoU"));
  add("Panoptic quality [%]", trends.metric_chart<&planes::Metrics::pq>("Panoptic quality"));
  add("Angle error [\u00b0]", trends.metric_chart<&planes::Metrics::alpha_deg>("Angle error"));
  add("Steppable area [m\u00b2]", trends.chart(
                                      "Steppable area",
                                      [](const ReportFrame& f) {
                                        return f.terrain ? f.terrain->steppable_area_m2
                                                         : std::nan("");
                                      },
                                      true));
  add("Planes lost from the frame before",
      trends.tracks_chart<&FrameTracks::breaks>("Planes lost", true));
  add("Pixels on planes that go on [%]",
      trends.tracks_chart<&FrameTracks::kept_percent>("Pixels that go on", false));
  const auto has_stairs = [](const ReportFrame& f) { return f.terrain && f.terrain->steps() > 0; };
  if (std::ranges::any_of(page.report.recordings[recording].frames, has_stairs))
    add("Steps of stairs",
        trends.chart(
            "Steps of stairs",
            [](const ReportFrame& f) { return f.terrain ? f.terrain->steps() : std::nan(""); },
            true));
  return list;
}

}  // namespace

const char* name_of(Standing standing) {
  switch (standing) {
    case Standing::none:
      return "done";
    case Standing::passed:
      return "passed";
    case Standing::warned:
      return "warning";
    case Standing::failed:
      return "failed";
  }
  return "";
}

std::string title_of(const PageSource& page, const PageFrame& frame) {
  const int index = frame.frame ? frame.frame->index : frame.comparison->index;
  if (page.report.recordings.size() == 1 && frame.frame) return fmt::format("Frame {}", index);
  return fmt::format("Frame {} of {}", index,
                     frame.frame ? page.recording_of(frame).name : frame.comparison->recording);
}

Data thumbnails(const PageSource& page, const PageFrame& frame, std::size_t most) {
  Data list{Data::type::list};
  if (!frame.frame) return list;
  std::size_t count = 0;
  for (const char* name : kThumbnails) {
    const auto& pictures = frame.frame->pictures;
    const auto picture = std::ranges::find(pictures, name, &ReportPicture::name);
    if (picture == pictures.end() || count == most) continue;
    const std::string source = webp_source(page.dir / thumbnail_of(*picture));
    if (source.empty()) continue;
    add_thumbnail(list, source,
                  frame.embedded ? "#" + frame.anchor + "/" + picture->name : href(picture->file),
                  fmt::format("{}, {}", picture->title, title_of(page, frame)), picture->title);
    ++count;
  }
  if (const PlaneMaps maps = plane_maps(frame); !maps.baseline.empty())
    add_thumbnail(list, maps.baseline, "#" + frame.anchor,
                  fmt::format("The baseline\u2019s planes, {}", title_of(page, frame)),
                  "The baseline\u2019s planes");
  return list;
}

Data row_data(const PageSource& page, const PageFrame& frame) {
  const ReportFrame* now = frame.frame;
  Data row;
  row.set("anchor", frame.anchor);
  row.set("missing", now == nullptr);
  row.set("index", std::to_string(now ? now->index : frame.comparison->index));
  row.set("place", std::to_string(&frame - page.plan.frames.data()));
  row.set("rank", std::to_string(frame.rank));
  row.set("name", text_or_false(now ? now->name : ""));
  const bool several = page.report.recordings.size() > 1 || !now;
  row.set("recording", several
                           ? Data(now ? page.recording_of(frame).name : frame.comparison->recording)
                           : Data(false));
  row.set("thumbnails", thumbnails(page, frame, std::size(kThumbnails)));
  row.set("standing", name_of(frame.standing));
  row.set("standing_text", !now                 ? "missing"
                           : frame.is_refused() ? "refused"
                                                : name_of(frame.standing));
  const std::vector<const Breach*>& reasons = frame.breaches.empty() ? frame.notes : frame.breaches;
  row.set("reason", text_or_false(frame.is_refused() ? now->refused
                                  : !reasons.empty() ? reasons[0]->text()
                                                     : ""));
  row.set("more",
          reasons.size() > 1 ? Data(fmt::format("and {} more", reasons.size() - 1)) : Data(false));
  row.set("has_change", page.has_baseline());
  if (page.has_baseline()) {
    row.set("change", changes_text(frame));
    row.set("change_value", fmt::format("{:.6g}", weight_of(*frame.comparison)));
  }
  const bool has_figures = now && !frame.is_refused();
  row.set("figures", has_figures ? figures_of(page, *now) : Data{Data::type::list});
  row.set("no_figures",
          has_figures ? Data(false) : Data(std::to_string(page.has_metrics() ? 6 : 2)));
  return row;
}

Data recording_data(const PageSource& page, std::size_t index) {
  const ReportRecording& recording = page.report.recordings[index];
  Data data;
  data.set("anchor", fmt::format("r{}", index + 1));
  data.set("name", recording.name);
  data.set("facts", facts(recording));
  data.set("has_warnings", !recording.info.warnings.empty());
  data.set("warnings", list_of("text", recording.info.warnings));
  const Data trends = trends_data(page, index);
  data.set("has_trends", trends.is_non_empty_list());
  data.set("trends", trends);
  const std::string overview = overview_of(recording);
  const bool is_there = recording.frames.size() > 1 && !overview.empty() &&
                        std::filesystem::exists(page.dir / overview);
  data.set("overview", is_there ? Data(href(overview)) : Data(false));
  return data;
}

}  // namespace planescope::report::html
