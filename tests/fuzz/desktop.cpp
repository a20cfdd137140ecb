// Files of the window: sessions, what it remembers, and scripts.

#include <cstdlib>

#include "app/desktop/script.hpp"
#include "app/desktop/state/session.hpp"
#include "core/io/image/png.hpp"
#include "core/model/file_bytes.hpp"
#include "fuzz/fuzz.hpp"

namespace planescope::fuzz {
namespace {

namespace fs = std::filesystem;

/// Beside the recording that the corpus names, and saved again.
void read_session(Bytes bytes) {
  [[maybe_unused]] static const fs::path depth =
      file_of("session/rec/depth/000000.png", io::encode_png(plain_depth()));
  const fs::path path = file_of("session/a.session", bytes);
  desktop::State state;
  desktop::open_session(state, path.string());
  const auto saved = [&](const char* name) {
    const fs::path again = path.parent_path() / name;
    desktop::save_session(state, again);
    desktop::open_session(state, again.string());
    const ByteVector text = read_file_bytes(again);
    return std::string(text.begin(), text.end());
  };
  saved("1.session");  // names and numbers of the first may be put in range
  require(saved("2.session") == saved("3.session"), "a session that changes when it is saved");
}

void read_settings(Bytes bytes) {
  setenv("XDG_STATE_HOME", memory_folder().c_str(), 1);
  file_of("planescope/desktop.json", bytes);
  desktop::save_settings(desktop::load_settings());
  desktop::load_settings();
}

/// Reads alone: actions may write files anywhere. The window's tests play random ones.
void read_script(Bytes bytes) { desktop::Script::read(file_of("script/a.json", bytes)); }

}  // namespace

std::vector<Target> desktop_targets() {
  return {{"session", read_session}, {"settings", read_settings}, {"script", read_script}};
}

}  // namespace planescope::fuzz
