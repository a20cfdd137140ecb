// Height map of the measurements on a plane.

#include "core/planes/foot/places.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/planes/outline/rings.hpp"

namespace planescope::planes {

Places::Places(std::span<const Measured> measured, double cell_m) : cell_m_(cell_m) {
  constexpr double kMostCells = 1024;  // per axis; limits memory
  constexpr double kFoot_m = 0.05;
  Eigen::AlignedBox2d box;
  for (const Measured& m : measured) box.extend(m.at);
  if (box.isEmpty()) return;
  low_ = box.min();
  cell_m_ = std::max(cell_m, box.sizes().maxCoeff() / kMostCells);
  about_ = std::max(1, static_cast<int>(std::lround(kFoot_m / cell_m_)));
  columns_ = 1 + static_cast<int>(box.sizes().x() / cell_m_);
  rows_ = 1 + static_cast<int>(box.sizes().y() / cell_m_);
  cells_.resize(static_cast<std::size_t>(columns_) * rows_);
  for (const Measured& m : measured) {
    const Vec2d at = (m.at - low_) / cell_m_;
    Cell& cell = cells_[index(static_cast<int>(at.x()), static_cast<int>(at.y()))];
    cell.sum += m.height_m * m.weight;
    cell.weight += m.weight;
  }
  for (Cell& cell : cells_) {
    if (cell.weight == 0) continue;
    cell.height_m = cell.sum / cell.weight;
    ++occupied_;
  }
}

double Places::mean_about(int x, int y) const {
  double sum = 0, count = 0;
  for (int v = std::max(0, y - about_); v <= std::min(rows_ - 1, y + about_); ++v)
    for (int u = std::max(0, x - about_); u <= std::min(columns_ - 1, x + about_); ++u) {
      const Cell& near = cells_[index(u, v)];
      sum += near.height_m;  // 0 if the cell is empty
      count += near.weight > 0;
    }
  return sum / count;
}

double Places::rough_rms_m() const {
  double squares = 0;
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      const Cell& cell = cells_[index(x, y)];
      if (cell.weight == 0) continue;
      const double above = cell.height_m - mean_about(x, y);
      squares += above * above;
    }
  return occupied_ > 0 ? std::sqrt(squares / occupied_) : 0;
}

double Places::step_m(double share) const {
  std::vector<double> steps;
  const auto add = [&](const Cell& a, const Cell& b) {
    if (a.weight > 0 && b.weight > 0) steps.push_back(std::abs(a.height_m - b.height_m));
  };
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      if (x + 1 < columns_) add(cells_[index(x, y)], cells_[index(x + 1, y)]);
      if (y + 1 < rows_) add(cells_[index(x, y)], cells_[index(x, y + 1)]);
    }
  if (steps.empty()) return 0;
  const auto nth = steps.begin() + static_cast<std::ptrdiff_t>(
                                       std::lround(share * static_cast<double>(steps.size() - 1)));
  std::ranges::nth_element(steps, nth);
  return *nth;
}

Polygons Places::near_off(double limit_m, double reach_m) const {
  // Cells are squares, and their corners must be within reach as well.
  const double reach = reach_m / cell_m_ + std::numbers::sqrt2;
  const int margin = static_cast<int>(std::ceil(reach));
  const int width = columns_ + 2 * margin, height = rows_ + 2 * margin;
  std::vector<std::int32_t> near(static_cast<std::size_t>(width) * height, 0);
  std::vector<int> half_width;  // of a disc, by row
  for (int v = -margin; v <= margin; ++v)
    half_width.push_back(static_cast<int>(std::sqrt(std::max(0.0, reach * reach - v * v))));
  bool any = false;
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      if (cells_[index(x, y)].weight == 0 || !(std::abs(mean_about(x, y)) > limit_m)) continue;
      any = true;
      for (int v = 0; v <= 2 * margin; ++v) {
        const auto row = near.begin() + static_cast<std::ptrdiff_t>(y + v) * width + x + margin;
        std::fill(row - half_width[v], row + half_width[v] + 1, 1);
      }
    }
  if (!any) return {};
  Polygons polygons;
  std::vector<std::size_t> of_part;
  for (const Ring& ring : trace_rings(near, width, height)) {
    PolygonRing on_plane;
    for (const Corner& corner : ring.corners)
      on_plane.push_back(low_ + cell_m_ * (corner.place() - Vec2d::Constant(margin)));
    std::ranges::reverse(on_plane);  // image rows point down
    if (ring.hole) {
      polygons[of_part[ring.part]].holes.push_back(std::move(on_plane));
    } else {
      of_part.resize(std::max<std::size_t>(of_part.size(), ring.part + 1));
      of_part[ring.part] = polygons.size();
      polygons.push_back({std::move(on_plane), {}});
    }
  }
  const Polygons smooth = simplified(polygons, 0.75 * cell_m_);
  return is_valid(smooth) ? smooth : polygons;
}

std::vector<Vec2d> Places::cut(const Vec2d& at, const Vec2d& towards) const {
  std::vector<Vec2d> along;
  for (int y = 0; y < rows_; ++y)
    for (int x = 0; x < columns_; ++x) {
      const Cell& cell = cells_[index(x, y)];
      const Vec2d from_at = low_ + cell_m_ * Vec2d(x + 0.5, y + 0.5) - at;
      const double off = towards.x() * from_at.y() - towards.y() * from_at.x();
      if (cell.weight > 0 && std::abs(off) <= 0.5 * cell_m_)
        along.emplace_back(towards.dot(from_at), cell.height_m);
    }
  std::ranges::sort(along, {}, [](const Vec2d& p) { return p.x(); });
  return along;
}

std::vector<Places> places_of(const FrameResult& result,
                              const std::vector<Outline>& outlines,
                              double cell_m) {
  std::vector<std::vector<Places::Measured>> measured(outlines.size());
  const Segmentation& segmentation = result.segmentation;
  for (std::size_t i = 0; i < segmentation.plane_of.size(); ++i) {
    const std::int32_t id = segmentation.plane_of[i];
    if (id <= 0) continue;
    const PlaneFit& fit = segmentation.planes[id - 1].fit;
    const PlaneBasis& basis = outlines[id - 1].basis;
    const Vec3d at = result.voxels.points[i].cast<double>() - fit.centroid;
    measured[id - 1].push_back({{basis.u.dot(at), basis.v.dot(at)},
                                fit.normal.dot(at),
                                static_cast<double>(result.voxels.count[i])});
  }
  std::vector<Places> places;
  for (const auto& of_plane : measured) places.emplace_back(of_plane, cell_m);
  return places;
}

}  // namespace planescope::planes
