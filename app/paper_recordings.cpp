#include "app/paper_recordings.hpp"

#include <fmt/format.h>

#include <fstream>
#include <map>
#include <sstream>

#include "app/typed.hpp"
#include "core/base/error.hpp"

namespace planescope {
namespace {

/// As if it had been typed.
Typed typed_line(std::istringstream& words) {
  Typed typed;
  const std::map<std::string, std::string*> options = {{"--frames", &typed.frames},
                                                       {"--gravity", &typed.gravity},
                                                       {"--intrinsics", &typed.intrinsics},
                                                       {"--depth-unit", &typed.depth_unit}};
  std::string name;
  while (words >> name) {
    const auto option = options.find(name);
    if (option == options.end())
      throw Error("'" + name +
                  "' is not known, expected --frames, --gravity, --intrinsics or "
                  "--depth-unit");
    if (!(words >> *option->second)) throw Error(name + " has no value");
  }
  return typed;
}

}  // namespace

std::vector<PaperRecording> listed_recordings(const std::filesystem::path& list,
                                              const std::filesystem::path& data) {
  std::ifstream file(list);
  if (!file) throw Error(list.string() + ": cannot be read");
  std::vector<PaperRecording> recordings;
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    std::istringstream words(line);
    std::string name, path;
    if (!(words >> name) || name[0] == '#') continue;
    try {
      if (!(words >> path)) throw Error("a name without a path");
      Typed typed = typed_line(words);
      typed.inputs = {(data / path).string()};
      if (std::filesystem::exists(data / path)) recordings.push_back({name, input_args(typed)});
    } catch (const Error& error) {
      throw Error(fmt::format("{}, line {}: {}", list.string(), number, error.what()));
    }
  }
  return recordings;
}

}  // namespace planescope
