#include "tests/real/sheets.hpp"

#include <fmt/format.h>

#include <cmath>
#include <set>
#include <utility>

namespace planescope {
namespace {

using Cells = std::set<std::pair<int, int>>;

// The cells that a plane's points occupy when they are projected onto `onto`.
Cells occupied_cells(const FrameOutput& output, int id, const OutputPlane& onto, double cell_m) {
  const Vec3d u = onto.normal.unitOrthogonal();
  const Vec3d v = onto.normal.cross(u);
  Cells cells;
  for (std::size_t i = 0; i < output.cloud.points.size(); ++i) {
    if (output.cloud.instance[i] != id) continue;
    const Vec3d p = output.cloud.points[i].cast<double>() + output.cloud.origin;
    cells.emplace(static_cast<int>(std::floor(p.dot(u) / cell_m)),
                  static_cast<int>(std::floor(p.dot(v) / cell_m)));
  }
  return cells;
}

double overlap(const Cells& a, const Cells& b) {
  std::size_t both = 0;
  for (const auto& cell : a) both += b.count(cell);
  return static_cast<double>(both) / static_cast<double>(std::min(a.size(), b.size()));
}

}  // namespace

std::vector<std::string> find_sheets(const FrameOutput& output, const SheetOptions& options) {
  std::vector<std::string> problems;
  const double min_cosine = std::cos(options.max_angle_deg * M_PI / 180);
  for (std::size_t i = 0; i < output.planes.size(); ++i) {
    for (std::size_t j = i + 1; j < output.planes.size(); ++j) {
      const OutputPlane& a = output.planes[i];
      const OutputPlane& b = output.planes[j];
      if (a.label != b.label || std::min(a.points, b.points) < options.min_points) continue;
      if (std::abs(a.normal.dot(b.normal)) < min_cosine) continue;
      const double offset = std::min(std::abs(a.normal.dot(b.centroid) - a.offset_m),
                                     std::abs(b.normal.dot(a.centroid) - b.offset_m));
      if (offset > options.max_offset_m) continue;
      const double share = overlap(occupied_cells(output, a.id, a, options.cell_m),
                                   occupied_cells(output, b.id, a, options.cell_m));
      if (share > options.min_overlap)
        problems.push_back(fmt::format(
            "planes {} and {} ({} and {} points) are sheets of one surface: {:.1f} mm apart, "
            "{:.0f} % of the smaller is covered by the other",
            a.id, b.id, a.points, b.points, offset * 1e3, share * 100));
    }
  }
  return problems;
}

}  // namespace planescope
