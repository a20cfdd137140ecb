// Writes index.html from the templates in assets/report, piece by piece, because a page of a
// thousand frames is too large for memory. Contains its plan, and its text, numbers and links.

#include "core/report/page/page.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <kainjow/mustache.hpp>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <ostream>
#include <utility>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"
#include "core/report/data/report_files.hpp"
#include "core/report/page/charts.hpp"
#include "core/report/page/pictures.hpp"

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

namespace planescope::report::html {
namespace {

constexpr std::size_t kMostWorst = 10;
constexpr std::size_t kEmbeddedFirst = 12, kEmbeddedWorst = 12;
constexpr std::size_t kFramesOpen = 3;  // in longer pages
constexpr std::size_t kFewFrames = 3;   // no list of the worst for this few frames without rules

Standing standing_of(const PageFrame& frame, bool is_compared) {
  Standing standing = is_compared ? Standing::passed : Standing::none;
  if (!frame.breaches.empty())
    standing =
        frame.breaches[0]->rule.level == RuleLevel::error ? Standing::failed : Standing::warned;
  if (!frame.is_refused()) return standing;
  return std::max(standing, frame.frame->unreadable ? Standing::failed : Standing::warned);
}

/// Orders frames that rules do not rank: by the smaller share of labels on the right planes, or
/// without labels by more signs of trouble.
double doubt(const PageFrame& frame) {
  if (!frame.frame || frame.is_refused()) return std::numeric_limits<double>::infinity();
  if (frame.frame->metrics) return 1 - frame.frame->metrics->mean_iou / 100;
  return signs_of(*frame.frame).weight();
}

void add_breaches(const Judgement& judgement, PagePlan& plan, std::vector<std::size_t>& order) {
  std::map<std::tuple<std::string, bool, int>, std::vector<std::size_t>> by_name;
  for (std::size_t k = 0; k < plan.frames.size(); ++k) {
    const FrameComparison& frame = *plan.frames[k].comparison;
    by_name[{frame.recording, frame.fate == FrameFate::missing, frame.index}].push_back(k);
  }
  for (const Breach& breach : judgement.breaches) {
    const auto found = by_name.find({breach.recording, breach.is_missing, breach.frame});
    if (breach.frame < 0 || found == by_name.end()) {
      plan.general.push_back(&breach);
      continue;
    }
    for (const std::size_t k : found->second) {
      if (plan.frames[k].breaches.empty()) order.push_back(k);
      plan.frames[k].breaches.push_back(&breach);
    }
  }
  for (const Breach& note : judgement.notes) {
    const auto found = by_name.find({note.recording, note.is_missing, note.frame});
    if (note.frame < 0 || found == by_name.end())
      plan.general_notes.push_back(&note);
    else
      for (const std::size_t k : found->second) plan.frames[k].notes.push_back(&note);
  }
}

void rank_frames(PagePlan& plan, std::vector<std::size_t> order, bool is_compared) {
  for (std::size_t k = 0; k < plan.frames.size(); ++k)
    if (plan.frames[k].breaches.empty()) order.push_back(k);
  if (is_compared) {
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
      return plan.frames[a].standing > plan.frames[b].standing;
    });
  } else {
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
      return doubt(plan.frames[a]) > doubt(plan.frames[b]);
    });
  }
  const bool few = plan.frames.size() <= kFewFrames;
  for (std::size_t place = 0; place < order.size(); ++place) {
    PageFrame& frame = plan.frames[order[place]];
    frame.rank = static_cast<int>(place) + 1;
    frame.embedded |= place < kEmbeddedWorst;
    const bool is_bad = frame.standing > Standing::passed;
    if (plan.worst.size() < kMostWorst && (is_bad || (!is_compared && !few)))
      plan.worst.push_back(&frame);
  }
  const std::size_t open = plan.frames.size() <= kFramesAllOpen ? plan.frames.size() : kFramesOpen;
  const bool by_rank = !plan.worst.empty() && plan.worst[0]->standing > Standing::passed;
  for (std::size_t k = 0; k < plan.frames.size(); ++k) {
    plan.frames[k].embedded |= k < kEmbeddedFirst;
    plan.frames[k].open = (by_rank ? static_cast<std::size_t>(plan.frames[k].rank) - 1 : k) < open;
  }
}

