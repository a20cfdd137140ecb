#pragma once

// What `planescope segment` wrote for one frame, read back for the tests with real recordings.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "core/model/frame.hpp"
#include "core/model/types.hpp"

namespace planescope {

struct OutputPlane {
  int id = 0;
  std::string label;  // h | v
  Vec3d normal;       // unit, world frame
  Vec3d centroid;     // [m]
  double offset_m = 0;
  std::int64_t points = 0;
};

/// Heights of a flight's treads above its foot, from the lowest [m].
using OutputFlight = std::vector<double>;

struct FrameOutput {
  std::filesystem::path folder;
  std::vector<OutputPlane> planes;  // sorted as in planes.json
  std::vector<OutputFlight> flights;
  Vec3d gravity;      // sensor frame, unit
  Image16 plane_ids;  // empty for clouds
  PointSet cloud;     // world frame, with `instance`
};

/// Throws Error where a file is missing or says something else than its neighbours.
FrameOutput read_frame_output(const std::filesystem::path& folder);

/// The plane with that id, nullptr for 0 (no plane) and for ids that planes.json does not list.
const OutputPlane* plane_of_id(const FrameOutput& output, int id);

}  // namespace planescope
