#pragma once

// Which frames the page is about, in which order it looks at them, and how much it shows of each.
// Included by report_html*.cpp only.

#include <string>
#include <vector>

#include "core/report/compare/judgement.hpp"

namespace planescope::report::html {

/// How a frame fares, best first; none: it is held to nothing.
enum class Standing : std::uint8_t { none, passed, warned, failed };

struct PageFrame {
  std::size_t recording = 0;
  const ReportFrame* frame = nullptr;           // null: the baseline has it alone
  const FrameComparison* comparison = nullptr;  // null: the report is held to nothing
  std::string anchor;                           // "f012", of several recordings "r2/f012"
  std::vector<const Breach*> breaches;          // worst first
  Standing standing = Standing::none;
  int rank = 0;           // 1 the worst; of the others as they come
  bool embedded = false;  // with its pictures; others only with thumbnails
  bool open = false;      // unfolded at first

  bool is_compared() const { return comparison && comparison->fate == FrameFate::compared; }
  bool is_refused() const { return frame && !frame->refused.empty(); }
};

struct PagePlan {
  std::vector<PageFrame> frames;        // as in the report, then those that are missing
  std::vector<const PageFrame*> worst;  // to look at first, the worst first, at most ten
  std::vector<const Breach*> general;   // of a whole recording, or of all
  int failed = 0;                       // frames

  PagePlan() = default;
  PagePlan(PagePlan&&) = default;  // `worst` points into `frames`
};
PagePlan plan_page(const Report& report);

std::string frame_anchor(std::size_t recordings, std::size_t recording, int index);

}  // namespace planescope::report::html
