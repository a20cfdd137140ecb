#include "app/desktop/state/session.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <limits>
#include <nlohmann/json.hpp>
#include <type_traits>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/look.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSessionSchema = "planescope.session/2";
constexpr const char* kFirstSessionSchema = "planescope.session/1";  // planes by place in the trace
constexpr const char* kSettingsSchema = "planescope.desktop/1";

// ---- Parts of both -----------------------------------------------------------------------------

// Readers throw nlohmann's exceptions, or Error.

Json vector_json(const Vec3d& v) { return {v.x(), v.y(), v.z()}; }
Vec3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Json camera_json(const render::Camera& camera) {
  return {{"eye", vector_json(camera.eye)},
          {"target", vector_json(camera.target)},
          {"up", vector_json(camera.up)}};
}
render::Camera camera_from(const Json& json) {
  render::Camera camera;
  camera.eye = vector_of(json.at("eye"));
  camera.target = vector_of(json.at("target"));
  camera.up = vector_of(json.at("up"));
  return camera;
}

int int_of(const Json& json, const char* key) { return whole_int(json.at(key), key); }

template <typename Enum>
void enum_of(const Json& json, const char* key, int count, Enum& value) {
  value = static_cast<Enum>(std::clamp(int_of(json, key), 0, count - 1));
}

const std::vector<std::string> kFacings = {"home", "top", "side", "front"};

Json bookmark_json(const Bookmark& b) {
  Json json = {{"name", b.name},
               {"note", b.note},
               {"frame", b.frame},
               {"step", b.step},
               {"node", b.node},
               {"plane", b.plane_of_trace ? -1 : b.plane},
               {"voxel", b.voxel},
               {"filter", b.filter},
               {"camera", camera_json(b.camera)},
               {"facing", b.facing ? Json(kFacings[static_cast<std::size_t>(*b.facing)]) : Json()},
               {"orthographic", b.orthographic}};
  if (b.plane_of_trace) json["trace_plane"] = b.plane;
  return json;
}

/// `first`: as sessions of the first version have them.
Bookmark bookmark_of(const Json& json, bool first = false) {
  Bookmark b;
  b.name = json.at("name");
  b.note = json.at("note");
  b.frame = int_of(json, "frame");
  b.step = int_of(json, "step");
  b.node = int_of(json, "node");
  b.plane = int_of(json, "plane");
  b.plane_of_trace = first && b.plane >= 0;
  if (json.contains("trace_plane")) {
    b.plane = int_of(json, "trace_plane");
    b.plane_of_trace = true;
  }
  b.voxel = int_of(json, "voxel");
  b.filter = json.at("filter");
  b.camera = camera_from(json.at("camera"));
  if (json.contains("facing") && !json.at("facing").is_null())
    b.facing = static_cast<Facing>(choice_argument("facing", json.at("facing"), kFacings));
  b.orthographic = json.value("orthographic", false);
  return b;
}

Json breakpoint_json(const Breakpoint& b) {
  return {{"kind", static_cast<int>(b.kind)},
          {"filter", b.filter},
          {"index", b.index},
          {"enabled", b.enabled}};
}

Breakpoint breakpoint_of(const Json& json) {
  Breakpoint b;
  if (json.contains("kind")) enum_of(json, "kind", 3, b.kind);
  b.filter = json.at("filter");
  b.index = int_of(json, "index");
  b.enabled = json.at("enabled");
  return b;
}

/// Every setting of the view that is kept: panels, colors, theme, layout; not the cursor. `visit`
/// is called with a key and a value, and for numbers and enumerations with the limits or the count.
template <typename View, typename Visit>
void visit_settings(View& view, const Visit& visit) {
  visit("color_by", view.color_by, render::kColorBys);
  visit("color_range", view.range);
  visit("show_queue", view.show_queue);
  visit("show_settled", view.show_settled);
  visit("show_numerals", view.show_numerals);
  visit("show_points", view.show_points);
  visit("show_planes", view.show_planes);
  visit("show_names", view.show_names);
  visit("show_normals", view.show_normals);
  visit("show_foot", view.show_foot);
  visit("point_size", view.point_size, kLeastPointSize, kMostPointSize);
  visit("show_stairs", view.show_stairs);
  visit("backdrop", view.backdrop, 3);
  visit("orthographic", view.orthographic);
  visit("overlay_opacity", view.overlay_opacity, 0.0, 1.0);
  visit("theme", view.theme, 2);
  visit("zoom", view.zoom, 0.6, 3.0);
  visit("inspector_tab", view.inspector_tab);
  visit("tool_tab", view.tool_tab);
  visit("list_tab", view.list_tab);
  visit("show_map", view.show_map);
  visit("octree_search", view.octree_search);
  visit("only_matches", view.only_matches);
  visit("rate", view.playing.steps_per_s, 1.0, 100000.0);
  visit("step_unit", view.step_unit, 3);
  visit("brush_px", view.label.brush_px, 1.0, 200.0);
  visit("wand_tolerance_m", view.label.wand_options.tolerance_m, 0.0005, 0.1);
  visit("through", view.label.through);
  visit("truth_plane", view.truth_plane);
  visit("views", view.views, 3);
  visit("layout", view.layout);
}

