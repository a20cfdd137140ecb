// The planes of the label mode: the active one's class, locks, joins and splits, first labels from
// the algorithm, labels for the next frame.

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/work.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/review/carry.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

std::string name_of(int plane) { return fmt::format("P{}", plane); }

/// Of the active plane; where there is none, of what is painted next.
void set_class(State& state, const std::string& text, Label label) {
  const char* name = to_string(label);
  LabelView& view = state.view.label;
  const LabelWork work = label_work(state);
  if (text.empty() && !labels::find_plane(*work.labels, view.plane)) {
    const Paints wanted = label == Label::h ? Paints::h_only : Paints::v_only;
    view.paints = view.paints == wanted ? Paints::plane : wanted;
    return say(state, view.paints == wanted ? fmt::format("strokes mark {}, without a plane", name)
                                            : "strokes mark planes");
  }
  const int plane = plane_argument(state, "label.class", text);
  commit_and_say(state, fmt::format("Make {} {}", name_of(plane), name),
                 labels::with_class(*work.labels, plane, label),
                 fmt::format("{} is {} already", name_of(plane), name));
}

void join(State& state, const std::string& text) {
  const LabelWork work = label_work(state);
  const int into = plane_argument(state, "label.join", "");
  int from = 0;
  if (!text.empty())
    from = plane_argument(state, "label.join", text);
  else if (state.view.label.hover >= 0)
    from = work.labels->plane.data[static_cast<std::size_t>(state.view.label.hover)];
  if (!labels::find_plane(*work.labels, from))
    throw Error(fmt::format("no plane under the mouse to join into {}", name_of(into)));
  if (from == into) throw Error(fmt::format("{} itself is under the mouse", name_of(into)));
  commit_and_say(state, fmt::format("Join {} into {}", name_of(from), name_of(into)),
                 labels::joined(*work.labels, work.frame.grid, into, from), "");
}

void split(State& state, const std::string& text) {
  const LabelWork work = label_work(state);
  const int plane = plane_argument(state, "label.split", text);
  const FrameLabels after = labels::split_by_parts(*work.labels, work.frame.grid, plane,
                                                   labels::AuditOptions{}.min_area_m2);
  const std::size_t parts = 1 + after.planes.size() - work.labels->planes.size();
  commit_and_say(state, fmt::format("Split {} into its {} parts", name_of(plane), parts), after,
                 fmt::format("{} has one part; Shift+S cuts it along a line", name_of(plane)));
}

void toggle(State& state, const std::string& text, labels::PlaneFlag flag) {
  const LabelWork work = label_work(state);
  const int id =
      plane_argument(state, flag == labels::PlaneFlag::locked ? "label.lock" : "label.hide", text);
  const LabelPlane& plane = *labels::find_plane(*work.labels, id);
  const bool on = flag == labels::PlaneFlag::locked ? !plane.locked : !plane.hidden;
  const char* verb =
      flag == labels::PlaneFlag::locked ? (on ? "Lock" : "Unlock") : (on ? "Hide" : "Show");
  commit_and_say(state, fmt::format("{} {}", verb, name_of(id)),
                 labels::with_flag(*work.labels, id, flag, on), "");
}

void show_all(State& state) {
  FrameLabels after = *label_work(state).labels;
  for (LabelPlane& plane : after.planes) plane.hidden = false;
  commit_and_say(state, "Show all planes", after, "no plane is hidden");
}

void remove(State& state, const std::string& text) {
  const LabelWork work = label_work(state);
  const int plane = plane_argument(state, "label.remove", text);
  commit_and_say(state, fmt::format("Remove {}", name_of(plane)),
                 labels::without_plane(*work.labels, plane), "");
  if (state.view.label.plane == plane) state.view.label.plane = 0;
}

void look(State& state, const std::string& text) {
  const LabelWork work = label_work(state);
  const int plane = plane_argument(state, "label.look", text);
  state.view.label.plane = plane;
  look_at_pixels(state, labels::pixels_of_plane(*work.labels, plane));
}

/// The run of the frame looked at; null while it is made.
const debug::Run* run_of_frame(const State& state) {
  const debug::Run* run = state.run();
  return run && run->subject->frame.index == state.document.frame ? run : nullptr;
}

/// How much of the frame the algorithm was not shown: labels there have to be drawn.
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
  commit_and_say(state, title,
                 labels::from_segmentation(*work.labels, work.frame.grid, found.plane, found.label),
                 "the labels already equal the algorithm's result" + beyond);
  if (!beyond.empty() && state.labels() != work.labels) say(state, title + beyond);
  state.view.label.wand = {};
}

