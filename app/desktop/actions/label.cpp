// Actions of label mode: entering and leaving, history, saving, and settings of the current tool.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/work.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

labels::LabelStore* store_of(const State& state) {
  const OpenRecording* open = state.document.current();
  return open ? open->labels.get() : nullptr;
}

void enter(State& state) {
  open_labels(state);
  state.view.mode = Mode::labels;
  if (measures(state.view.click)) state.view.click = Click::selects;
  unflash(state);
  state.view.playing.direction = 0;
}

/// Undoes or redoes one step on its own frame; steps on several frames work from any frame.
void travel(State& state, bool back) {
  labels::LabelStore& store = *store_of(state);
  const std::vector<int> frames = back ? store.undo_frames() : store.redo_frames();
  if (frames.empty()) return say_nothing_done(state, back ? "nothing to undo" : "nothing to redo");
  if (frames.size() == 1 && frames.front() != state.document.frame) {
    show_frame(state, frames.front());
    return say(state, fmt::format("this step belongs to frame {}; press again to {} it",
                                  frames.front(), back ? "undo" : "redo"));
  }
  if (!labels_at_hand(state)) return;
  for (const int frame : frames)
    if (!labels_at(*state.document.current(), frame))
      throw Error(fmt::format("frame {}: cannot open its labels", frame));
  let_go(state.view.label);
  const std::string title = back ? store.history(1).front().title : "";
  back ? store.undo() : store.redo();
  const std::string on =
      frames.size() > 1 ? fmt::format(", on {}", counted(frames.size(), "frame")) : "";
  say(state, (back ? "undone: " + title : "redone: " + store.history(1).front().title) + on);
}

void save(State& state) {
  const labels::LabelStore& store = *store_of(state);
  if (!store.read_only().empty()) throw Error(store.read_only());
  if (!store.any_unsaved()) return say(state, "labels are already saved");
  say(state, "labels written to " + state.document.current()->label_dir.string());
  save_labels(state);
}

// ---- Current tool ------------------------------------------------------------------------------

constexpr double kLeastBrush_px = 1, kLargestBrush_px = 200;

void take_tool(State& state, LabelTool tool) {
  if (state.view.label.tool == tool) return;
  let_go(state.view.label);
  state.view.label.tool = tool;
}

void choose_plane(State& state, int plane) {
  state.view.label.plane = plane;
  state.view.label.paints = Paints::plane;
}

/// Steps through planes in order of ids, wrapping around.
void step_plane(State& state, int by) {
  const std::vector<LabelPlane>& planes = state.labels()->planes;
  if (planes.empty())
    return say_hint(state, "there is no plane yet", [](const State& s) {
      const auto labels = s.labels();
      return labels && !labels->planes.empty();
    });
  const int count = static_cast<int>(planes.size());
  const auto at = std::ranges::lower_bound(planes, state.view.label.plane, {}, &LabelPlane::id);
  int index = static_cast<int>(at - planes.begin());
  const bool on_one = at != planes.end() && at->id == state.view.label.plane;
  if (by > 0)
    index = on_one ? index + 1 : index;
  else
    index -= 1;
  choose_plane(state, planes[static_cast<std::size_t>((index + count) % count)].id);
}

/// Choosing the same effect twice returns to painting planes.
void paint(State& state, Paints what) {
  LabelView& view = state.view.label;
  view.paints = view.paints == what ? Paints::plane : what;
}

void set_brush(State& state, double radius_px) {
  state.view.label.brush_px = std::clamp(radius_px, kLeastBrush_px, kLargestBrush_px);
}

/// Resizes the brush, or changes the wand's tolerance.
void resize(State& state, double factor) {
  const LabelView& view = state.view.label;
  if (view.tool == LabelTool::wand)
    return set_wand_tolerance(state, view.wand_options.tolerance_m * factor);
  const double wanted = view.brush_px * factor;
  set_brush(state,
            factor > 1 ? std::max(wanted, view.brush_px + 1) : std::min(wanted, view.brush_px - 1));
}

