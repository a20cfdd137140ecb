// One frame of the page: changes of its planes since the baseline, its pictures and its figures.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <ranges>

#include "core/io/image/png.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/page/page.hpp"
#include "core/report/page/pictures.hpp"

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

/// Changed planes first, the worst at the front.
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

const planes::PlaneSummary* summary_of(const ReportFrame& frame, int id) {
  return id > 0 ? &frame.planes.at(static_cast<std::size_t>(id) - 1).summary : nullptr;
}

std::string vector_text(const Vec3d& v) {
  return fmt::format("{}, {}, {}", decimal(v.x(), 3), decimal(v.y(), 3), decimal(v.z(), 3));
}

std::string area_text(const planes::PlaneSummary* plane) {
  return plane ? fmt::format("{:.3f}", plane->area_m2) : "";
}

std::string place_of(const PageFrame& frame, const PlaneComparison& plane) {
  return plane.now > 0 ? fmt::format("{}/p{}", frame.anchor, plane.now)
                       : fmt::format("{}/was{}", frame.anchor, plane.baseline);
}

/// One command for each plane that changed, if the frame fails.
std::vector<std::string> commands_of(const PageFrame& frame) {
  std::vector<std::string> commands;
  if (frame.standing != Standing::failed) return commands;
  for (const PlaneComparison* plane : by_change(*frame.comparison))
    if (plane->fate != PlaneFate::same)
      commands.push_back("planescope view --open report.json#" + place_of(frame, *plane));
  return commands;
}

PageJson fate_data(const PageFrame& frame, const PlaneComparison& plane, const ComparedInks& inks) {
  const auto id_or_none = [](int id) { return id > 0 ? PageJson(id) : PageJson(); };
  const auto color = [](const std::vector<PlaneInk>& of, int id) {
    return id > 0 ? of[static_cast<std::size_t>(id) - 1].color : std::string();
  };
  const bool in_both = plane.baseline > 0 && plane.now > 0;
  const std::string place = place_of(frame, plane);
  return {{"fate", to_string(plane.fate)},
          {"was", id_or_none(plane.baseline)},
          {"is", id_or_none(plane.now)},
          {"was_color", color(inks.baseline, plane.baseline)},
          {"is_color", color(inks.now, plane.now)},
          {"others", others_text(plane)},
          {"place", place},
          {"own_anchor", plane.now > 0 ? "" : place},
          {"offset", in_both ? fmt::format("{:.1f}", 1000 * plane.offset_m) : ""},
          {"angle", in_both ? fmt::format("{:.2f}", plane.angle_deg) : ""},
          {"area_was", area_text(summary_of(*frame.comparison->baseline, plane.baseline))},
          {"area", area_text(summary_of(*frame.frame, plane.now))},
          {"iou", in_both ? fmt::format("{:.2f}", plane.iou) : ""},
          {"changed", plane.fate != PlaneFate::same},
          {"undecided", plane.undecided}};
}

/// Why frames are not compared, for display.
const char* not_compared(FrameFate fate) {
  constexpr const char* kTexts[] = {
      "",
      "The pixels or points of this frame differ from the baseline, so planes are not compared.",
      "This frame was processed in the baseline but is rejected now.",
      "This frame was rejected in the baseline.",
      "This frame was rejected in the baseline as well.",
      "This frame is not in the baseline.",
      ""};  // by FrameFate
  return kTexts[static_cast<std::size_t>(fate)];
}

/// As text beside the picture, because in the picture it would be too small to read.
PageJson legend_data(const ReportPicture& picture) {
  constexpr std::size_t kMost = 12;  // for more planes, use the table
  PageJson legend = PageJson::array();
  for (const LegendMark& mark : picture.legend | std::views::take(kMost)) {
    const char* shape = mark.shape == "dot"           ? "dot"
                        : mark.shape == "hatched_box" ? "hatched"
                                                      : "box";
    legend.push_back({{"shape", shape}, {"color", safe_color(mark.color)}, {"text", mark.text}});
  }
  return legend;
}

