// Review queue of label mode: building it, choosing items, and applying decisions.

#include "app/desktop/labeling/review.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/work.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

FrameLabels read_other(const ReviewSides& sides) {
  const std::filesystem::path& folder = sides.folder;
  std::optional<FrameLabels> other =
      labels::read_frame_labels(folder, sides.frame->frame, sides.frame->sha256);
  if (!other)
    throw Error(fmt::format("{}: no labels for frame {}", folder.string(), sides.frame->frame));
  return std::move(*other);
}

/// Index of the same region in a newer queue; -1: none.
int place_in(const ReviewQueue& queue, const labels::Disagreement& item) {
  const auto same = std::ranges::find_if(queue.items, [&](const labels::Disagreement& one) {
    return one.kind == item.kind && one.pixel == item.pixel;
  });
  return same == queue.items.end() ? -1 : static_cast<int>(same - queue.items.begin());
}

/// Moves decided items behind undecided ones.
void undecided_first(ReviewQueue& queue) {
  std::ranges::stable_partition(queue.items,
                                [](const labels::Disagreement& one) { return !one.note; });
}

std::int64_t now_s() {
  using namespace std::chrono;
  return duration_cast<seconds>(system_clock::now().time_since_epoch()).count();
}

std::string title_of(const labels::Disagreement& item, ReviewDecision decision) {
  std::string title = fmt::format("Review: {} {}", to_string(item.kind), past_tense(decision));
  if (item.label_plane > 0) title += fmt::format(" (P{})", item.label_plane);
  return title;
}

/// Throws Error if the labels of an item have changed since the queue was built.
void expect_unchanged(const State& state, const labels::Disagreement& item) {
  const FrameLabels &before = *state.results.label.review->labels, &now = *state.labels();
  for (const std::uint32_t pixel : item.pixels)
    if (before.plane.data[pixel] != now.plane.data[pixel] ||
        before.hv.data[pixel] != now.hv.data[pixel])
      throw Error("the labels there have changed; the list is being updated");
}

/// Throws Error if the item belongs to locked or hidden planes.
void decide_on_item(const State& state,
                    labels::LabelDraft& draft,
                    labels::Disagreement& item,
                    ReviewDecision decision) {
  labels::decide(draft, state.label_frame()->grid, item, *state.results.label.review->other_labels,
                 decision, state.document.current()->labels->annotator(), now_s());
  item.note = draft.labels.review.back();
}

/// Commits one undo step. `next` is the queue with its decided items.
void commit_decisions(State& state,
                      const std::string& title,
                      labels::LabelDraft& draft,
                      const std::shared_ptr<ReviewQueue>& next,
                      ReviewDecision decision) {
  const bool is_current = next->labels == state.labels();
  commit_and_say(state, title, draft, "already decided that way");
  next->labels_decided = decision == ReviewDecision::take || decision == ReviewDecision::ignore;
  if (!next->labels_decided && is_current) next->labels = state.labels();  // no label changed
  undecided_first(*next);
  state.results.label.review = next;
}

/// Chooses the next item to decide after index `place`.
void go_on(State& state, int place) {
  const ReviewQueue& queue = *state.results.label.review;
  const int left = static_cast<int>(queue.undecided());
  if (left > 0) return choose_item(state, place < left ? place : 0);
  choose_item(state, -1);
  say(state, "all regions are decided; Shift+D marks the frame as reviewed");
}

}  // namespace

std::shared_ptr<const ReviewQueue> make_queue(const ReviewSides& sides) {
  auto queue = std::make_shared<ReviewQueue>();
  queue->labels = sides.labels;
  queue->run = sides.run;
  const labels::LabelGrid& grid = sides.frame->grid;
  if (sides.run) {
    queue->other = planes::to_string(sides.run->segment_options.profile);
    queue->other_labels =
        std::make_shared<const labels::OtherLabels>(labels_of_run(*sides.run, grid));
  } else {
    const FrameLabels other = read_other(sides);
    queue->other = sides.folder.string();
    queue->other_labels = std::make_shared<const labels::OtherLabels>(labels::other_of(other));
    queue->agreement = labels::agreement_of(*sides.labels, other);
  }
  queue->smallest_cm2 = sides.smallest_cm2;
  queue->items = labels::find_disagreements(*sides.labels, *queue->other_labels, grid,
                                            {.min_area_m2 = 1e-4 * sides.smallest_cm2});
  return queue;
}

void take_queue(State& state, const std::shared_ptr<const ReviewQueue>& queue) {
  const std::shared_ptr<const ReviewQueue> before = std::move(state.results.label.review);
  const int chosen = state.view.label.review_item;
  state.results.label.review = queue;
  state.results.label.review_refusal.clear();
  if (!before) return choose_item(state, queue->undecided() > 0 ? 0 : -1);
  if (chosen >= 0 && chosen < static_cast<int>(before->items.size())) {
    const int place = place_in(*queue, before->items[static_cast<std::size_t>(chosen)]);
    if (place >= 0) {
      state.view.label.review_item = place;
      return;
    }
  }
  const int left = static_cast<int>(queue->undecided());
  const bool goes_on = before->labels_decided && chosen >= 0 && left > 0;
  // Otherwise keep the view, because the user may be drawing in it.
  goes_on ? choose_item(state, std::min(chosen, left - 1)) : choose_item(state, -1);
}

