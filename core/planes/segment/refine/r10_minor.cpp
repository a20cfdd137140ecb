#include "core/planes/segment/refine/r10_minor.hpp"

#include <Eigen/Cholesky>
#include <cmath>

#include "core/model/inverse_plane.hpp"
#include "core/model/plane.hpp"
#include "core/planes/segment/state.hpp"

namespace planescope::planes::r10_minor {
namespace {

using Vec6d = Eigen::Matrix<double, 6, 1>;
using Mat6d = Eigen::Matrix<double, 6, 6>;

constexpr double kWidth_px = 640;  // of an image whose pixels count as they are
constexpr int kStride = 2;         // of the pixels that are fitted, along rows and columns

/// A plane's picture.
struct Picture {
  int pixels = 0;
  InverseSums plane;
  Mat6d quadric = Mat6d::Zero();  // sums for the fit of w by all products of the ray's coordinates
  Vec6d quadric_w = Vec6d::Zero();
  std::vector<Vec2d> rim;  // ends of its rows

  void add(const PixelGrid::Seen& seen) {
    const auto& [ray, w] = seen;
    plane.add(ray, w);
    Vec6d row;
    row << ray.x() * ray.x(), ray.y() * ray.y(), ray.z() * ray.z(), ray.x() * ray.y(),
        ray.x() * ray.z(), ray.y() * ray.z();
    quadric.selfadjointView<Eigen::Lower>().rankUpdate(row);
    quadric_w += row * w;
  }

  double counts_for(const Options& options) const {
    const double hull_px = polygon_area(convex_hull(rim));
    const double rms = plane.fit().rms;
    const Mat6d full = quadric.selfadjointView<Eigen::Lower>();
    const Vec6d bent = full.ldlt().solve(quadric_w);
    const double squares = std::max(0.0, plane.ww() - bent.dot(quadric_w));
    const double rms_bent = std::sqrt(squares / std::max(1, plane.count - 3));
    return pixels * std::pow(std::min(1.0, pixels / std::max(1.0, hull_px)), options.ragged) *
           std::pow(rms > 0 ? std::min(1.0, rms_bent / rms) : 1, options.curved) *
           std::pow(rms > options.calm_m ? options.calm_m / rms : 1, options.rough);
  }
};

std::vector<Picture> pictures(const SegmentState& state) {
  const PixelGrid& pixels = state.more.pixels;
  const std::vector<std::int32_t> plane =
      state.plane_of_pixel.empty() ? planes_of_pixels(state) : state.plane_of_pixel;
  std::vector<Picture> all(state.planes.size());
  const auto add_rim = [&](std::int32_t k, int x, int y) {
    if (k < 0) return;
    all[k].rim.emplace_back(x, y);
    all[k].rim.emplace_back(x, y + 1);
  };
  for (int y = 0; y < pixels.height; ++y) {
    std::int32_t last = -1;
    for (int x = 0; x < pixels.width; ++x) {
      const std::size_t i = pixels.at(x, y);
      const std::int32_t k = plane[i];
      if (k != last) add_rim(last, x, y), add_rim(k, x, y);
      last = k;
      if (k < 0) continue;
      ++all[k].pixels;
      if (x % kStride != 0 || y % kStride != 0) continue;
      all[k].add(pixels.seen(i, state.sensor));
    }
    add_rim(last, pixels.width, y);
  }
  return all;
}

}  // namespace

void run(SegmentState& state, const Options& options) {
  if (!options.on || state.more.pixels.empty()) return;
  const std::vector<Picture> all = pictures(state);
  const double scale = kWidth_px / state.more.pixels.width;
  const PlanePoints members = points_by_plane(state);
  for (std::int32_t k = 0; k < static_cast<std::int32_t>(all.size()); ++k) {
    if (!state.planes[k].alive || scale * scale * all[k].counts_for(options) >= options.pixels)
      continue;
    log_refine(state, options, k);
    drop_plane(state, k, members.of(k));
    state.minor.push_back(k);
    state.minor_points.emplace_back(members.of(k).begin(), members.of(k).end());
  }
  // What they had taken from their neighbours goes back.
  if (!state.minor.empty()) r11_pixel_borders::run(state, state.options.r11_pixel_borders);
}

}  // namespace planescope::planes::r10_minor