/// Pictures embedded in the page, and links to the others.
void set_pictures(const PageSource& page, const PageFrame& frame, PageJson& data) {
  PageJson pictures = PageJson::array(), files = PageJson::array();
  for (const ReportPicture& picture : frame.frame->pictures) {
    const std::string source =
        frame.embedded ? webp_source(page.dir / copy_of(picture)) : std::string();
    if (source.empty()) {
      files.push_back({{"title", picture.title},
                       {"file", href(picture.file)},
                       {"copy", href(copy_of(picture))}});
      continue;
    }
    const char* shape = pictures.empty() ? "hero" : picture.name == "truth" ? "wide" : "";
    pictures.push_back({{"title", picture.title},
                        {"file", href(picture.file)},
                        {"picture_anchor", frame.anchor + "/" + picture.name},
                        {"shape", shape},
                        {"alt", picture.alt},
                        {"width", picture.width},
                        {"height", picture.height},
                        {"source", source},
                        {"legend", legend_data(picture)}});
  }
  data["pictures"] = std::move(pictures);
  data["files"] = std::move(files);
}

PageJson planes_data(const PageFrame& frame) {
  PageJson planes = PageJson::array();
  for (const ReportPlane& plane : frame.frame->planes) {
    const planes::PlaneSummary& s = plane.summary;
    planes.push_back(
        {{"id", s.id},
         {"plane_anchor", fmt::format("{}/p{}", frame.anchor, s.id)},
         {"color", safe_color(plane.color)},
         {"label", to_string(s.label, "\u2013")},
         {"area", fmt::format("{:.3f}", s.area_m2)},
         {"points", grouped(s.points)},
         {"voxels", grouped(s.voxels)},
         {"tilt", std::isnan(s.tilt_deg) ? "\u2013" : fmt::format("{:.1f}", s.tilt_deg)},
         {"rms", fmt::format("{:.1f}", 1000 * s.rms_m)},
         {"normal", vector_text(s.normal)},
         {"offset", decimal(s.offset_m, 3)},
         {"undecided", s.undecided ? fmt::format("undecided, margin {:.2g}", s.margin) : ""}});
  }
  return planes;
}

/// Every measurement is in exactly one of these.
void set_counts(const ReportFrame& frame, PageJson& data) {
  struct Part {
    const char* css_class;
    const char* name;
    std::uint64_t count;
  };
  const planes::CloudCounts& c = frame.counts;
  const Part parts[] = {
      {"to-plane", "on a plane", frame.points_on_planes},
      {"to-left", "in no plane", c.kept - frame.points_on_planes},
      {"to-crop", "beyond the range", c.beyond_range},
      {"to-crop", "outside the cube", c.outside_cube},
      {"to-none", "no measurement", c.no_measurement},
      {"to-none", "invalid", c.invalid},
  };
  PageJson bar = PageJson::array(), counts = PageJson::array();
  std::vector<std::string> spoken;
  const auto add = [&](const char* css_class, const char* name, std::uint64_t count,
                       const std::string& of_all) {
    counts.push_back(
        {{"class", css_class}, {"name", name}, {"value", grouped(count)}, {"share", of_all}});
  };
  for (const Part& part : parts) {
    add(part.css_class, part.name, part.count, share(part.count, c.pixels));
    if (part.count == 0) continue;
    const double percent = 100.0 * static_cast<double>(part.count) / static_cast<double>(c.pixels);
    bar.push_back({{"class", part.css_class}, {"percent", fmt::format("{:.3f}", percent)}});
    spoken.push_back(share(part.count, c.pixels) + " " + part.name);
  }
  add("", "all", c.pixels, "");
  add("", "points used, N<sub>m</sub>", c.kept, share(c.kept, c.pixels));
  add("", "voxels, N<sub>d</sub>", frame.voxels, "");
  data["bar"] = std::move(bar);
  data["bar_text"] = fmt::format("{}", fmt::join(spoken, ", "));
  data["counts"] = std::move(counts);
}

