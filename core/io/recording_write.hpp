#pragma once

// Writes depth image recordings as folders that open_recording() and other tools read, and MCAP
// files.

#include <filesystem>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "core/io/ros_message.hpp"
#include "core/model/frame.hpp"

namespace planescope::io {

/// `open3d`: depth/ and color/ with numbered PNGs and camera_intrinsic.json, like Open3D's
/// recorder. `tum`: depth/ and rgb/ with PNGs named by time, depth.txt and rgb.txt. Both include a
/// sidecar.
enum class FolderForm : std::uint8_t { open3d, tum };

/// Facts about a written frame for the lists and the sidecar.
struct WrittenFrame {
  Frame facts;  // without depth, color and points
  std::string name;
  bool has_color = false;
};

/// `name`: the frame's name in the output.
WrittenFrame facts_of(Frame frame, const std::string& name);

/// Writes the images of one frame below `dir`; may be called from any thread. `number`: index in
/// the folder. Depth counts are unchanged. Throws Error.
WrittenFrame write_frame(const std::filesystem::path& dir,
                         FolderForm form,
                         int number,
                         const Frame& frame);

/// Writes the lists and the sidecar of all frames. Throws Error if they do not share one camera, or
/// in the form `tum` if their times do not increase.
void write_folder_facts(const std::filesystem::path& dir,
                        FolderForm form,
                        const std::vector<WrittenFrame>& frames);

/// Writes only the sidecar of frames with depth. Throws Error if they do not share one camera.
void write_recording_facts(const std::filesystem::path& sidecar,
                           const std::vector<WrittenFrame>& frames);

/// Writes only the times and gravity of frames stored in files of their own names.
void write_frame_facts(const std::filesystem::path& sidecar,
                       const std::vector<WrittenFrame>& frames);

/// Writes ROS 2 messages as an MCAP file: zstd chunks, an index, statistics, and the definition of
/// every type. Deterministic.
class McapWriter {
 public:
  explicit McapWriter(std::ostream& out);
  /// `latched`: late subscribers also receive it; later messages on this topic are skipped.
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
  std::string schemas_, channel_records_, chunk_indexes_;  // of the summary, by kind
  std::map<std::uint16_t, std::string> entries_;           // of the chunk, by channel
  std::uint64_t messages_ = 0, first_ns_ = 0, last_ns_ = 0, chunk_first_ns_ = 0, chunk_last_ns_ = 0;
  std::uint32_t chunks_ = 0;
};

}  // namespace planescope::io
