#include "core/report/data/report_files.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <functional>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::report {
namespace {

// RFC 4180.
std::string quoted(const std::string& text) {
  if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
  std::string result = "\"";
  for (const char c : text) result += c == '"' ? std::string("\"\"") : std::string(1, c);
  return result + '"';
}

std::string csv_line(const ReportRecording& recording, const ReportFrame& frame) {
  const std::string start = fmt::format(
      "{},{},{},{},{}", quoted(recording.info.path.string()), frame.index, quoted(frame.name),
      frame.refused.empty() ? "done" : "refused", quoted(frame.refused));
  if (!frame.refused.empty()) return start + std::string(21, ',') + "\n";
  const planes::CloudCounts& c = frame.counts;
  const Vec3d& g = frame.gravity.direction;
  // Nobody's direction, and planes of neither class: left empty.
  std::string gravity = ",,", classes = ",";
  if (frame.gravity.known()) {
    gravity = fmt::format("{:.6f},{:.6f},{:.6f}", g.x(), g.y(), g.z());
    classes = fmt::format("{},{}", frame.planes_h, frame.planes_v);
  }
  std::string metrics = ",,,,,";
  if (frame.metrics)
    metrics = fmt::format("{},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g}", frame.metrics->planes_truth,
                          frame.metrics->alpha_deg, frame.metrics->r_p, frame.metrics->r_m,
                          frame.metrics->point_accuracy, frame.metrics->mean_iou);
  return start + fmt::format(",{},{},{},{},{},{},{},{},{},{},{},{},{}\n",
                             to_string(frame.gravity.source), gravity, c.pixels, c.no_measurement,
                             c.invalid, c.beyond_range, c.outside_cube, c.kept, frame.voxels,
                             classes, frame.points_on_planes, frame.segment.unassigned, metrics);
}

}  // namespace

std::string frames_csv(const Report& report) {
  std::string text =
      "recording,frame,name,status,message,gravity_source,gravity_x,gravity_y,gravity_z,pixels,"
      "no_measurement,invalid,beyond_range,outside_cube,n_m,n_d,planes_h,planes_v,"
      "points_on_planes,voxels_in_no_plane,truth_planes,alpha_deg,r_p,r_m,point_accuracy,"
      "mean_iou\n";
  for (const ReportRecording& recording : report.recordings)
    for (const ReportFrame& frame : recording.frames) text += csv_line(recording, frame);
  return text;
}

void write_report_files(const std::filesystem::path& dir, const Report& report) {
  write_file_text(dir / "frames.csv", frames_csv(report));
  write_file_text(dir / "junit.xml", junit_xml(report));
  write_overviews(dir, report);
  write_file_stream(dir / "index.html",
                    [&](std::ostream& out) { write_report_page(out, report, dir); });
  write_file_stream(dir / "report.json",
                    [&](std::ostream& out) { write_report_json(out, report); });
}

}  // namespace planescope::report