constexpr double kSliver_m = 0.04;       // radius
constexpr double kFloorHeight_m = 0.03;  // a step is higher, a piece of the floor is not
constexpr double kLeastSupport = 0.9;

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("-._~/").find(c) != std::string_view::npos;
}

}  // namespace

std::string frame_anchor(std::size_t recordings, std::size_t recording, int index) {
  if (recordings == 1) return fmt::format("f{:03}", index);
  return fmt::format("r{}/f{:03}", recording + 1, index);
}

PagePlan plan_page(const Report& report) {
  PagePlan plan;
  const Judgement* judgement = report.judgement.get();
  for (std::size_t r = 0; r < report.recordings.size(); ++r)
    for (const ReportFrame& frame : report.recordings[r].frames) {
      PageFrame& added = plan.frames.emplace_back();
      added.recording = r;
      added.frame = &frame;
      added.anchor = frame_anchor(report.recordings.size(), r, frame.index);
    }
  std::vector<std::size_t> order;  // frames that break a rule, the worst first
  if (judgement) {
    const std::vector<FrameComparison>& compared = judgement->comparison.frames;
    for (int missing = 1; plan.frames.size() < compared.size(); ++missing)
      plan.frames.emplace_back().anchor = fmt::format("missing{}", missing);
    for (std::size_t k = 0; k < plan.frames.size(); ++k) plan.frames[k].comparison = &compared[k];
    add_breaches(*judgement, plan, order);
  }
  for (PageFrame& frame : plan.frames) {
    frame.standing = standing_of(frame, judgement != nullptr);
    plan.failed += frame.standing == Standing::failed;
  }
  rank_frames(plan, std::move(order), judgement != nullptr);
  return plan;
}

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

std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", grouped(count), noun, count == 1 ? "" : "s");
}

std::string decimal(double value, int digits) {
  std::string text = fmt::format("{:.{}f}", std::abs(value), digits);
  const bool zero = text.find_first_not_of("0.") == std::string::npos;
  return value < 0 && !zero ? "\u2212" + text : text;
}

std::string escaped(const std::string& text) { return kainjow::mustache::html_escape(text); }

std::string href(const std::string& file) {
  std::string result;
  for (const char c : file.substr(std::min(file.find_first_not_of('/'), file.size())))
    result += is_plain(c)
                  ? std::string(1, c)
                  : fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
  return result;
}

std::string valid_text(const std::string& text) {
  const std::string written =
      PageJson(text).dump(-1, ' ', false, PageJson::error_handler_t::replace);
  std::string result;
  for (const char c : PageJson::parse(written).get<std::string>())
    if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t')
      result += "\uFFFD";
    else
      result += c;
  return result;
}

std::string safe_color(const std::string& color) {
  const bool is_color = color.size() == 7 && color[0] == '#' &&
                        color.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  return is_color ? color : "#888888";
}

std::string gravity_text(const Gravity& gravity) {
  switch (gravity.source) {
    case GravitySource::option:
      return "specified on the command line";
    case GravitySource::sidecar:
      return "from the recording\u2019s files";
    case GravitySource::imu:
      return "from the recording\u2019s IMU";
    case GravitySource::picked:
      return "picked in the window";
    case GravitySource::estimate:
      return fmt::format("<em>estimated</em> from the scene, confidence {:.2f}",
                         gravity.confidence);
    case GravitySource::assumed:
      return "<em>assumed</em>";
    case GravitySource::carried:
      return fmt::format("<em>carried</em> from another frame, confidence {:.2f}",
                         gravity.confidence);
    case GravitySource::none:
      break;
  }
  return "<em>unknown</em>";
}

std::string webp_source(const std::filesystem::path& file) {
  if (!std::filesystem::exists(file)) return "";  // the page links the picture instead
  return "data:image/webp;base64," + base64(read_file_bytes(file));
}

double Signs::weight() const { return slivers + 3 * floor_pieces + 2 * low_support + off_planes; }

std::string Signs::text() const {
  std::vector<std::string> signs;
  if (floor_pieces > 0) signs.push_back(fmt::format("the floor in {} pieces", floor_pieces + 1));
  if (low_support > 0) signs.push_back(counted(low_support, "plane") + " with low support");
  if (slivers > 0) signs.push_back(counted(slivers, "sliver"));
  return fmt::format("{}{}{:.1f} % of the points on planes", fmt::join(signs, ", "),
                     signs.empty() ? "" : "; ", 100 * (1 - off_planes));
}

