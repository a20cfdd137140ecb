#pragma once

// Inside the page's writer: which frames it is about, the data of its templates, and the words that
// its parts share. Included by page*.cpp, and by report_files.cpp for its escaping.

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

// Which frames the page is about, in which order it looks at them, and how much it shows of each.

/// Longer pages unfold only some frames, and have a list of contents.
inline constexpr std::size_t kFramesAllOpen = 12;

/// How a frame did against the rules, best first; none: there are no rules.
enum class Standing : std::uint8_t { none, passed, warned, failed };

struct PageFrame {
  std::size_t recording = 0;
  const ReportFrame* frame = nullptr;           // null: the baseline has it alone
  const FrameComparison* comparison = nullptr;  // null: the report is held to nothing
  std::string anchor;                           // "f012", of several recordings "r2/f012"
  std::vector<const Breach*> breaches;          // worst first
  std::vector<const Breach*> notes;             // of undecided planes
  Standing standing = Standing::none;
  int rank = 0;           // 1: the worst
  bool embedded = false;  // with its pictures; others only with thumbnails
  bool open = false;      // unfolded at first

  bool is_compared() const { return comparison && comparison->fate == FrameFate::compared; }
  bool is_refused() const { return frame && !frame->refused.empty(); }
};

struct PagePlan {
  std::vector<PageFrame> frames;        // as in the report, then those that are missing
  std::vector<const PageFrame*> worst;  // to look at first, the worst first, at most ten
  std::vector<const Breach*> general;   // of a whole recording, or of all
  std::vector<const Breach*> general_notes;
  int failed = 0;  // frames

  PagePlan() = default;
  PagePlan(PagePlan&&) = default;  // `worst` points into `frames`
};
PagePlan plan_page(const Report& report);

std::string frame_anchor(std::size_t recordings, std::size_t recording, int index);

/// Signs that planes of a frame went wrong, without labels and without a baseline: which frames to
/// look at first where nothing else says so.
struct Signs {
  int slivers = 0;        // planes too narrow for a circle of 4 cm radius
  int floor_pieces = 0;   // level planes within 3 cm of the floor's height: pieces of it, beside it
  int low_support = 0;    // planes that miss a tenth of the pixels within their outline
  double off_planes = 0;  // share of the points, 0 to 1

  /// The more, the worse: a floor in pieces counts three times a sliver, low support twice, and all
  /// points off planes once.
  double weight() const;
  /// "2 slivers, the floor in 3 pieces, 1 plane of low support; 61.2 % of the points on planes".
  std::string text() const;
};
/// Of a frame that was processed.
Signs signs_of(const ReportFrame& frame);

// The page's pieces: data for its templates. In them numbers are text, empty text is not there, an
// item of a list that is text is called `text`, and has_X says whether the list X has items.

using PageJson = nlohmann::ordered_json;

struct PageSource {
  const Report& report;
  const std::filesystem::path& dir;  // where the pictures' copies lie
  const PagePlan& plan;

  const ReportRecording& recording_of(const PageFrame& frame) const {
    return report.recordings[frame.recording];
  }
  bool has_metrics() const;
  bool has_baseline() const { return report.judgement && report.judgement->baseline; }
};

/// Of report_page.mustache: the verdict, what differs, the worst frames, the totals.
void set_verdict(const PageSource& page, PageJson& data);

/// Data of report_row.mustache.
PageJson row_data(const PageSource& page, const PageFrame& frame);
/// "failed", for people and for CSS.
const char* name_of(Standing standing);
/// The same of a frame, which may also be missing or refused.
const char* result_of(const PageFrame& frame);
/// "Frame 12", "Frame 12 of a.bag".
std::string title_of(const PageSource& page, const PageFrame& frame);
/// Entries `source`, `href`, `alt` of a frame's thumbnails; at most `most`.
PageJson thumbnails(const PageSource& page, const PageFrame& frame, std::size_t most);

/// Data of report_recording.mustache: facts, warnings, how its frames go.
PageJson recording_data(const PageSource& page, std::size_t recording);
/// All frames' sources of gravity, each once, as HTML.
std::string gravity_summary(const std::vector<ReportRecording>& recordings);

/// Data of report_frame.mustache.
PageJson frame_data(const PageSource& page, const PageFrame& frame);

/// Planes of a compared frame then and now, as sources of images; empty for clouds.
struct PlaneMaps {
  std::string baseline, now;
  int width = 0, height = 0;
};
PlaneMaps plane_maps(const PageFrame& frame);
/// "2 lost, 1 gained" of planes that changed; "none" where all are as they were. `count(fate)`.
std::string changes_text(const std::function<std::size_t(PlaneFate)>& count);
std::string changes_text(const PageFrame& frame);

/// Of report_end.mustache: how near to their thresholds decisions fell, and what one needs to make
/// the report again.
PageJson end_data(const PageSource& page);

// Text, numbers and links.

/// 12 345, with narrow spaces that do not break.
std::string grouped(std::uint64_t value);
/// "12.3 %" of the whole.
std::string share(std::uint64_t part, std::uint64_t whole);
/// "2 frames", "1 frame".
std::string counted(std::size_t count, std::string_view noun);
/// A true minus sign, and none before zeros.
std::string decimal(double value, int digits);
std::string escaped(const std::string& text);
/// For a link to a file beside the page: never another scheme, host or place of this page.
std::string href(const std::string& file);
/// Bytes that are no UTF-8, and control characters, become U+FFFD.
std::string valid_text(const std::string& text);
/// "#rrggbb", or grey where it is none.
std::string safe_color(const std::string& color);
/// Where gravity comes from, as HTML; emphasised where it is a guess.
std::string gravity_text(const Gravity& gravity);
/// "data:image/webp;base64,..." of a file; empty where it cannot be read.
std::string webp_source(const std::filesystem::path& file);

}  // namespace planescope::report::html
