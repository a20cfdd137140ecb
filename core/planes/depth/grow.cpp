// Moves pixels at borders between regions, and grows regions over free pixels.

#include <cmath>

#include "core/planes/depth/regions.hpp"

namespace planescope::planes {
namespace {

constexpr int kMostTries = 7;           // how often other regions may claim a pixel
constexpr double kClearlyBetter = 0.8;  // share of the misfit below which an assigned pixel
                                        // changes regions
constexpr int kPatch = 2;               // px: radius of the patch around a pixel that is evaluated
                                        // with it
constexpr double kSameSurface = 4;      // sigma: a larger step of rho separates surfaces
constexpr double kLeastRegion = 32;     // px: smallest region that grows

/// Sums over the pixels around one pixel that are on the same surface.
struct Patch {
  double n = 0, u = 0, v = 0, rho = 0;
  double misfit(const InversePlane& p) const {  // mean residual, so that noise averages out
    return std::abs(rho - p.a * u - p.b * v - p.c * n) / n;
  }
};

class Growth {
 public:
  explicit Growth(DepthSegmentation& s) : s_(s), tries_(s.image.pixels(), 0) {
    for (const DepthRegion& region : s.regions) {
      const double sigma = std::sqrt(s.noise.pixel2(region.plane));
      reach_.push_back(s.options.reach_sigma * sigma);
      same_.push_back(static_cast<float>(kSameSurface * (std::sqrt(s.noise.white2(region.plane)) +
                                                         std::sqrt(s.noise.bow2(region.plane)))));
    }
  }

  /// Breadth first from the borders, so that all regions advance evenly.
  void run() {
    const int width = s_.image.width, height = s_.image.height;
    const std::vector<std::int32_t>& region = s_.region_of;
    std::vector<std::uint32_t> front;
    front.reserve(region.size() / 4);
    for (int y = 1; y + 1 < height; ++y) append_border_pixels(region, width, y, front);
    for (std::size_t head = 0; head < front.size(); ++head) {
      const std::uint32_t i = front[head];
      const int x = static_cast<int>(i) % width, y = static_cast<int>(i) / width;
      const auto ask = [&](std::uint32_t o, int ox, int oy) {
        if (takes(region[i], o, ox, oy)) front.push_back(o);
      };
      if (x + 1 < width) ask(i + 1, x + 1, y);
      if (x > 0) ask(i - 1, x - 1, y);
      if (y + 1 < height) ask(i + width, x, y + 1);
      if (y > 0) ask(i - width, x, y - 1);
    }
  }

 private:
  bool takes(std::int32_t by, std::uint32_t o, int x, int y) {
    const float rho = s_.image.rho[o];
    const std::int32_t owner = s_.region_of[o];
    if (rho <= 0 || owner == by || tries_[o] >= kMostTries) return false;
    const InversePlane& plane = s_.regions[by].plane;
    const double u = s_.image.u(x), v = s_.image.v(y);
    if (std::abs(rho - plane.at(u, v)) > reach_[by]) return false;
    if (owner >= 0) {
      ++tries_[o];
      const Patch patch = patch_at(o, x, y, std::max(same_[by], same_[owner]));
      if (patch.misfit(plane) >= kClearlyBetter * patch.misfit(s_.regions[owner].plane))
        return false;
      s_.regions[owner].moments.remove(u, v, rho);
    }
    s_.regions[by].moments.add(u, v, rho);
    s_.region_of[o] = by;
    return true;
  }

  Patch patch_at(std::uint32_t pixel, int x, int y, float same) const {
    const int width = s_.image.width;
    const float* const rho = s_.image.rho.data();
    const float center = rho[pixel];
    Patch patch;
    for (int j = std::max(0, y - kPatch); j <= std::min(s_.image.height - 1, y + kPatch); ++j)
      for (int i = std::max(0, x - kPatch); i <= std::min(width - 1, x + kPatch); ++i) {
        const float r = rho[j * width + i];
        if (r <= 0 || std::abs(r - center) > same) continue;
        patch.n += 1, patch.u += i, patch.v += j, patch.rho += r;
      }
    patch.u += patch.n * s_.image.u(0);
    patch.v += patch.n * s_.image.v(0);
    return patch;
  }

  DepthSegmentation& s_;
  std::vector<std::uint8_t> tries_;
  std::vector<double> reach_;  // per region [1/m]
  std::vector<float> same_;    // per region
};

}  // namespace

void grow_regions(DepthSegmentation& s) {
  const std::vector<std::int32_t> before =
      s.traced.trace ? s.region_of : std::vector<std::int32_t>{};
  Growth(s).run();
  bool dropped = false;
  for (DepthRegion& region : s.regions) {
    if (!region.alive) continue;
    region.alive = region.moments.n >= kLeastRegion;
    dropped |= !region.alive;
    if (region.alive) region.plane = region.moments.fit();
  }
  if (dropped) free_pixels_of_ended(s);
  log_growth(s, before);
}

}  // namespace planescope::planes
