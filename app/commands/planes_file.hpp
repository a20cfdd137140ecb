#pragma once

// PLANES.mcap, which segment and map write: frames with their planes as messages of ROS 2.

#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <vector>

#include "app/cli/output.hpp"
#include "core/io/recording_write.hpp"
#include "core/planes/result/analyze.hpp"
#include "core/world/files/map_files.hpp"

namespace planescope::app {

/// Whether -o names such a file, not a folder.
bool is_planes_file(const std::filesystem::path& out);

/// The messages of one frame.
struct FrameMessages {
  std::int64_t stamp_ns = 0;
  std::vector<io::RosMessage> list;
};
/// `map`: null without one.
FrameMessages messages_of(const Frame& frame,
                          const planes::FrameResult& result,
                          const planes::FramePlanes& found,
                          const world::KnownMap* map);

/// The planes of a map, and the way of the camera, for the start of the file.
std::vector<io::RosMessage> messages_of(const world::WorldMap& map);

/// Appears only when complete.
class PlanesFile {
 public:
  /// Throws Error if `out` exists or cannot be written.
  explicit PlanesFile(const std::filesystem::path& out);

  /// A folder for what is needed until commit().
  std::filesystem::path work_folder() const;
  /// Messages that begin the file and stay valid.
  void begin(std::vector<io::RosMessage> messages) { first_ = std::move(messages); }
  void add(const FrameMessages& frame);
  void commit();

 private:
  std::filesystem::path out_, staged_;
  StagedOutput output_;
  std::ofstream file_;
  std::optional<io::McapWriter> writer_;
  std::vector<io::RosMessage> first_;
};

}  // namespace planescope::app
