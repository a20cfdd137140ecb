#include <algorithm>
#include <cmath>
#include <numeric>

#include "core/lab/synthetic/counter_random.hpp"
#include "core/lab/synthetic/rotation.hpp"
#include "core/lab/synthetic/trigonometry.hpp"
#include "core/lab/training/training_set.hpp"
#include "core/model/random.hpp"

namespace planescope::lab {
namespace {

using Indices = std::vector<std::uint32_t>;

enum Stream : std::uint64_t { kThinning = 1, kUniformNoise = 2, kGaussianNoise = 3 };

const Vec3f& any_of(const Indices& kept, const planes::LabelledCloud& cloud, Random& random) {
  return cloud.points[kept[random.integer(0, static_cast<int>(kept.size()) - 1)]];
}

void thin(Indices& kept, double least_share, std::uint64_t seed, Random& random) {
  const double share = random.uniform(least_share, 1);
  std::erase_if(kept, [&](std::uint32_t i) { return random_uniform(seed, kThinning, i) > share; });
}

void remove_clusters(Indices& kept,
                     const planes::LabelledCloud& cloud,
                     const AugmentOptions& options,
                     Random& random) {
  const std::size_t least = (kept.size() + 1) / 2;
  const int clusters = random.integer(0, options.clusters);
  for (int k = 0; k < clusters; ++k) {
    const Vec3f center = any_of(kept, cloud, random);
    const auto radius = static_cast<float>(random.uniform(0, options.cluster_radius_m));
    Indices rest = kept;
    std::erase_if(rest, [&](std::uint32_t i) {
      return (cloud.points[i] - center).squaredNorm() <= radius * radius;
    });
    if (rest.size() >= least) kept = std::move(rest);
  }
}

/// The `count` points nearest to one of them.
void crop(Indices& kept, const planes::LabelledCloud& cloud, std::size_t count, Random& random) {
  if (count == 0 || kept.size() <= count) return;
  const Vec3f center = any_of(kept, cloud, random);
  std::vector<float> distance2;
  distance2.reserve(kept.size());
  for (const std::uint32_t i : kept) distance2.push_back((cloud.points[i] - center).squaredNorm());
  std::vector<float> sorted = distance2;
  std::nth_element(sorted.begin(), sorted.begin() + static_cast<long>(count) - 1, sorted.end());
  const float limit = sorted[count - 1];
  auto at_limit = static_cast<long>(count) - std::count_if(distance2.begin(), distance2.end(),
                                                           [&](float d) { return d < limit; });
  std::size_t out = 0;
  for (std::size_t k = 0; k < kept.size(); ++k)
    if (distance2[k] < limit || (distance2[k] == limit && at_limit-- > 0)) kept[out++] = kept[k];
  kept.resize(out);
}

Mat3d random_turn(const AugmentOptions& options, Random& random) {
  const double yaw_deg = random.uniform(-options.yaw_deg, options.yaw_deg);
  const double azimuth_deg = random.uniform(0, 360);
  const Vec3d axis(cos_deg(azimuth_deg), sin_deg(azimuth_deg), 0);
  return rotation(axis, random.uniform(0, options.tilt_deg)) * rotation(Vec3d::UnitZ(), yaw_deg);
}

}  // namespace

planes::LabelledCloud augment(const planes::LabelledCloud& cloud,
                              const AugmentOptions& options,
                              std::uint64_t seed) {
  Random random(seed);
  Indices kept(cloud.points.size());
  std::iota(kept.begin(), kept.end(), 0u);
  if (options.thinning < 1) thin(kept, options.thinning, seed, random);
  planes::LabelledCloud result;
  result.kind = cloud.kind;
  if (kept.empty()) return result;
  remove_clusters(kept, cloud, options, random);
  crop(kept, cloud, static_cast<std::size_t>(options.points), random);

  const Mat3d turn = random_turn(options, random);
  const double sigma = random.uniform(0, options.gaussian_noise_m);
  result.points.reserve(kept.size());
  result.labels.reserve(kept.size());
  for (const std::uint32_t i : kept) {
    Vec3d p = turn * cloud.points[i].cast<double>();
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint64_t number = 3 * std::uint64_t{i} + static_cast<std::uint64_t>(axis);
      if (options.uniform_noise_m > 0)
        p[axis] += options.uniform_noise_m * (2 * random_uniform(seed, kUniformNoise, number) - 1);
      if (sigma > 0) p[axis] += sigma * random_normal(seed, kGaussianNoise, number);
    }
    result.points.push_back(p.cast<float>());
    result.labels.push_back(cloud.labels[i]);
  }
  return result;
}

}  // namespace planescope::lab
