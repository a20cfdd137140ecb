// One frame: what became of its planes since the baseline, its pictures and its figures.

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

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

const planes::PlaneSummary* summary_of(const ReportFrame& frame, int id) {
  return id > 0 ? &frame.planes.at(static_cast<std::size_t>(id) - 1).summary : nullptr;
}

std::string area_text(const planes::PlaneSummary* plane) {
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
  const planes::PlaneSummary* was = summary_of(*frame.comparison->baseline, plane.baseline);
  const planes::PlaneSummary* is = summary_of(*frame.frame, plane.now);
  row.set("area_was", area_text(was));
  row.set("area", area_text(is));
  row.set("ratio", in_both ? fmt::format("{:.0f} %", 100 * plane.area_ratio) : "");
  row.set("iou", in_both ? fmt::format("{:.2f}", plane.iou) : "");
  row.set("changed", plane.fate != PlaneFate::same);
  row.set("undecided", plane.undecided);
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

/// In words beside the picture: in it they would be too small to read.
Data legend_data(const ReportPicture& picture) {
  constexpr std::size_t kMost = 12;  // more than a table of planes tells better
  Data legend{Data::type::list};
  for (std::size_t k = 0; k < std::min(picture.legend.size(), kMost); ++k) {
    const LegendMark& mark = picture.legend[k];
    Data entry;
    entry.set("shape", mark.shape == "dot"           ? "dot"
                       : mark.shape == "hatched_box" ? "hatched"
                                                     : "box");
    entry.set("color", safe_color(mark.color));
    entry.set("text", mark.text);
    legend.push_back(entry);
  }
  return legend;
}

/// Pictures inside the page, and links to those that are not.
void set_pictures(const PageSource& page, const PageFrame& frame, Data& data) {
  Data pictures{Data::type::list}, files{Data::type::list};
  for (const ReportPicture& picture : frame.frame->pictures) {
    Data one;
    one.set("title", picture.title);
    one.set("file", href(picture.file));
    const std::string source =
        frame.embedded ? webp_source(page.dir / copy_of(picture)) : std::string();
    if (source.empty()) {
      one.set("copy", href(copy_of(picture)));
      files.push_back(one);
      continue;
    }
    one.set("picture_anchor", frame.anchor + "/" + picture.name);
    const bool is_first = !pictures.is_non_empty_list();
    one.set("shape", is_first                  ? Data("hero")
                     : picture.name == "truth" ? Data("wide")
                                               : Data(false));
    one.set("alt", picture.alt);
    one.set("width", std::to_string(picture.width));
    one.set("height", std::to_string(picture.height));
    one.set("source", source);
    one.set("has_legend", !picture.legend.empty());
    one.set("legend", legend_data(picture));
    pictures.push_back(one);
  }
  data.set("has_pictures", pictures.is_non_empty_list());
  data.set("pictures", pictures);
  data.set("has_files", files.is_non_empty_list());
  data.set("files", files);
}

Data planes_data(const PageFrame& frame) {
  Data planes{Data::type::list};
  for (const ReportPlane& plane : frame.frame->planes) {
    const planes::PlaneSummary& s = plane.summary;
    Data data;
    data.set("id", std::to_string(s.id));
    data.set("plane_anchor", fmt::format("{}/p{}", frame.anchor, s.id));
    data.set("color", safe_color(plane.color));
    data.set("label", to_string(s.label, "\u2013"));
    data.set("area", fmt::format("{:.3f}", s.area_m2));
    data.set("points", grouped(s.points));
    data.set("voxels", grouped(s.voxels));
    data.set("tilt", std::isnan(s.tilt_deg) ? "\u2013" : fmt::format("{:.1f}", s.tilt_deg));
    data.set("rms", fmt::format("{:.1f}", 1000 * s.rms_m));
    data.set("normal", fmt::format("{}, {}, {}", decimal(s.normal.x(), 3), decimal(s.normal.y(), 3),
                                   decimal(s.normal.z(), 3)));
    data.set("offset", decimal(s.offset_m, 3));
    data.set("undecided",
             s.undecided ? Data(fmt::format("undecided, margin {:.2g}", s.margin)) : Data(false));
    planes.push_back(data);
  }
  return planes;
}

/// Every measurement is in exactly one of these.
void set_counts(const ReportFrame& frame, Data& data) {
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
  Data bar{Data::type::list}, counts{Data::type::list};
  std::string spoken;
  const auto add = [&](const char* css_class, const std::string& name, std::uint64_t count,
                       const std::string& of_all) {
    Data row;
    row.set("class", text_or_false(css_class));
    row.set("name", name);
    row.set("value", grouped(count));
    row.set("share", of_all);
    counts.push_back(row);
  };
  for (const Part& part : parts) {
    if (part.count > 0) {
      Data piece;
      piece.set("class", part.css_class);
      piece.set("percent", fmt::format("{:.3f}", 100.0 * static_cast<double>(part.count) /
                                                     static_cast<double>(c.pixels)));
      bar.push_back(piece);
      spoken += fmt::format("{}{} {}", spoken.empty() ? "" : ", ", share(part.count, c.pixels),
                            part.name);
    }
    add(part.css_class, part.name, part.count, share(part.count, c.pixels));
  }
  add("", "all", c.pixels, "");
  add("", "points used, N<sub>m</sub>", c.kept, share(c.kept, c.pixels));
  add("", "voxels, N<sub>d</sub>", frame.voxels, "");
  data.set("bar", bar);
  data.set("bar_text", spoken);
  data.set("counts", counts);
}

void set_nodes(const Report& report, const ReportFrame& frame, Data& data) {
  const planes::SegmentCounts& counts = frame.segment;
  const int used = used_depths(counts);
  Data depths{Data::type::list}, cases{Data::type::list};
  for (int depth = 0; depth < used; ++depth) depths.push_back(Data("depth", std::to_string(depth)));
  for (int c = 1; c <= 4; ++c) {
    Data row, cells{Data::type::list};
    for (int depth = 0; depth < used; ++depth) {
      const std::uint32_t count = counts.nodes_per_case_depth[c][depth];
      Data cell;
      cell.set("zero", count == 0);
      cell.set("count", count == 0 ? "\u00b7" : std::to_string(count));
      cells.push_back(cell);
    }
    row.set("numeral", planes::to_string(static_cast<planes::Case>(c)));
    row.set("color", safe_color(report.case_colors[c]));
    row.set("all", grouped(counts.nodes_per_case[c]));
    row.set("cells", cells);
    cases.push_back(row);
  }
  data.set("depths", depths);
  data.set("cases", cases);
  std::string text = fmt::format(
      "{} nodes visited, {} plane candidates, {} merges. Voxels left over by the traversal: {}, of "
      "them {} joined a plane afterwards; in no plane at the end: {}.",
      grouped(counts.nodes_visited), grouped(counts.candidates), grouped(counts.merges),
      grouped(counts.leftovers), grouped(counts.assigned), grouped(counts.unassigned));
  if (frame.noise.estimated) {
    const double sigma_mm = 1000 * frame.noise.sigma_m;
    text += fmt::format(" Measured noise: {:.1f} mm{}.", sigma_mm,
                        frame.noise.by_range ? " at 1 m, growing with the square of range" : "");
  }
  data.set("nodes_text", text);
}

Data rows(const std::vector<std::pair<std::string, std::string>>& pairs, const char* value_name) {
  Data result{Data::type::list};
  for (const auto& [name, value] : pairs) {
    Data row;
    row.set("name", name);
    row.set(value_name, value);
    result.push_back(row);
  }
  return result;
}

Data timings_data(const planes::FrameTimings& t, bool is_ours) {
  const auto ms = [](double value) { return fmt::format("{:.2f}", value); };
  if (!is_ours)
    return rows({{"reading the frame", ms(t.load_ms)},
                 {"back-projection, crop", ms(t.cloud_ms)},
                 {"t<sub>d</sub> voxel grid", ms(t.t_d_ms)},
                 {"t<sub>s</sub> the method", ms(t.t_s_ms)},
                 {"t<sub>d</sub> + t<sub>s</sub>", ms(t.t_d_ms + t.t_s_ms)}},
                "ms");
  return rows(
      {{"reading the frame", ms(t.load_ms)},
       {"back-projection, crop", ms(t.cloud_ms)},
       {"t<sub>d</sub> voxel grid", ms(t.t_d_ms)},
       {"t<sub>c</sub> classification", ms(t.t_c_ms)},
       {"t<sub>b</sub> octree", ms(t.t_b_ms)},
       {"t<sub>s</sub> traversal, merge, assignment", ms(t.t_s_ms)},
       {"t<sub>d</sub> + t<sub>c</sub> + t<sub>b</sub> + t<sub>s</sub>", ms(planes::paper_ms(t))}},
      "ms");
}

Data metrics_data(const planes::Metrics& m) {
  const auto percent = [](double value) {
    return std::isnan(value) ? std::string("\u2013") : fmt::format("{:.2f} %", value);
  };
  return rows(
      {{"true planes / found", fmt::format("{} / {}", m.planes_truth, m.planes_found)},
       {"&alpha;, mean angle of the normals", fmt::format("{:.2f}\u00b0", m.alpha_deg)},
       {"r<sub>p</sub>, found / true", percent(m.r_p)},
       {"r<sub>m</sub>, points missed", percent(m.r_m)},
       {"points on the right plane", percent(m.point_accuracy)},
       {"mean IoU", percent(m.mean_iou)},
       {"planes detected at IoU 0.8", std::to_string(m.detected_iou80)},
       {"over- / under-segmented", fmt::format("{} / {}", m.over_segmented, m.under_segmented)},
       {"missed / noise planes", fmt::format("{} / {}", m.missed, m.noise)},
       {"h / v right near edges", percent(m.label_accuracy_edge)},
       {"h / v right elsewhere", percent(m.label_accuracy_inner)}},
      "value");
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
  const Image8 now = draw_plane_map(frame.frame->regions, inks.now);
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

Data frame_data(const PageSource& page, const PageFrame& of) {
  const ReportFrame& frame = *of.frame;
  Data data;
  data.set("anchor", of.anchor);
  data.set("open", of.open);
  data.set("index", std::to_string(frame.index));
  data.set("name", text_or_false(frame.name));
  data.set("recording_name", page.recording_of(of).name);
  data.set("refused", text_or_false(frame.refused));
  const bool is_bad = of.standing > Standing::passed;
  data.set("badge",
           is_bad ? Data(of.is_refused() ? "refused" : name_of(of.standing)) : Data(false));
  data.set("standing", name_of(of.standing));
  std::vector<std::string> reasons;
  for (const Breach* breach : of.breaches) reasons.push_back(breach->text());
  data.set("has_reasons", !reasons.empty());
  data.set("reasons", list_of("text", reasons));
  std::vector<std::string> notes;
  for (const Breach* note : of.notes) notes.push_back(note->text());
  data.set("has_notes", !notes.empty());
  data.set("notes", list_of("text", notes));
  set_comparison(page, of, data);
  set_terrain_changes(of, data);
  if (of.is_refused()) {
    data.set("summary", "refused");
    return data;
  }
  data.set(
      "summary",
      fmt::format("{}, {} of {} points on them", counted(frame.planes.size(), "plane"),
                  share(frame.points_on_planes, frame.counts.kept), grouped(frame.counts.kept)));
  set_pictures(page, of, data);
  data.set("has_planes", !frame.planes.empty());
  data.set("planes", planes_data(of));
  data.set("has_undecided", frame.planes_undecided > 0);
  set_terrain(of, data);
  const bool is_cloud = page.recording_of(of).info.width == 0;
  data.set("pixels_name", is_cloud ? "points" : "pixels");
  set_counts(frame, data);
  const bool is_ours = page.report.is_ours();
  data.set("is_ours", is_ours);
  if (is_ours) set_nodes(page.report, frame, data);
  data.set("timings", timings_data(frame.timings, is_ours));
  data.set("has_metrics", frame.metrics.has_value());
  if (frame.metrics) data.set("metrics", metrics_data(*frame.metrics));
  const Vec3d& d = frame.gravity.direction;
  if (!frame.gravity.known())
    data.set(
        "gravity",
        fmt::format("Gravity is <em>not known</em>: {}. No point and no plane is h or v, and the "
                    "world\u2019s axes are {}. To tell h from v, {}.",
                    escaped(frame.gravity.note),
                    is_cloud ? "those of the file" : "the camera\u2019s own: x ahead, y left, z up",
                    escaped(planes::kHowToGiveGravity)));
  else
    data.set("gravity",
             fmt::format("Gravity points to ({}, {}, {}) in the sensor\u2019s frame: {}{}.",
                         decimal(d.x(), 3), decimal(d.y(), 3), decimal(d.z(), 3),
                         gravity_text(frame.gravity),
                         frame.gravity.note.empty() ? "" : "; " + escaped(frame.gravity.note)));
  return data;
}

}  // namespace planescope::report::html
