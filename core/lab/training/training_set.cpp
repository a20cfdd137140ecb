#include "core/lab/training/training_set.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "core/lab/synthetic/repeatable.hpp"
#include "core/lab/synthetic/scan.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/lab/synthetic/surface_points.hpp"
#include "core/model/parallel.hpp"
#include "core/model/random.hpp"

namespace planescope::lab {

// ---- The paper's objects (Sec. III) ----

namespace {

// Clean and axis-aligned, their sizes drawn uniformly from the paper's ranges.

planes::LabelledCloud sampled(const char* kind,
                              std::span<const Rectangle> faces,
                              int points,
                              Random& random) {
  const auto count = static_cast<std::size_t>(points);
  SurfacePoints surface = sample_surface(faces, count, Mat3d::Identity(), random);
  planes::LabelledCloud cloud{kind, std::move(surface.points), {}};
  for (const std::uint32_t face : surface.rectangle)
    cloud.labels.push_back(label_of_normal(faces[face].normal));
  return cloud;
}

/// A frame around [0, length] x [0, width].
void add_floor(std::vector<Rectangle>& faces, double length, double width, double margin) {
  const Vec3d along(length + 2 * margin, 0, 0), across(0, width, 0);
  const Vec3d x(margin, 0, 0), y(0, margin, 0), up = Vec3d::UnitZ();
  faces.push_back({{-margin, -margin, 0}, along, y, up});
  faces.push_back({{-margin, width, 0}, along, y, up});
  faces.push_back({{-margin, 0, 0}, x, across, up});
  faces.push_back({{length, 0, 0}, x, across, up});
}

/// 2 to 6 steps of length 0.2-0.4 m, width 0.2-1.5 m and height 0.08-0.3 m.
planes::LabelledCloud make_stairs_shape(std::uint64_t seed, int points) {
  StairsOptions options;
  options.seed = seed;
  options.points = points;
  options.random_yaw = false;
  options.min_width_m = 0.2;
  options.min_height_m = 0.08;
  const Stairs stairs = make_stairs(0, options);
  planes::LabelledCloud cloud{"stairs", stairs.cloud.points, {}};
  for (const std::uint8_t label : stairs.cloud.label)
    cloud.labels.push_back(static_cast<Label>(label));
  return cloud;
}

/// Length and width 0.1-2 m, height 0.08-0.3 m: a top and four sides. The paper does not say what
/// boxes stand on: `on_floor` lays floor around it, 10-50 cm wide.
planes::LabelledCloud make_box_shape(std::uint64_t seed, int points, bool on_floor) {
  Random random(seed);
  const double length = random.uniform(0.1, 2), width = random.uniform(0.1, 2);
  const double height = random.uniform(0.08, 0.3);
  const Vec3d along(length, 0, 0), across(0, width, 0), up(0, 0, height);
  const Vec3d origin = Vec3d::Zero(), x = Vec3d::UnitX(), y = Vec3d::UnitY();
  std::vector<Rectangle> faces = {{up, along, across, Vec3d::UnitZ()},
                                  {origin, along, up, -y},
                                  {across, along, up, y},
                                  {origin, across, up, -x},
                                  {along, across, up, x}};
  if (on_floor) add_floor(faces, length, width, random.uniform(0.1, 0.5));
  return sampled("box", faces, points, random);
}

/// Length and width 0.1-2 m, two edges level, the normal's z component uniform in [-1, 1].
planes::LabelledCloud make_plane_shape(std::uint64_t seed, int points) {
  Random random(seed);
  const double length = random.uniform(0.1, 2), width = random.uniform(0.1, 2);
  const double normal_z = random.uniform(-1, 1), azimuth_deg = random.uniform(0, 360);
  const Vec3d level(-sin_deg(azimuth_deg), cos_deg(azimuth_deg), 0);
  const Vec3d ahead(level.y(), -level.x(), 0);
  const Vec3d normal = std::sqrt(1 - normal_z * normal_z) * ahead + normal_z * Vec3d::UnitZ();
  const Rectangle face{Vec3d::Zero(), length * level, width * normal.cross(level), normal};
  return sampled("plane", {&face, 1}, points, random);
}

// ---- The set ----

enum Kind : std::uint64_t { kStairs = 1, kBox = 2, kPlane = 3, kScan = 4 };

planes::LabelledCloud make_cloud_of_set(const TrainingSetOptions& options, int index) {
  const auto seed = [&](Kind kind) {
    return random_bits(options.seed, kind, static_cast<std::uint64_t>(index));
  };
  if (index < options.stairs) return make_stairs_shape(seed(kStairs), options.points);
  index -= options.stairs;
  if (index < options.boxes) {
    const bool on_floor = random_uniform(seed(kBox), 0, 0) < options.boxes_on_floor;
    return make_box_shape(seed(kBox), options.points, on_floor);
  }
  index -= options.boxes;
  if (index < options.planes) return make_plane_shape(seed(kPlane), options.points);
  index -= options.planes;
  return make_training_scan(seed(kScan), options.voxel_size_m, options.real_errors);
}

}  // namespace

std::vector<planes::LabelledCloud> make_training_set(
    const TrainingSetOptions& options, int threads, const std::function<void(int, int)>& progress) {
  assert(options.points > 0);
  const int count = options.count();
  std::vector<planes::LabelledCloud> set(static_cast<std::size_t>(count));
  const auto make = [&](int i) {
    set[static_cast<std::size_t>(i)] = make_cloud_of_set(options, i);
  };
  work_through(count, threads, make, progress);
  return set;
}

// ---- Augmentation ----

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