void hover(State& state, const std::optional<LabelGesture>& at) {
  LabelView& view = state.view.label;
  view.hover_hidden = 0;
  view.hover = at ? pixel_of_gesture(state, "label.hover", *at) : -1;
  if (!at || at->where != DrawnIn::space || view.tool != LabelTool::brush) return;
  LabelGesture dab = *at;
  dab.radius_px = static_cast<float>(view.brush_px);
  view.hover_hidden = selected_by(state, dab).hidden;
}

void pick_label(State& state) {
  const std::int64_t pixel = state.view.label.hover;
  const int plane = pixel < 0 ? 0 : state.labels()->plane.data[static_cast<std::size_t>(pixel)];
  if (plane == 0) return say(state, "no label under the mouse");
  if (plane == kPlaneIgnore) {
    state.view.label.paints = Paints::ignore;
    return say(state, "painting \"do not score\"");
  }
  choose_plane(state, plane);
  say(state, fmt::format("P{}", plane));
}

}  // namespace

void leave_label_mode(State& state) {
  save_labels_if_possible(state);
  let_go(state.view.label);
  state.results.label.carry = {};
  state.results.label.spread = {};
  state.view.mode = Mode::debugger;
  if (state.document.labels_written) ++state.document.labels_version;
  state.document.labels_written = false;
}

void let_go(LabelView& view) {
  view.wand = {};
  view.bound = nullptr;
  view.finish.reset();
  view.stroke.reset();
  view.polygon.reset();
}

void commit_labels(State& state, const labels::LabelEdit& edit) {
  labels::LabelStore* store = store_of(state);
  if (!store || !state.labels()) throw Error("the frame is not ready yet");
  if (!store->read_only().empty()) throw Error(store->read_only());
  state.view.label.finish.reset();  // belongs to the previous labels
  store->commit(edit);
}

labels::LabelEdit commit_labels(State& state, const std::string& title, labels::LabelDraft& draft) {
  labels::fit_planes(draft, state.label_frame()->grid);
  labels::LabelEdit edit = draft.edit(state.document.frame, title);
  commit_labels(state, edit);
  return edit;
}

void open_labels(State& state) {
  OpenRecording& open = *state.document.current();
  state.document.check_output(open.label_dir);
  if (!open.labels) open.labels = std::make_shared<labels::LabelStore>(open.label_dir);
  const labels::LabelStore& store = *open.labels;
  state.results.label.save_problem.clear();  // it belongs to another recording
  if (!store.notices().empty())
    say(state, store.notices().front(), true);
  else if (!store.read_only().empty())
    say(state, store.read_only(), true);
  else
    say(state, fmt::format("labels from {}", open.label_dir.string()));
}

void save_labels(State& state) {
  labels::LabelStore* store = store_of(state);
  if (!store || !store->read_only().empty() || !store->any_unsaved()) return;
  std::string& problem = state.results.label.save_problem;
  const std::size_t shown = store->notices().size();
  try {
    store->save_all();
    if (store->notices().size() > shown) {
      state.view.label.finish.reset();  // external files may have been adopted
      say(state, store->notices().back(), true);
    }
    problem.clear();
    state.document.labels_written = true;
  } catch (const std::exception& error) {
    problem = error.what();
    throw Error("labels were not saved (they are still in the journal): " + problem);
  }
}

void save_labels_if_possible(State& state) {
  try {
    save_labels(state);
  } catch (const Error& error) {
    say(state, error.what(), true);
  }
}

void add_label_mode_actions(std::vector<Action>& all) {
  const ActionGroup mode{all, KeyMode::labels, "Labels"};
  const auto has_store = [](const State& s) { return store_of(s) != nullptr; };
  mode.add("label.mode", "Label this recording")
      .key("Ctrl+L")
      .in(KeyMode::anywhere)
      .when([](const State& s) { return s.document.current() != nullptr; })
      .on([](const State& s) { return s.view.mode == Mode::labels; })
      .run([](State& s) { s.view.mode == Mode::labels ? leave_label_mode(s) : enter(s); });
  mode.add("label.undo", "Undo")
      .key("Ctrl+Z")
      .words("undo revert back")
      .when([](const State& s) { return store_of(s) && store_of(s)->undo_count() > 0; })
      .run([](State& s) { travel(s, true); });
  mode.add("label.redo", "Redo")
      .key("Ctrl+Shift+Z Ctrl+Y")
      .words("redo again")
      .when([](const State& s) { return store_of(s) && store_of(s)->redo_count() > 0; })
      .run([](State& s) { travel(s, false); });
  mode.add("label.save", "Save the labels").key("Ctrl+S").when(has_store).run(save);
  mode.add("label.annotator", "Annotator")
      .key("Ctrl+Shift+A")
      .when(has_store)
      .run(text("NAME"), [](State& s, const std::string& name) {
        store_of(s)->set_annotator(name);
        say(s, "annotator: " + name);
      });
}

