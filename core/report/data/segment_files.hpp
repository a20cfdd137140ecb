#pragma once

// What `planescope segment` writes about a frame. Nothing but timings.json depends on time or on
// the number of threads.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/model/frame.hpp"
#include "core/planes/result/analyze.hpp"

namespace planescope::report {

/// "frames/000123", the place of a frame's files below the output folder.
std::filesystem::path frame_folder(int frame_index);

/// Plane id per depth pixel, 0 none. For depth frames.
Image16 plane_image(const Frame& frame, const planes::FrameResult& result);
/// Track per depth pixel instead, `tracks` by plane id - 1.
Image16 track_image(const Frame& frame,
                    const planes::FrameResult& result,
                    std::span<const int> tracks);

/// All input points in input order (depth: the valid pixels in raster order; clouds: every point of
/// the file) in the world frame, with label (0 unknown, 1 h, 2 v) and instance (plane id, 0 none).
PointSet labelled_cloud(const Frame& frame, const planes::FrameResult& result);

/// Writes planes.json, timings.json, cloud.ply, for depth frames planes.png and, where tracks are
/// known, tracks.png, and `also` those of plane_formats() into `dir`, which exists. Throws Error
/// naming the file that cannot be written.
void write_segment_files(const std::filesystem::path& dir,
                         const Frame& frame,
                         const planes::FrameResult& result,
                         const planes::FramePlanes& found,
                         const planes::PipelineOptions& options,
                         const std::vector<std::string>& also = {});

}  // namespace planescope::report
