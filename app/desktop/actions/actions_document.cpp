// Recordings, frames, bookmarks and session files.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/state/report_open.hpp"
#include "app/desktop/state/session.hpp"
#include "core/io/folder/camera_files.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {
namespace {

bool has_recording(const State& state) { return state.document.current() != nullptr; }

/// Drops what belonged to the frame before; the view stays.
void leave_frame(State& state) {
  save_labels_if_possible(state);
  unflash(state);  // the selection is A's
  state.document.marked.clear();
  state.results.pinned = nullptr;
  state.results.comparison = nullptr;
  state.results.fix = {};
  state.results.sensitivity.clear();
  state.view.arrival.reset();
  state.view.report_place.reset();
  state.view.tracks.place.reset();
  state.view.truth_plane = 0;
  state.view.playing.direction = 0;
  state.view.click = Click::selects;
  state.view.measured.clear();
  LabelView& label = state.view.label;
  let_go(label);
  label.plane = 0;
  label.hover = -1;
  label.review_item = label.finding = -1;
  LabelResults& found = state.results.label;
  found.review = nullptr;
  found.review_refusal.clear();
  found.audit = nullptr;
  found.carry = {};
  if (state.view.against == Against::pinned) state.view.against = Against::nothing;
}

/// Labels of a recording that is newly shown; leaves the label mode if they cannot be opened.
void open_labels_of_mode(State& state) {
  if (state.view.mode != Mode::labels) return;
  try {
    open_labels(state);
  } catch (const Error& error) {
    apply(state, {"label.mode", ""});
    say(state, error.what(), true);
  }
}

void show_recording(State& state, int index) {
  if (index == state.document.recording) return;
  leave_frame(state);
  state.document.recording = index;
  state.document.frame = 0;
  forget_cameras(state);
  state.results.strip.clear();
  open_labels_of_mode(state);
}

void show_frame(State& state, int frame) {
  const int count = state.document.current()->recording->frame_count();
  const int wanted = std::clamp(frame, 0, count - 1);
  if (wanted == state.document.frame) return;
  leave_frame(state);
  state.document.frame = wanted;
}

bool is_last_frame(const State& state) {
  return state.document.frame + 1 >= state.document.current()->recording->frame_count();
}

void open(State& state, const std::string& text) {
  if (text.empty()) throw Error("action recording.open: a path is missing");
  Document& document = state.document;
  const std::filesystem::path path = text;
  for (std::size_t i = 0; i < document.recordings.size(); ++i)
    if (document.recordings[i].path == path) {
      note_recent(document, path);
      return show_recording(state, static_cast<int>(i));
    }
  std::shared_ptr<const io::Recording> recording;
  try {
    recording = io::open_recording(path, options_to_open(document.recording_options));
  } catch (const Error& error) {
    if (!forget_recent(document, path)) throw;
    throw Error(std::string(error.what()) + "; it is no longer among the recent ones");
  }
  document.recordings.push_back({path, recording, labels::default_label_dir(path)});
  note_recent(document, path);
  read_picked(state, document.recordings.back());
  show_recording(state, static_cast<int>(document.recordings.size()) - 1);
}

constexpr const char* kIntrinsicsTake = "FX,FY,CX,CY [METERS_PER_COUNT [remember]]";

/// Reads the recording again, with other intrinsics; `remember` stores them beside it.
void set_intrinsics(State& state, const std::string& text) {
  OpenRecording& open = *state.document.current();
  const std::vector<std::string> words = words_of(text);
  const std::vector<std::string> numbers = words.empty() ? words : split(words[0], ',');
  const bool remember = words.size() == 3 && words[2] == "remember";
  if (numbers.size() != 4 || words.size() > (remember ? 3 : 2))
    throw Error("action intrinsics.set: '" + text + "' found, expected " + kIntrinsicsTake);
  io::RecordingOptions options = state.document.recording_options;
  std::array<double, 4> k{};
  for (std::size_t i = 0; i < 4; ++i) k[i] = number_argument("intrinsics.set", numbers[i]);
  options.intrinsics = k;
  if (words.size() > 1) options.depth_unit_m = number_argument("intrinsics.set", words[1]);
  std::shared_ptr<const io::Recording> recording = io::open_recording(open.path, options);
  leave_frame(state);
  open.recording = std::move(recording);
  open.labels = nullptr;
  read_picked(state, open);
  forget_cameras(state);
  state.results.strip.clear();
  state.view.edits_intrinsics = false;
  if (remember) {
    io::remember_camera(open.recording->info());
    say(state, "intrinsics stored in " + io::camera_file(open.recording->info()).string());
  }
  open_labels_of_mode(state);
}

bool has_camera(const State& state) {
  return has_recording(state) && state.document.current()->recording->info().width > 0;
}
bool knows_camera(const State& state) {
  return has_camera(state) && state.document.current()->recording->info().knows_camera();
}

void add_bookmark(State& state, const std::string& name) {
  Bookmark bookmark = bookmark_here(state);
  bookmark.name =
      name.empty() ? fmt::format("frame {} step {}", bookmark.frame, bookmark.step) : name;
  state.document.bookmarks.push_back(bookmark);
  state.view.inspector_tab = "bookmarks";
}

Bookmark& bookmark_at(State& state, const char* action, const std::string& text) {
  auto& all = state.document.bookmarks;
  for (Bookmark& bookmark : all)
    if (bookmark.name == text) return bookmark;
  return item_argument(action, text, all);
}

}  // namespace

