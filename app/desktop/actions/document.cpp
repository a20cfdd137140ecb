// Actions on recordings, frames, bookmarks and session files.

#include <fmt/format.h>

#include <algorithm>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/state/session.hpp"
#include "core/io/folder/folder_files.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

bool has_recording(const State& state) { return state.document.current() != nullptr; }

// ---- Recordings and frames ---------------------------------------------------------------------

/// Drops the data of the previous frame but keeps the view.
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

/// Opens the labels of a newly shown recording; leaves label mode on failure.
void open_labels_of_mode(State& state) {
  if (state.view.mode != Mode::labels) return;
  try {
    open_labels(state);
  } catch (const Error& error) {
    leave_label_mode(state);
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

bool is_last_frame(const State& state) {
  return state.document.frame + 1 >= state.document.current()->recording->frame_count();
}

void open_recording(State& state, const std::string& text) {
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
    throw Error(std::string(error.what()) + "; removed from the recent recordings");
  }
  document.recordings.push_back({path, recording, labels::default_label_dir(path)});
  note_recent(document, path);
  read_picked(state, document.recordings.back());
  show_recording(state, static_cast<int>(document.recordings.size()) - 1);
}

// ---- Intrinsics --------------------------------------------------------------------------------

constexpr const char* kIntrinsicsTake = "FX,FY,CX,CY [METERS_PER_COUNT [remember]]";

CameraEntry read_camera(const State&, const std::string& action, const std::string& text) {
  const std::vector<std::string> words = words_of(text);
  const std::vector<std::string> numbers = words.empty() ? words : split(words[0], ',');
  CameraEntry entry;
  entry.remember = words.size() == 3 && words[2] == "remember";
  if (numbers.size() != 4 || words.size() > (entry.remember ? 3 : 2))
    throw Error("action intrinsics.set: invalid argument '" + text + "'; expected " +
                kIntrinsicsTake);
  for (std::size_t i = 0; i < 4; ++i) entry.intrinsics[i] = number_argument(action, numbers[i]);
  if (words.size() > 1) entry.depth_unit_m = number_argument(action, words[1]);
  return entry;
}

/// Reopens the recording with other intrinsics.
void set_intrinsics(State& state, const CameraEntry& entry) {
  OpenRecording& open = *state.document.current();
  io::RecordingOptions options = state.document.recording_options;
  options.intrinsics = entry.intrinsics;
  if (entry.depth_unit_m) options.depth_unit_m = *entry.depth_unit_m;
  std::shared_ptr<const io::Recording> recording = io::open_recording(open.path, options);
  leave_frame(state);
  open.recording = std::move(recording);
  open.labels = nullptr;
  read_picked(state, open);
  forget_cameras(state);
  state.results.strip.clear();
  state.view.edits_intrinsics = false;
  if (entry.remember) {
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

// ---- Bookmarks ---------------------------------------------------------------------------------

void add_bookmark(State& state, const std::string& name) {
  Bookmark bookmark = bookmark_here(state);
  bookmark.name =
      name.empty() ? fmt::format("frame {} step {}", bookmark.frame, bookmark.step) : name;
  state.document.bookmarks.push_back(bookmark);
  state.view.inspector_tab = "bookmarks";
}

/// Finds a bookmark by name or number.
int read_bookmark(const State& state, const std::string& action, const std::string& text) {
  const std::vector<Bookmark>& all = state.document.bookmarks;
  const auto named = std::ranges::find(all, text, &Bookmark::name);
  if (named != all.end()) return static_cast<int>(named - all.begin());
  return whole_argument(action, text, 0, static_cast<int>(all.size()) - 1);
}

BookmarkNote read_note(const State& state, const std::string& action, const std::string& text) {
  const std::size_t at = text.find(' ');
  return {read_bookmark(state, action, text.substr(0, at)),
          at == std::string::npos ? "" : text.substr(at + 1)};
}

}  // namespace

void show_frame(State& state, int frame) {
  const int count = state.document.current()->recording->frame_count();
  const int wanted = std::clamp(frame, 0, count - 1);
  if (wanted == state.document.frame) return;
  leave_frame(state);
  state.document.frame = wanted;
}

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
  constexpr double kShown_s = 0.2;  // minimum display time
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

std::string frame_name(const Bookmark& bookmark) {
  return bookmark.frame < 0 ? "a removed frame" : fmt::format("frame {}", bookmark.frame);
}

void go_to_bookmark(State& state, const Bookmark& bookmark) {
  const OpenRecording* open = state.document.current();
  const int count = open ? open->recording->frame_count() : 0;
  if (bookmark.frame < 0 || bookmark.frame >= count)
    throw Error(fmt::format("bookmark '{}' is on {}, but the recording has {}", bookmark.name,
                            frame_name(bookmark), counted(count, "frame")));
  const bool other_frame = bookmark.frame != state.document.frame;
  if (other_frame) show_frame(state, bookmark.frame);
  state.view.orthographic = bookmark.orthographic;
  if (bookmark.facing)
    move_camera(state, std::nullopt, *bookmark.facing);
  else
    move_camera(state, bookmark.camera);
  set_filter(state, bookmark.filter);
  if (other_frame || !state.run()) {
    state.view.arrival = bookmark;
    return;
  }
  go_to_step(state, bookmark.step);
  const debug::Run& run = *state.run();
  const auto known = [](std::int32_t index, std::size_t size) {
    return index >= 0 && static_cast<std::size_t>(index) < size ? index : -1;
  };
  state.view.selected = {.node = known(bookmark.node, run.octree().nodes.size()),
                         .plane = run.timeline.plane_of_number(bookmark.plane),
                         .voxel = known(bookmark.voxel, run.subject->voxel_count())};
}

void add_document_actions(std::vector<Action>& all) {
  const ActionGroup file{all, KeyMode::anywhere, "File"};
  const ActionGroup open{all, KeyMode::anywhere, "File", has_recording};
  file.add("recording.open", "Open a recording")
      .key("Ctrl+O")
      .words("load file import")
      .run(text("PATH"), open_recording);
  open.add("recording.show", "Switch to a recording")
      .run(item(
               "NUMBER", [](const State& s) -> auto& { return s.document.recordings; }),
           show_recording);
  file.add("intrinsics.edit", "Edit the camera intrinsics")
      .key("Alt+I")
      .words("camera calibration focal length")
      .when(knows_camera)
      .flips(&ViewState::edits_intrinsics);
  file.add("intrinsics.set", "Set the camera intrinsics")
      .when(has_camera)
      .run(Takes<CameraEntry>{kIntrinsicsTake, read_camera}, set_intrinsics);
  open.add("assumptions.hide", "Hide the assumptions about this recording")
      .key("Alt+H")
      .menu("View")
      .run([](State& s) { s.view.assumptions_hidden = s.document.current()->path; });
  open.add("frame.show", "Show a frame")
      .key("Ctrl+G")
      .run(whole("FRAME",
                 [](const State& s) {
                   return Range{0, s.document.current()->recording->frame_count() - 1};
                 }),
           show_frame);
  open.add("frame.next", "Next frame").key("PageDown").run([](State& s) {
    show_frame(s, s.document.frame + 1);
  });
  open.add("frame.previous", "Previous frame").key("PageUp").run([](State& s) {
    show_frame(s, s.document.frame - 1);
  });
  open.add("frame.play", "Play frames")
      .key("Ctrl+Space")
      .in(KeyMode::debugger)
      .on([](const State& s) { return s.view.playing_frames; })
      .run([](State& s) {
        s.view.playing_frames = !s.view.playing_frames && !is_last_frame(s);
        s.view.frame_due = 0;
      });
  file.add("strip.cancel", "Stop loading thumbnails")
      .key("Ctrl+K")
      .when([](const State& s) {
        return s.results.strip_done < static_cast<int>(s.results.strip.size()) &&
               !s.view.strip_stopped;
      })
      .run([](State& s) { s.view.strip_stopped = true; });

  const Takes<int> bookmark{"NUMBER or NAME", read_bookmark};
  file.add("bookmark.add", "Bookmark this view")
      .key("Ctrl+D")
      .when(has_run)
      .run(text("[NAME]"), add_bookmark);
  file.add("bookmark.go", "Go to a bookmark").key("Ctrl+B").run(bookmark, [](State& s, int i) {
    go_to_bookmark(s, Bookmark(s.document.bookmarks[static_cast<std::size_t>(i)]));
  });
  file.add("bookmark.note", "Add a note to a bookmark")
      .run(Takes<BookmarkNote>{"NUMBER TEXT", read_note}, [](State& s, const BookmarkNote& one) {
        s.document.bookmarks[static_cast<std::size_t>(one.bookmark)].note = one.note;
      });
  file.add("bookmark.remove", "Remove a bookmark").run(bookmark, [](State& s, int i) {
    s.document.bookmarks.erase(s.document.bookmarks.begin() + i);
  });
  open.add("session.save", "Save the session")
      .key("Ctrl+S")
      .run(text("PATH"), [](State& s, const std::string& path) {
        save_session(s, path);
        s.document.session = path;
        say(s, "session written to " + path);
      });
  file.add("session.open", "Open a session or a report")
      .key("Ctrl+Shift+O")
      .run(text("PATH[#BOOKMARK]"), [](State& s, const std::string& where) {
        if (is_report(where))
          open_report(s, {where, {}, {}, false});
        else
          open_session(s, where);
      });
  file.add("quit", "Quit").key("Ctrl+Q").run([](State& s) { s.view.quit = true; });
}

}  // namespace planescope::desktop
