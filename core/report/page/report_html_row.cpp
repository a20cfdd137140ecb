// One line per frame, with thumbnails.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/report/page/report_html_pieces.hpp"

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

double share_on_planes(const ReportFrame& frame) {
  const auto points = static_cast<double>(frame.counts.kept);
  return points > 0 ? 100 * static_cast<double>(frame.points_on_planes) / points : 0;
}

Data figures_of(const PageSource& page, const ReportFrame& frame) {
  Data cells{Data::type::list};
  Data planes = cell(std::to_string(frame.planes.size()), double(frame.planes.size()));
  planes.set("more", frame.gravity.known()
                         ? fmt::format("{} h, {} v", frame.planes_h, frame.planes_v)
                         : std::string("without h and v"));
  cells.push_back(planes);
  cells.push_back(cell(share(frame.points_on_planes, frame.counts.kept), share_on_planes(frame)));
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
    const std::string source = jpeg_source(page.dir / thumbnail_of(*picture));
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
  row.set("reason", text_or_false(frame.is_refused()        ? now->refused
                                  : !frame.breaches.empty() ? text_of(*frame.breaches[0])
                                                            : ""));
  row.set("more", frame.breaches.size() > 1
                      ? Data(fmt::format("and {} more", frame.breaches.size() - 1))
                      : Data(false));
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

}  // namespace planescope::report::html
