#pragma once

// A frame's planes in the formats of other tools. All in the world frame: z up, metres.

#include <filesystem>
#include <string>
#include <vector>

#include "core/planes/result/analyze.hpp"

namespace planescope::report {

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

}  // namespace planescope::report
