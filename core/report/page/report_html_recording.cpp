// The part of the page that is about a recording as a whole.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/report/data/report_files.hpp"
#include "core/report/page/line_chart.hpp"
#include "core/report/page/report_html_pieces.hpp"

namespace planescope::report::html {
namespace {

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

using ValueNow = double (*)(const ReportFrame&);
using ValueBefore = double (*)(const RecordedFrame&);

double percent(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole) : std::nan("");
}

/// A value of each frame now and, where there is one, in the baseline.
class Trends {
 public:
  Trends(const PageSource& page, std::size_t recording) : page_(page) {
    for (const PageFrame& frame : page.plan.frames)
      if (frame.frame && frame.recording == recording) frames_.push_back(&frame);
    std::ranges::stable_sort(frames_, {}, [](const PageFrame* f) { return f->frame->index; });
  }
  std::size_t size() const { return frames_.size(); }

  std::string chart(const std::string& name,
                    ValueNow now,
                    ValueBefore before,
                    bool from_zero) const {
    LineChart chart;
    chart.title = name + " by frame";
    chart.x_name = "frame";
    chart.from_zero = from_zero;
    chart.x_from = frames_.front()->frame->index;
    Curve curve_now{"now", {}, 0}, curve_before{"baseline", {}, 1};
    for (const PageFrame* frame : frames_) {
      chart.x.push_back(frame->frame->index);
      curve_now.values.push_back(frame->is_refused() ? std::nan("") : now(*frame->frame));
      const RecordedFrame* baseline = frame->comparison ? frame->comparison->baseline : nullptr;
      curve_before.values.push_back(baseline && baseline->refused.empty() ? before(*baseline)
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
        [](const RecordedFrame& f) { return f.metrics ? (*f.metrics).*kField : std::nan(""); },
        false);
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
                    "Planes", [](const ReportFrame& f) { return double(f.planes.size()); },
                    [](const RecordedFrame& f) { return double(f.planes.size()); }, true));
  add("Points on planes [%]",
      trends.chart(
          "Points on planes",
          [](const ReportFrame& f) { return percent(f.points_on_planes, f.counts.kept); },
          [](const RecordedFrame& f) { return percent(f.points_on_planes, f.points); }, false));
  add("Mean IoU with the labels [%]", trends.metric_chart<&planes::Metrics::mean_iou>("Mean IoU"));
  add("Panoptic quality [%]", trends.metric_chart<&planes::Metrics::pq>("Panoptic quality"));
  add("Angle error [\u00b0]", trends.metric_chart<&planes::Metrics::alpha_deg>("Angle error"));
  return list;
}

}  // namespace

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
