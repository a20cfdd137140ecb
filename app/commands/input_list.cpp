#include "app/commands/input_list.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::app {

void read_list(const std::filesystem::path& list,
               const std::function<void(std::istringstream& words)>& read) {
  std::ifstream file = open_to_read(list);
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
  if (file.bad()) throw Error(list.string() + ": cannot be read to its end");
}

void set_listed_options(InputArgs& args,
                        std::istringstream& words,
                        std::span<const std::string> known) {
  std::string name, value;
  while (words >> name) {
    if (std::ranges::find(known, name) == known.end())
      throw Error(
          fmt::format("'{}' is not known, expected some of {}", name, fmt::join(known, ", ")));
    if (!(words >> value)) throw Error(name + " has no value");
    set_input_option(args, name, value);
  }
}

}  // namespace planescope::app
