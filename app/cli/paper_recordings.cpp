#include "app/cli/paper_recordings.hpp"

#include "app/cli/list_file.hpp"
#include "core/model/error.hpp"

namespace planescope::app {

std::vector<PaperRecording> listed_recordings(const std::filesystem::path& list,
                                              const std::filesystem::path& data) {
  static const std::vector<std::string> options = {"--frames", "--gravity", "--intrinsics",
                                                   "--depth-unit"};
  std::vector<PaperRecording> recordings;
  read_list(list, [&](std::istringstream& words) {
    std::string name, path;
    if (!(words >> name >> path)) throw Error("a name without a path");
    Typed typed = typed_options(words, options);
    typed.inputs = {(data / path).string()};
    if (std::filesystem::exists(data / path)) recordings.push_back({name, input_args(typed)});
  });
  return recordings;
}

}  // namespace planescope::app
