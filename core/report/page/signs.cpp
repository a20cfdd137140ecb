#include "core/report/page/signs.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "core/model/text.hpp"

namespace planescope::report {
namespace {

constexpr double kSliver_m = 0.04;       // radius
constexpr double kFloorHeight_m = 0.03;  // a step is higher, and a piece of the floor is not
constexpr double kLeastSupport = 0.9;

}  // namespace

double Signs::weight() const { return slivers + 3 * floor_pieces + 2 * low_support + off_planes; }

std::string Signs::text() const {
  std::vector<std::string> signs;
  if (floor_pieces > 0) signs.push_back(fmt::format("the floor in {} pieces", floor_pieces + 1));
  if (low_support > 0) signs.push_back(counted(low_support, "plane") + " of low support");
  if (slivers > 0) signs.push_back(counted(slivers, "sliver"));
  return fmt::format("{}{}{:.1f} % of the points on planes", fmt::join(signs, ", "),
                     signs.empty() ? "" : "; ", 100 * (1 - off_planes));
}

Signs signs_of(const ReportFrame& frame) {
  Signs signs;
  signs.off_planes = 1 - frame.percent_on_planes() / 100;
  const int floor = frame.terrain ? frame.terrain->floor : 0;
  for (const ReportPlane& plane : frame.planes) {
    if (!plane.footing) continue;
    const Footing& footing = *plane.footing;
    signs.slivers += footing.clearance_m < kSliver_m;
    signs.low_support += footing.support < kLeastSupport;
    signs.floor_pieces +=
        floor > 0 && plane.summary.id != floor && std::abs(footing.height_m) <= kFloorHeight_m;
  }
  return signs;
}

}  // namespace planescope::report
