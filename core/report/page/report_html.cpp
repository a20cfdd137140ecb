// index.html, from the templates in assets/report, written piece by piece: a page of a thousand
// frames is larger than what one wants to hold in memory.

#include <fmt/format.h>

#include <span>

#include "core/model/sha256.hpp"
#include "core/report/data/report_files.hpp"
#include "core/report/page/line_chart.hpp"
#include "core/report/page/report_html_pieces.hpp"
#include "core/report/page/thumbnail.hpp"

extern "C" {
extern const char planescope_asset_report_css[], planescope_asset_report_css_end[];
extern const char planescope_asset_report_page_css[], planescope_asset_report_page_css_end[];
extern const char planescope_asset_report_js[], planescope_asset_report_js_end[];
extern const char planescope_asset_report_page_mustache[],
    planescope_asset_report_page_mustache_end[];
extern const char planescope_asset_report_row_mustache[],
    planescope_asset_report_row_mustache_end[];
extern const char planescope_asset_report_recording_mustache[],
    planescope_asset_report_recording_mustache_end[];
extern const char planescope_asset_report_frame_mustache[],
    planescope_asset_report_frame_mustache_end[];
extern const char planescope_asset_report_end_mustache[],
    planescope_asset_report_end_mustache_end[];
}

namespace planescope::report {
namespace {

using namespace html;

constexpr const char* kEndOfRows = "</tbody>\n</table>\n</div>\n</section>\n";

std::string page_title(const Report& report) {
  if (report.recordings.size() == 1) return report.recordings[0].name;
  return fmt::format("{} recordings", report.recordings.size());
}

/// What the browser holds the script to: "sha256-...".
std::string hash_source(const std::string& script) {
  const std::string hex = sha256_hex(std::as_bytes(std::span(script)));
  std::vector<unsigned char> digest;
  for (std::size_t i = 0; i < hex.size(); i += 2)
    digest.push_back(static_cast<unsigned char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return "sha256-" + base64(digest);
}

/// One entry per column after "Change": the figures of a frame.
Data columns_of(const PageSource& page) {
  std::vector<std::string> names = {"Planes", "On planes"};
  if (page.has_metrics()) names.insert(names.end(), {"IoU", "PQ", "Right", "Angle"});
  return list_of("name", names);
}

Data page_data(const PageSource& page) {
  Data data;
  const std::string script(planescope_asset_report_js, planescope_asset_report_js_end);
  data.set("css",
           std::string(planescope_asset_report_css, planescope_asset_report_css_end) +
               std::string(planescope_asset_report_page_css, planescope_asset_report_page_css_end) +
               line_chart_style());
  data.set("script_hash", hash_source(script));
  data.set("title", page_title(page.report));
  data.set("version", page.report.version);
  data.set("created", page.report.created_utc);
  data.set("has_rows", page.plan.frames.size() > 1);
  data.set("has_change", page.has_baseline());
  data.set("columns", columns_of(page));
  data.set("frames_text", counted(page.plan.frames.size(), "frame"));
  set_verdict(page, data);
  return data;
}

void write_frames(std::ostream& out, const PageSource& page) {
  Template recording(planescope_asset_report_recording_mustache,
                     planescope_asset_report_recording_mustache_end);
  Template frame(planescope_asset_report_frame_mustache,
                 planescope_asset_report_frame_mustache_end);
  std::size_t next = 0;
  for (std::size_t r = 0; r < page.report.recordings.size(); ++r) {
    recording.write(out, recording_data(page, r));
    for (; next < page.plan.frames.size() && page.plan.frames[next].frame &&
           page.plan.frames[next].recording == r;
         ++next)
      frame.write(out, frame_data(page, page.plan.frames[next]));
  }
}

}  // namespace

void write_report_page(std::ostream& out, const Report& report, const std::filesystem::path& dir) {
  const PagePlan plan = plan_page(report);
  const PageSource page{report, dir, plan};
  Template(planescope_asset_report_page_mustache, planescope_asset_report_page_mustache_end)
      .write(out, page_data(page));
  if (plan.frames.size() > 1) {
    Template row(planescope_asset_report_row_mustache, planescope_asset_report_row_mustache_end);
    for (const PageFrame& frame : plan.frames) row.write(out, row_data(page, frame));
    out << kEndOfRows;
  }
  write_frames(out, page);
  Data end;
  end.set("script", std::string(planescope_asset_report_js, planescope_asset_report_js_end));
  set_histograms(page, end);
  set_record(page, end);
  Template(planescope_asset_report_end_mustache, planescope_asset_report_end_mustache_end)
      .write(out, end);
}

}  // namespace planescope::report