void add_label_tool_actions(std::vector<Action>& all) {
  const ActionGroup tools{all, KeyMode::labels, "Tools"};
  const ActionGroup planes{all, KeyMode::labels, "Planes"};
  const auto add_tool = [&](const char* name, const char* title, const char* key, LabelTool tool) {
    tools.add(name, title)
        .key(key)
        .on([tool](const State& s) { return s.view.label.tool == tool; })
        .run([tool](State& s) { take_tool(s, tool); });
  };
  add_tool("label.tool.wand", "Plane wand", "W", LabelTool::wand);
  add_tool("label.tool.brush", "Brush", "B", LabelTool::brush);
  add_tool("label.tool.rectangle", "Rectangle", "R", LabelTool::rectangle);
  add_tool("label.tool.lasso", "Lasso", "L", LabelTool::lasso);
  add_tool("label.tool.polygon", "Polygon", "Shift+L", LabelTool::polygon);
  add_tool("label.tool.cut", "Cut the active plane", "Shift+S", LabelTool::cut);
  tools.add("label.tool", "Choose a tool")
      .run(choice<LabelTool>("wand|brush|rectangle|lasso|polygon|cut"), take_tool);
  tools.add("label.through", "Include hidden points").key("X").flips([](auto& view) -> auto& {
    return view.label.through;
  });
  tools.add("label.brush", "Brush size").run(number("RADIUS in pixels"), set_brush);
  tools.add("label.smaller", "Smaller brush or tolerance").key("[").run([](State& s) {
    resize(s, 1 / 1.25);
  });
  tools.add("label.larger", "Larger brush or tolerance").key("]").run([](State& s) {
    resize(s, 1.25);
  });
  tools.add("label.classes", "Color by horizontal and vertical").key("C").flips([
  ](auto& view) -> auto& { return view.label.show_class; });
  planes.add("label.plane", "Choose a plane")
      .key("1 2 3 4 5 6 7 8 9")
      .key_is_argument()
      .run(plane_number("PLANE", 0), choose_plane);
  planes.add("label.plane.new", "New plane")
      .key("N")
      .on([](const State& s) {
        return s.view.label.plane == 0 && s.view.label.paints == Paints::plane;
      })
      .run([](State& s) { choose_plane(s, 0); });
  planes.add("label.plane.next", "Next plane").key("Tab").when(labels_at_hand).run([](State& s) {
    step_plane(s, 1);
  });
  planes.add("label.plane.previous", "Previous plane")
      .key("Shift+Tab")
      .when(labels_at_hand)
      .run([](State& s) { step_plane(s, -1); });
  planes.add("label.pick", "Choose the label under the mouse")
      .key("P")
      .when(labels_at_hand)
      .run(pick_label);
  const auto add_paint = [&](const char* name, const char* title, const char* key, Paints what) {
    planes.add(name, title)
        .key(key)
        .on([what](const State& s) { return s.view.label.paints == what; })
        .run([what](State& s) { paint(s, what); });
  };
  add_paint("label.ignore", "Paint \"do not score\"", "I", Paints::ignore);
  add_paint("label.erase", "Erase", "0", Paints::erase);
  planes.add("label.class_only", "Paint a class without a plane")
      .menu()
      .run(one_of("h|v"), [](State& s, const std::string& label) {
        paint(s, label == "h" ? Paints::h_only : Paints::v_only);
      });
  tools.add("label.hover", "Hover over a pixel")
      .when(labels_at_hand)
      .run(or_none(place_in_view("U,V or space:WxH X,Y or none")), hover);
}

}  // namespace planescope::desktop
