#pragma once

// The label files of a frame: DIR/000123.{plane.png,hv.png,json}, numbered by 0-based depth frame.
// For a cloud, the images contain its points in file order, kPointsInRow per row; the rest of the
// last row is 0.

#include <array>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/model/frame.hpp"

namespace planescope::planes {
struct SourceTruth;  // core/planes/pipeline/truth.hpp
}

namespace planescope::labels {

/// <recording>.labels beside the recording (a trailing slash is ignored).
std::filesystem::path default_label_dir(const std::filesystem::path& recording);

inline constexpr int kPointsInRow = 1024;
inline constexpr std::uint32_t kMostPoints = 1u << 25;  // of a cloud: rows fit into any PNG

/// Known properties of the frame that the labels must match.
struct ExpectedFrame {
  std::string sha256;      // Recording::frame_hash; empty: unknown
  std::size_t points = 0;  // of a cloud; 0: of a depth image, or unknown

  ExpectedFrame(std::string hash, std::size_t cloud_points = 0)  // NOLINT: a hash is enough
      : sha256(std::move(hash)), points(cloud_points) {}
  ExpectedFrame(const char* hash) : sha256(hash) {}  // NOLINT
};

/// Writes the three files of a frame.
void write_frame_labels(const std::filesystem::path& dir,
                        int frame_index,
                        const FrameLabels& labels);
/// nullopt if the frame has no labels there. Throws Error if files are damaged, belong to another
/// frame, or differ in size: labels are rejected, never resized.
std::optional<FrameLabels> read_frame_labels(const std::filesystem::path& dir,
                                             int frame_index,
                                             const ExpectedFrame& expected);

/// read_frame_labels() for a loaded frame. Throws Error also if the labels are of a cloud and the
/// frame is a depth image, or vice versa, or if their sizes differ.
std::optional<FrameLabels> read_labels_of_frame(const std::filesystem::path& dir,
                                                const Frame& frame,
                                                const std::string& sha256);

/// From `label_dir` if it contains labels of the frame (`sha256` must match unless it is empty),
/// otherwise from the frame's own cloud fields, otherwise nullopt.
std::optional<planes::SourceTruth> frame_truth(const Frame& frame,
                                               const std::filesystem::path& label_dir,
                                               const std::string& sha256);

// The three files as bytes, to inspect them before writing or to compare them.

inline constexpr std::size_t kLabelFiles = 3;  // plane image, h/v image, JSON: in this order

using LabelFileBytes = std::array<std::vector<unsigned char>, kLabelFiles>;

std::array<std::filesystem::path, kLabelFiles> label_file_paths(const std::filesystem::path& dir,
                                                                int frame_index);

/// False also if the check fails.
bool is_there(const std::filesystem::path& path);

/// Throws Error that names files in `dir` if the labels are inconsistent.
LabelFileBytes encode_label_files(const std::filesystem::path& dir,
                                  int frame_index,
                                  const FrameLabels& labels);
/// Creates the folder if needed.
void write_label_files(const std::filesystem::path& dir,
                       int frame_index,
                       const LabelFileBytes& bytes);

/// Everything in FrameLabels except its two images, as JSON text of schema "planescope.labels/1".
std::string label_json(int frame_index, const FrameLabels& labels);

/// The reverse; `where` names the file in messages. Throws Error unless this is such a text of this
/// frame.
FrameLabels parse_label_json(const std::string& text, int frame_index, const std::string& where);

}  // namespace planescope::labels