void set_nodes(const Report& report, const ReportFrame& frame, PageJson& data) {
  const planes::SegmentCounts& counts = frame.segment;
  const int used = used_depths(counts);
  for (int depth = 0; depth < used; ++depth) data["depths"].push_back(depth);
  for (int c = 1; c <= 4; ++c) {
    PageJson cells = PageJson::array();
    for (int depth = 0; depth < used; ++depth) {
      const std::uint32_t count = counts.nodes_per_case_depth[c][depth];
      cells.push_back(
          {{"zero", count == 0}, {"count", PageJson(count ? std::to_string(count) : "\u00b7")}});
    }
    data["cases"].push_back({{"numeral", planes::to_string(static_cast<planes::Case>(c))},
                             {"color", safe_color(report.case_colors[c])},
                             {"all", grouped(counts.nodes_per_case[c])},
                             {"cells", cells}});
  }
  std::string text = fmt::format(
      "{} nodes visited, {} plane candidates, {} merges. Voxels unassigned after the traversal: "
      "{}; {} of these were assigned to a plane afterwards. Voxels in no plane at the end: {}.",
      grouped(counts.nodes_visited), grouped(counts.candidates), grouped(counts.merges),
      grouped(counts.leftovers), grouped(counts.assigned), grouped(counts.unassigned));
  if (frame.noise.estimated)
    text += fmt::format(" Measured noise: {:.1f} mm{}.", 1000 * frame.noise.sigma_m,
                        frame.noise.by_range ? " at 1 m, growing with the square of range" : "");
  data["nodes_text"] = text;
}

PageJson timings_data(const planes::FrameTimings& t, bool is_ours) {
  PageJson rows = PageJson::array();
  const auto add = [&](const char* name, double ms) {
    rows.push_back({{"name", name}, {"ms", fmt::format("{:.2f}", ms)}});
  };
  add("reading the frame", t.load_ms);
  add("back-projection, crop", t.cloud_ms);
  add("t<sub>d</sub> voxel grid", t.t_d_ms);
  if (is_ours) {
    add("t<sub>c</sub> classification", t.t_c_ms);
    add("t<sub>b</sub> octree", t.t_b_ms);
    add("t<sub>s</sub> traversal, merge, assignment", t.t_s_ms);
    add("t<sub>d</sub> + t<sub>c</sub> + t<sub>b</sub> + t<sub>s</sub>", planes::paper_ms(t));
  } else {
    add("t<sub>s</sub> the method", t.t_s_ms);
    add("t<sub>d</sub> + t<sub>s</sub>", t.t_d_ms + t.t_s_ms);
  }
  return rows;
}

PageJson metrics_data(const planes::Metrics& m) {
  PageJson rows = PageJson::array();
  const auto add = [&](const char* name, const std::string& value) {
    rows.push_back({{"name", name}, {"value", value}});
  };
  const auto percent = [](double value) {
    return std::isnan(value) ? std::string("\u2013") : fmt::format("{:.2f} %", value);
  };
  add("true planes / found", fmt::format("{} / {}", m.planes_truth, m.planes_found));
  add("&alpha;, mean angle of the normals", fmt::format("{:.2f}\u00b0", m.alpha_deg));
  add("r<sub>p</sub>, found / true", percent(m.r_p));
  add("r<sub>m</sub>, points missed", percent(m.r_m));
  add("points on the correct plane", percent(m.point_accuracy));
  add("mean IoU", percent(m.mean_iou));
  add("planes detected at IoU 0.8", std::to_string(m.detected_iou80));
  add("over- / under-segmented", fmt::format("{} / {}", m.over_segmented, m.under_segmented));
  add("missed / noise planes", fmt::format("{} / {}", m.missed, m.noise));
  add("h / v correct near edges", percent(m.label_accuracy_edge));
  add("h / v correct elsewhere", percent(m.label_accuracy_inner));
  return rows;
}

// ---- Terrain ----

constexpr const char* kNone = "\u2013";

std::string or_none(double value, int digits) {
  return std::isnan(value) ? kNone : decimal(value, digits);
}

