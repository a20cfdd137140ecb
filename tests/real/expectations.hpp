#pragma once

// What `planescope segment` wrote for one frame of a real recording, read back, and the kinds of
// things that tests/real_data.json can expect of it.

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "core/model/frame.hpp"

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
  std::vector<OutputPlane> planes;  // sorted as in planes.json
  std::vector<OutputFlight> flights;
  Vec3d gravity;      // sensor frame, unit
  Image16 plane_ids;  // empty for clouds
  PointSet cloud;     // world frame, with `instance`
};

/// Throws Error where a file is missing or says something else than its neighbours.
FrameOutput read_frame_output(const std::filesystem::path& folder);

/// One line per thing that is not as expected, empty where all is. `expectation` is one object of
/// real_data.json; its "kind" names the check:
///   angle        acute angle between the planes at pixels a and b is `deg` +- `tolerance_deg`
///   label        the plane at pixel `at` is `label` (h or v)
///   one_plane    the pixels `at` lie on one plane
///   apart        the pixels `at` lie on planes of their own
///   height       the plane at `upper` stands `m` +- `tolerance_m` above the plane at `lower`
///   offset       the distance along the normal between parallel planes at a and b, same form
///   gravity      found within `tolerance_deg` of `direction` (sensor frame)
///   planes       the number of planes is from `least` to `most`
///   coverage     at least `least` (0..1) of the points inside the range are on a plane
///   no_sheets    no two planes with one label lie over each other, nearly parallel and close
///   levels       horizontal planes stand at the heights `z` +- `tolerance_m` where y = `y`, and no
///                such plane spans two of them
///   flights      there are as many flights of stairs as in `heights`, the treads of each at these
///                heights +- `tolerance_m` above what is before its first riser
std::vector<std::string> check_expectation(const nlohmann::json& expectation,
                                           const FrameOutput& output);

/// Checks that need no expectation: the three files of a frame agree with one another.
std::vector<std::string> check_consistency(const FrameOutput& output);

/// Looks at the slice |y - `y_m`| < 3 cm of the output's cloud: each height of `levels_m` has a
/// horizontal plane within `tolerance_m`, and no horizontal plane spans two of them.
std::vector<std::string> check_levels(const FrameOutput& output,
                                      double y_m,
                                      const std::vector<double>& levels_m,
                                      double tolerance_m);

/// When two planes count as one surface that was split into parallel sheets.
struct SheetOptions {
  double max_angle_deg = 5;
  double max_offset_m = 0.06;  // of one plane's centroid from the other plane
  double cell_m = 0.05;        // overlap is counted in cells of this size
  double min_overlap = 0.2;    // share of the smaller plane's cells that the other covers too
  int min_points = 300;        // smaller planes are crumbs, not sheets
};

/// One line per pair of planes with the same label that lie over each other, nearly parallel and
/// close.
std::vector<std::string> find_sheets(const FrameOutput& output, const SheetOptions& options);

}  // namespace planescope
