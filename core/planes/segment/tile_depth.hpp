#pragma once

// What was measured in a tile and around it, as far as windows about its pixels reach: a coordinate
// at a time and near each other, for what is asked of all planes that are near the tile.

#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "core/model/plane.hpp"
#include "core/planes/segment/depth_kernels.hpp"
#include "core/planes/segment/pixel_reach.hpp"
#include "core/planes/segment/tile_sets.hpp"
#include "core/planes/segment/window_sums.hpp"

namespace planescope::planes {

class TileDepth {
 public:
  /// `plane`: per pixel of the image, that of its point. Windows are of 2 half + 1 pixels.
  void load(const PixelGrid& pixels,
            const PixelReach& reach,
            std::span<const std::int32_t> plane,
            const Rect& tile,
            int half) {
    rect_ = pixels.around(tile, half);
    tile_ = tile;
    stride_ = (rect_.width() + kPixelGroup - 1) / kPixelGroup * kPixelGroup;
    // A group may begin at any pixel of the last row.
    const std::size_t size = static_cast<std::size_t>(stride_) * rect_.height() + kPixelGroup;
    for (std::vector<double>* values : {&x_, &y_, &z_, &tau_m_}) values->resize(size);
    plane_.resize(size);
    measured_.start(rect_.width(), rect_.height(), half);
    most_tau_m_ = 0;
    for (int y = rect_.y0; y < rect_.y1; ++y) load_row(pixels, reach, plane, y);
    for (int y = tile.y0; y < tile.y1; ++y) {
      measured_.move_to(y - rect_.y0);
      for (int x = tile.x0; x < tile.x1; ++x)
        in_window_[in_tile(x, y)] = measured_.at(x - rect_.x0);
    }
  }

  double most_tau_m() const { return most_tau_m_; }
  double tau_m(int x, int y) const { return tau_m_[at(x, y)]; }
  double distance_m(const PlaneFit& fit, int x, int y) const {
    const std::size_t i = at(x, y);
    return fit.distance_m({x_[i], y_[i], z_[i]});
  }
  /// Measured pixels in the window about a pixel of the tile.
  int measured_in_window(int x, int y) const { return in_window_[in_tile(x, y)]; }
  /// From a pixel on.
  PixelRow row(int x, int y) const {
    const std::size_t i = at(x, y);
    return {&x_[i], &y_[i], &z_[i], &tau_m_[i], &plane_[i]};
  }

 private:
  void load_row(const PixelGrid& pixels,
                const PixelReach& reach,
                std::span<const std::int32_t> plane,
                int y) {
    const std::size_t from = pixels.at(rect_.x0, y), to = at(rect_.x0, y);
    const int width = rect_.width();
    const float* p = pixels.measured[from].data();
    double *x = &x_[to], *y_of = &y_[to], *z = &z_[to];
    for (int i = 0; i < width; ++i, p += 3) x[i] = p[0], y_of[i] = p[1], z[i] = p[2];
    const double* tau_m = &reach.tau_m[from];
    std::copy(tau_m, tau_m + width, &tau_m_[to]);
    std::copy(&plane[from], &plane[from] + width, &plane_[to]);
    std::int32_t* measured = measured_.row(y - rect_.y0);
    double most = most_tau_m_;
    for (int i = 0; i < width; ++i) {
      measured[i] = tau_m[i] > 0 ? 1 : 0;
      most = tau_m[i] > most ? tau_m[i] : most;
    }
    most_tau_m_ = most;
  }
  std::size_t at(int x, int y) const {
    return static_cast<std::size_t>(y - rect_.y0) * stride_ + (x - rect_.x0);
  }
  std::size_t in_tile(int x, int y) const {
    return static_cast<std::size_t>(y - tile_.y0) * kTile + (x - tile_.x0);
  }

  Rect rect_, tile_;
  int stride_ = 0;
  double most_tau_m_ = 0;
  std::vector<double> x_, y_, z_, tau_m_;  // per pixel of the rectangle
  std::vector<std::int32_t> plane_;
  WindowSums<std::int32_t> measured_;
  std::array<std::int32_t, static_cast<std::size_t>(kTile)* kTile> in_window_ = {};
};

}  // namespace planescope::planes
