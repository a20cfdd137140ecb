#include "app/lab/lists.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <span>
#include <sstream>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

/// Calls read(words) for each line that is not empty and no comment. Throws Error naming the list
/// and the line where that throws one.
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

/// The rest of a line: options as they would be typed, of those that are `known`. Throws Error.
void set_options(InputArgs& args, std::istringstream& words, std::span<const std::string> known) {
  std::string name, value;
  while (words >> name) {
    if (std::ranges::find(known, name) == known.end())
      throw Error(
          fmt::format("'{}' is not known, expected some of {}", name, fmt::join(known, ", ")));
    if (!(words >> value)) throw Error(name + " has no value");
    set_input_option(args, name, value);
  }
}

lab::ListedFrame listed_frame(std::istringstream& words) {
  static const std::vector<std::string> options = {"--intrinsics", "--depth-unit", "--gravity",
                                                   "--max-range"};
  lab::ListedFrame listed;
  lab::LabelledName& name = listed.name;
  std::string half, frame;
  if (!(words >> name.name >> half >> name.recording >> frame))
    throw Error("expected NAME HALF RECORDING FRAME OPTIONS");
  name.half = lab::parse_half(half);
  name.frame = parse_integer(frame, "FRAME");
  if (name.frame < 0) throw Error("FRAME: " + frame + " is out of range, expected at least 0");
  InputArgs input;
  set_options(input, words, options);
  listed.reading = {input.recording, input.pipeline.gravity, input.pipeline.cloud.max_range_m};
  return listed;
}

}  // namespace

std::vector<lab::ListedFrame> labelled_list(const std::filesystem::path& list,
                                            std::optional<lab::Half> half) {
  std::vector<lab::ListedFrame> frames;
  read_list(list, [&](std::istringstream& words) {
    lab::ListedFrame listed = listed_frame(words);
    if (std::ranges::any_of(
            frames, [&](const lab::ListedFrame& f) { return f.name.name == listed.name.name; }))
      throw Error(listed.name.name + " is there twice");
    frames.push_back(std::move(listed));
  });
  if (half) std::erase_if(frames, [&](const lab::ListedFrame& f) { return f.name.half != *half; });
  if (frames.empty())
    throw Error(list.string() + ": no frame" +
                (half ? fmt::format(" of half {}", lab::to_string(*half)) : ""));
  return frames;
}

std::vector<PaperRecording> listed_recordings(const std::filesystem::path& list,
                                              const std::filesystem::path& data) {
  static const std::vector<std::string> options = {"--frames", "--gravity", "--intrinsics",
                                                   "--depth-unit"};
  std::vector<PaperRecording> recordings;
  read_list(list, [&](std::istringstream& words) {
    std::string name, path;
    if (!(words >> name >> path)) throw Error("a name without a path");
    PaperRecording recording{name, {}};
    set_options(recording.input, words, options);
    recording.input.inputs = {data / path};
    if (std::filesystem::exists(data / path)) recordings.push_back(std::move(recording));
  });
  return recordings;
}

}  // namespace planescope::app
