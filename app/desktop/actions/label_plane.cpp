// Actions on planes in label mode: class, locks, joins and splits of the active plane; cleanup
// gestures; initial labels from the algorithm; labels for other frames.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/work.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/labels/review/carry.hpp"
#include "core/labels/wand/wand.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

// ---- Cleanup: each gesture previews its change; Enter commits it as one undo step ---------------

/// `nothing` completes the message for a plane to which the gesture does not apply.
void show_finish(State& state,
                 int plane,
                 const std::string& title,
                 const std::string& nothing,
                 const labels::Finish& finish) {
  LabelView& view = state.view.label;
  let_go(view);
  view.plane = plane;
  view.paints = Paints::plane;
  labels::LabelDraft draft = draft_of(state);
  labels::finish_plane(draft, state.label_frame()->grid, plane, finish);
  labels::fit_planes(draft, state.label_frame()->grid);
  auto edit = std::make_shared<labels::LabelEdit>(draft.edit(state.document.frame, title));
  if (edit->empty()) return say_nothing_done(state, fmt::format("P{} {}", plane, nothing));
  const char* const sample = sample_name(*state.label_frame());
  std::string what;
  if (!finish.adds.empty()) what = counted(finish.adds.size(), sample) + " more";
  if (!finish.takes.empty())
    what += (what.empty() ? "" : ", ") + counted(finish.takes.size(), sample) + " less";
  say_hint(state, fmt::format("{}: {}; Enter accepts, Esc cancels", title, what),
           [](const State& s) { return !s.view.label.finish; });
  view.finish = std::move(edit);
}

using Finishing = decltype(&labels::fill_holes);

void drop_specks(State& state, const std::optional<double>& typed_cm2) {
  const LabelWork work = label_work(state);
  const int plane = active_plane(state);
  const double least_cm2 = typed_cm2.value_or(1e4 * labels::AuditOptions{}.min_area_m2);
  if (!(least_cm2 > 0))
    throw Error(fmt::format("action label.specks: {} cm2 is not a valid speck size", least_cm2));
  show_finish(state, plane, fmt::format("Drop the specks of P{} below {:g} cm²", plane, least_cm2),
              fmt::format("has no specks below {:g} cm²", least_cm2),
              labels::drop_specks(*work.labels, work.frame.grid, plane, 1e-4 * least_cm2));
}

// ---- Active plane ------------------------------------------------------------------------------

/// Sets the class of the active plane, or of the next painted one if none is active.
void set_class(State& state, const std::optional<int>& chosen, Label label) {
  const char* name = to_string(label);
  LabelView& view = state.view.label;
  const LabelWork work = label_work(state);
  if (!chosen && !labels::find_plane(*work.labels, view.plane)) {
    const Paints wanted = label == Label::h ? Paints::h_only : Paints::v_only;
    view.paints = view.paints == wanted ? Paints::plane : wanted;
    return say(state, view.paints == wanted ? fmt::format("strokes mark {} without a plane", name)
                                            : "strokes mark planes");
  }
  const int plane = active_plane(state, chosen);
  labels::LabelDraft draft = draft_of(state);
  labels::set_class(draft, plane, label);
  commit_and_say(state, fmt::format("Make P{} {}", plane, name), draft,
                 fmt::format("P{} is {} already", plane, name));
}

void join(State& state, const std::optional<int>& chosen) {
  const LabelWork work = label_work(state);
  const int into = active_plane(state);
  int from = 0;
  if (chosen)
    from = active_plane(state, chosen);
  else if (state.view.label.hover >= 0)
    from = work.labels->plane.data[static_cast<std::size_t>(state.view.label.hover)];
  if (!labels::find_plane(*work.labels, from))
    throw Error(fmt::format("no plane under the mouse to join into P{}", into));
  if (from == into) throw Error(fmt::format("P{} itself is under the mouse", into));
  labels::LabelDraft draft = draft_of(state);
  labels::join_planes(draft, into, from);
  commit_and_say(state, fmt::format("Join P{} into P{}", from, into), draft);
}

void split_parts(State& state, const std::optional<int>& chosen) {
  const LabelWork work = label_work(state);
  const int plane = active_plane(state, chosen);
  labels::LabelDraft draft = draft_of(state);
  labels::split_by_parts(draft, work.frame.grid, plane, labels::AuditOptions{}.min_area_m2);
  const std::size_t parts = 1 + draft.labels.planes.size() - work.labels->planes.size();
  commit_and_say(state, fmt::format("Split P{} into its {} parts", plane, parts), draft,
                 fmt::format("P{} has one part; Shift+S cuts it along a line", plane));
}

