// Sessions and window settings: saves, reads and restores them as JSON.

#include "app/desktop/state/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/look.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json_fields.hpp"
#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSessionSchema = "planescope.session/2";
constexpr const char* kSettingsSchema = "planescope.desktop/1";

// ---- Shared ------------------------------------------------------------------------------------

const std::vector<std::string> kFacings = {"home", "top", "side", "front"};

}  // namespace

template <typename Fields>
void visit_fields(Fields& fields, Same<Bookmark> auto& b) {
  fields("name", b.name);
  fields("note", b.note);
  fields("frame", b.frame, kSigned);
  fields.with_default("frame_sha256", b.frame_sha256, "");
  fields("step", b.step, kSigned);
  fields("node", b.node, kSigned);
  fields("plane", b.plane, kSigned);
  fields("voxel", b.voxel, kSigned);
  fields("filter", b.filter);
  fields.object("camera", kPlain, [&](auto& of) {
    of("eye", b.camera.eye);
    of("target", b.camera.target);
    of("up", b.camera.up);
  });
  std::string facing = b.facing ? kFacings[static_cast<std::size_t>(*b.facing)] : "";
  fields("facing", facing, kOrNull);
  fields("orthographic", b.orthographic, kOptional);
  if constexpr (Fields::kReads)
    if (!facing.empty())
      b.facing = static_cast<Facing>(choice_argument("facing", facing, kFacings));
}

void visit_fields(auto& fields, Same<Breakpoint> auto& b) {
  fields.clamped("kind", b.kind, 0, 2);
  fields("filter", b.filter);
  fields("index", b.index, kSigned);
  fields("enabled", b.enabled);
}

template <typename Fields>
static void color_range_field(Fields& fields, auto& range) {
  std::optional<std::array<double, 2>> limits;
  if constexpr (Fields::kReads) {
    if (!fields.place().json().contains("color_range")) return;
    fields("color_range", limits);
    range.reset();
    if (limits) range = render::ValueRange{(*limits)[0], (*limits)[1]};
    if (range && !render::is_range(*range)) range.reset();
  } else {
    if (range) limits = {range->low_m, range->high_m};
    fields("color_range", limits);
  }
}

/// Panels, colors, theme and layout: everything except the cursor. Missing fields keep their value
/// in `view`.
void visit_fields(auto& fields, Same<ViewState> auto& view) {
  fields.clamped("color_by", view.color_by, 0, render::kColorBys - 1, kOptional);
  color_range_field(fields, view.range);
  fields("show_queue", view.show_queue, kOptional);
  fields("show_settled", view.show_settled, kOptional);
  fields("show_numerals", view.show_numerals, kOptional);
  fields("show_points", view.show_points, kOptional);
  fields("show_planes", view.show_planes, kOptional);
  fields("show_names", view.show_names, kOptional);
  fields("show_normals", view.show_normals, kOptional);
  fields("show_foot", view.show_foot, kOptional);
  fields.clamped("point_size", view.point_size, kLeastPointSize, kMostPointSize, kOptional);
  fields("show_stairs", view.show_stairs, kOptional);
  fields.clamped("backdrop", view.backdrop, 0, 2, kOptional);
  fields("orthographic", view.orthographic, kOptional);
  fields("overlay_opacity", view.overlay_opacity, kOptional);
  fields.clamped("theme", view.theme, 0, 1, kOptional);
  fields.clamped("zoom", view.zoom, 0.6, 3.0, kOptional);
  fields("inspector_tab", view.inspector_tab, kOptional);
  fields("tool_tab", view.tool_tab, kOptional);
  fields("list_tab", view.list_tab, kOptional);
  fields("show_map", view.show_map, kOptional);
  fields("octree_search", view.octree_search, kOptional);
  fields("only_matches", view.only_matches, kOptional);
  fields.clamped("rate", view.playing.steps_per_s, 1, 100000, kOptional);
  fields.clamped("step_unit", view.step_unit, 0, 2, kOptional);
  fields.clamped("brush_px", view.label.brush_px, 1, 200, kOptional);
  fields.clamped("wand_tolerance_m", view.label.wand_options.tolerance_m, 0.0005, 0.1, kOptional);
  fields("through", view.label.through, kOptional);
  fields("truth_plane", view.truth_plane, kOptional | kSigned);
  fields.clamped("views", view.views, 0, 2, kOptional);
  fields.object("layout", kOptional, [&](auto& of) {
    for (const LayoutPart& part : kLayoutParts)
      of.clamped(part.name, view.layout.*part.share, 0, 0.9, kOptional);
  });
}

Json view_json(const ViewState& view) { return json_of(view); }

// ---- Sessions ----------------------------------------------------------------------------------