struct SettingsWriter {
  Json& json;

  template <typename T, typename... Limits>
  void operator()(const char* key, const T& value, Limits...) const {
    if constexpr (std::is_enum_v<T>)
      json[key] = static_cast<int>(value);
    else
      json[key] = value;
  }
  void operator()(const char* key, const std::optional<render::ValueRange>& range) const {
    json[key] = range ? Json{range->low_m, range->high_m} : Json(nullptr);
  }
  void operator()(const char* key, const Layout& layout) const {
    for (const LayoutPart& part : kLayoutParts) json[key][part.name] = layout.*part.share;
  }
};

/// Keys that are missing leave what the view has.
struct SettingsReader {
  const Json& json;

  template <typename T>
  void operator()(const char* key, T& value) const {
    if (!json.contains(key)) return;
    if constexpr (std::is_same_v<T, int>)
      value = int_of(json, key);
    else
      value = json.at(key).get<T>();
  }
  void operator()(const char* key, double& value, double low, double high) const {
    (*this)(key, value);
    value = std::clamp(value, low, high);
  }
  template <typename Enum>
  void operator()(const char* key, Enum& value, int count) const {
    if (json.contains(key)) enum_of(json, key, count, value);
  }
  void operator()(const char* key, std::optional<render::ValueRange>& value) const {
    if (!json.contains(key)) return;
    value.reset();
    if (json.at(key).is_null()) return;
    const render::ValueRange range{json.at(key).at(0).get<double>(),
                                   json.at(key).at(1).get<double>()};
    if (render::is_range(range)) value = range;
  }
  void operator()(const char* key, Layout& layout) const {
    if (json.contains(key))
      for (const LayoutPart& part : kLayoutParts)
        SettingsReader{json.at(key)}(part.name, layout.*part.share, 0.0, 0.9);
  }
};

}  // namespace

Json view_json(const ViewState& view) {
  Json json;
  visit_settings(view, SettingsWriter{json});
  return json;
}