void play_frames(State& state, double seconds) {
  ViewState& view = state.view;
  if (!view.playing_frames) return;
  if (view.mode == Mode::labels || !has_recording(state) || is_last_frame(state)) {
    view.playing_frames = false;
    return;
  }
  const debug::Run* run = state.run();
  const bool shown =
      !state.results.loading && (!state.results.refusal.empty() ||
                                 (run && run->subject->frame.index == state.document.frame));
  if (!shown) return;
  constexpr double kShown_s = 0.2;  // long enough to be looked at
  view.frame_due += seconds;
  if (view.frame_due < kShown_s) return;
  view.frame_due = 0;
  show_frame(state, state.document.frame + 1);
}

Bookmark bookmark_here(const State& state) {
  const ViewState& view = state.view;
  Bookmark here;
  here.frame = state.document.frame;
  here.step = view.step;
  here.node = view.selected.node;
  if (state.run() && view.selected.plane >= 0)
    here.plane = state.run()->timeline.number_of_plane(view.selected.plane);
  here.voxel = view.selected.voxel;
  here.filter = view.search.text;
  here.camera = camera_of(state);
  if (!view.camera) here.facing = view.facing;
  here.orthographic = view.orthographic;
  return here;
}

void go_to_bookmark(State& state, const Bookmark& bookmark) {
  const OpenRecording* open = state.document.current();
  const int count = open ? open->recording->frame_count() : 0;
  if (bookmark.frame < 0 || bookmark.frame >= count)
    throw Error(fmt::format("bookmark '{}' is on frame {}, but the recording has {}", bookmark.name,
                            bookmark.frame, count));
  const bool other_frame = bookmark.frame != state.document.frame;
  if (other_frame) show_frame(state, bookmark.frame);
  state.view.orthographic = bookmark.orthographic;
  if (bookmark.facing)
    move_camera(state, std::nullopt, *bookmark.facing);
  else
    move_camera(state, bookmark.camera);
  apply(state, {"filter.set", bookmark.filter});
  if (!other_frame && state.run()) {
    go_to_step(state, bookmark.step);
    const int nodes = static_cast<int>(state.run()->octree().nodes.size());
    const int voxels = static_cast<int>(state.run()->subject->voxel_count());
    const debug::Timeline& timeline = state.run()->timeline;
    const auto known = [](std::int32_t index, int size) {
      return index >= 0 && index < size ? index : -1;
    };
    state.view.selected = {.node = known(bookmark.node, nodes),
                           .plane = timeline.plane_of_number(bookmark.plane),
                           .voxel = known(bookmark.voxel, voxels)};
  } else {
    state.view.arrival = bookmark;
  }
}

