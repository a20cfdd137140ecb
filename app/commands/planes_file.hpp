#pragma once

// PLANES.mcap as written by segment and map: frames and their planes as ROS 2 messages.

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

/// Whether -o names an .mcap file rather than a folder.
bool is_planes_file(const std::filesystem::path& out);

/// The messages of one frame.
struct FrameMessages {
  std::int64_t stamp_ns = 0;
  std::vector<io::RosMessage> list;
};
/// `map` may be null.
FrameMessages messages_of(const Frame& frame,
                          const planes::FrameResult& result,
                          const planes::FramePlanes& found,
                          const world::KnownMap* map);

/// Messages with the planes and the camera path of a map, for the start of the file.
std::vector<io::RosMessage> messages_of(const world::WorldMap& map);

/// An MCAP file that appears only when complete.
class PlanesFile {
 public:
  /// Throws Error if `out` exists, is part of the recording or cannot be written.
  PlanesFile(const std::filesystem::path& out, const std::filesystem::path& recording);

  /// Folder for temporary files until commit().
  std::filesystem::path work_folder() const;
  /// Latched messages at the start of the file.
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