namespace {

Json options_json(const planes::PipelineOptions& options) {
  Json json;
  const planes::PipelineOptions defaults;
  for (const planes::OptionInfo& info : planes::option_table()) {
    const std::string value = info.get(options);
    // Builds without a rival do not know its options, so write them only if they were changed.
    if (info.section != "rivals" || value != info.get(defaults)) json[info.name] = value;
  }
  return json;
}

/// Reads the profile first, because it sets options that the others then override. Throws Error.
planes::PipelineOptions options_of(const JsonPlace& place, const planes::PipelineOptions& now) {
  planes::PipelineOptions options = now;
  options.method = planes::Method::ours;  // sessions from before rivals do not name a method
  options.rivals = {};
  const auto set = [&](const std::string& name) {
    planes::set_option(options, name, place.at(name.c_str()).text());
  };
  if (place.has("profile")) set("profile");
  for (const auto& item : place.json().items())
    if (item.key() != "profile") set(item.key());
  return options;
}

/// Finds the session's recording: at its path, relative to the session file, or beside the file.
fs::path find_recording(const fs::path& session, const fs::path& written) {
  const fs::path folder = fs::absolute(session).parent_path();
  for (const fs::path& path :
       {written.is_absolute() ? written : folder / written, folder / written.filename()})
    if (fs::exists(path)) return path;
  throw Error(fmt::format("{}: its recording {} was not found there or next to the session",
                          session.string(), written.string()));
}

/// Contents of a session, read and validated before the state is changed.
struct Session {
  OpenRecording recording;
  std::string path, frame_sha256;  // of the recording; of the frame shown
  std::string note;                // about frames whose numbers have changed; empty: none
  int frame = 0;
  planes::PipelineOptions options;
  Bookmark cursor;
  ViewState view;
  std::vector<Breakpoint> breakpoints;
  std::vector<Bookmark> bookmarks;
  std::vector<std::uint32_t> marked;
};

/// Everything except the options, which are read separately.
template <typename Fields>
void visit_fields(Fields& fields, Same<Session> auto& session) {
  fields.object("recording", kPlain, [&](auto& of) {
    of("path", session.path);
    of("frame", session.frame, kSigned);
    of("frame_sha256", session.frame_sha256);
  });
  if constexpr (!Fields::kReads) fields.json()["options"] = options_json(session.options);
  fields("cursor", session.cursor);
  fields("view", session.view);
  fields("breakpoints", session.breakpoints);
  fields("bookmarks", session.bookmarks);
  fields("marked", session.marked, kOptional);
}

/// Frames may have been added to the recording or removed since the session was saved.
void find_session_frames(Session& session, const fs::path& path) {
  const OpenRecording& open = session.recording;
  std::vector<FrameIdentity> wanted = {{session.frame, session.frame_sha256, {}, 0}};
  std::vector<Bookmark*> marks;
  for (Bookmark& b : session.bookmarks)
    if (!b.frame_sha256.empty()) {
      wanted.push_back({b.frame, b.frame_sha256, {}, 0});
      marks.push_back(&b);
    }
  const auto found = io::find_frames(*open.recording, wanted);
  if (!found[0])
    throw Error(fmt::format("{}: {} is not the session's recording; frame {} differs",
                            path.string(), open.path.string(), session.frame));
  if (*found[0] != session.frame)
    session.note = fmt::format("frame {} in the session is now frame {} of {}", session.frame,
                               *found[0], open.path.string());
  // Bookmarks of old sessions have no hash, so their frames cannot be found.
  for (Bookmark& b : session.bookmarks)
    if (b.frame_sha256.empty() && *found[0] != session.frame) b.frame = -1;
  session.frame = session.cursor.frame = *found[0];
  for (std::size_t i = 0; i < marks.size(); ++i) marks[i]->frame = found[i + 1].value_or(-1);
}

Session read_session(const State& state, const fs::path& path) {
  Session session;
  session.view = state.view;
  session.view.flash = session.view.marking = false;
  session.view.playing.direction = 0;
  session.view.case_colors = CaseColors::ready;  // keep the session's own colors
  if (session.view.against == Against::pinned) session.view.against = Against::nothing;
  read_place(path, read_json<Json>(path), [&](const JsonPlace& place) {
    place.schema({kSessionSchema});
    session.options = options_of(place.at("options"), state.document.options);
    read_fields(place, session);
  });

  OpenRecording& open = session.recording;
  open.path = find_recording(path, session.path);
  open.recording = io::open_recording(open.path, options_to_open(state.document.recording_options));
  open.label_dir = labels::default_label_dir(open.path);
  find_session_frames(session, path);
  return session;
}

}  // namespace

io::RecordingOptions options_to_open(io::RecordingOptions options) {
  options.intrinsics_may_lack = true;
  return options;
}

void take_recording(State& state, OpenRecording taken, int frame) {
  if (state.view.mode == Mode::labels) leave_label_mode(state);
  Document& document = state.document;
  const auto same = [&](const OpenRecording& open) {
    std::error_code gone;
    return fs::equivalent(open.path, taken.path, gone);
  };
  for (const OpenRecording& open : document.recordings)
    if (same(open)) {  // keep the label folder in use
      taken.label_dir = open.label_dir;
      taken.labels = open.labels;
    }
  std::erase_if(document.recordings, same);
  read_picked(state, taken);
  note_recent(document, taken.path);
  document.recordings.push_back(std::move(taken));
  document.recording = static_cast<int>(document.recordings.size()) - 1;
  document.frame = frame;
  state.results = {};
  state.undo.clear();
  state.redo.clear();
}