void choose_item(State& state, int item) {
  state.view.label.review_item = item;
  const ReviewQueue* queue = state.results.label.review.get();
  if (queue && item >= 0)
    look_at_pixels(state, queue->items[static_cast<std::size_t>(item)].pixels);
}

void decide(State& state, ReviewDecision decision) {
  labels::LabelDraft draft = draft_of(state);
  const std::shared_ptr<const ReviewQueue> queue = state.results.label.review;
  const int chosen = state.view.label.review_item;
  if (!queue || chosen < 0 || chosen >= static_cast<int>(queue->items.size()))
    throw Error("no region is selected; press D to open the review, then Down to select one");
  const labels::Disagreement& item = queue->items[static_cast<std::size_t>(chosen)];
  expect_unchanged(state, item);
  auto next = std::make_shared<ReviewQueue>(*queue);
  decide_on_item(state, draft, next->items[static_cast<std::size_t>(chosen)], decision);
  commit_decisions(state, title_of(item, decision), draft, next, decision);
  if (decision == ReviewDecision::edit) return choose_item(state, place_in(*next, item));
  if (!item.note) go_on(state, chosen);
}

bool is_sliver(const labels::Disagreement& item) {
  return item.kind == DisagreementKind::boundary && !item.note;
}

Slivers slivers_of(const ReviewQueue& queue) {
  Slivers slivers;
  for (const labels::Disagreement& item : queue.items) {
    if (!is_sliver(item)) continue;
    ++slivers.count;
    slivers.pixels += item.pixels.size();
  }
  return slivers;
}

void decide_slivers(State& state, ReviewDecision decision) {
  const std::shared_ptr<const ReviewQueue> queue = state.results.label.review;
  if (!queue || slivers_of(*queue).count == 0)
    throw Error("the review has no slivers to decide on");
  labels::LabelDraft draft = draft_of(state);
  auto next = std::make_shared<ReviewQueue>(*queue);
  int decided = 0, left = 0;
  for (labels::Disagreement& item : next->items) {
    if (!is_sliver(item)) continue;
    expect_unchanged(state, item);
    try {
      decide_on_item(state, draft, item, decision);
      ++decided;
    } catch (const Error&) {  // locked or hidden
      ++left;
    }
  }
  const std::string title =
      fmt::format("Review: {} {}{}", counted(std::size_t(decided), "sliver"), past_tense(decision),
                  left > 0 ? fmt::format(", {} left", left) : "");
  if (decided == 0) throw Error("all slivers belong to planes that are locked or hidden");
  commit_decisions(state, title, draft, next, decision);
  if (decision == ReviewDecision::keep || next->undecided() == 0) return go_on(state, 0);
  choose_item(state, 0);
}

std::vector<Decided> decided_items(const FrameLabels& labels, const ReviewQueue& queue) {
  std::vector<Decided> all;
  for (auto note = labels.review.rbegin(); note != labels.review.rend(); ++note) {
    const auto item = std::ranges::find_if(
        queue.items, [&](const labels::Disagreement& one) { return one.note == *note; });
    all.push_back(
        {*note, item == queue.items.end() ? -1 : static_cast<int>(item - queue.items.begin())});
  }
  return all;
}

const char* to_string(DisagreementKind kind) {
  constexpr std::array kNames{"missed", "invented", "split", "merged", "class", "boundary"};
  return kNames[static_cast<std::size_t>(kind)];
}

const char* past_tense(ReviewDecision decision) {
  constexpr std::array kNames{"kept", "taken", "to edit", "ignored"};
  return kNames[static_cast<std::size_t>(decision)];
}

// ---- Actions -----------------------------------------------------------------------------------

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

void start_review(State& state) {
  state.view.label.tab = "review";
  const ReviewQueue* queue = state.results.label.review.get();
  if (queue && state.view.label.review_item < 0 && queue->undecided() > 0) choose_item(state, 0);
}

void step_item(State& state, int by) {
  const int count = item_count(state), now = state.view.label.review_item;
  choose_item(state, now < 0 ? (by > 0 ? 0 : count - 1) : std::clamp(now + by, 0, count - 1));
}

/// Without an `index`, decides on the chosen item.
void decide_on(State& state, ReviewDecision decision, const std::optional<int>& index) {
  if (index) state.view.label.review_item = *index;
  decide(state, decision);
}

void edit_item(State& state, const std::optional<int>& index) {
  decide_on(state, ReviewDecision::edit, index);
  LabelView& view = state.view.label;
  const labels::Disagreement& item =
      state.results.label.review->items[static_cast<std::size_t>(view.review_item)];
  view.tool = LabelTool::brush;
  view.paints = Paints::plane;
  view.plane = item.label_plane;
}

