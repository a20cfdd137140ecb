#include "core/labels/model/frame_truth.hpp"

#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"

namespace planescope::labels {

std::optional<planes::SourceTruth> frame_truth(const Frame& frame,
                                               const std::filesystem::path& label_dir,
                                               const std::string& sha256) {
  if (!frame.is_cloud() && !label_dir.empty())
    if (const auto labels = read_frame_labels(label_dir, frame.index, sha256)) {
      if (labels->plane.width != frame.depth.width || labels->plane.height != frame.depth.height)
        throw Error(label_dir.string() + ": labels of frame " + std::to_string(frame.index) +
                    " are " + std::to_string(labels->plane.width) + "x" +
                    std::to_string(labels->plane.height) + ", its depth is " +
                    std::to_string(frame.depth.width) + "x" + std::to_string(frame.depth.height));
      return planes::truth_of_labels(*labels);
    }
  if (frame.is_cloud()) return planes::truth_of_cloud(*frame.cloud);
  return std::nullopt;
}

}  // namespace planescope::labels