/// "[FRAMES] [doubt [SHARE]]": one frame, or so many, or until a plane is less sure than the share.
CarryJob carry_argument(const std::string& text) {
  constexpr int kMostFrames = 1'000'000;
  CarryJob plan;
  const std::vector<std::string> words = words_of(text);
  std::size_t next = 0;
  const auto is_number = [&] {
    return next < words.size() && std::isdigit(static_cast<unsigned char>(words[next][0]));
  };
  int frames = 1;
  const bool counts = is_number();
  if (counts) frames = whole_argument("label.carry", words[next++], 1, kMostFrames);
  if (next < words.size() && words[next] == "doubt") {
    ++next;
    if (!counts) frames = kMostFrames;
    plan.least_share = is_number() ? number_argument("label.carry", words[next++]) : labels::kSure;
    if (!(plan.least_share > 0 && plan.least_share <= 1))
      throw Error(
          fmt::format("action label.carry: a share of {}, expected 0 to 1", plan.least_share));
  }
  if (next < words.size())
    throw Error(fmt::format("action label.carry: '{}', expected [FRAMES] [doubt [SHARE]]", text));
  plan.left = frames - 1;
  return plan;
}

void show_next(State& state, const char* what, bool (*is_wanted)(const FrameMark&)) {
  const int frame = state.document.frame;
  const int frames = state.document.current()->recording->frame_count();
  for (int step = 1; step < frames; ++step) {  // on from here, and round the end
    const int next = (frame + step) % frames;
    if (is_wanted(frame_mark(state, next)))
      return apply(state, {"frame.show", std::to_string(next)});
  }
  say_nothing_done(state, fmt::format("no other frame is {}", what));
}

/// Of the frames that labels were proposed in and nobody has reviewed yet.
void show_next_doubtful(State& state) {
  for (const auto& [frame, share] : state.results.label.spread.doubtful)
    if (frame != state.document.frame && !frame_mark(state, frame).reviewed)
      return apply(state, {"frame.show", std::to_string(frame)});
  say_nothing_done(state, "no other frame has proposed labels to review");
}

Action next_frame(const char* name,
                  const char* title,
                  const char* key,
                  const char* what,
                  bool (*is_wanted)(const FrameMark&)) {
  return {name,      title, "Labels",
          key,       "",    [=](State& s, const std::string&) { show_next(s, what, is_wanted); },
          can_label, {}};
}

/// Of the active plane, or of the one that the argument names.
Action on_plane(const std::string& name,
                const std::string& title,
                const std::string& key,
                std::function<void(State&, const std::string&)> run) {
  return {name, title, "Planes", key, "[PLANE]", std::move(run), can_label, {}};
}

Action on_frame(const std::string& name,
                const std::string& title,
                const std::string& key,
                void (*run)(State&)) {
  return {name,      title, "Planes", key, "", [run](State& s, const std::string&) { run(s); },
          can_label, {}};
}

}  // namespace

std::vector<Action> label_plane_actions() {
  const auto class_action = [](const char* name, const char* title, const char* key, Label label) {
    return on_plane(name, title, key,
                    [label](State& s, const std::string& text) { set_class(s, text, label); });
  };
  const auto flag_action = [](const char* name, const char* title, const char* key,
                              labels::PlaneFlag flag) {
    return on_plane(name, title, key,
                    [flag](State& s, const std::string& text) { toggle(s, text, flag); });
  };
  return {
      on_frame("label.take", "Start from the algorithm", "T", take),
      {"label.carry",
       "Carry labels to the next frame",
       "Planes",
       ".",
       "[FRAMES] [doubt [SHARE]]",
       [](State& s, const std::string& text) { begin_carry(s, carry_argument(text)); },
       can_label,
       {}},
      {"label.carry.doubt",
       "Carry labels on until one is doubtful",
       "Planes",
       "Ctrl+.",
       "",
       [](State& s, const std::string&) { begin_carry(s, carry_argument("doubt")); },
       can_label,
       {}},
      on_frame("label.spread", "Propose labels in all frames that see their planes", "Ctrl+Shift+.",
               begin_spread),
      on_frame("label.spread.track", "Propose the selected track in all frames that see it",
               "Alt+T", begin_spread_of_track),
      on_frame("label.spread.next", "Next proposed frame, most doubtful first", "Alt+U",
               show_next_doubtful),
      next_frame("label.next.unlabelled", "Next frame without labels", "U", "without labels",
                 [](const FrameMark& mark) { return !mark.labelled; }),
      next_frame("label.next.unreviewed", "Next labeled frame that is not reviewed", "Y",
                 "labeled and not reviewed",
                 [](const FrameMark& mark) { return mark.labelled && !mark.reviewed; }),
      class_action("label.class.h", "Horizontal", "H", Label::h),
      class_action("label.class.v", "Vertical", "V", Label::v),
      on_plane("label.join", "Join the plane under the mouse into the active one", "J", join),
      on_plane("label.split", "Split by connected parts", "S", split),
      flag_action("label.lock", "Lock or unlock", "K", labels::PlaneFlag::locked),
      flag_action("label.hide", "Hide or show", "O", labels::PlaneFlag::hidden),
      on_frame("label.show_all", "Show all planes", "Shift+O", show_all),
      on_plane("label.remove", "Remove the plane", "Delete", remove),
      on_plane("label.look", "Look at the plane", "F", look),
  };
}

}  // namespace planescope::desktop