void save_session(const State& state, const fs::path& path) {
  const OpenRecording* open = state.document.current();
  if (path.empty()) throw Error("action session.save: a path is missing");
  if (!open) throw Error(path.string() + ": no recording is open, so there is no session to write");
  state.document.check_output(path);
  std::error_code ignored;
  const fs::path folder = fs::absolute(path).parent_path();
  const fs::path recording = fs::absolute(open->path);
  const fs::path relative = fs::relative(recording, folder, ignored);
  Session session;
  session.path = (relative.empty() ? recording : relative).generic_string();
  session.frame = state.document.frame;
  session.frame_sha256 = open->recording->frame_hash(state.document.frame);
  session.options = state.document.options;
  session.cursor = bookmark_here(state);
  session.view = state.view;
  session.breakpoints = state.document.breakpoints;
  session.bookmarks = state.document.bookmarks;
  for (Bookmark& b : session.bookmarks)
    if (b.frame >= 0 && b.frame < open->recording->frame_count()) try {
        b.frame_sha256 = open->recording->frame_hash(b.frame);
      } catch (const Error&) {  // a damaged frame keeps its number
      }
  session.marked = state.document.marked;
  Json json = {{"schema", kSessionSchema}};
  json.update(json_of(session));
  write_file_text(path, json_text(json, 2));
}

void open_session(State& state, const std::string& where) {
  const std::size_t at = where.rfind('#');
  const fs::path path = where.substr(0, at);
  Session session = read_session(state, path);
  Bookmark arrival = session.cursor;
  if (at != std::string::npos) {
    const std::string name = where.substr(at + 1);
    const auto found = std::find_if(session.bookmarks.begin(), session.bookmarks.end(),
                                    [&](const Bookmark& one) { return one.name == name; });
    if (found == session.bookmarks.end())
      throw Error(fmt::format("{}: has no bookmark '{}'", path.string(), name));
    arrival = *found;
  }
  const int count = session.recording.recording->frame_count();
  if (arrival.frame < 0 || arrival.frame >= count)
    throw Error(fmt::format("{}: refers to {}, but {} has {}", path.string(), frame_name(arrival),
                            session.recording.path.string(), counted(count, "frame")));

  session.view.mode = Mode::debugger;
  take_recording(state, std::move(session.recording), arrival.frame);
  Document& document = state.document;
  document.options = session.options;
  document.breakpoints = session.breakpoints;
  document.bookmarks = session.bookmarks;
  document.marked = session.marked;
  document.session = path;
  state.view = session.view;
  state.view.camera.reset();
  if (!arrival.facing) state.view.camera = arrival.camera;
  state.view.facing = arrival.facing.value_or(Facing::home);
  state.view.orthographic = arrival.orthographic;
  set_filter(state, arrival.filter);
  state.view.arrival = arrival;
  if (!session.note.empty()) say(state, session.note);
}

// ---- Settings ----------------------------------------------------------------------------------

fs::path settings_path() {
  const char* state = std::getenv("XDG_STATE_HOME");
  const char* home = std::getenv("HOME");
  const fs::path base = state && *state ? fs::path(state)
                        : home && *home ? fs::path(home) / ".local" / "state"
                                        : fs::temp_directory_path();
  return base / "planescope" / "desktop.json";
}

template <typename Fields>
void visit_fields(Fields& fields, Same<Settings> auto& settings) {
  fields.clamped("width", settings.width, 640, 16384);
  fields.clamped("height", settings.height, 400, 16384);
  fields("maximized", settings.maximized);
  fields("last_recording", settings.last_recording);
  fields("last_frame", settings.last_frame, kSigned);
  fields("view", settings.view);
  fields("recent", settings.recent, kOptional);
  Bookmark place;
  if (settings.camera) place.camera = *settings.camera;
  if (!Fields::kReads && !settings.camera) return;
  fields.object("camera", kOptional, [&](auto& of) {
    visit_fields(of, place);
    if constexpr (Fields::kReads) settings.camera = place.camera;
  });
}

Settings load_settings() {
  try {
    const auto json = read_json<Json>(settings_path());
    const JsonPlace place(json);
    place.schema({kSettingsSchema});
    Settings settings;
    read_fields(place, settings);
    if (settings.recent.size() > kMostRecent) settings.recent.resize(kMostRecent);
    return settings;
  } catch (const std::exception&) {
    return {};
  }
}

void save_settings(const Settings& settings) {
  const fs::path path = settings_path();
  std::error_code failed;
  fs::create_directories(path.parent_path(), failed);
  Json json = {{"schema", kSettingsSchema}};
  json.update(json_of(settings));
  try {
    write_file_text(path, json_text(json, 2));
  } catch (const Error&) {  // settings are optional
  }
}

}  // namespace planescope::desktop
