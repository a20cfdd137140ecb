#include "app/desktop/labeling/label_marks.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/model/file_bytes.hpp"

namespace planescope::desktop {
namespace {

constexpr std::size_t kMaxBytes = 64 << 20;

/// What cannot be read is refused when the frame is opened; here it is a frame with labels.
FrameMark mark_of(const std::filesystem::path& path) {
  FrameMark mark;
  std::error_code gone;
  mark.labelled = std::filesystem::exists(path, gone);
  if (!mark.labelled) return mark;
  try {
    const auto bytes = read_file_bytes(path, kMaxBytes);
    mark.reviewed = nlohmann::json::parse(bytes).value("review_state", "") == "reviewed";
  } catch (const std::exception&) {
  }
  return mark;
}

}  // namespace

std::vector<FrameMark> marks_in(const std::filesystem::path& dir,
                                int frames,
                                const std::stop_token& stop) {
  std::vector<FrameMark> marks;
  for (int i = 0; i < frames && !stop.stop_requested(); ++i)
    marks.push_back(mark_of(dir / fmt::format("{:06}.json", i)));
  return marks;
}

}  // namespace planescope::desktop
