#include "app/cli/labelled_list.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "app/cli/list_file.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope {
namespace {

ListedFrame listed_frame(std::istringstream& words) {
  static const std::vector<std::string> options = {"--intrinsics", "--depth-unit", "--gravity",
                                                   "--max-range"};
  ListedFrame listed;
  LabelledName& name = listed.name;
  std::string half, frame;
  if (!(words >> name.name >> half >> name.recording >> frame))
    throw Error("expected NAME HALF RECORDING FRAME OPTIONS");
  name.half = parse_half(half);
  name.frame = parse_integer(frame, "FRAME");
  if (name.frame < 0) throw Error("FRAME: " + frame + " is out of range, expected at least 0");
  const InputArgs input = input_args(typed_options(words, options));
  listed.reading = {input.recording, input.pipeline.gravity, input.pipeline.cloud.max_range_m};
  return listed;
}

}  // namespace

std::vector<ListedFrame> labelled_list(const std::filesystem::path& list,
                                       std::optional<Half> half) {
  std::vector<ListedFrame> frames;
  read_list(list, [&](std::istringstream& words) {
    ListedFrame listed = listed_frame(words);
    if (std::ranges::any_of(frames,
                            [&](const ListedFrame& f) { return f.name.name == listed.name.name; }))
      throw Error(listed.name.name + " is there twice");
    frames.push_back(std::move(listed));
  });
  if (half) std::erase_if(frames, [&](const ListedFrame& f) { return f.name.half != *half; });
  if (frames.empty())
    throw Error(list.string() + ": no frame" +
                (half ? fmt::format(" of half {}", to_string(*half)) : ""));
  return frames;
}

}  // namespace planescope
