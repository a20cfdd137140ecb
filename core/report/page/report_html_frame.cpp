// The part of the page that is about one frame.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/planes/cloud/gravity.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/page/report_html_pieces.hpp"

namespace planescope::report::html {
namespace {

/// Pictures inside the page, and links to those that are not.
void set_pictures(const PageSource& page, const PageFrame& frame, Data& data) {
  Data pictures{Data::type::list}, files{Data::type::list};
  for (const ReportPicture& picture : frame.frame->pictures) {
    Data one;
    one.set("title", picture.title);
    one.set("file", href(picture.file));
    const std::string source =
        frame.embedded ? jpeg_source(page.dir / copy_of(picture)) : std::string();
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
    const PlaneSummary& s = plane.summary;
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
  int deepest = 0;
  for (int c = 1; c <= 4; ++c)
    for (int depth = 0; depth < 22; ++depth)
      if (counts.nodes_per_case_depth[c][depth] > 0) deepest = std::max(deepest, depth);
  Data depths{Data::type::list}, cases{Data::type::list};
  for (int depth = 0; depth <= deepest; ++depth)
    depths.push_back(Data("depth", std::to_string(depth)));
  for (int c = 1; c <= 4; ++c) {
    Data row, cells{Data::type::list};
    for (int depth = 0; depth <= deepest; ++depth) {
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
  for (const Breach* breach : of.breaches) reasons.push_back(text_of(*breach));
  data.set("has_reasons", !reasons.empty());
  data.set("reasons", list_of("text", reasons));
  set_comparison(page, of, data);
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
  const bool is_cloud = page.recording_of(of).info.width == 0;
  data.set("pixels_name", is_cloud ? "points" : "pixels");
  set_counts(frame, data);
  const bool is_ours = page.report.method == planes::Method::ours;
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
