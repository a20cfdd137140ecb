#pragma once

// Recordings of depth images, written as folders that open_recording() and other tools read; and
// MCAP files.

#include <filesystem>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "core/io/ros_message.hpp"
#include "core/model/frame.hpp"

namespace planescope::io {

/// `open3d`: depth/ and color/ with numbered PNGs, camera_intrinsic.json, as Open3D's recorder has
/// them. `tum`: depth/ and rgb/ with PNGs named by time, depth.txt and rgb.txt. Both with a
/// sidecar.
enum class FolderForm : std::uint8_t { open3d, tum };

/// What the lists and the sidecar say of a frame that was written.
struct WrittenFrame {
  Frame facts;  // without depth, colour and points
  std::string name;
  bool has_color = false;
};

/// `name`: of the frame in what was written.
WrittenFrame facts_of(Frame frame, const std::string& name);

/// Writes the images of one frame below `dir`; from any thread. `number`: its place in the folder.
/// Depth counts stay as they are. Throws Error.
WrittenFrame write_frame(const std::filesystem::path& dir,
                         FolderForm form,
                         int number,
                         const Frame& frame);

/// Writes what is told of all frames. Throws Error where they do not have one camera, and in the
/// form `tum` where their times do not grow.
void write_folder_facts(const std::filesystem::path& dir,
                        FolderForm form,
                        const std::vector<WrittenFrame>& frames);

/// The sidecar alone: all that is told of frames with depth. Throws Error where they do not have
/// one camera.
void write_recording_facts(const std::filesystem::path& sidecar,
                           const std::vector<WrittenFrame>& frames);

/// The sidecar alone, of frames that lie in files of their own names: when they were taken, and
/// their gravity.
void write_frame_facts(const std::filesystem::path& sidecar,
                       const std::vector<WrittenFrame>& frames);

/// Writes messages of ROS 2 as an MCAP file: zstd chunks, an index, statistics, and the definition
/// of every type. Deterministic.
class McapWriter {
 public:
  explicit McapWriter(std::ostream& out);
  /// `latched`: late subscribers get it, too; further ones on this topic are skipped.
  void add(const RosMessage& message, std::int64_t stamp_ns, bool latched = false);
  void end_chunk();
  void finish();

 private:
  struct Channel {
    std::uint16_t id = 0;
    std::uint64_t messages = 0;
  };
  void write(const std::string& bytes);

  std::ostream& out_;
  std::uint64_t position_ = 0;
  std::map<std::string, std::uint16_t> schema_ids_;  // by type
  std::map<std::string, Channel> channels_;          // by topic
  std::string chunk_;
  std::string schemas_, channel_records_, chunk_indexes_;  // of the summary, grouped by kind
  std::map<std::uint16_t, std::string> entries_;           // of the chunk, by channel
  std::uint64_t messages_ = 0, first_ns_ = 0, last_ns_ = 0, chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::uint32_t chunks_ = 0;
};

}  // namespace planescope::io