std::vector<Action> document_actions() {
  const std::string file = "File";
  return {
      {"recording.open", "Open a recording", file, "Ctrl+O", "PATH", open, {}, {}},
      {"recording.show",
       "Switch to a recording",
       "",
       "",
       "NUMBER",
       [](State& s, const std::string& text) {
         const auto count = static_cast<int>(s.document.recordings.size());
         show_recording(s, whole_argument("recording.show", text, 0, count - 1));
       },
       has_recording,
       {}},
      {"intrinsics.edit", "Edit the camera intrinsics", file, "Alt+I", "",
       [](State& s, const std::string&) { s.view.edits_intrinsics = !s.view.edits_intrinsics; },
       knows_camera, [](const State& s) { return s.view.edits_intrinsics; }},
      {"intrinsics.set",
       "Set the camera intrinsics",
       "",
       "",
       kIntrinsicsTake,
       set_intrinsics,
       has_camera,
       {}},
      {"assumptions.hide",
       "Hide the assumptions about this recording",
       "View",
       "Alt+H",
       "",
       [](State& s, const std::string&) { s.view.assumptions_hidden = s.document.current()->path; },
       has_recording,
       {}},
      {"frame.show",
       "Show a frame",
       file,
       "Ctrl+G",
       "FRAME",
       [](State& s, const std::string& text) {
         const int count = s.document.current()->recording->frame_count();
         show_frame(s, whole_argument("frame.show", text, 0, count - 1));
       },
       has_recording,
       {}},
      {"frame.next",
       "Next frame",
       file,
       "PageDown",
       "",
       [](State& s, const std::string&) { show_frame(s, s.document.frame + 1); },
       has_recording,
       {}},
      {"frame.previous",
       "Previous frame",
       file,
       "PageUp",
       "",
       [](State& s, const std::string&) { show_frame(s, s.document.frame - 1); },
       has_recording,
       {}},
      {"frame.play", "Play frames", file, "Ctrl+Space", "",
       [](State& s, const std::string&) {
         s.view.playing_frames = !s.view.playing_frames && !is_last_frame(s);
         s.view.frame_due = 0;
       },
       has_recording, [](const State& s) { return s.view.playing_frames; }, KeyMode::debugger},
      {"strip.cancel",
       "Stop filling the strip",
       file,
       "Ctrl+K",
       "",
       [](State& s, const std::string&) { s.view.strip_stopped = true; },
       [](const State& s) {
         return s.results.strip_done < static_cast<int>(s.results.strip.size()) &&
                !s.view.strip_stopped;
       },
       {}},
      {"bookmark.add", "Bookmark this view", file, "Ctrl+D", "[NAME]", add_bookmark, has_run, {}},
      {"bookmark.go",
       "Go to a bookmark",
       file,
       "Ctrl+B",
       "NUMBER or NAME",
       [](State& s, const std::string& text) {
         go_to_bookmark(s, Bookmark(bookmark_at(s, "bookmark.go", text)));
       },
       {},
       {}},
      {"bookmark.note",
       "Add a note to a bookmark",
       "",
       "",
       "NUMBER TEXT",
       [](State& s, const std::string& text) {
         const std::size_t at = text.find(' ');
         bookmark_at(s, "bookmark.note", text.substr(0, at)).note =
             at == std::string::npos ? "" : text.substr(at + 1);
       },
       {},
       {}},
      {"bookmark.remove",
       "Remove a bookmark",
       "",
       "",
       "NUMBER or NAME",
       [](State& s, const std::string& text) {
         auto& all = s.document.bookmarks;
         const Bookmark& one = bookmark_at(s, "bookmark.remove", text);
         all.erase(all.begin() + (&one - all.data()));
       },
       {},
       {}},
      {"session.save",
       "Save the session",
       file,
       "Ctrl+S",
       "PATH",
       [](State& s, const std::string& text) {
         save_session(s, text);
         s.document.session = text;
         say(s, "session written to " + text);
       },
       has_recording,
       {}},
      {"session.open",
       "Open a session or a report",
       file,
       "Ctrl+Shift+O",
       "PATH[#BOOKMARK]",
       [](State& s, const std::string& text) {
         if (is_report(text))
           open_report(s, {text, {}, {}, false});
         else
           open_session(s, text);
       },
       {},
       {}},
      {"quit",
       "Quit",
       file,
       "Ctrl+Q",
       "",
       [](State& s, const std::string&) { s.view.quit = true; },
       {},
       {}},
  };
}

}  // namespace planescope::desktop
