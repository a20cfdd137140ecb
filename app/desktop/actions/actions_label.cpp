// The label mode itself: in and out, history, saving.

#include <fmt/format.h>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/gesture.hpp"
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

void leave(State& state) {
  save_labels_if_possible(state);
  let_go(state.view.label);
  state.results.label.carry = {};
  state.results.label.spread = {};
  state.view.mode = Mode::debugger;
  if (state.document.labels_written) ++state.document.labels_version;
  state.document.labels_written = false;
}

/// One step of the history, on the frame where it was made; a step on several frames from anywhere.
void travel(State& state, bool back) {
  labels::LabelStore& store = *store_of(state);
  const std::vector<int> frames = back ? store.undo_frames() : store.redo_frames();
  if (frames.empty()) return say_nothing_done(state, back ? "nothing to undo" : "nothing to redo");
  if (frames.size() == 1 && frames.front() != state.document.frame) {
    apply(state, {"frame.show", std::to_string(frames.front())});
    return say(state, fmt::format("the step is on frame {}: press again to {} it", frames.front(),
                                  back ? "undo" : "redo"));
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

}  // namespace

void let_go(LabelView& view) {
  view.wand = {};
  view.bound = nullptr;
  view.finish.reset();
  view.stroke.reset();
  view.polygon.reset();
}

void commit_labels(State& state, const std::string& title, const FrameLabels& after) {
  labels::LabelStore* store = store_of(state);
  const std::shared_ptr<const FrameLabels> before = state.labels();
  if (!store || !before) throw Error("the frame is not ready yet");
  if (!store->read_only().empty()) throw Error(store->read_only());
  state.view.label.finish.reset();  // was of the labels before
  store->commit(labels::make_edit(state.document.frame, title, *before, after));
}

void open_labels(State& state) {
  OpenRecording& open = *state.document.current();
  if (!open.labels) open.labels = std::make_shared<labels::LabelStore>(open.label_dir);
  const labels::LabelStore& store = *open.labels;
  state.results.label.save_problem.clear();  // was another recording's
  if (!store.notices().empty())
    say(state, store.notices().front(), true);
  else if (!store.read_only().empty())
    say(state, store.read_only(), true);
  else
    say(state, fmt::format("labels of {}", open.label_dir.string()));
}

void save_labels(State& state) {
  labels::LabelStore* store = store_of(state);
  if (!store || !store->read_only().empty() || !store->any_unsaved()) return;
  std::string& problem = state.results.label.save_problem;
  const std::size_t told = store->notices().size();
  try {
    store->save_all();
    if (store->notices().size() > told) say(state, store->notices().back(), true);
    problem.clear();
    state.document.labels_written = true;
  } catch (const std::exception& error) {
    problem = error.what();
    throw Error("labels not saved (they are in the journal): " + problem);
  }
}

void save_labels_if_possible(State& state) {
  try {
    save_labels(state);
  } catch (const Error& error) {
    say(state, error.what(), true);
  }
}

std::vector<Action> label_mode_actions() {
  const std::string menu = "Labels";
  const auto can_undo = [](const State& s) { return store_of(s) && store_of(s)->undo_frame(); };
  const auto can_redo = [](const State& s) { return store_of(s) && store_of(s)->redo_frame(); };
  std::vector<Action> actions = {
      {"label.mode", "Label this recording", menu, "Ctrl+L", "",
       [](State& s, const std::string&) { s.view.mode == Mode::labels ? leave(s) : enter(s); },
       [](const State& s) { return s.document.current() != nullptr; },
       [](const State& s) { return s.view.mode == Mode::labels; }},
      {"label.undo",
       "Undo",
       menu,
       "Ctrl+Z",
       "",
       [](State& s, const std::string&) { travel(s, true); },
       can_undo,
       {}},
      {"label.redo",
       "Redo",
       menu,
       "Ctrl+Shift+Z Ctrl+Y",
       "",
       [](State& s, const std::string&) { travel(s, false); },
       can_redo,
       {}},
      {"label.save",
       "Save the labels",
       menu,
       "Ctrl+S",
       "",
       [](State& s, const std::string&) {
         const labels::LabelStore& store = *store_of(s);
         if (!store.read_only().empty()) throw Error(store.read_only());
         if (!store.any_unsaved()) return say(s, "labels are already saved");
         say(s, "labels written to " + s.document.current()->label_dir.string());
         save_labels(s);
       },
       [](const State& s) { return store_of(s) != nullptr; },
       {}},
      {"label.annotator",
       "Annotator",
       menu,
       "Ctrl+Shift+A",
       "NAME",
       [](State& s, const std::string& name) {
         store_of(s)->set_annotator(name);
         say(s, "annotator: " + name + "");
       },
       [](const State& s) { return store_of(s) != nullptr; },
       {}},
  };
  for (std::size_t i = 1; i < actions.size(); ++i) actions[i].mode = KeyMode::labels;
  return actions;
}

}  // namespace planescope::desktop