void treat_slivers(State& state, SliverAction what) {
  if (what == SliverAction::keep) return decide_slivers(state, ReviewDecision::keep);
  if (what == SliverAction::take) return decide_slivers(state, ReviewDecision::take);
  if (what == SliverAction::ignore) return decide_slivers(state, ReviewDecision::ignore);
  LabelView& view = state.view.label;
  view.review_slivers = !view.review_slivers;
  const ReviewQueue* queue = state.results.label.review.get();
  const bool inside = queue && view.review_item >= 0 && view.review_item < item_count(state) &&
                      is_sliver(queue->items[static_cast<std::size_t>(view.review_item)]);
  if (!view.review_slivers && inside) view.review_item = -1;
}

SliverAction read_sliver_action(const State&, const std::string&, const std::string& text) {
  const std::vector<std::string> names = {"show", "keep", "take", "ignore"};
  const auto at = std::ranges::find(names, text);
  if (at != names.end()) return static_cast<SliverAction>(at - names.begin());
  throw Error(fmt::format(
      "action review.slivers: unknown value '{}'; expected show, keep, take, or ignore", text));
}

void finish_review(State& state) {
  const LabelWork work = label_work(state);
  labels::LabelDraft draft = draft_of(state);
  const bool reviewed = work.labels->review_state == "reviewed";
  const ReviewQueue* queue = state.results.label.review.get();
  if (!reviewed && (!queue || queue->labels != work.labels))
    throw Error("differences have not been computed; press D to open the review");
  if (!reviewed && queue->undecided() > 0)
    throw Error(fmt::format("{} of {} regions are undecided", queue->undecided(),
                            queue->undecided() + work.labels->review.size()));
  draft.labels.review_state = reviewed ? "unreviewed" : "reviewed";
  commit_and_say(state, reviewed ? "Not reviewed" : "Reviewed", draft);
}

void compare_with(State& state, const std::string& folder) {
  const LabelWork work = label_work(state);
  if (!folder.empty()) {  // reject an unusable folder immediately
    const auto other = labels::read_frame_labels(folder, work.frame.frame, work.frame.sha256);
    if (!other) throw Error(fmt::format("{}: no labels for frame {}", folder, work.frame.frame));
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

}  // namespace

void add_review_actions(std::vector<Action>& all) {
  const ActionGroup review{all, KeyMode::labels, "Review", can_label};
  const auto has_items = [](const State& s) { return can_label(s) && item_count(s) > 0; };
  const Takes<int> item = whole("NUMBER", [](const State& s) {
    return Range{0, item_count(s) - 1};
  });
  review.add("review.start", "Review differences from the algorithm").key("D").run(start_review);
  review.add("review.next", "Next region").key("Down").when(has_items).run([](State& s) {
    step_item(s, 1);
  });
  review.add("review.previous", "Previous region").key("Up").when(has_items).run([](State& s) {
    step_item(s, -1);
  });
  const auto add_decision = [&](const char* name, const char* title, const char* key,
                                ReviewDecision decision) {
    review.add(name, title).key(key).run(maybe(item), [decision](State& s, const auto& index) {
      decide_on(s, decision, index);
    });
  };
  add_decision("review.keep", "Keep the labels", "", ReviewDecision::keep);
  add_decision("review.take", "Take the other side", "A", ReviewDecision::take);
  review.add("review.edit", "Edit the labels here").key("E").run(maybe(item), edit_item);
  add_decision("review.ignore", "Do not score the region", "G", ReviewDecision::ignore);
  review.add("review.item", "Select a region").run(item, choose_item);
  review.add("review.slivers", "Show or decide all slivers")
      .run(Takes<SliverAction>{"show|keep|take|ignore", read_sliver_action}, treat_slivers);
  review.add("review.smallest", "Smallest region in the review")
      .menu()
      .when(nullptr)
      .run(number("CM2"), [](State& s, double cm2) {
        if (!(cm2 >= 0 && cm2 <= kLargestRegion_cm2))
          throw Error(
              fmt::format("action review.smallest: {} cm2 is out of range; expected 0 to {:g}", cm2,
                          kLargestRegion_cm2));
        s.view.label.review_smallest_cm2 = cm2;
      });
  review.add("review.against", "Compare with another annotator's labels")
      .run(text("[FOLDER]"), compare_with);
  review.add("review.done", "Mark the frame as reviewed")
      .key("Shift+D")
      .on([](const State& s) { return can_label(s) && s.labels()->review_state == "reviewed"; })
      .run(finish_review);
  review.add("check.next", "Next problem").key("F4").run([](State& s) { step_finding(s, 1); });
  review.add("check.previous", "Previous problem").key("Shift+F4").run([](State& s) {
    step_finding(s, -1);
  });
  review.add("check.show", "Show a problem")
      .run(whole("NUMBER",
                 [](const State& s) {
                   return Range{0, finding_count(s) - 1};
                 }),
           show_finding);
}

}  // namespace planescope::desktop
