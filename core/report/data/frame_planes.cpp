#include "core/report/data/frame_planes.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "core/model/text.hpp"

namespace planescope::report {
namespace {

std::string mm(double m) { return fmt::format("{:.0f} mm", 1000 * m); }

std::string told(const planes::Flight& flight) {
  const char* const way[] = {"", " up", " down"};
  return fmt::format("{}{}, rise {}, going {}", counted(flight.steps.size(), "step"),
                     way[static_cast<std::size_t>(flight.seen)], mm(flight.rise_m),
                     mm(flight.going_m));
}
std::string told(const planes::Kerb& kerb) { return mm(kerb.rise_m); }
std::string told(const planes::SlopingPlane& ramp) {
  return fmt::format("{:.0f} deg", ramp.slope_deg);
}

/// "2 kerbs: 100 mm, 120 mm".
template <typename Thing>
void add(const std::vector<Thing>& things,
         const char* noun,
         const char* separator,
         std::vector<std::string>& all) {
  if (things.empty()) return;
  std::vector<std::string> each;
  for (const Thing& thing : things) each.push_back(told(thing));
  all.push_back(fmt::format("{}: {}", counted(things.size(), noun), fmt::join(each, separator)));
}

}  // namespace

FramePlanes frame_planes(const Frame& frame,
                         const planes::FrameResult& result,
                         const planes::PipelineOptions& options) {
  const double cell_m = cell_size_m(options.cloud.voxel_size_m);
  FramePlanes found;
  found.summaries = summarize_planes(result, options.cloud.voxel_size_m);
  found.outlines = planes::outlines_of(frame, result, cell_m);
  found.footholds = planes::footholds_of(frame, result, found.outlines, cell_m, options.foot);
  std::optional<Vec3d> sensor;
  if (!result.from_cloud) sensor = result.cloud.T_world_sensor.translation();
  const std::vector<planes::Outline> minor = planes::minor_outlines_of(result, cell_m);
  found.stairs = planes::find_stairs({result.segmentation.planes, found.outlines},
                                     {result.segmentation.minor, minor}, sensor, options.stairs);
  return found;
}

std::string line_of(const planes::Stairs& stairs) {
  std::vector<std::string> all;
  add(stairs.flights, "flight", " and ", all);
  add(stairs.kerbs, "kerb", ", ", all);
  add(stairs.ramps, "ramp", ", ", all);
  return fmt::format("{}", fmt::join(all, "; "));
}

}  // namespace planescope::report