PageJson footing_data(const PageFrame& frame, const ReportPlane& plane) {
  const Footing& footing = *plane.footing;
  PageJson row = {{"id", plane.summary.id},
                  {"place", fmt::format("{}/p{}", frame.anchor, plane.summary.id)},
                  {"color", safe_color(plane.color)},
                  {"outline_area", fmt::format("{:.3f}", footing.outline_area_m2)},
                  {"height", or_none(footing.height_m, 3)},
                  {"slope", or_none(footing.slope_deg, 1)},
                  {"tilt_sigma", fmt::format("{:.2f}", std::max(footing.tilt_sigma_deg[0],
                                                                footing.tilt_sigma_deg[1]))},
                  {"offset_sigma", fmt::format("{:.1f}", 1000 * footing.offset_sigma_m)},
                  {"rough", fmt::format("{:.1f}", 1000 * footing.rough_rms_m)},
                  {"support", fmt::format("{:.0f} %", 100 * footing.support)},
                  {"clearance", fmt::format("{:.1f}", 100 * footing.clearance_m)},
                  {"has_foot", footing.foot.has_value()}};
  if (!footing.foot) return row;
  const FootRoom& foot = *footing.foot;
  row.update({{"foot_area", fmt::format("{:.3f}", foot.area_m2)},
              {"pieces", foot.piece_count},
              {"steppable", foot.steppable ? "yes" : "no"},
              {"class", foot.steppable ? "passed" : "failed"},
              {"title", foot.steppable ? "Steppable" : "Not steppable: " + foot.why_not},
              {"why_not", foot.why_not}});
  return row;
}

/// A line for each flight, kerb and ramp; lengths that do not apply are empty.
PageJson ways_data(const Terrain& terrain) {
  PageJson ways = PageJson::array();
  const auto mm = [](double m) { return fmt::format("{:.0f}", 1000 * m); };
  const auto add = [&](const std::string& what, double rise_m, const std::string& going,
                       double width_m, const std::vector<int>& planes) {
    ways.push_back({{"what", what},
                    {"rise", mm(rise_m)},
                    {"going", going},
                    {"width", fmt::format("{:.2f}", width_m)},
                    {"planes", fmt::format("{}", fmt::join(planes, ", "))}});
  };
  const char* const way[] = {"", ", seen from below: up", ", seen from above: down"};
  for (const FlightFigures& flight : terrain.flights)
    add(fmt::format("flight of {}{}{}", counted(static_cast<std::size_t>(flight.count), "step"),
                    way[static_cast<std::size_t>(flight.seen)],
                    flight.landing ? ", to a landing" : ""),
        flight.rise_m, mm(flight.going_m), flight.width_m, flight.planes);
  for (const KerbFigures& kerb : terrain.kerbs)
    add("kerb", kerb.rise_m, "", kerb.width_m, kerb.planes);
  for (const RampFigures& ramp : terrain.ramps)
    add(fmt::format("ramp, {:.1f}\u00b0", ramp.slope_deg), ramp.rise_m, mm(ramp.run_m),
        ramp.width_m, {ramp.plane});
  return ways;
}

/// Properties of planes to stand on, stairs, kerbs and ramps, and their changes since the baseline.
void set_terrain(const PageFrame& of, PageJson& data) {
  if (of.is_compared()) data["terrain_changes"] = terrain_changes(*of.comparison);
  if (of.is_refused()) return;
  bool has_foot = false;
  for (const ReportPlane& plane : of.frame->planes) {
    if (!plane.footing) continue;
    data["footings"].push_back(footing_data(of, plane));
    has_foot |= plane.footing->foot.has_value();
  }
  data["has_foot"] = has_foot;
  if (of.frame->terrain) data["ways"] = ways_data(*of.frame->terrain);
}

// ---- The frame ----

/// Adds the comparison with the baseline's frame to the frame's figures.
void set_comparison(const PageSource& page, const PageFrame& frame, PageJson& data) {
  if (!page.has_baseline()) return;
  if (!frame.is_compared()) {
    data["not_compared"] = not_compared(frame.comparison->fate);
    return;
  }
  const std::string changes = changes_text(frame);
  if (changes == "none") {
    data["unchanged"] = counted(frame.comparison->planes.size(), "plane");
    return;
  }
  const PlaneMaps maps = plane_maps(frame);
  const ComparedInks inks = inks_of(frame);
  PageJson fates = PageJson::array();
  for (const PlaneComparison* plane : by_change(*frame.comparison))
    fates.push_back(fate_data(frame, *plane, inks));
  data["compared"] = {{"changes", changes},
                      {"has_maps", !maps.now.empty()},
                      {"baseline_source", maps.baseline},
                      {"now_source", maps.now},
                      {"map_width", maps.width},
                      {"map_height", maps.height},
                      {"of_frame", title_of(page, frame)},
                      {"fates", std::move(fates)},
                      {"commands", commands_of(frame)}};
}

