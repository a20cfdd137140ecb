// What became of a frame's planes since the baseline.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/io/image/png.hpp"
#include "core/report/data/plane_map.hpp"
#include "core/report/page/report_html_pieces.hpp"
#include "core/report/page/thumbnail.hpp"

namespace planescope::report::html {
namespace {

constexpr PlaneFate kChanges[] = {PlaneFate::lost,  PlaneFate::gained, PlaneFate::merged,
                                  PlaneFate::split, PlaneFate::moved,  PlaneFate::resized};

std::string png_source(const Image8& image) {
  return "data:image/png;base64," + base64(io::encode_png(image));
}

ComparedInks inks_of(const PageFrame& frame) {
  std::vector<std::string> colors;
  for (const ReportPlane& plane : frame.frame->planes) colors.push_back(safe_color(plane.color));
  return compared_inks(frame.comparison->planes, frame.comparison->baseline->planes.size(), colors);
}

/// Those that changed first, the worst of them in front.
std::vector<const PlaneComparison*> by_change(const FrameComparison& frame) {
  std::vector<const PlaneComparison*> planes;
  for (const PlaneFate fate : kChanges)
    for (const PlaneComparison& plane : frame.planes)
      if (plane.fate == fate) planes.push_back(&plane);
  for (const PlaneComparison& plane : frame.planes)
    if (plane.fate == PlaneFate::same) planes.push_back(&plane);
  return planes;
}

std::string others_text(const PlaneComparison& plane) {
  if (plane.others.empty()) return "";
  const char* what = plane.fate == PlaneFate::merged ? "with" : "also";
  return fmt::format("{} {}", what, fmt::join(plane.others, ", "));
}

const PlaneSummary* summary_of(const std::vector<PlaneSummary>& planes, int id) {
  return id > 0 ? &planes.at(static_cast<std::size_t>(id) - 1) : nullptr;
}

std::string area_text(const PlaneSummary* plane) {
  return plane ? fmt::format("{:.3f}", plane->area_m2) : "";
}

std::string place_of(const PageFrame& frame, const PlaneComparison& plane) {
  return plane.now > 0 ? fmt::format("{}/p{}", frame.anchor, plane.now)
                       : fmt::format("{}/was{}", frame.anchor, plane.baseline);
}

/// One for each plane that changed, where the frame fails.
std::vector<std::string> commands_of(const PageFrame& frame) {
  std::vector<std::string> commands;
  if (frame.standing != Standing::failed) return commands;
  for (const PlaneComparison* plane : by_change(*frame.comparison))
    if (plane->fate != PlaneFate::same)
      commands.push_back("planescope view --open report.json#" + place_of(frame, *plane));
  return commands;
}

Data fate_data(const PageFrame& frame, const PlaneComparison& plane, const ComparedInks& inks) {
  const auto color = [](const std::vector<PlaneInk>& of, int id) {
    return of[static_cast<std::size_t>(id) - 1].color;
  };
  Data row;
  row.set("fate", to_string(plane.fate));
  row.set("was", plane.baseline > 0 ? Data(std::to_string(plane.baseline)) : Data(false));
  row.set("is", plane.now > 0 ? Data(std::to_string(plane.now)) : Data(false));
  if (plane.baseline > 0) row.set("was_color", color(inks.baseline, plane.baseline));
  if (plane.now > 0) row.set("is_color", color(inks.now, plane.now));
  row.set("others", text_or_false(others_text(plane)));
  const std::string place = place_of(frame, plane);
  row.set("place", place);
  row.set("own_anchor", plane.now > 0 ? Data(false) : Data(place));
  const bool in_both = plane.baseline > 0 && plane.now > 0;
  row.set("offset", in_both ? fmt::format("{:.1f}", 1000 * plane.offset_m) : "");
  row.set("angle", in_both ? fmt::format("{:.2f}", plane.angle_deg) : "");
  const PlaneSummary* was = summary_of(frame.comparison->baseline->planes, plane.baseline);
  const PlaneSummary* is = summary_of(frame.comparison->now->planes, plane.now);
  row.set("area_was", area_text(was));
  row.set("area", area_text(is));
  row.set("ratio", in_both ? fmt::format("{:.0f} %", 100 * plane.area_ratio) : "");
  row.set("iou", in_both ? fmt::format("{:.2f}", plane.iou) : "");
  row.set("changed", plane.fate != PlaneFate::same);
  return row;
}

/// Why frames are not compared, for people.
std::string not_compared(FrameFate fate) {
  switch (fate) {
    case FrameFate::other_input:
      return "The pixels or points of this frame are not those of the baseline\u2019s: planes are "
             "not compared.";
    case FrameFate::refused:
      return "The baseline has this frame\u2019s planes; now it was refused.";
    case FrameFate::mended:
      return "The baseline refused this frame.";
    case FrameFate::added:
      return "The baseline does not have this frame.";
    case FrameFate::both_refused:
      return "The baseline refused this frame too.";
    case FrameFate::missing:
    case FrameFate::compared:
      break;
  }
  return "";
}

}  // namespace

std::string changes_text(const PageFrame& frame) {
  if (!frame.is_compared()) return to_string(frame.comparison->fate);
  std::vector<std::string> parts;
  for (const PlaneFate fate : kChanges)
    if (const int count = frame.comparison->count(fate); count > 0)
      parts.push_back(fmt::format("{} {}", count, to_string(fate)));
  return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", "));
}

PlaneMaps plane_maps(const PageFrame& frame) {
  PlaneMaps maps;
  if (!frame.is_compared()) return maps;
  const ComparedInks inks = inks_of(frame);
  const Image8 was = draw_plane_map(frame.comparison->baseline->regions, inks.baseline);
  const Image8 now = draw_plane_map(frame.comparison->now->regions, inks.now);
  if (was.empty() || now.empty()) return maps;
  maps.baseline = png_source(was);
  maps.now = png_source(now);
  maps.width = now.width;
  maps.height = now.height;
  return maps;
}

void set_comparison(const PageSource& page, const PageFrame& frame, Data& data) {
  data.set("compared", false);
  data.set("unchanged", false);
  data.set("not_compared", false);
  if (!page.has_baseline()) return;
  if (!frame.is_compared()) {
    data.set("not_compared", text_or_false(not_compared(frame.comparison->fate)));
    return;
  }
  const std::string changes = changes_text(frame);
  if (changes == "none") {
    data.set("unchanged", counted(frame.comparison->planes.size(), "plane"));
    return;
  }
  Data compared;
  compared.set("changes", changes);
  const PlaneMaps maps = plane_maps(frame);
  compared.set("has_maps", !maps.now.empty());
  compared.set("baseline_source", maps.baseline);
  compared.set("now_source", maps.now);
  compared.set("map_width", std::to_string(maps.width));
  compared.set("map_height", std::to_string(maps.height));
  compared.set("of_frame", title_of(page, frame));
  const ComparedInks inks = inks_of(frame);
  Data fates{Data::type::list};
  for (const PlaneComparison* plane : by_change(*frame.comparison))
    fates.push_back(fate_data(frame, *plane, inks));
  compared.set("fates", fates);
  const std::vector<std::string> commands = commands_of(frame);
  compared.set("has_commands", !commands.empty());
  compared.set("commands", list_of("text", commands));
  data.set("compared", compared);
}

}  // namespace planescope::report::html
