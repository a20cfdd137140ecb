#pragma once

// Small recordings of a floor and a wall with known truth, for command-line tests.

#include <filesystem>

#include "core/io/recording.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/types.hpp"

namespace planescope::testing_cli {

/// Depth in millimeters of a level camera that sees a floor 0.5 m below it and a wall 1.2 m ahead.
/// 160x120, focal length 120, center (80, 60). Gravity is 0,1,0.
Image16 floor_and_wall();

/// The exact truth: plane 1 is the floor, 2 the wall.
FrameLabels floor_and_wall_labels(const io::Recording& recording, int frame = 0);

/// A folder recording with depth/000000.png ... and an Open3D intrinsics file.
void write_depth_folder(const std::filesystem::path& dir, const Image16& depth, int frames = 1);
/// scratch() with this recording in `rec`.
std::filesystem::path scratch_with_rec(int frames = 1);
/// Writes the truth of one of its frames to the label folder `to`.
void write_true_labels(const std::filesystem::path& recording,
                       const std::filesystem::path& to,
                       int frame = 0);
void write_intrinsics(const std::filesystem::path& dir, int width, int height);

/// The same scene as a cloud with z up, with true labels and instances.
PointSet floor_and_wall_cloud();

void write_text(const std::filesystem::path& path, const std::string& text);

}  // namespace planescope::testing_cli
