#pragma once

// Output files of `planescope segment` for a frame. Only timings.json depends on time; nothing
// depends on the number of threads.

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/model/frame.hpp"
#include "core/planes/result/analyze.hpp"

namespace planescope::report {

/// "frames/000123", the folder of a frame's files in the output folder.
std::filesystem::path frame_folder(int frame_index);

/// Plane id per depth pixel, 0 none. For depth frames.
Image16 plane_image(const Frame& frame, const planes::FrameResult& result);
/// The same for tracks; `tracks` by plane id - 1.
Image16 track_image(const Frame& frame,
                    const planes::FrameResult& result,
                    std::span<const int> tracks);

/// All input points in input order (depth: the valid pixels in raster order; clouds: every point of
/// the file) in the world frame, with label (0 unknown, 1 h, 2 v) and instance (plane id, 0 none).
PointSet labeled_cloud(const Frame& frame, const planes::FrameResult& result);

/// Writes planes.json, timings.json, cloud.ply, planes.png for depth frames, tracks.png if tracks
/// are known, and the formats in `also` into the existing folder `dir`. Throws Error naming the
/// file that cannot be written.
void write_segment_files(const std::filesystem::path& dir,
                         const Frame& frame,
                         const planes::FrameResult& result,
                         const planes::FramePlanes& found,
                         const planes::PipelineOptions& options,
                         const std::vector<std::string>& also = {});

// A frame's planes in the formats of other tools, in the world frame: z up, meters.

struct PlaneFormat {
  const char* name;  // value of --also
  const char* file;
  const char* holds;  // one phrase
  std::string (*text)(const planes::FramePlanes&);
};
/// geojson, obj, ply, planar-terrain, csv, svg.
const std::vector<PlaneFormat>& plane_formats();

/// Writes these formats, by name, into the existing folder `dir`. Throws Error naming the file that
/// cannot be written.
void write_plane_files(const std::filesystem::path& dir,
                       const std::vector<std::string>& formats,
                       const planes::FramePlanes& found);

/// A picture of each plane, seen against its normal: covered area, holes, unknown area, foot space
/// with its convex pieces, and the largest circle.
std::string planes_svg(const planes::FramePlanes& found);

/// planescope_msgs/PlaneArray as one line of JSON, with exactly the message's fields.
std::string ros_json(const Frame& frame,
                     const planes::FrameResult& result,
                     const planes::FramePlanes& found);

}  // namespace planescope::report
