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

// A frame's planes in the formats of other tools, in the world frame: z up, metres.

struct PlaneFormat {
  const char* name;  // as --also has it
  const char* file;
  const char* holds;  // one phrase
  std::string (*text)(const planes::FramePlanes&);
};
/// geojson, obj, ply, planar-terrain, csv, svg.
const std::vector<PlaneFormat>& plane_formats();

/// Those of these formats, by name, into `dir`, which exists. Throws Error naming the file that
/// cannot be written.
void write_plane_files(const std::filesystem::path& dir,
                       const std::vector<std::string>& formats,
                       const planes::FramePlanes& found);

/// A picture of each plane, seen against its normal: what it covers, holes, what is unknown, where
/// a foot may go with its convex pieces, and the largest circle.
std::string planes_svg(const planes::FramePlanes& found);

/// planescope_msgs/PlaneArray as one line of JSON, with the message's fields, all of them, and no
/// others.
std::string ros_json(const Frame& frame,
                     const planes::FrameResult& result,
                     const planes::FramePlanes& found);

}  // namespace planescope::report
