#include "app/cli/assets.hpp"

#include <cstdlib>
#include <vector>

#include "core/model/error.hpp"

namespace planescope::app {
namespace fs = std::filesystem;

fs::path find_asset(const std::string& name, const std::string& what) {
  std::vector<fs::path> places;
  if (const char* assets = std::getenv("PLANESCOPE_ASSETS")) {
    places.push_back(fs::path(assets) / name);
  } else {
    std::error_code failed;
    const fs::path program = fs::read_symlink("/proc/self/exe", failed);
    if (!failed)
      places.push_back(program.parent_path().parent_path() / "share" / "planescope" / name);
    places.push_back(fs::path(PLANESCOPE_SOURCE_DIR) / "assets" / name);
  }
  std::string tried;
  for (const fs::path& place : places) {
    std::error_code ignored;
    if (fs::exists(place, ignored)) return place;
    tried += (tried.empty() ? "" : " nor ") + place.string();
  }
  throw Error(what + " missing: there is no " + tried);
}

}  // namespace planescope::app
