#pragma once

// What the points of a plane cover of it.

#include <algorithm>
#include <span>
#include <vector>

#include "core/model/plane.hpp"
#include "core/planes/cloud/pixel_kernels.hpp"
#include "core/planes/pipeline/plane_runs.hpp"

namespace planescope::report {

/// A plane's points on it, a block at a time. Where they lie is computed anew for each visit: that
/// is quicker than to keep it, as a block stays in the cache.
class FlatPoints {
 public:
  static constexpr std::size_t kMost = 512;
  struct Block {
    std::size_t count = 0;
    double u[kMost], v[kMost];  // on the plane [m]
    double n[kMost];            // distances from it, signed [m]
  };

  /// `points` and `runs` must outlive it. The axes are u, v and n of `basis` and `normal`.
  FlatPoints(const std::vector<Vec3f>& points,
             std::span<const planes::PointRun> runs,
             const PlaneBasis& basis,
             const Vec3d& normal,
             const Vec3d& origin);

  std::size_t size() const { return size_; }

  /// In the order of the points.
  template <typename Visit>
  void visit(const Visit& visit) const {
    Vec3f members[kMost];
    Block block;
    planes::LayFlatArgs args = args_;
    args.points = members[0].data();
    args.u = block.u, args.v = block.v, args.n = block.n;
    const auto flush = [&] {
      args.count = block.count;
      kernels_.lay_flat(args);
      visit(block);
      block.count = 0;
    };
    for (const planes::PointRun& run : runs_)
      for (std::size_t begin = run.begin; begin < run.end;) {
        const std::size_t count = std::min(run.end - begin, kMost - block.count);
        std::copy_n(points_.data() + begin, count, members + block.count);
        block.count += count;
        begin += count;
        if (block.count == kMost) flush();
      }
    if (block.count > 0) flush();
  }

 private:
  const std::vector<Vec3f>& points_;
  std::span<const planes::PointRun> runs_;
  std::size_t size_ = 0;
  planes::LayFlatArgs args_;
  const planes::PixelKernels& kernels_;
};

struct Cover {
  double squares_m2 = 0;    // sum of the squared distances from the plane
  std::size_t cells = 0;    // of a grid that hold a point
  std::vector<Vec2d> hull;  // as convex_hull() of all points, bit for bit
};

Cover cover_of(const FlatPoints& points, double cell_m);

}  // namespace planescope::report
