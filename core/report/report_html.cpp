// index.html: one page that needs nothing beside it, from the templates in assets/report.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "core/base/error.hpp"
#include "core/report/report_files.hpp"
#include "core/report/report_html_parts.hpp"

extern "C" {
extern const char planescope_asset_report_css[], planescope_asset_report_css_end[];
extern const char planescope_asset_report_page_mustache[],
    planescope_asset_report_page_mustache_end[];
extern const char planescope_asset_report_frame_mustache[],
    planescope_asset_report_frame_mustache_end[];
}

namespace planescope {
namespace html {

std::string grouped(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), "\u202f");
  return digits;
}

std::string share(std::uint64_t part, std::uint64_t whole) {
  const double value =
      whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
  return fmt::format("{:.1f} %", value);
}

std::string escaped(const std::string& text) { return kainjow::mustache::html_escape(text); }

Data text_or_false(const std::string& text) { return text.empty() ? Data(false) : Data(text); }

std::string gravity_text(const Gravity& gravity) {
  switch (gravity.source) {
    case GravitySource::option:
      return "given on the command line";
    case GravitySource::sidecar:
      return "from the recording\u2019s files";
    case GravitySource::imu:
      return "from the recording\u2019s IMU";
    case GravitySource::picked:
      return "from a picked floor";
    case GravitySource::estimate:
      return fmt::format("<em>estimated</em> from the scene, confidence {:.2f}",
                         gravity.confidence);
    case GravitySource::assumed:
      break;
  }
  return "<em>assumed</em>";
}

const char* case_meaning(Case c) {
  switch (c) {
    case Case::I:
      return "mixed labels (fails Criterion 1): divided";
    case Case::II:
      return "too few points (fails Criterion 2): left over";
    case Case::III:
      return "one label but not planar (fails Criterion 3): divided";
    case Case::IV:
      return "planar: a candidate, its outliers left over";
    case Case::none:
      break;
  }
  return "";
}

}  // namespace html