void toggle(State& state, const std::optional<int>& chosen, labels::PlaneFlag flag) {
  const int id = active_plane(state, chosen);
  labels::LabelDraft draft = draft_of(state);
  const LabelPlane& plane = *labels::find_plane(draft.labels, id);
  const bool on = flag == labels::PlaneFlag::locked ? !plane.locked : !plane.hidden;
  const char* verb =
      flag == labels::PlaneFlag::locked ? (on ? "Lock" : "Unlock") : (on ? "Hide" : "Show");
  labels::set_flag(draft, id, flag, on);
  commit_and_say(state, fmt::format("{} P{}", verb, id), draft);
}

void show_all(State& state) {
  labels::LabelDraft draft = draft_of(state);
  for (LabelPlane& plane : draft.labels.planes) plane.hidden = false;
  commit_and_say(state, "Show all planes", draft, "no plane is hidden");
}

void remove_plane(State& state, const std::optional<int>& chosen) {
  const int plane = active_plane(state, chosen);
  labels::LabelDraft draft = draft_of(state);
  labels::remove_plane(draft, plane);
  commit_and_say(state, fmt::format("Remove P{}", plane), draft);
  if (state.view.label.plane == plane) state.view.label.plane = 0;
}

void look(State& state, const std::optional<int>& chosen) {
  const LabelWork work = label_work(state);
  const int plane = active_plane(state, chosen);
  state.view.label.plane = plane;
  look_at_pixels(state, labels::pixels_of_plane(*work.labels, plane));
}

/// The run of the current frame; null while it is being made.
const debug::Run* run_of_frame(const State& state) {
  const debug::Run* run = state.run();
  return run && run->subject->frame.index == state.document.frame ? run : nullptr;
}

/// The share of the frame outside the algorithm's range, where labels must be drawn manually.
std::string beyond_text(const debug::Run& run, const labels::LabelGrid& grid) {
  if (grid.is_cloud()) return "";
  const double range_m = run.options.cloud.max_range_m;
  std::size_t beyond = 0;
  for (std::size_t i = 0; i < grid.pixels(); ++i)
    if (grid.points[i].z() > range_m && run.subject->voxel_of_source(i) == planes::kNoVoxel)
      ++beyond;
  const double share = static_cast<double>(beyond) /
                       static_cast<double>(std::max<std::size_t>(grid.measured_count, 1));
  if (share < 0.05) return "";
  return fmt::format(": {:.0f} % of the pixels are beyond --max-range {:g} m", 100 * share,
                     range_m);
}

void take(State& state) {
  const LabelWork work = label_work(state);
  const debug::Run* run = run_of_frame(state);
  if (!run) throw Error("the algorithm has not run on this frame yet");
  const labels::OtherLabels found = labels_of_run(*run, work.frame.grid);
  const char* name = run->is_ours() ? planes::to_string(run->segment_options.profile)
                                    : planes::to_string(run->options.method);
  const std::string title = fmt::format("Start from the algorithm ({})", name);
  const std::string beyond = beyond_text(*run, work.frame.grid);
  labels::LabelDraft draft = draft_of(state);
  labels::take_segmentation(draft, work.frame.grid, found.plane, found.label);
  commit_and_say(state, title, draft, "the labels already equal the algorithm's result" + beyond);
  if (!beyond.empty() && state.labels() != work.labels) say(state, title + beyond);
  state.view.label.wand = {};
}

/// "[FRAMES] [doubt [SHARE]]": one frame, this many, or until a plane's confidence is below SHARE.
CarryJob read_carry(const State&, const std::string& action, const std::string& text) {
  constexpr int kMostFrames = 1'000'000;
  CarryJob plan;
  const std::vector<std::string> words = words_of(text);
  std::size_t next = 0;
  const auto is_number = [&] {
    return next < words.size() && std::isdigit(static_cast<unsigned char>(words[next][0]));
  };
  int frames = 1;
  const bool counts = is_number();
  if (counts) frames = whole_argument(action, words[next++], 1, kMostFrames);
  if (next < words.size() && words[next] == "doubt") {
    ++next;
    if (!counts) frames = kMostFrames;
    plan.least_share = is_number() ? number_argument(action, words[next++]) : labels::kSure;
    if (!(plan.least_share > 0 && plan.least_share <= 1))
      throw Error(fmt::format(
          "action label.carry: share {} is out of range; expected more than 0 and at most 1",
          plan.least_share));
  }
  if (next < words.size())
    throw Error(fmt::format(
        "action label.carry: invalid argument '{}'; expected [FRAMES] [doubt [SHARE]]", text));
  plan.left = frames - 1;
  return plan;
}

