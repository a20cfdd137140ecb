#pragma once

// Reads the output of `planescope segment` for a frame of a real recording, and checks it against
// the expectations in tests/real_data.json.

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

/// Throws Error if a file is missing or contradicts the others.
FrameOutput read_frame_output(const std::filesystem::path& folder);

/// Returns one line per violated expectation. `expectation` is an object of real_data.json; its
/// "kind" selects the check:
///   angle        acute angle between the planes at pixels a and b is `deg` +- `tolerance_deg`
///   label        the plane at pixel `at` is `label` (h or v)
///   one_plane    the pixels `at` are on one plane
///   apart        the pixels `at` are on different planes
///   height       the plane at `upper` is `m` +- `tolerance_m` above the plane at `lower`
///   offset       the distance along the normal between parallel planes at a and b, same form
///   gravity      found within `tolerance_deg` of `direction` (sensor frame)
///   planes       the number of planes is from `least` to `most`
///   coverage     at least `least` (0..1) of the points within range are on a plane
///   no_sheets    no two planes with the same label overlap, nearly parallel and close
///   levels       horizontal planes have the heights `z` +- `tolerance_m` at y = `y`, and no such
///                plane spans two of them
///   flights      the flights of stairs match `heights`, which lists the heights of the treads of
///                each, +- `tolerance_m`, above the level before its first riser
std::vector<std::string> check_expectation(const nlohmann::json& expectation,
                                           const FrameOutput& output);

/// Checks that need no expectation: the three files of a frame agree.
std::vector<std::string> check_consistency(const FrameOutput& output);

/// Checks the slice |y - `y_m`| < 3 cm of the output's cloud: each height of `levels_m` has a
/// horizontal plane within `tolerance_m`, and no horizontal plane spans two of them.
std::vector<std::string> check_levels(const FrameOutput& output,
                                      double y_m,
                                      const std::vector<double>& levels_m,
                                      double tolerance_m);

/// Conditions for two planes to be sheets of one surface.
struct SheetOptions {
  double max_angle_deg = 5;
  double max_offset_m = 0.06;  // of one plane's centroid from the other plane
  double cell_m = 0.05;        // overlap is counted in cells of this size
  double min_overlap = 0.2;    // share of the smaller plane's cells that the other also covers
  int min_points = 300;        // smaller planes are ignored
};

/// One line per pair of planes with the same label that overlap, nearly parallel and close.
std::vector<std::string> find_sheets(const FrameOutput& output, const SheetOptions& options);

}  // namespace planescope
