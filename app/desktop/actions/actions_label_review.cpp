// The review's queue and the checks.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/review.hpp"
#include "app/desktop/labeling/work.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {
namespace {

constexpr double kLargestRegion_cm2 = 1e6;

int item_count(const State& state) {
  const ReviewQueue* queue = state.results.label.review.get();
  return queue ? static_cast<int>(queue->items.size()) : 0;
}
int finding_count(const State& state) {
  const Audit* audit = state.results.label.audit.get();
  return audit ? static_cast<int>(audit->findings.size()) : 0;
}

void start(State& state) {
  state.view.label.tab = "review";
  const ReviewQueue* queue = state.results.label.review.get();
  if (queue && state.view.label.review_item < 0 && queue->undecided() > 0) choose_item(state, 0);
}

void step_item(State& state, int by) {
  const int count = item_count(state), now = state.view.label.review_item;
  choose_item(state, now < 0 ? (by > 0 ? 0 : count - 1) : std::clamp(now + by, 0, count - 1));
}

void decide_told(State& state,
                 const std::string& action,
                 ReviewDecision decision,
                 const std::string& text) {
  if (!text.empty())
    state.view.label.review_item = whole_argument(action, text, 0, item_count(state) - 1);
  decide(state, decision);
}

void edit(State& state, const std::string& text) {
  decide_told(state, "review.edit", ReviewDecision::edit, text);
  LabelView& view = state.view.label;
  const labels::Disagreement& item =
      state.results.label.review->items[static_cast<std::size_t>(view.review_item)];
  view.tool = LabelTool::brush;
  view.paints = Paints::plane;
  view.plane = item.label_plane;
}

void slivers(State& state, const std::string& what) {
  LabelView& view = state.view.label;
  if (what == "show") {
    view.review_slivers = !view.review_slivers;
    const ReviewQueue* queue = state.results.label.review.get();
    const bool inside = queue && view.review_item >= 0 && view.review_item < item_count(state) &&
                        is_sliver(queue->items[static_cast<std::size_t>(view.review_item)]);
    if (!view.review_slivers && inside) view.review_item = -1;
    return;
  }
  if (what == "keep") return decide_slivers(state, ReviewDecision::keep);
  if (what == "take") return decide_slivers(state, ReviewDecision::take);
  if (what == "ignore") return decide_slivers(state, ReviewDecision::ignore);
  throw Error(
      fmt::format("action review.slivers: '{}', expected show, keep, take or ignore", what));
}

void finish(State& state) {
  const LabelWork work = label_work(state);
  FrameLabels after = *work.labels;
  const bool reviewed = after.review_state == "reviewed";
  const ReviewQueue* queue = state.results.label.review.get();
  if (!reviewed && (!queue || queue->labels != work.labels))
    throw Error("differences are unknown: D opens the review");
  if (!reviewed && queue->undecided() > 0)
    throw Error(fmt::format("{} of {} regions are undecided", queue->undecided(),
                            queue->undecided() + after.review.size()));
  after.review_state = reviewed ? "unreviewed" : "reviewed";
  commit_and_say(state, reviewed ? "Not reviewed" : "Reviewed", after, "");
}

void compare_with(State& state, const std::string& folder) {
  const LabelWork work = label_work(state);
  if (!folder.empty()) {  // so that a folder that cannot be compared with is refused at once
    const auto other = labels::read_frame_labels(folder, work.frame.frame, work.frame.sha256);
    if (!other) throw Error(fmt::format("{}: no labels of frame {}", folder, work.frame.frame));
  }
  LabelView& view = state.view.label;
  view.tab = "review";
  if (view.compare_with == folder) return;
  view.compare_with = folder;
  view.review_item = -1;
  state.results.label.review = nullptr;
  state.results.label.review_refusal.clear();
}

void show_finding(State& state, int index) {
  LabelView& view = state.view.label;
  view.tab = "checks";
  view.finding = index;
  if (index >= finding_count(state)) return;  // shown when the checks are done
  const labels::Finding& finding =
      state.results.label.audit->findings[static_cast<std::size_t>(index)];
  view.plane = finding.plane;
  const labels::PixelSet place{finding.pixel};
  look_at_pixels(state, finding.pixels.empty() ? place : finding.pixels);
  say(state, finding.text);
}

void step_finding(State& state, int by) {
  const int count = finding_count(state), now = state.view.label.finding;
  if (state.results.label.audit && count == 0) {
    state.view.label.tab = "checks";
    return say(state, "no problems found");
  }
  show_finding(state, count == 0 || now < 0 ? 0 : (now + by + count) % count);
}

Action on_frame(const char* name, const char* title, const char* key, void (*run)(State&)) {
  return {name,      title, "Review", key, "", [run](State& s, const std::string&) { run(s); },
          can_label, {}};
}

Action on_item(const char* name, const char* title, const char* key, ReviewDecision decision) {
  return {
      name,
      title,
      "Review",
      key,
      "[NUMBER]",
      [name, decision](State& s, const std::string& text) { decide_told(s, name, decision, text); },
      can_label,
      {}};
}

Action step_action(const char* name, const char* title, const char* key, int by) {
  return {name,
          title,
          "Review",
          key,
          "",
          [by](State& s, const std::string&) { step_item(s, by); },
          [](const State& s) { return can_label(s) && item_count(s) > 0; },
          {}};
}

}  // namespace