void show_next(State& state, const char* what, bool (*is_wanted)(const FrameMark&)) {
  const int frame = state.document.frame;
  const int frames = state.document.current()->recording->frame_count();
  for (int step = 1; step < frames; ++step) {  // forward from here, wrapping around
    const int next = (frame + step) % frames;
    if (is_wanted(frame_mark(state, next))) return show_frame(state, next);
  }
  say_nothing_done(state, fmt::format("no other frame is {}", what));
}

/// Shows the next frame with proposed labels that are not reviewed.
void show_next_doubtful(State& state) {
  for (const auto& [frame, share] : state.results.label.spread.doubtful)
    if (frame != state.document.frame && !frame_mark(state, frame).reviewed)
      return show_frame(state, frame);
  say_nothing_done(state, "no other frame has proposed labels to review");
}

// ---- A plane on all frames that it was carried over: one undo step per frame -------------------

bool is_carried(const FrameLabels& labels, int plane) {
  const LabelPlane* found = labels::find_plane(labels, plane);
  return found && found->origin == LabelOrigin::carried;
}

/// Frames that the plane was carried over, including this one, ascending: backwards while it came
/// from the previous frame, forwards while it continued to the next one.
std::vector<int> chain_of(const OpenRecording& open, int frame, int plane) {
  std::vector<int> chain{frame};
  for (int at = frame; at > 0; --at) {
    const auto here = labels_at(open, at), before = labels_at(open, at - 1);
    if (!here || !before || !is_carried(*here, plane) || !labels::find_plane(*before, plane)) break;
    chain.insert(chain.begin(), at - 1);
  }
  for (int at = frame + 1; at < open.recording->frame_count(); ++at) {
    const auto there = labels_at(open, at);
    if (!there || !is_carried(*there, plane)) break;
    chain.push_back(at);
  }
  return chain;
}

using ChangePlane = void (*)(labels::LabelDraft&, int);

/// Skips and counts locked planes. Changes the current frame last, so that undo starts there.
void change_chain(State& state,
                  const std::string& verb,
                  const std::string& what,
                  ChangePlane change) {
  const LabelWork work = label_work(state);
  const int plane = active_plane(state);
  const OpenRecording& open = *state.document.current();
  if (!open.labels->read_only().empty()) throw Error(open.labels->read_only());
  std::vector<int> chain = chain_of(open, state.document.frame, plane);
  std::erase(chain, state.document.frame);
  chain.push_back(state.document.frame);
  std::size_t changed = 0, locked = 0;
  for (const int frame : chain) {
    const auto labels = labels_at(open, frame);
    if (labels::find_plane(*labels, plane)->locked) {
      ++locked;
      continue;
    }
    labels::LabelDraft draft(*labels);
    change(draft, plane);
    const labels::LabelEdit edit =
        draft.edit(frame, fmt::format("{} P{}{}, carried", verb, plane, what));
    if (edit.empty()) continue;
    open.labels->commit(edit);
    ++changed;
  }
  let_go(state.view.label);
  const std::string left = locked > 0 ? fmt::format(" ({} locked)", locked) : "";
  if (changed == 0)
    return say_nothing_done(state,
                            fmt::format("P{}: nothing to change in its chain{}", plane, left));
  say(state, fmt::format("{} P{}{} on {}{}; undo reverts one frame at a time", verb, plane, what,
                         counted(changed, "frame"), left));
}

}  // namespace

