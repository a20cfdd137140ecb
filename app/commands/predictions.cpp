#include "app/commands/predictions.hpp"

#include <fmt/format.h>

#include "core/labels/exchange/exchange.hpp"
#include "core/report/data/segment_files.hpp"

namespace planescope::app {

namespace fs = std::filesystem;

std::optional<FrameLabels> read_prediction(const fs::path& dir,
                                           const io::Recording& recording,
                                           const Frame& frame,
                                           const Gravity& gravity) {
  const std::string hash = recording.frame_hash(frame.index);
  const std::string name = fmt::format("{:06}", frame.index);
  if (fs::exists(dir / (name + ".plane.png")))
    return labels::read_frame_labels(dir, frame.index, hash);
  std::vector<fs::path> candidates = {dir / report::frame_folder(frame.index) / "cloud.ply"};
  for (const char* ending : {".npy", ".label", ".npz", ".ply", ".pcd", ".json"})
    candidates.push_back(dir / (name + ending));
  for (const fs::path& path : candidates)
    if (fs::exists(path))
      return labels::labels_of_points(labels::read_labelled(path, labels::label_format_of(path)),
                                      labels::make_label_grid(frame, gravity), hash, path.string());
  return std::nullopt;
}

}  // namespace planescope::app
