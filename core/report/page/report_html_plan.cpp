#include "core/report/page/report_html_plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <utility>

namespace planescope::report::html {
namespace {

constexpr std::size_t kMostWorst = 10;
constexpr std::size_t kEmbeddedFirst = 12, kEmbeddedWorst = 12;
constexpr std::size_t kFramesAllOpen = 12;  // of more only some are unfolded
constexpr std::size_t kFramesOpen = 3;
constexpr std::size_t kFewFrames = 3;  // without rules there is no worst of so few

Standing standing_of(const PageFrame& frame, bool is_judged) {
  Standing standing = is_judged ? Standing::passed : Standing::none;
  if (!frame.breaches.empty())
    standing =
        frame.breaches[0]->rule.level == RuleLevel::error ? Standing::failed : Standing::warned;
  if (!frame.is_refused()) return standing;
  return std::max(standing, frame.frame->unreadable ? Standing::failed : Standing::warned);
}

/// Orders frames that no rule tells apart: the smaller the share of labels, or of points, on the
/// right planes, the worse.
double doubt(const PageFrame& frame) {
  if (!frame.frame || frame.is_refused()) return 2;
  if (frame.frame->metrics) return 1 - frame.frame->metrics->mean_iou / 100;
  const auto points = static_cast<double>(frame.frame->counts.kept);
  return points > 0 ? 1 - static_cast<double>(frame.frame->points_on_planes) / points : 1;
}

void add_breaches(const Judgement& judgement, PagePlan& plan, std::vector<std::size_t>& order) {
  std::map<std::pair<std::string, int>, std::vector<std::size_t>> by_name;
  for (std::size_t k = 0; k < plan.frames.size(); ++k)
    by_name[{plan.frames[k].comparison->recording, plan.frames[k].comparison->index}].push_back(k);
  for (const Breach& breach : judgement.breaches) {
    const auto found = by_name.find({breach.recording, breach.frame});
    if (breach.frame < 0 || found == by_name.end()) {
      plan.general.push_back(&breach);
      continue;
    }
    for (const std::size_t k : found->second) {
      if (plan.frames[k].breaches.empty()) order.push_back(k);
      plan.frames[k].breaches.push_back(&breach);
    }
  }
}

void rank_frames(PagePlan& plan, std::vector<std::size_t> order, bool is_judged) {
  for (std::size_t k = 0; k < plan.frames.size(); ++k)
    if (plan.frames[k].breaches.empty()) order.push_back(k);
  if (is_judged) {
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
    if (plan.worst.size() < kMostWorst && (is_bad || (!is_judged && !few)))
      plan.worst.push_back(&frame);
  }
  const std::size_t open = plan.frames.size() <= kFramesAllOpen ? plan.frames.size() : kFramesOpen;
  const bool by_rank = !plan.worst.empty() && plan.worst[0]->standing > Standing::passed;
  for (std::size_t k = 0; k < plan.frames.size(); ++k) {
    plan.frames[k].embedded |= k < kEmbeddedFirst;
    plan.frames[k].open = (by_rank ? static_cast<std::size_t>(plan.frames[k].rank) - 1 : k) < open;
  }
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

}  // namespace planescope::report::html
