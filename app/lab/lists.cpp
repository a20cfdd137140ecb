#include "app/lab/lists.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

#include "app/commands/inputs.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::app {
namespace {

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
  set_listed_options(input, words, options);
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
    set_listed_options(recording.input, words, options);
    recording.input.inputs = {data / path};
    if (std::filesystem::exists(data / path)) recordings.push_back(std::move(recording));
  });
  return recordings;
}

}  // namespace planescope::app
