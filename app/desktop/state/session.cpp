#include "app/desktop/state/session.hpp"

#include <fmt/format.h>

#include <fstream>
#include <nlohmann/json.hpp>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/camera.hpp"
#include "app/desktop/state/session_json.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSchema = "planescope.session/1";

Json options_json(const planes::PipelineOptions& options) {
  Json json;
  const planes::PipelineOptions defaults;
  for (const planes::OptionInfo& info : planes::option_table()) {
    const std::string value = info.get(options);
    // Builds without a rival do not know its options: they are named only where they are changed.
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

Json read_json(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path.string() + ": cannot be read");
  try {
    return Json::parse(file);
  } catch (const Json::exception& error) {
    throw Error(path.string() + ": is no session, its JSON is damaged: " + json_problem(error));
  }
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

Session read_session(const State& state, const fs::path& path) {
  const Json json = read_json(path);
  try {
    const std::string schema = json.at("schema");
    if (schema != kSchema)
      throw Error(fmt::format("{}: its schema is {}, expected {}", path.string(), schema, kSchema));
    Session session;
    session.options = options_of(json.at("options"), state.document.options);
    session.frame = json.at("recording").at("frame");
    session.cursor = bookmark_of(json.at("cursor"));
    session.view = state.view;
    session.view.flash = session.view.marking = false;
    session.view.playing.direction = 0;
    if (session.view.against == Against::pinned) session.view.against = Against::nothing;
    view_of(json.at("view"), session.view);
    for (const Json& one : json.at("breakpoints"))
      session.breakpoints.push_back(breakpoint_of(one));
    for (const Json& one : json.at("bookmarks")) session.bookmarks.push_back(bookmark_of(one));
    session.marked = json.value("marked", std::vector<std::uint32_t>{});

    OpenRecording& open = session.recording;
    open.path = find_recording(path, json.at("recording").at("path").get<std::string>());
    open.recording = io::open_recording(open.path, state.document.recording_options);
    open.label_dir = labels::default_label_dir(open.path);
    const int count = open.recording->frame_count();
    if (session.frame < 0 || session.frame >= count)
      throw Error(fmt::format("{}: it shows frame {}, but {} has {} frames", path.string(),
                              session.frame, open.path.string(), count));
    const std::string hash = json.at("recording").at("frame_sha256");
    if (hash != open.recording->frame_hash(session.frame))
      throw Error(fmt::format("{}: {} is another recording than the session's, frame {} differs",
                              path.string(), open.path.string(), session.frame));
    return session;
  } catch (const Json::exception& error) {
    throw Error(path.string() + ": is no session that can be read: " + json_problem(error));
  }
}

}  // namespace

void take_recording(State& state, OpenRecording taken, int frame) {
  if (state.view.mode == Mode::labels) apply(state, {"label.mode", ""});
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
  json["schema"] = kSchema;
  json["recording"] = {{"path", (relative.empty() ? recording : relative).generic_string()},
                       {"frame", state.document.frame},
                       {"frame_sha256", open->recording->frame_hash(state.document.frame)}};
  json["options"] = options_json(state.document.options);
  Bookmark cursor;
  cursor.frame = state.document.frame;
  cursor.step = state.view.step;
  cursor.node = state.view.selected.node;
  cursor.plane = state.view.selected.plane;
  cursor.voxel = state.view.selected.voxel;
  cursor.filter = state.view.search.text;
  cursor.camera = camera_of(state);
  json["cursor"] = bookmark_json(cursor);
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
  state.view.camera = arrival.camera;
  apply(state, {"filter.set", arrival.filter});
  state.view.arrival = arrival;
}

}  // namespace planescope::desktop