namespace {

// ---- Sessions ----------------------------------------------------------------------------------

Json options_json(const planes::PipelineOptions& options) {
  Json json;
  const planes::PipelineOptions defaults;
  for (const planes::OptionInfo& info : planes::option_table()) {
    const std::string value = info.get(options);
    // Builds without a rival do not know its options: they are written only where they are changed.
    if (info.section != "rivals" || value != info.get(defaults)) json[info.name] = value;
  }
  return json;
}

/// Throws Error. The profile first: it sets what the others then change.
planes::PipelineOptions options_of(const Json& json, const planes::PipelineOptions& now) {
  planes::PipelineOptions options = now;
  options.method = planes::Method::ours;  // sessions from before there were others do not name it
  options.rivals = {};
  if (json.contains("profile")) planes::set_option(options, "profile", json.at("profile"));
  for (const auto& [name, value] : json.items())
    if (name != "profile") planes::set_option(options, name, value.get<std::string>());
  return options;
}

/// Where the session's recording is: as it says, from the session file on, or beside it.
fs::path find_recording(const fs::path& session, const fs::path& written) {
  const fs::path folder = fs::absolute(session).parent_path();
  for (const fs::path& path :
       {written.is_absolute() ? written : folder / written, folder / written.filename()})
    if (fs::exists(path)) return path;
  throw Error(fmt::format("{}: its recording {} is neither there nor beside the session",
                          session.string(), written.string()));
}

/// Everything of a session, read and checked before anything of the state is touched.
struct Session {
  OpenRecording recording;
  int frame = 0;
  planes::PipelineOptions options;
  Bookmark cursor;
  ViewState view;
  std::vector<Breakpoint> breakpoints;
  std::vector<Bookmark> bookmarks;
  std::vector<std::uint32_t> marked;
};

/// All of it but the recording. Throws nlohmann's exceptions, and Error that does not name the
/// file.
Session session_of(const Json& json, const State& state) {
  const std::string schema = json.at("schema");
  const bool first = schema == kFirstSessionSchema;
  if (!first && schema != kSessionSchema)
    throw Error(fmt::format("its schema is {}, expected {}", shown(schema), kSessionSchema));
  Session session;
  session.options = options_of(json.at("options"), state.document.options);
  session.frame = int_of(json.at("recording"), "frame");
  session.cursor = bookmark_of(json.at("cursor"), first);
  session.view = state.view;
  session.view.flash = session.view.marking = false;
  session.view.playing.direction = 0;
  session.view.case_colors = CaseColors::ready;  // its own colors stay
  if (session.view.against == Against::pinned) session.view.against = Against::nothing;
  visit_settings(session.view, SettingsReader{json.at("view")});
  for (const Json& one : json.at("breakpoints")) session.breakpoints.push_back(breakpoint_of(one));
  for (const Json& one : json.at("bookmarks")) session.bookmarks.push_back(bookmark_of(one, first));
  if (json.contains("marked"))
    for (const Json& voxel : json.at("marked"))
      session.marked.push_back(static_cast<std::uint32_t>(
          whole_number(voxel, 0, std::numeric_limits<std::uint32_t>::max(), "a marked voxel")));
  return session;
}

Session read_session(const State& state, const fs::path& path) {
  const auto json = read_json<Json>(path);
  std::string written, hash;
  Session session;
  try {
    session = session_of(json, state);
    written = json.at("recording").at("path");
    hash = json.at("recording").at("frame_sha256");
  } catch (const Error& error) {
    throw Error(path.string() + ": " + error.what());
  } catch (const Json::exception& error) {
    throw Error(path.string() + ": is no session that can be read: " + json_problem(error));
  }

  OpenRecording& open = session.recording;
  open.path = find_recording(path, written);
  open.recording = io::open_recording(open.path, options_to_open(state.document.recording_options));
  open.label_dir = labels::default_label_dir(open.path);
  const int count = open.recording->frame_count();
  if (session.frame < 0 || session.frame >= count)
    throw Error(fmt::format("{}: it shows frame {}, but {} has {} frames", path.string(),
                            session.frame, open.path.string(), count));
  if (hash != open.recording->frame_hash(session.frame))
    throw Error(fmt::format("{}: {} is another recording than the session's, frame {} differs",
                            path.string(), open.path.string(), session.frame));
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
    if (same(open)) {  // its labels stay where they are being made
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
  std::error_code ignored;
  const fs::path folder = fs::absolute(path).parent_path();
  const fs::path recording = fs::absolute(open->path);
  const fs::path relative = fs::relative(recording, folder, ignored);
  Json json;
  json["schema"] = kSessionSchema;
  json["recording"] = {{"path", (relative.empty() ? recording : relative).generic_string()},
                       {"frame", state.document.frame},
                       {"frame_sha256", open->recording->frame_hash(state.document.frame)}};
  json["options"] = options_json(state.document.options);
  json["cursor"] = bookmark_json(bookmark_here(state));
  json["view"] = view_json(state.view);
  json["breakpoints"] = Json::array();
  for (const Breakpoint& one : state.document.breakpoints)
    json["breakpoints"].push_back(breakpoint_json(one));
  json["bookmarks"] = Json::array();
  for (const Bookmark& one : state.document.bookmarks)
    json["bookmarks"].push_back(bookmark_json(one));
  json["marked"] = state.document.marked;

  write_file_text(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
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
    throw Error(fmt::format("{}: it leads to frame {}, but {} has {} frames", path.string(),
                            arrival.frame, session.recording.path.string(), count));

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

Settings load_settings() {
  try {
    const auto json = read_json<Json>(settings_path());
    if (json.at("schema") != kSettingsSchema) return {};
    Settings settings;
    settings.width = std::clamp(int_of(json, "width"), 640, 16384);
    settings.height = std::clamp(int_of(json, "height"), 400, 16384);
    settings.maximized = json.at("maximized");
    settings.last_recording = json.at("last_recording").get<std::string>();
    settings.last_frame = int_of(json, "last_frame");
    if (json.contains("recent"))
      for (const Json& path : json.at("recent"))
        if (settings.recent.size() < kMostRecent)
          settings.recent.emplace_back(path.get<std::string>());
    visit_settings(settings.view, SettingsReader{json.at("view")});
    if (json.contains("camera")) settings.camera = bookmark_of(json.at("camera")).camera;
    return settings;
  } catch (const std::exception&) {
    return {};
  }
}

void save_settings(const Settings& settings) {
  const fs::path path = settings_path();
  std::error_code failed;
  fs::create_directories(path.parent_path(), failed);
  Json json = {{"schema", kSettingsSchema},
               {"width", settings.width},
               {"height", settings.height},
               {"maximized", settings.maximized},
               {"last_recording", settings.last_recording.string()},
               {"last_frame", settings.last_frame},
               {"view", view_json(settings.view)}};
  json["recent"] = Json::array();
  for (const fs::path& one : settings.recent) json["recent"].push_back(one.string());
  if (settings.camera) {
    Bookmark place;
    place.camera = *settings.camera;
    json["camera"] = bookmark_json(place);
  }
  try {
    write_file_text(path, json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n');
  } catch (const Error&) {  // nobody asked for them to be kept
  }
}

}  // namespace planescope::desktop
