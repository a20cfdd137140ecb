#include "app/desktop/state/settings.hpp"

#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>

#include "app/desktop/state/session_json.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kSettingsSchema = "planescope.desktop/1";

}  // namespace

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
    std::ifstream file(settings_path(), std::ios::binary);
    if (!file) return {};
    const Json json = Json::parse(file);
    if (json.at("schema") != kSettingsSchema) return {};
    Settings settings;
    settings.width = std::clamp(json.at("width").get<int>(), 640, 16384);
    settings.height = std::clamp(json.at("height").get<int>(), 400, 16384);
    settings.maximized = json.at("maximized");
    settings.last_recording = json.at("last_recording").get<std::string>();
    settings.last_frame = json.at("last_frame");
    view_of(json.at("view"), settings.view);
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
