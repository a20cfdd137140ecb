// Assigns plane colors: matches planes between frames and separates neighbors.

#include "render/plane_colors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <set>
#include <tuple>

#include "core/model/plane.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "render/scenes.hpp"

namespace planescope::render {

// ---- Matching planes of two frames ----

namespace {

constexpr double kMaxCells = 4800;    // per image: 8 x 8 pixels each for VGA
constexpr int kTouchingShare = 80;    // planes touch within 1/80 of the image's width
constexpr double kCloudCell_m = 0.1;  // cell edge
// Farther clouds (map coordinates) are shifted to their center.
constexpr double kFarFromSensor_m = 100;
constexpr double kDeg = std::numbers::pi / 180;

// Overlapping planes: allowed differences between neighboring frames of a hand-held camera while
// its motion is unknown.
constexpr double kOverlapAngle_deg = 15, kOverlapOffset_m = 0.12;
constexpr double kSlack =
    2;  // limits grow by a factor of 1 + kSlack if planes cover the same cells
// Planes compared after motion compensation: its error plus the noise of both fits.
constexpr double kMovedAngle_deg = 6, kMovedOffset_m = 0.05, kMovedOffsetShare = 0.02;
constexpr double kRadii = 2, kRoom_m = 0.1;  // allowed distance of centroids in the plane
constexpr double kPieceShare = 0.5;          // smallest share of a piece's cells on the plane it
                                             // was part of
// Motion: standard deviations of a plane's normal and offset, and the prior for directions not
// determined by any plane.
constexpr double kNormalSigma_deg = 1, kOffsetSigma_m = 0.01;
constexpr double kTurnSigma_deg = 5, kShiftSigma_m = 0.05;

using Cells = std::vector<PlaneImage::Cell>;

/// Plane id per pixel; 0: none.
std::vector<std::int32_t> pixel_ids(const planes::Cloud& cloud,
                                    std::span<const std::int32_t> plane_of) {
  std::vector<std::int32_t> ids(static_cast<std::size_t>(cloud.width) * cloud.height, 0);
  for (std::size_t i = 0; i < plane_of.size(); ++i)
    if (plane_of[i] > 0) ids[cloud.source[i]] = plane_of[i];
  return ids;
}

Cells image_cells(const std::vector<std::int32_t>& ids, int width, int height) {
  const int step =
      std::max(1, static_cast<int>(std::ceil(std::sqrt(width * double{1} * height / kMaxCells))));
  Cells cells;
  std::uint32_t at = 0;
  for (int y = step / 2; y < height; y += step)
    for (int x = step / 2; x < width; x += step, ++at)
      if (const std::int32_t id = ids[static_cast<std::size_t>(y) * width + x]; id > 0)
        cells.push_back({at, id});
  return cells;
}

void insert_pair(std::set<std::pair<int, int>>& pairs, int a, int b) {
  if (a != b) pairs.emplace(std::min(a, b), std::max(a, b));
}

std::set<std::pair<int, int>> touching_in_image(const std::vector<std::int32_t>& ids,
                                                int width,
                                                int height) {
  const int reach = std::max(2, width / kTouchingShare);
  std::set<std::pair<int, int>> pairs;
  const auto scan = [&](int lines, int length, int line_step, int step) {
    for (int line = 0; line < lines; ++line) {
      int last = 0, last_at = 0;
      std::size_t pixel = static_cast<std::size_t>(line) * line_step;
      for (int at = 0; at < length; ++at, pixel += static_cast<std::size_t>(step)) {
        const int id = ids[pixel];
        if (id == 0) continue;
        if (last > 0 && last != id && at - last_at <= reach) insert_pair(pairs, last, id);
        last = id;
        last_at = at;
      }
    }
  };
  scan(height, width, width, 1);
  scan(width, height, 1, width);
  return pairs;
}

// Cells of space use 10 bits per axis, and wrap around beyond 100 m.
std::uint32_t space_cell(const Eigen::Vector3i& c) {
  const auto low = [](int i) { return static_cast<std::uint32_t>(i) & 0x3FF; };
  return low(c.z()) << 20 | low(c.y()) << 10 | low(c.x());
}
Eigen::Vector3i of_space_cell(std::uint32_t at) {
  return {static_cast<int>(at & 0x3FF), static_cast<int>(at >> 10 & 0x3FF),
          static_cast<int>(at >> 20)};
}

Cells space_cells(const planes::Cloud& cloud,
                  std::span<const std::int32_t> plane_of,
                  const Pose& T_sensor_cloud) {
  Cells cells;
  for (std::size_t i = 0; i < plane_of.size(); ++i) {
    if (plane_of[i] <= 0) continue;
    const Vec3d p = T_sensor_cloud * cloud.points[i].cast<double>() / kCloudCell_m;
    const PlaneImage::Cell cell{space_cell(p.array().floor().cast<int>()), plane_of[i]};
    if (cells.empty() || cells.back() != cell) cells.push_back(cell);
  }
  std::ranges::sort(cells);
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

/// Calls visit(a, b) with the planes of each common cell, in cell order.
template <typename Visit>
void for_shared_cells(const Cells& a, const Cells& b, const Visit& visit) {
  auto from = b.begin();
  for (const PlaneImage::Cell& cell : a) {
    while (from != b.end() && from->at < cell.at) ++from;
    for (auto at = from; at != b.end() && at->at == cell.at; ++at) visit(cell.plane, at->plane);
  }
}

std::set<std::pair<int, int>> touching_in_space(const Cells& cells) {
  std::set<std::pair<int, int>> pairs;
  for (int shift = 0; shift < 14; ++shift) {  // the cell itself and half of its 26 neighbors
    const Eigen::Vector3i by(shift % 3 - 1, shift / 3 % 3 - 1, shift / 9 - 1);
    Cells moved = cells;
    for (PlaneImage::Cell& cell : moved) cell.at = space_cell(of_space_cell(cell.at) + by);
    std::ranges::sort(moved);
    for_shared_cells(moved, cells, [&](int a, int b) { insert_pair(pairs, a, b); });
  }
  return pairs;
}

/// The larger of the distances between each plane's centroid and the other plane.
double gap_m(const PlaneInView& a, const PlaneInView& b) {
  const Vec3d apart = b.centroid - a.centroid;
  return std::max(std::abs(a.normal.dot(apart)), std::abs(b.normal.dot(apart)));
}

/// Number of cells by plane id - 1.
std::vector<double> cells_of(const PlaneImage& image) {
  std::vector<double> count(image.planes.size(), 0);
  for (const PlaneImage::Cell& cell : image.cells) ++count[cell.plane - 1];
  return count;
}

PlaneInView plane_in_view(const Moments& moments, const Pose& T_sensor_cloud) {
  PlaneInView plane;
  plane.size = static_cast<std::size_t>(moments.count);
  if (plane.size < 3) return plane;
  const PlaneFit fit = fit_plane(moments);
  plane.normal = T_sensor_cloud.linear() * fit.normal;
  plane.centroid = T_sensor_cloud * fit.centroid;
  plane.offset_m = plane.normal.dot(plane.centroid);
  plane.radius_m = std::sqrt((fit.eigenvalues[1] + fit.eigenvalues[2]) / fit.count);
  return plane;
}

double offset_apart_m(const PlaneInView& a, const PlaneInView& b) {
  return std::abs(a.offset_m - std::copysign(b.offset_m, b.offset_m * a.normal.dot(b.normal)));
}

/// Small motion of the sensor that maps matched planes of `before` to those of `now`: least squares
/// with a prior. A normal changes by w x n, an offset by n . t.
Pose motion_of(const PlaneImage& before, const PlaneImage& now, const std::vector<int>& before_of) {
  Mat3d turn = Mat3d::Identity() / std::pow(kTurnSigma_deg * kDeg, 2);
  Mat3d shift = Mat3d::Identity() / std::pow(kShiftSigma_m, 2);
  Vec3d turn_by = Vec3d::Zero(), shift_by = Vec3d::Zero();
  for (std::size_t i = 0; i < before_of.size(); ++i) {
    if (before_of[i] == 0) continue;
    const PlaneInView& a = before.planes[static_cast<std::size_t>(before_of[i]) - 1];
    const PlaneInView& b = now.planes[i];
    // Ignore clutter that is fitted differently in each frame.
    if (planes::plane_angle_deg(a.normal, b.normal) > kOverlapAngle_deg ||
        offset_apart_m(a, b) > kOverlapOffset_m)
      continue;
    const double side = a.normal.dot(b.normal) < 0 ? -1 : 1;
    const Vec3d normal = side * b.normal;
    // Larger planes are more precise, but no single plane should dominate.
    const double weight = std::sqrt(static_cast<double>(std::min(a.size, b.size)) / 1000.0);
    const double w_n = weight / std::pow(kNormalSigma_deg * kDeg, 2);
    const double w_d = weight / std::pow(kOffsetSigma_m, 2);
    turn += w_n * (Mat3d::Identity() - a.normal * a.normal.transpose());
    turn_by += w_n * a.normal.cross(normal);
    shift += w_d * normal * normal.transpose();
    shift_by += w_d * (side * b.offset_m - a.offset_m) * normal;
  }
  const Vec3d w = turn.ldlt().solve(turn_by);
  Pose motion = Pose::Identity();
  if (w.norm() > 1e-12)
    motion.linear() = Eigen::AngleAxisd(w.norm(), w.normalized()).toRotationMatrix();
  motion.translation() = shift.ldlt().solve(shift_by);
  return motion;
}

/// Transforms a plane to another frame.
PlaneInView moved(PlaneInView plane, const Pose& T) {
  plane.normal = T.linear() * plane.normal;
  plane.centroid = T * plane.centroid;
  plane.offset_m += plane.normal.dot(T.translation());
  return plane;
}

}  // namespace

PlaneImage plane_image(const planes::Cloud& cloud,
                       std::span<const std::int32_t> plane_of,
                       std::size_t count) {
  PlaneImage image;
  std::vector<Moments> moments(count);
  for (std::size_t i = 0; i < plane_of.size(); ++i)
    if (plane_of[i] > 0)
      moments[static_cast<std::size_t>(plane_of[i]) - 1].add(cloud.points[i].cast<double>());
  Pose T_sensor_cloud = cloud.T_world_sensor.inverse();
  if (cloud.origin.norm() < kFarFromSensor_m)
    T_sensor_cloud.translation() += T_sensor_cloud.linear() * cloud.origin;
  for (const Moments& of : moments) image.planes.push_back(plane_in_view(of, T_sensor_cloud));

  std::set<std::pair<int, int>> touching;
  if (cloud.width > 0) {
    const std::vector<std::int32_t> ids = pixel_ids(cloud, plane_of);
    image.cells = image_cells(ids, cloud.width, cloud.height);
    touching = touching_in_image(ids, cloud.width, cloud.height);
  } else {
    image.cells = space_cells(cloud, plane_of, T_sensor_cloud);
    touching = touching_in_space(image.cells);
  }
  image.touching.assign(touching.begin(), touching.end());
  return image;
}

PlaneImage plane_image(const planes::FrameResult& result) {
  return plane_image(result.cloud, result.plane_of, result.segmentation.planes.size());
}

PlaneImage plane_image(const debug::Run& run) {
  return plane_image(run.subject->prepared.cloud, run.plane_of, run.segmentation.planes.size());
}

PlaneMatch match_planes(const PlaneImage& before, const PlaneImage& now) {
  const std::size_t rows = before.planes.size(), columns = now.planes.size();
  PlaneMatch match;
  match.before_of.assign(columns, 0);
  match.piece_of.assign(columns, 0);
  std::vector<double> shared(rows * columns, 0);
  const std::vector<double> size_before = cells_of(before), size_now = cells_of(now);
  for_shared_cells(before.cells, now.cells, [&](int b, int n) {
    ++shared[(static_cast<std::size_t>(b) - 1) * columns + static_cast<std::size_t>(n) - 1];
  });
  const auto assign = [&](const std::vector<double>& value) {
    const std::vector<int> column_of =
        planes::best_assignment(value, static_cast<int>(rows), static_cast<int>(columns));
    for (std::size_t b = 0; b < rows; ++b)
      if (column_of[b] >= 0)
        match.before_of[static_cast<std::size_t>(column_of[b])] = static_cast<int>(b) + 1;
  };

  // First match overlapping planes, so that as many cells as possible keep their plane.
  std::vector<double> value(rows * columns, 0);
  for (std::size_t b = 0; b < rows; ++b)
    for (std::size_t n = 0; n < columns; ++n) {
      const PlaneInView &from = before.planes[b], &to = now.planes[n];
      const double both = shared[b * columns + n];
      if (both == 0) continue;
      const double slack = 1 + kSlack * both / (size_before[b] + size_now[n] - both);
      const double angle =
          planes::plane_angle_deg(from.normal, to.normal) / (slack * kOverlapAngle_deg);
      const double offset =
          std::min(offset_apart_m(from, to), gap_m(from, to)) / (slack * kOverlapOffset_m);
      if (angle > 1 || offset > 1) continue;
      value[b * columns + n] = both * (2 - angle * angle - offset * offset) / 2;
    }
  assign(value);
  match.T_now_before = motion_of(before, now, match.before_of);

  // Then match the rest after compensating the camera's motion.
  std::vector<std::uint8_t> taken(rows, 0);
  for (const int b : match.before_of)
    if (b > 0) taken[b - 1] = 1;
  std::vector<double> near(rows * columns, 0);
  for (std::size_t b = 0; b < rows; ++b) {
    const PlaneInView from = moved(before.planes[b], match.T_now_before);
    for (std::size_t n = 0; n < columns; ++n) {
      const PlaneInView& to = now.planes[n];
      if (match.before_of[n] > 0 || from.size == 0 || to.size == 0) continue;
      const double angle = planes::plane_angle_deg(from.normal, to.normal) / kMovedAngle_deg;
      const double offset =
          offset_apart_m(from, to) / (kMovedOffset_m + kMovedOffsetShare * std::abs(to.offset_m));
      const double apart =
          (from.centroid - to.centroid).norm() / (kRadii * (from.radius_m + to.radius_m) + kRoom_m);
      const double worst = std::max({angle, offset, apart});
      if (worst > 1) continue;
      if (!taken[b])
        near[b * columns + n] = 2 - worst;
      else if (shared[b * columns + n] >= kPieceShare * size_now[n])
        match.piece_of[n] = static_cast<int>(b) + 1;
    }
  }
  assign(near);
  for (std::size_t n = 0; n < columns; ++n)
    if (match.before_of[n] > 0) match.piece_of[n] = 0;
  return match;
}

// ---- Colors ----

namespace {

constexpr std::size_t kColors = kPlaneColors;

std::vector<std::vector<int>> neighbors_of(const PlaneImage& planes) {
  std::vector<std::vector<int>> neighbors(planes.planes.size());
  for (const auto& [a, b] : planes.touching) {
    neighbors[a - 1].push_back(b - 1);
    neighbors[b - 1].push_back(a - 1);
  }
  return neighbors;
}

/// Color for a plane without one, see settle_colors(). Ties go to the first in the palette.
int new_color(const PlaneImage& planes,
              const std::vector<int>& colors,
              const std::vector<int>& neighbors,
              const std::array<bool, kColors>& reserved) {
  struct Use {
    std::size_t touching = 0, anywhere = 0;
    bool reserved = false;
    auto operator<=>(const Use&) const = default;
  };
  std::array<Use, kColors> uses;
  for (std::size_t i = 0; i < colors.size(); ++i)
    if (colors[i] > 0) uses[static_cast<std::size_t>(colors[i]) - 1].anywhere += 1;
  for (const int i : neighbors)
    if (const int color = colors[i]; color > 0) uses[color - 1].touching += planes.planes[i].size;
  for (std::size_t c = 0; c < kColors; ++c) uses[c].reserved = reserved[c];
  return static_cast<int>(std::ranges::min_element(uses) - uses.begin()) + 1;
}

}  // namespace

std::vector<int> ColoredPlanes::own_colors() const {
  const auto own = std::ranges::count(unseen, 0);
  return {colors.begin(), colors.begin() + own};
}

std::vector<int> settle_colors(const PlaneImage& planes,
                               std::vector<int> wanted,
                               const std::vector<int>& reserved) {
  wanted.resize(planes.planes.size(), 0);
  for (int& color : wanted)
    if (color > 0) color = (color - 1) % kPlaneColors + 1;
  std::array<bool, kColors> is_reserved{};
  for (const int color : reserved) is_reserved[color - 1] = true;
  const std::vector<std::vector<int>> neighbors = neighbors_of(planes);
  std::vector<int> by_size(wanted.size());
  std::iota(by_size.begin(), by_size.end(), 0);
  const auto size_of = [&](int i) { return planes.planes[i].size; };
  std::ranges::stable_sort(by_size, std::greater(), size_of);

  std::vector<int> colors(wanted.size(), 0);
  const auto touches = [&](int i, int color) {
    return std::ranges::any_of(neighbors[i], [&](int other) { return colors[other] == color; });
  };
  for (const int i : by_size)
    if (const int color = wanted[i]; color > 0 && !touches(i, color)) colors[i] = color;
  for (const int i : by_size) {
    int& color = colors[i];
    if (color > 0) continue;
    const int found = new_color(planes, colors, neighbors[i], is_reserved);
    // Smaller neighbors with that color lose it, and get another one later.
    for (const int other : neighbors[i])
      if (int& theirs = colors[other];
          theirs == found && std::tuple(size_of(i), other) > std::tuple(size_of(other), i))
        theirs = 0;
    color = found;
  }
  return colors;
}

ColoredPlanes color_planes(PlaneImage now, const ColoredPlanes* before) {
  ColoredPlanes colored;
  colored.image = std::move(now);
  const std::size_t own = colored.image.planes.size();
  colored.unseen.assign(own, 0);
  if (!before) {
    colored.colors = settle_colors(colored.image, {});
    return colored;
  }
  const PlaneMatch match = match_planes(before->image, colored.image);
  std::vector<int> wanted(own, 0);
  std::vector<std::uint8_t> goes_on(before->colors.size(), 0);
  for (std::size_t i = 0; i < own; ++i) {
    const int from = match.before_of[i] > 0 ? match.before_of[i] : match.piece_of[i];
    if (from == 0) continue;
    wanted[i] = before->colors[from - 1];
    goes_on[from - 1] = 1;
  }
  std::vector<int> remembered;
  std::vector<PlaneInView> lost;
  for (std::size_t b = 0; b < goes_on.size(); ++b) {
    if (goes_on[b] || before->unseen[b] >= kRememberedFrames) continue;
    remembered.push_back(before->colors[b]);
    colored.unseen.push_back(before->unseen[b] + 1);
    lost.push_back(moved(before->image.planes[b], match.T_now_before));
  }
  colored.colors = settle_colors(colored.image, std::move(wanted), remembered);
  colored.image.planes.insert(colored.image.planes.end(), lost.begin(), lost.end());
  colored.colors.insert(colored.colors.end(), remembered.begin(), remembered.end());
  return colored;
}

std::vector<int> first_colors(const planes::FrameResult& result) {
  return settle_colors(plane_image(result), {});
}

std::vector<int> true_plane_colors(const PlaneImage& truth,
                                   std::span<const int> found_of,
                                   std::span<const int> colors) {
  std::vector<int> wanted;
  for (const int found : found_of) wanted.push_back(found == 0 ? 0 : color_id_of(found, colors));
  return settle_colors(truth, std::move(wanted));
}

std::vector<int> trace_colors(const debug::Run& run, std::span<const int> colors) {
  std::vector<int> others;
  for (int color = 1; color <= kPlaneColors; ++color)
    if (std::ranges::find(colors, color) == colors.end()) others.push_back(color);
  std::vector<int> of_trace;
  std::size_t passing = 0;
  for (std::int32_t plane = 0; plane < run.timeline.plane_count(); ++plane) {
    const std::int32_t id = run.timeline.result_of_plane(plane);
    if (id > 0)
      of_trace.push_back(color_id_of(id, colors));
    else
      of_trace.push_back(others.empty() ? plane + 1 : others[passing++ % others.size()]);
  }
  return of_trace;
}

}  // namespace planescope::render