void add_label_plane_actions(std::vector<Action>& all) {
  const ActionGroup planes{all, KeyMode::labels, "Planes", can_label};
  const ActionGroup frames{all, KeyMode::labels, "Labels", can_label};
  const Takes<std::optional<int>> plane = maybe(plane_number("PLANE", 1));

  const auto add_finish = [&](const char* name, const char* title, const char* key,
                              const char* verb, const char* nothing, Finishing finish) {
    planes.add(name, title).key(key).run(plane, [=](State& s, const std::optional<int>& chosen) {
      const LabelWork work = label_work(s);
      const int id = active_plane(s, chosen);
      // Uses the wand's tolerance but not its lasso.
      show_finish(s, id, fmt::format("{} P{}", verb, id), nothing,
                  finish(*work.labels, work.frame.grid, id, s.view.label.wand_options));
    });
  };
  add_finish("label.fill", "Fill the holes", "Shift+H", "Fill the holes of", "has no holes to fill",
             labels::fill_holes);
  add_finish("label.smooth", "Smooth the border", "Shift+E", "Smooth the border of",
             "already has a smooth border", labels::smooth_border);
  add_finish("label.grow", "Grow to the border of the surface", "Shift+R", "Grow",
             "already reaches the border of its surface", labels::grow_to_border);
  planes.add("label.specks", "Drop specks").key("Shift+C").run(maybe(number("CM2")), drop_specks);
  planes.add("label.residual", "Distance to the active plane")
      .key("Shift+V")
      .menu("Tools")
      .when(nullptr)
      .flips([](auto& view) -> auto& { return view.label.show_residual; });

  planes.add("label.take", "Start from the algorithm").key("T").run(take);
  planes.add("label.carry", "Carry labels to the next frame")
      .key(".")
      .run(Takes<CarryJob>{"[FRAMES] [doubt [SHARE]]", read_carry}, begin_carry);
  planes.add("label.carry.doubt", "Carry labels on until one is doubtful")
      .key("Ctrl+.")
      .run([](State& s) { begin_carry(s, read_carry(s, "label.carry.doubt", "doubt")); });
  planes.add("label.spread", "Propose labels in all frames that see their planes")
      .key("Ctrl+Shift+.")
      .run(begin_spread);
  planes.add("label.spread.track", "Propose the selected track in all frames that see it")
      .key("Alt+T")
      .run(begin_spread_of_track);
  planes.add("label.spread.next", "Next proposed frame, most doubtful first")
      .key("Alt+U")
      .run(show_next_doubtful);
  frames.add("label.next.unlabelled", "Next frame without labels").key("U").run([](State& s) {
    show_next(s, "without labels", [](const FrameMark& mark) { return !mark.labeled; });
  });
  frames.add("label.next.unreviewed", "Next frame to review").key("Y").run([](State& s) {
    show_next(s, "labeled and not reviewed",
              [](const FrameMark& mark) { return mark.labeled && !mark.reviewed; });
  });

  const auto add_class = [&](const char* name, const char* title, const char* key, Label label) {
    planes.add(name, title).key(key).run(plane, [label](State& s, const auto& chosen) {
      set_class(s, chosen, label);
    });
  };
  const auto add_flag = [&](const char* name, const char* title, const char* key,
                            labels::PlaneFlag flag) {
    planes.add(name, title).key(key).run(plane, [flag](State& s, const auto& chosen) {
      toggle(s, chosen, flag);
    });
  };
  add_class("label.class.h", "Horizontal", "H", Label::h);
  add_class("label.class.v", "Vertical", "V", Label::v);
  planes.add("label.join", "Join the plane under the mouse into the active one")
      .key("J")
      .run(plane, join);
  planes.add("label.split", "Split by connected parts").key("S").run(plane, split_parts);
  add_flag("label.lock", "Lock or unlock", "K", labels::PlaneFlag::locked);
  add_flag("label.hide", "Hide or show", "O", labels::PlaneFlag::hidden);
  planes.add("label.show_all", "Show all planes").key("Shift+O").run(show_all);
  planes.add("label.remove", "Remove the plane").key("Delete").run(plane, remove_plane);
  planes.add("label.look", "Frame the plane").key("F").run(plane, look);

  const auto add_chain = [&](const char* name, const char* title, const char* key, const char* verb,
                             const char* what, ChangePlane change) {
    planes.add(name, title).key(key).run([=](State& s) { change_chain(s, verb, what, change); });
  };
  add_chain("label.chain.h", "Horizontal, on all frames it was carried over", "Ctrl+Shift+H",
            "Make", " h",
            [](labels::LabelDraft& draft, int id) { labels::set_class(draft, id, Label::h); });
  add_chain("label.chain.v", "Vertical, on all frames it was carried over", "Ctrl+Shift+V", "Make",
            " v",
            [](labels::LabelDraft& draft, int id) { labels::set_class(draft, id, Label::v); });
  add_chain("label.chain.remove", "Remove the plane from all frames it was carried over",
            "Ctrl+Delete", "Remove", "", labels::remove_plane);
}

}  // namespace planescope::desktop