Signs signs_of(const ReportFrame& frame) {
  Signs signs;
  signs.off_planes = 1 - frame.percent_on_planes() / 100;
  const int floor = frame.terrain ? frame.terrain->floor : 0;
  for (const ReportPlane& plane : frame.planes) {
    if (!plane.footing) continue;
    const Footing& footing = *plane.footing;
    signs.slivers += footing.clearance_m < kSliver_m;
    signs.low_support += footing.support < kLeastSupport;
    signs.floor_pieces +=
        floor > 0 && plane.summary.id != floor && std::abs(footing.height_m) <= kFloorHeight_m;
  }
  return signs;
}

}  // namespace planescope::report::html

namespace planescope::report {
namespace {

using namespace html;

constexpr const char* kEndOfRows = "</tbody>\n</table>\n</div>\n</section>\n";

using Data = kainjow::mustache::data;

/// In the form for templates that page.hpp describes.
Data data_of(const PageJson& json) {
  if (json.is_object()) {
    Data object;
    for (const auto& [name, value] : json.items()) {
      if (value.is_array()) object.set("has_" + name, !value.empty());
      object.set(name, data_of(value));
    }
    return object;
  }
  if (json.is_array()) {
    Data list{Data::type::list};
    for (const PageJson& item : json)
      list.push_back(item.is_object() ? data_of(item) : Data("text", data_of(item)));
    return list;
  }
  if (json.is_number()) return json.dump();
  if (json.is_boolean()) return json.get<bool>();
  if (json.is_null() || json.get_ref<const std::string&>().empty()) return false;
  return json.get_ref<const std::string&>();
}

/// A template of assets/report, parsed once.
class Template {
 public:
  Template(const char* begin, const char* end) : mustache_(std::string(begin, end)) {
    if (!mustache_.is_valid()) throw Error("report template: " + mustache_.error_message());
  }
  void write(std::ostream& out, const PageJson& json) {
    // Render to a string: a stream would silently truncate when out of memory.
    std::string text;
    mustache_.render(data_of(json), [&](const std::string& piece) { text += piece; });
    out << valid_text(text);
  }

 private:
  kainjow::mustache::mustache mustache_;
};

std::string page_title(const Report& report) {
  if (report.recordings.size() == 1) return report.recordings[0].name;
  return fmt::format("{} recordings", report.recordings.size());
}

/// The script's hash for the content security policy: "sha256-...".
std::string hash_source(const std::string& script) {
  const std::string hex = sha256_hex(script);
  std::vector<unsigned char> digest;
  for (std::size_t i = 0; i < hex.size(); i += 2)
    digest.push_back(static_cast<unsigned char>(std::stoi(hex.substr(i, 2), nullptr, 16)));
  return "sha256-" + base64(digest);
}

/// One entry per column after "Change": the figures of a frame.
std::vector<std::string> columns_of(const PageSource& page) {
  std::vector<std::string> names = {"Planes", "On planes"};
  for (const FrameMetric& metric : frame_metrics())
    if (metric.column && page.has_metrics()) names.emplace_back(metric.column);
  return names;
}

/// The smallest file that the page links, to check whether its folder exists.
std::string picture_beside(const Report& report) {
  for (const ReportRecording& recording : report.recordings)
    for (const ReportFrame& frame : recording.frames)
      for (const ReportPicture& picture : frame.pictures) return href(thumbnail_of(picture));
  return "";
}

PageJson page_data(const PageSource& page) {
  const std::string script(planescope_asset_report_js, planescope_asset_report_js_end);
  PageJson data = {
      {"css",
       std::string(planescope_asset_report_css, planescope_asset_report_css_end) +
           std::string(planescope_asset_report_page_css, planescope_asset_report_page_css_end) +
           line_chart_style()},
      {"script_hash", hash_source(script)},
      {"title", page_title(page.report)},
      {"version", page.report.version},
      {"created", page.report.created_utc},
      {"has_rows", page.plan.frames.size() > 1},
      {"has_change", page.has_baseline()},
      {"columns", columns_of(page)},
      {"frames_text", counted(page.plan.frames.size(), "frame")},
      {"beside", picture_beside(page.report)}};
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
  PageJson end = end_data(page);
  end["script"] = std::string(planescope_asset_report_js, planescope_asset_report_js_end);
  Template(planescope_asset_report_end_mustache, planescope_asset_report_end_mustache_end)
      .write(out, end);
}

}  // namespace planescope::report