std::vector<std::string> texts_of(const std::vector<const Breach*>& breaches) {
  std::vector<std::string> texts;
  for (const Breach* breach : breaches) texts.push_back(breach->text());
  return texts;
}

std::string gravity_of_frame(const Gravity& gravity, bool is_cloud) {
  if (!gravity.known())
    return fmt::format(
        "Gravity is <em>unknown</em>: {}. Points and planes are neither h nor v, and the axes of "
        "the world are {}. To distinguish h from v, {}.",
        escaped(gravity.note),
        is_cloud ? "those of the file" : "those of the camera: x forward, y left, z up",
        escaped(planes::kHowToGiveGravity));
  return fmt::format("Gravity points to ({}) in the sensor\u2019s frame: {}{}.",
                     vector_text(gravity.direction), gravity_text(gravity),
                     gravity.note.empty() ? "" : "; " + escaped(gravity.note));
}

}  // namespace

std::string changes_text(const std::function<std::size_t(PlaneFate)>& count) {
  std::vector<std::string> parts;
  for (const PlaneFate fate : kChanges)
    if (const std::size_t planes = count(fate); planes > 0)
      parts.push_back(grouped(planes) + " " + to_string(fate));
  return parts.empty() ? "none" : fmt::format("{}", fmt::join(parts, ", "));
}

std::string changes_text(const PageFrame& frame) {
  if (!frame.is_compared()) return to_string(frame.comparison->fate);
  return changes_text([&](PlaneFate fate) { return frame.comparison->count(fate); });
}

PlaneMaps plane_maps(const PageFrame& frame) {
  if (!frame.is_compared()) return {};
  const ComparedInks inks = inks_of(frame);
  const Image8 was = draw_plane_map(frame.comparison->baseline->regions, inks.baseline);
  const Image8 now = draw_plane_map(frame.frame->regions, inks.now);
  if (was.empty() || now.empty()) return {};
  return {png_source(was), png_source(now), now.width, now.height};
}

PageJson frame_data(const PageSource& page, const PageFrame& of) {
  const ReportFrame& frame = *of.frame;
  const bool is_bad = of.standing > Standing::passed;
  PageJson data = {{"anchor", of.anchor},
                   {"open", of.open},
                   {"index", frame.index},
                   {"name", frame.name},
                   {"recording_name", page.recording_of(of).name},
                   {"refused", frame.refused},
                   {"badge", is_bad ? result_of(of) : ""},
                   {"standing", name_of(of.standing)},
                   {"reasons", texts_of(of.breaches)},
                   {"notes", texts_of(of.notes)},
                   {"summary", "rejected"}};
  set_comparison(page, of, data);
  set_terrain(of, data);
  if (of.is_refused()) return data;
  const bool is_cloud = page.recording_of(of).info.width == 0, is_ours = page.report.is_ours();
  data["summary"] =
      fmt::format("{}, {} of {} points on them", counted(frame.planes.size(), "plane"),
                  share(frame.points_on_planes, frame.counts.kept), grouped(frame.counts.kept));
  data["planes"] = planes_data(of);
  data["has_undecided"] = frame.planes_undecided > 0;
  data["pixels_name"] = is_cloud ? "points" : "pixels";
  data["is_ours"] = is_ours;
  data["timings"] = timings_data(frame.timings, is_ours);
  data["gravity"] = gravity_of_frame(frame.gravity, is_cloud);
  if (frame.metrics) data["metrics"] = metrics_data(*frame.metrics);
  if (is_ours) set_nodes(page.report, frame, data);
  set_pictures(page, of, data);
  set_counts(frame, data);
  return data;
}

}  // namespace planescope::report::html
