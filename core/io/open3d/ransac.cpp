// Sun et al. 2023, Sec. V-C 1: "we set the maximum number of iterations to 1000 and excluded plane
// candidates with fewer than 50 points".

#include "core/io/open3d/ransac.hpp"

#include <omp.h>
#include <open3d/geometry/PointCloud.h>
#include <open3d/utility/Random.h>

#include <algorithm>
#include <mutex>
#include <numeric>

namespace planescope::open3d {
namespace {

/// Open3D's RANSAC shares its iterations out among OpenMP threads, which take random numbers in
/// whatever order they come. The setting is the calling thread's own, others keep theirs.
class OneThread {
 public:
  OneThread() { omp_set_num_threads(1); }
  ~OneThread() { omp_set_num_threads(before_); }
  OneThread(const OneThread&) = delete;
  OneThread& operator=(const OneThread&) = delete;

 private:
  int before_ = omp_get_max_threads();
};

}  // namespace

planes::FoundPlanes find_planes_ransac(std::span<const Vec3f> points,
                                       const planes::RansacOptions& options) {
  static std::mutex one_at_a_time;
  const std::scoped_lock lock(one_at_a_time);
  const OneThread one_thread;
  ::open3d::utility::random::Seed(options.seed);

  ::open3d::geometry::PointCloud rest;
  rest.points_.reserve(points.size());
  for (const Vec3f& p : points) rest.points_.push_back(p.cast<double>());
  std::vector<std::size_t> index(points.size());  // in `points`, of each point of `rest`
  std::iota(index.begin(), index.end(), std::size_t{0});

  std::vector<std::int32_t> group(points.size(), 0);
  const std::size_t min_points = std::max(options.min_points, 3);
  for (std::int32_t id = 1; rest.points_.size() >= min_points; ++id) {
    // With a probability below 1 it would stop once it is that sure of its plane; the paper's
    // speed (3.1 frames a second) is that of all the iterations.
    constexpr double kProbability = 1;
    const auto [plane, inliers] =
        rest.SegmentPlane(options.theta_pf_m, 3, options.iterations, kProbability);
    const bool spans_plane = !plane.isZero(0);  // points on one line: none, and all are inliers
    if (!spans_plane || inliers.size() < min_points) break;

    std::vector<bool> taken(index.size(), false);
    for (const std::size_t i : inliers) {
      taken[i] = true;
      group[index[i]] = id;
    }
    std::size_t kept = 0;
    for (std::size_t i = 0; i < index.size(); ++i) {
      if (taken[i]) continue;
      index[kept] = index[i];
      rest.points_[kept++] = rest.points_[i];
    }
    index.resize(kept);
    rest.points_.resize(kept);
  }
  return planes::found_planes(points, group);
}

}  // namespace planescope::open3d
