#include "app/cli/list_file.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <map>

#include "core/model/error.hpp"

namespace planescope::app {

void read_list(const std::filesystem::path& list,
               const std::function<void(std::istringstream& words)>& read) {
  std::ifstream file(list);
  if (!file || std::filesystem::is_directory(list)) throw Error(list.string() + ": cannot be read");
  int number = 0;
  for (std::string line; std::getline(file, line);) {
    ++number;
    std::istringstream words(line);
    if ((words >> std::ws).eof() || words.peek() == '#') continue;
    try {
      read(words);
    } catch (const Error& error) {
      throw Error(fmt::format("{}, line {}: {}", list.string(), number, error.what()));
    }
  }
}

Typed typed_options(std::istringstream& words, std::span<const std::string> known) {
  Typed typed;
  const std::map<std::string, std::string*> options = {{"--frames", &typed.frames},
                                                       {"--gravity", &typed.gravity},
                                                       {"--intrinsics", &typed.intrinsics},
                                                       {"--depth-unit", &typed.depth_unit},
                                                       {"--max-range", &typed.max_range}};
  std::string name;
  while (words >> name) {
    if (std::ranges::find(known, name) == known.end())
      throw Error(
          fmt::format("'{}' is not known, expected some of {}", name, fmt::join(known, ", ")));
    if (!(words >> *options.at(name))) throw Error(name + " has no value");
  }
  return typed;
}

}  // namespace planescope::app
