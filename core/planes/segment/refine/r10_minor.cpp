#include "core/planes/segment/refine/r10_minor.hpp"

#include <Eigen/Cholesky>
#include <cmath>
#include <optional>

#include "core/model/inverse_plane.hpp"
#include "core/model/plane.hpp"
#include "core/planes/segment/seen_pixels.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::planes::r10_minor {
namespace {

using Vec6d = Eigen::Matrix<double, 6, 1>;
using Mat6d = Eigen::Matrix<double, 6, 6>;

constexpr double kWidth_px = 640;  // of an image whose pixels count as they are
constexpr int kStride = 2;         // of the pixels that are fitted, along rows and columns

/// Sums for the fit of w by all products of the ray's coordinates; additive. Two in a register: the
/// lower triangle of the normal equations, with a little more, a column after the other.
class QuadricSums {
 public:
  void add(const PixelGrid::Seen& seen) {
    const double x = seen.ray.x(), y = seen.ray.y(), z = seen.ray.z();
    const double row[6] = {x * x, y * y, z * z, x * y, x * z, y * z};
    const Two pairs[3] = {{row[0], row[1]}, {row[2], row[3]}, {row[4], row[5]}};
    int k = 0;
    for (int column = 0; column < 6; ++column)
      for (int pair = column / 2; pair < 3; ++pair) squares_[k++] += row[column] * pairs[pair];
    for (int pair = 0; pair < 3; ++pair) with_w_[pair] += seen.w * pairs[pair];
  }
  /// Sum of the squares of w about the quadric, with those of w itself.
  double squares_about(double ww) const {
    Mat6d full;
    Vec6d with_w;
    int k = 0;
    for (int column = 0; column < 6; ++column)
      for (int pair = column / 2; pair < 3; ++pair, ++k)
        for (int i = 0; i < 2; ++i)
          full(2 * pair + i, column) = full(column, 2 * pair + i) = squares_[k][i];
    for (int row = 0; row < 6; ++row) with_w[row] = with_w_[row / 2][row % 2];
    const Vec6d bent = full.ldlt().solve(with_w);
    return std::max(0.0, ww - bent.dot(with_w));
  }

 private:
  using Two = double __attribute__((vector_size(16)));
  Two squares_[12] = {};
  Two with_w_[3] = {};
};

/// A plane's picture.
struct Picture {
  int pixels = 0;
  InverseSums plane;
  QuadricSums quadric;
  std::vector<Vec2d> rim;  // ends of its rows: what lies between is not on the convex hull

  struct Row {
    int y = -1, begin = 0, end = 0;
  } row;  // that it is in

  void add_rim(int y, int begin, int end) {
    if (y != row.y) {
      finish_row();
      row = {y, begin, end};
    }
    row.end = end;
  }
  void finish_row() {
    if (row.y < 0) return;
    for (const int x : {row.begin, row.end})
      for (const int y : {row.y, row.y + 1}) rim.emplace_back(x, y);
  }

  double counts_for(const Options& options) const {
    const double hull_px = polygon_area(convex_hull(rim));
    const double rms = plane.fit().rms;
    const double rms_bent =
        std::sqrt(quadric.squares_about(plane.ww()) / std::max(1, plane.count - 3));
    return pixels * std::pow(std::min(1.0, pixels / std::max(1.0, hull_px)), options.ragged) *
           std::pow(rms > 0 ? std::min(1.0, rms_bent / rms) : 1, options.curved) *
           std::pow(rms > options.calm_m ? options.calm_m / rms : 1, options.rough);
  }
};

std::vector<Picture> pictures(const SegmentState& state) {
  const PixelGrid& pixels = state.more.pixels;
  std::span<const std::int32_t> planes = state.plane_of_pixel;
  if (planes.empty()) planes = planes_of_pixels(state);
  std::vector<Picture> all(state.planes.size());
  SeenPixels rays(pixels, state.sensor);
  visit_plane_runs(pixels, planes, [&](std::int32_t k, int y, int begin, int end) {
    Picture& picture = all[k];
    picture.pixels += end - begin;
    picture.add_rim(y, begin, end);
    if (y % kStride != 0) return;
    InverseSums plane = picture.plane;  // in registers
    const std::size_t row = pixels.at(0, y);
    rays.visit(row + begin, row + end, [&](std::size_t i, const PixelGrid::Seen& seen) {
      if ((i - row) % kStride != 0) return;
      plane.add(seen.ray, seen.w);
      picture.quadric.add(seen);
    });
    picture.plane = plane;
  });
  for (Picture& picture : all) picture.finish_row();
  return all;
}

/// What the picture counts for where that is too little. Unless it is to be `exact`, its pixels are
/// told where they alone are too few: the rest only takes away.
std::optional<double> too_few_px(const Picture& picture,
                                 double scale,
                                 const Options& options,
                                 bool exact) {
  const double most = scale * scale * picture.pixels;
  if (!exact && !(most >= options.pixels)) return most;
  const double counts = scale * scale * picture.counts_for(options);
  if (counts >= options.pixels) return std::nullopt;
  return counts;
}

}  // namespace

void run(SegmentState& state, const Options& options) {
  if (!options.on || state.more.pixels.empty()) return;
  const std::vector<Picture> all = pictures(state);
  const double scale = kWidth_px / state.more.pixels.width;
  const PlanePoints members = points_by_plane(state);
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(all.size()); ++k) {
    if (!state.planes[k].alive) continue;
    const auto counts = too_few_px(all[k], scale, options, state.trace != nullptr);
    if (!counts) continue;
    log_refine(state, options, k, -1, *counts);
    drop_plane(state, k, members.of(k));
    state.minor.push_back(k);
    state.minor_points.emplace_back(members.of(k).begin(), members.of(k).end());
  }
  // What they had taken from their neighbours goes back.
  if (!state.minor.empty()) r11_pixel_borders::run(state, state.options.r11_pixel_borders);
}

}  // namespace planescope::planes::r10_minor
