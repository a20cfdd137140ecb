#pragma once

// Recordings of depth images as folders that open_recording() and other tools read.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

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

}  // namespace planescope::io
