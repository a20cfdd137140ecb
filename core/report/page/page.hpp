#pragma once

// Internals of the page's writer: selection of frames, data of its templates, and shared text.
// Included by page*.cpp, and by report_files.cpp for escaping.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "core/report/compare/judgement.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::report::html {

// Frames of the page, their order, and the level of detail of each.

/// Longer pages unfold only some frames, and have a table of contents.
inline constexpr std::size_t kFramesAllOpen = 12;

/// Result of a frame against the rules, best first; none: there are no rules.
enum class Standing : std::uint8_t { none, passed, warned, failed };

struct PageFrame {
  std::size_t recording = 0;
  const ReportFrame* frame = nullptr;           // null: only in the baseline
  const FrameComparison* comparison = nullptr;  // null: the report is not compared
  std::string anchor;                           // "f012", or with several recordings "r2/f012"
  std::vector<const Breach*> breaches;          // worst first
  std::vector<const Breach*> notes;             // about undecided planes
  Standing standing = Standing::none;
  int rank = 0;           // 1: the worst
  bool embedded = false;  // with its pictures; others have only thumbnails
  bool open = false;      // unfolded initially

  bool is_compared() const { return comparison && comparison->fate == FrameFate::compared; }
  bool is_refused() const { return frame && !frame->refused.empty(); }
};

struct PagePlan {
  std::vector<PageFrame> frames;        // in the report's order, then the missing ones
  std::vector<const PageFrame*> worst;  // to review first, the worst first, at most ten
  std::vector<const Breach*> general;   // of a whole recording, or of all
  std::vector<const Breach*> general_notes;
  int failed = 0;  // frames

  PagePlan() = default;
  PagePlan(PagePlan&&) = default;  // `worst` points into `frames`
};
PagePlan plan_page(const Report& report);

std::string frame_anchor(std::size_t recordings, std::size_t recording, int index);

/// Signs of wrong planes in a frame, without labels or a baseline: order for review if nothing else
/// ranks the frames.
struct Signs {
  int slivers = 0;        // planes too narrow for a circle of 4 cm radius
  int floor_pieces = 0;   // level planes within 3 cm of the floor's height: pieces of it
  int low_support = 0;    // planes that miss a tenth of the pixels within their outline
  double off_planes = 0;  // share of the points, 0 to 1

  /// Higher is worse: a floor in pieces counts three times a sliver, low support twice, and all
  /// points off planes once.
  double weight() const;
  /// "2 slivers, the floor in 3 pieces, 1 plane of low support; 61.2 % of the points on planes".
  std::string text() const;
};
/// For a processed frame.
Signs signs_of(const ReportFrame& frame);

// The page's pieces: data for its templates. Numbers are text there, empty text counts as missing,
// text items of a list are called `text`, and has_X is true if the list X has items.

using PageJson = nlohmann::ordered_json;

struct PageSource {
  const Report& report;
  const std::filesystem::path& dir;  // contains the pictures' copies
  const PagePlan& plan;

  const ReportRecording& recording_of(const PageFrame& frame) const {
    return report.recordings[frame.recording];
  }
  bool has_metrics() const;
  bool has_baseline() const { return report.judgement && report.judgement->baseline; }
};

/// For report_page.mustache: the verdict, differences, the worst frames, and totals.
void set_verdict(const PageSource& page, PageJson& data);

/// Data of report_row.mustache.
PageJson row_data(const PageSource& page, const PageFrame& frame);
/// "failed", for display and CSS.
const char* name_of(Standing standing);
/// The same for a frame, which may also be missing or refused.
const char* result_of(const PageFrame& frame);
/// "Frame 12", "Frame 12 of a.bag".
std::string title_of(const PageSource& page, const PageFrame& frame);
/// Entries `source`, `href`, `alt` of a frame's thumbnails; at most `most`.
PageJson thumbnails(const PageSource& page, const PageFrame& frame, std::size_t most);

/// Data of report_recording.mustache: facts, warnings, and charts over its frames.
PageJson recording_data(const PageSource& page, std::size_t recording);
/// All sources of gravity in the frames, each once, as HTML.
std::string gravity_summary(const std::vector<ReportRecording>& recordings);

/// Data of report_frame.mustache.
PageJson frame_data(const PageSource& page, const PageFrame& frame);

/// Planes of a compared frame then and now, as image sources; empty for clouds.
struct PlaneMaps {
  std::string baseline, now;
  int width = 0, height = 0;
};
PlaneMaps plane_maps(const PageFrame& frame);
/// "2 lost, 1 gained" for planes that changed; "none" if all are unchanged. `count(fate)`.
std::string changes_text(const std::function<std::size_t(PlaneFate)>& count);
std::string changes_text(const PageFrame& frame);

/// For report_end.mustache: decisions near their thresholds, and the facts to reproduce the report.
PageJson end_data(const PageSource& page);

// Text, numbers and links.

/// 12 345, with narrow no-break spaces.
std::string grouped(std::uint64_t value);
/// "12.3 %" of the whole.
std::string share(std::uint64_t part, std::uint64_t whole);
/// "2 frames", "1 frame".
std::string counted(std::size_t count, std::string_view noun);
/// With a true minus sign, but none for zeros.
std::string decimal(double value, int digits);
std::string escaped(const std::string& text);
/// Link to a file beside the page: never to another scheme, host or place on this page.
std::string href(const std::string& file);
/// Replaces invalid UTF-8 and control characters with U+FFFD.
std::string valid_text(const std::string& text);
/// "#rrggbb", or gray if it is invalid.
std::string safe_color(const std::string& color);
/// Source of gravity as HTML; emphasized if it is a guess.
std::string gravity_text(const Gravity& gravity);
/// "data:image/webp;base64,..." of a file; empty if it cannot be read.
std::string webp_source(const std::filesystem::path& file);

}  // namespace planescope::report::html