std::vector<Action> label_review_actions() {
  return {
      on_frame("review.start", "Review differences from the algorithm", "D", start),
      step_action("review.next", "Next region", "Down", 1),
      step_action("review.previous", "Previous region", "Up", -1),
      on_item("review.keep", "Keep the labels", "", ReviewDecision::keep),
      on_item("review.take", "Take the other side", "A", ReviewDecision::take),
      {"review.edit", "Edit the labels here", "Review", "E", "[NUMBER]", edit, can_label, {}},
      on_item("review.ignore", "Do not score the region", "G", ReviewDecision::ignore),
      {"review.item",
       "Select a region",
       "",
       "",
       "NUMBER",
       [](State& s, const std::string& text) {
         choose_item(s, whole_argument("review.item", text, 0, item_count(s) - 1));
       },
       can_label,
       {}},
      {"review.slivers",
       "Show or decide all slivers",
       "",
       "",
       "show|keep|take|ignore",
       slivers,
       can_label,
       {}},
      {"review.smallest",
       "Smallest region in the review",
       "Review",
       "",
       "CM2",
       [](State& s, const std::string& text) {
         const double cm2 = number_argument("review.smallest", text);
         if (!(cm2 >= 0 && cm2 <= kLargestRegion_cm2))
           throw Error(fmt::format("action review.smallest: {} cm2, expected 0 to {:g}", text,
                                   kLargestRegion_cm2));
         s.view.label.review_smallest_cm2 = cm2;
       },
       {},
       {}},
      {"review.against",
       "Compare with another annotator's labels",
       "",
       "",
       "[FOLDER]",
       compare_with,
       can_label,
       {}},
      {"review.done", "Mark the frame as reviewed", "Review", "Shift+D", "",
       [](State& s, const std::string&) { finish(s); }, can_label,
       [](const State& s) { return can_label(s) && s.labels()->review_state == "reviewed"; }},
      {"check.next",
       "Next problem",
       "Review",
       "F4",
       "",
       [](State& s, const std::string&) { step_finding(s, 1); },
       can_label,
       {}},
      {"check.previous",
       "Previous problem",
       "Review",
       "Shift+F4",
       "",
       [](State& s, const std::string&) { step_finding(s, -1); },
       can_label,
       {}},
      {"check.show",
       "Show a problem",
       "",
       "",
       "NUMBER",
       [](State& s, const std::string& text) {
         show_finding(s, whole_argument("check.show", text, 0, finding_count(s) - 1));
       },
       can_label,
       {}},
  };
}

}  // namespace planescope::desktop