namespace {

using html::Data;

constexpr int kFramesAllOpen = 12;  // more frames than that: only the first few are unfolded
constexpr int kFramesOpenAtFirst = 3;

std::string title_of(const Report& report) {
  if (report.recordings.size() == 1) return report.recordings[0].name;
  return fmt::format("{} recordings", report.recordings.size());
}

/// All frames' sources of gravity, each once.
std::string gravity_summary(const std::vector<ReportRecording>& recordings) {
  std::vector<std::string> sources;
  double least = 2;
  for (const ReportRecording& recording : recordings) {
    for (const ReportFrame& frame : recording.frames) {
      if (!frame.refused.empty()) continue;
      std::string text = html::gravity_text(frame.gravity);
      if (frame.gravity.source == GravitySource::estimate) {
        least = std::min(least, frame.gravity.confidence);
        text = "<em>estimated</em> from the scene";
      }
      if (std::find(sources.begin(), sources.end(), text) == sources.end()) sources.push_back(text);
    }
  }
  std::string result = fmt::format("{}", fmt::join(sources, " or "));
  if (least <= 1) result += fmt::format(" (confidence {:.2f} at least)", least);
  return result;
}

std::string range_text(int fewest, int most) {
  return fewest == most ? std::to_string(most) : fmt::format("{}\u2013{}", fewest, most);
}

/// What told h from v, as HTML.
std::string classifier_text(const Report& report) {
  if (report.method != Method::ours) return "the tilt of each plane";
  if (report.weights)
    return fmt::format("the network <code>{}</code> ({})", html::escaped(report.weights->file),
                       html::escaped(report.weights->network));
  if (report.classifier == "pca") return "PCA normals";
  return "the ground truth";
}

/// File, hash and the training record's plain facts, as HTML.
std::string weights_text(const WeightsRecord& weights) {
  std::string text = fmt::format("{} ({}), SHA-256 <code>{}</code>", html::escaped(weights.file),
                                 html::escaped(weights.network), weights.sha256);
  std::string facts;
  const auto training = nlohmann::ordered_json::parse(weights.training);
  for (const auto& [name, value] : training.items()) {
    if (value.is_structured()) continue;
    facts += facts.empty() ? ", trained with " : ", ";
    facts += name + " " + (value.is_string() ? value.get<std::string>() : value.dump());
  }
  return text + html::escaped(facts);
}

std::string verdict(const Report& report, const ReportTotals& totals) {
  if (totals.frames_done == 0) return "No frame was processed.";
  std::string text = fmt::format(
      "{} plane{} found in {}, holding {} of the measured points within range. Gravity was {}; h "
      "and v were told apart by {}.",
      range_text(totals.fewest_planes, totals.most_planes), totals.most_planes == 1 ? "" : "s",
      totals.frames_done == 1 ? "one frame" : fmt::format("each of {} frames", totals.frames_done),
      html::share(totals.points_on_planes, totals.points), gravity_summary(report.recordings),
      classifier_text(report));
  if (totals.frames_refused > 0)
    text += fmt::format(" {} frame{} refused.", totals.frames_refused,
                        totals.frames_refused == 1 ? " was" : "s were");
  std::size_t warnings = 0;
  for (const ReportRecording& recording : report.recordings)
    warnings += recording.info.warnings.size();
  if (warnings > 0)
    text += fmt::format(" There {} to read below.",
                        warnings == 1 ? "is a warning" : fmt::format("are {} warnings", warnings));
  return text;
}

double median_pipeline_ms(const Report& report) {
  std::vector<double> values;
  for (const ReportRecording& recording : report.recordings)
    for (const ReportFrame& frame : recording.frames)
      if (const FrameTimings& t = frame.timings; frame.refused.empty())
        values.push_back(t.t_d_ms + t.t_c_ms + t.t_b_ms + t.t_s_ms);
  if (values.empty()) return 0;
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

Data tiles(const Report& report, const ReportTotals& totals) {
  Data result{Data::type::list};
  const auto add = [&](const std::string& name, const std::string& value, const std::string& unit) {
    Data tile;
    tile.set("name", name);
    tile.set("value", value);
    tile.set("unit", html::text_or_false(unit));
    result.push_back(tile);
  };
  add(totals.frames_done == 1 ? "Planes" : "Planes per frame",
      range_text(totals.fewest_planes, totals.most_planes), "");
  add("Points on planes", html::share(totals.points_on_planes, totals.points), "");
  add("Frames", std::to_string(totals.frames_done),
      totals.frames_refused > 0 ? fmt::format("and {} refused", totals.frames_refused) : "");
  add("Voxel grid to planes", fmt::format("{:.1f}", median_pipeline_ms(report)),
      totals.frames_done == 1 ? "ms" : "ms, median");
  if (totals.metrics) {
    add("Points right", fmt::format("{:.1f} %", totals.metrics->point_accuracy), "");
    add("h / v right", fmt::format("{:.1f} %", totals.metrics->label_accuracy_edge), "near edges");
    add("Angle error", fmt::format("{:.2f}\u00b0", totals.metrics->alpha_deg), "");
  }
  return result;
}

Data facts(const ReportRecording& recording) {
  Data result{Data::type::list};
  const auto add = [&](const std::string& name, const std::string& value) {
    if (value.empty()) return;
    Data fact;
    fact.set("name", name);
    fact.set("value", value);
    result.push_back(fact);
  };
  const RecordingInfo& info = recording.info;
  add("Path", "<code>" + html::escaped(info.path.string()) + "</code>");
  add("Format", html::escaped(info.format));
  add("Sensor", html::escaped(info.device));
  add("Frames", recording.frames_asked == recording.frame_count
                    ? std::to_string(recording.frame_count)
                    : fmt::format("{} of {}", recording.frames_asked, recording.frame_count));
  if (info.width > 0) {
    const Intrinsics& k = info.intrinsics;
    add("Depth",
        html::escaped(fmt::format("{}\u00d7{}, 1 unit = {:.6g} mm ({})", info.width, info.height,
                                  1000 * info.depth_unit_m, info.depth_unit_source)));
    add("Intrinsics",
        html::escaped(fmt::format("fx {:.2f}, fy {:.2f}, cx {:.2f}, cy {:.2f} px ({})", k.fx, k.fy,
                                  k.cx, k.cy, info.intrinsics_source)));
    add("Colour", html::escaped(info.has_color ? info.color_note : "none"));
  }
  add("Gravity", gravity_summary({recording}));
  return result;
}

Data overview_row(std::size_t recording, const ReportFrame& frame) {
  Data row;
  row.set("anchor", html::frame_anchor(recording, frame));
  row.set("index", std::to_string(frame.index));
  row.set("name", frame.name);
  row.set("refused", !frame.refused.empty());
  row.set("gravity", html::gravity_text(frame.gravity));
  row.set("points", html::grouped(frame.counts.kept));
  row.set("voxels", html::grouped(frame.voxels));
  row.set("planes", std::to_string(frame.planes.size()));
  row.set("h", std::to_string(frame.planes_h));
  row.set("v", std::to_string(frame.planes_v));
  row.set("share", html::share(frame.points_on_planes, frame.counts.kept));
  const auto metric = [&](double Metrics::*field) {
    return frame.metrics ? fmt::format("{:.2f}", *frame.metrics.*field) : std::string();
  };
  row.set("alpha", metric(&Metrics::alpha_deg));
  row.set("r_p", metric(&Metrics::r_p));
  row.set("r_m", metric(&Metrics::r_m));
  return row;
}

Data recording_data(const Report& report, std::size_t index, int& frames_so_far, bool all_open) {
  const ReportRecording& recording = report.recordings[index];
  Data data;
  data.set("anchor", fmt::format("r{}", index));
  data.set("name", recording.name);
  data.set("facts", facts(recording));
  Data warnings{Data::type::list};
  for (const std::string& warning : recording.info.warnings)
    warnings.push_back(Data("text", warning));
  data.set("has_warnings", !recording.info.warnings.empty());
  data.set("warnings", warnings);
  data.set("has_metrics", totals_of(recording).metrics.has_value());

  Data frames{Data::type::list}, rows{Data::type::list};
  for (const ReportFrame& frame : recording.frames) {
    const bool open = all_open || frames_so_far < kFramesOpenAtFirst;
    frames.push_back(html::frame_data(report, index, frame, open));
    rows.push_back(overview_row(index, frame));
    ++frames_so_far;
  }
  data.set("frames", frames);
  Data overview{false};
  if (recording.frames.size() > 1) overview = Data("rows", rows);
  data.set("overview", overview);
  return data;
}

void set_record(const Report& report, Data& page) {
  page.set("command", report.command);
  page.set("version", report.version);
  page.set("commit", report.commit);
  page.set("modified", report.modified);
  page.set("method", to_string(report.method));
  page.set("is_ours", report.method == Method::ours);
  page.set("classifier", report.classifier);
  page.set("weights", report.weights ? weights_text(*report.weights) : "none");
  page.set("renderer", report.renderer.empty() ? "none" : report.renderer);
  page.set("options_of", std::string("method ") + to_string(report.method));
  Data hashes{Data::type::list}, options{Data::type::list};
  const auto add_hash = [&](const std::string& name, const std::string& sha256) {
    if (sha256.empty()) return;
    Data row;
    row.set("name", name);
    row.set("sha256", sha256);
    hashes.push_back(row);
  };
  for (const ReportRecording& recording : report.recordings) {
    add_hash(recording.name, recording.sha256);
    for (const ReportFrame& frame : recording.frames)
      add_hash(fmt::format("{}, frame {}", recording.name, frame.index), frame.sha256);
  }
  page.set("has_hashes", hashes.is_non_empty_list());
  page.set("hashes", hashes);
  int changed = 0;
  for (const ReportOption& option : report.options) {
    Data row;
    row.set("name", option.name);
    row.set("value", option.value);
    row.set("unit", option.unit);
    row.set("meaning", option.meaning);
    row.set("changed", option.changed);
    options.push_back(row);
    changed += option.changed;
    if (option.name == "profile") page.set("options_of", "profile " + option.value);
  }
  page.set("options", options);
  page.set("changed_text", changed == 0   ? std::string(", unchanged")
                           : changed == 1 ? std::string(", one option changed")
                                          : fmt::format(", {} options changed", changed));
}

}  // namespace

std::string report_html(const Report& report) {
  const ReportTotals totals = totals_of(report);
  Data page;
  page.set("css", std::string(planescope_asset_report_css, planescope_asset_report_css_end));
  page.set("title", title_of(report));
  page.set("created", report.created_utc);
  page.set("verdict", verdict(report, totals));
  page.set("partial", report.partial);
  page.set("frames_done", std::to_string(totals.frames_done + totals.frames_refused));
  page.set("frames_asked", std::to_string(totals.frames_asked));
  page.set("renderer_error", html::text_or_false(report.renderer_error));
  page.set("tiles", tiles(report, totals));
  int frames_so_far = 0;
  const bool all_open = totals.frames_done + totals.frames_refused <= kFramesAllOpen;
  Data recordings{Data::type::list};
  for (std::size_t i = 0; i < report.recordings.size(); ++i)
    recordings.push_back(recording_data(report, i, frames_so_far, all_open));
  page.set("recordings", recordings);
  Data cases{Data::type::list};
  for (const Case c : {Case::I, Case::II, Case::III, Case::IV}) {
    Data entry;
    entry.set("numeral", to_string(c));
    entry.set("color", report.case_colors[static_cast<int>(c)]);
    entry.set("meaning", html::case_meaning(c));
    cases.push_back(entry);
  }
  page.set("cases", cases);
  set_record(report, page);
  page.set("frame", Data(kainjow::mustache::partial([] {
             return std::string(planescope_asset_report_frame_mustache,
                                planescope_asset_report_frame_mustache_end);
           })));
  kainjow::mustache::mustache layout(std::string(planescope_asset_report_page_mustache,
                                                 planescope_asset_report_page_mustache_end));
  if (!layout.is_valid()) throw Error("report template: " + layout.error_message());
  return layout.render(page);
}

}  // namespace planescope
