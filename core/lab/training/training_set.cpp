// Training sets and recipes: the paper's shapes (Sec. III), camera scans and augmentation.

#include "core/lab/training/training_set.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

#include "core/lab/synthetic/render_scene.hpp"
#include "core/lab/synthetic/repeatable.hpp"
#include "core/lab/synthetic/scenes.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/model/random.hpp"
#include "core/planes/cloud/cloud.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::lab {

// ---- Scans ----

namespace {

enum ScanStream : std::uint64_t { kView = 1, kCamera = 2, kTestScene = 3, kComposedTest = 104 };

bool is_worth_learning(const planes::LabeledCloud& scan) {
  constexpr std::size_t kLeastVoxels = 300;
  const auto h = std::count(scan.labels.begin(), scan.labels.end(), Label::h);
  return scan.labels.size() >= kLeastVoxels && h > 0 && h < std::ssize(scan.labels);
}

D435Model usual_camera() {
  D435Model model;
  model.color = false;
  return model;
}

/// One in ten exact, the others with half to one and a half times the usual noise.
D435Model varied_camera(std::uint64_t seed) {
  D435Model model = usual_camera();
  model.noise = random_uniform(seed, kCamera, 0) >= 0.1;
  model.disparity_sigma_px = 0.03 + 0.09 * random_uniform(seed, kCamera, 1);
  return model;
}

/// Half of them with additional errors of real cameras.
D435Model real_camera(std::uint64_t seed) {
  D435Model model = varied_camera(seed);
  if (random_uniform(seed, kCamera, 2) < 0.5) return model;
  model.bow_sigma_px = 0.12 * random_uniform(seed, kCamera, 3);
  model.bow_px = 24 + static_cast<int>(56 * random_uniform(seed, kCamera, 4));
  model.flying_from = 2 * random_uniform(seed, kCamera, 5);
  model.blind_from = 1.3 + 2 * random_uniform(seed, kCamera, 6);
  return model;
}

constexpr double kRange_m = planes::CloudOptions{}.max_range_m;

double usual_range_m(std::uint64_t /*seed*/) { return kRange_m; }

/// Half of them with the default crop of commands, the others farther.
double real_range_m(std::uint64_t seed) {
  return std::max(kRange_m, 4 * random_uniform(seed, kCamera, 7) - 0.5);
}

/// The first useful view of a composed scene.
planes::LabeledCloud scan_composed_scene(std::uint64_t seed,
                                         double voxel_size_m,
                                         D435Model (*camera)(std::uint64_t),
                                         double (*range_m)(std::uint64_t),
                                         bool mark_edges) {
  for (std::uint64_t view = 0;; ++view) {
    const std::uint64_t view_seed = random_bits(seed, kView, view);
    const Scene scene = compose_scene(view_seed);
    planes::LabeledCloud scan = make_scan(scene, camera(view_seed), voxel_size_m, view_seed,
                                          mark_edges, range_m(view_seed));
    if (is_worth_learning(scan)) return scan;
  }
}

}  // namespace

planes::LabeledCloud make_scan(const Scene& scene,
                               const D435Model& model,
                               double voxel_size_m,
                               std::uint64_t seed,
                               bool mark_edges,
                               double max_range_m) {
  FrameLabels truth;
  const Frame frame = render_scene(scene, scene.camera, model, seed, &truth);
  const planes::Cloud cloud =
      planes::make_cloud(frame, truth.gravity, {.max_range_m = max_range_m});
  const planes::VoxelCloud voxels = planes::voxelize(cloud, voxel_size_m);
  std::vector<std::uint8_t> labels;
  labels.reserve(cloud.source.size());
  for (const std::uint32_t pixel : cloud.source) labels.push_back(truth.hv.data[pixel]);

  planes::LabeledCloud scan;
  scan.kind = "scan";
  const std::vector<std::uint8_t> votes = planes::vote_labels(voxels, labels);
  for (std::size_t v = 0; v < votes.size(); ++v) {
    if (votes[v] == 0) continue;
    scan.points.push_back(voxels.points[v]);
    scan.labels.push_back(static_cast<Label>(votes[v]));
  }
  if (!mark_edges) return scan;
  std::vector<Label> measured;
  for (const std::uint8_t label : labels)
    measured.push_back(label <= 2 ? static_cast<Label>(label) : Label::unknown);
  scan.near_edge = planes::near_other_label(scan.points, scan.labels, cloud.points, measured);
  return scan;
}

planes::LabeledCloud make_training_scan(std::uint64_t seed, double voxel_size_m, bool real_errors) {
  return scan_composed_scene(seed, voxel_size_m, real_errors ? real_camera : varied_camera,
                             real_errors ? real_range_m : usual_range_m, /*mark_edges=*/false);
}

planes::LabeledCloud make_composed_test_scan(std::uint64_t seed, int index, double voxel_size_m) {
  const std::uint64_t scan_seed =
      random_bits(seed, kComposedTest, static_cast<std::uint64_t>(index));
  return scan_composed_scene(
      scan_seed, voxel_size_m, [](std::uint64_t) { return usual_camera(); }, usual_range_m,
      /*mark_edges=*/true);
}

planes::LabeledCloud make_test_scan(std::uint64_t seed, int index, double voxel_size_m) {
  const auto i = static_cast<std::uint64_t>(index);
  const std::uint64_t scan_seed = random_bits(seed, kTestScene, i);
  const Scene scene = make_scene(scene_names()[i % scene_names().size()], scan_seed);
  return make_scan(scene, usual_camera(), voxel_size_m, scan_seed, /*mark_edges=*/true);
}

std::vector<planes::LabeledCloud> make_test_scans(std::uint64_t seed,
                                                  int count,
                                                  double voxel_size_m,
                                                  int threads) {
  std::vector<planes::LabeledCloud> scans(static_cast<std::size_t>(count));
  const auto make = [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      scans[i] = make_test_scan(seed, static_cast<int>(i), voxel_size_m);
  };
  parallel_for(scans.size(), threads, make, 1);
  return scans;
}

// ---- The paper's objects (Sec. III) ----

namespace {

// Clean and axis-aligned, with sizes drawn uniformly from the paper's ranges.

planes::LabeledCloud sampled(const char* kind,
                             std::span<const Rectangle> faces,
                             int points,
                             Random& random) {
  const auto count = static_cast<std::size_t>(points);
  SurfacePoints surface = sample_surface(faces, count, Mat3d::Identity(), random);
  planes::LabeledCloud cloud{kind, std::move(surface.points), {}};
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
planes::LabeledCloud make_stairs_shape(std::uint64_t seed, int points) {
  StairsOptions options;
  options.seed = seed;
  options.points = points;
  options.random_yaw = false;
  options.min_width_m = 0.2;
  options.min_height_m = 0.08;
  const Stairs stairs = make_stairs(0, options);
  planes::LabeledCloud cloud{"stairs", stairs.cloud.points, {}};
  for (const std::uint8_t label : stairs.cloud.label)
    cloud.labels.push_back(static_cast<Label>(label));
  return cloud;
}

/// Length and width 0.1-2 m, height 0.08-0.3 m: a top and four sides. The paper does not mention a
/// floor below boxes: `on_floor` adds a frame of floor around the box, 10-50 cm wide.
planes::LabeledCloud make_box_shape(std::uint64_t seed, int points, bool on_floor) {
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
planes::LabeledCloud make_plane_shape(std::uint64_t seed, int points) {
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

planes::LabeledCloud make_cloud_of_set(const TrainingSetOptions& options, int index) {
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

std::vector<planes::LabeledCloud> make_training_set(const TrainingSetOptions& options,
                                                    int threads,
                                                    const std::function<void(int, int)>& progress) {
  assert(options.points > 0);
  const int count = options.count();
  std::vector<planes::LabeledCloud> set(static_cast<std::size_t>(count));
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

const Vec3f& any_of(const Indices& kept, const planes::LabeledCloud& cloud, Random& random) {
  return cloud.points[kept[random.integer(0, static_cast<int>(kept.size()) - 1)]];
}

void thin(Indices& kept, double least_share, std::uint64_t seed, Random& random) {
  const double share = random.uniform(least_share, 1);
  std::erase_if(kept, [&](std::uint32_t i) { return random_uniform(seed, kThinning, i) > share; });
}

void remove_clusters(Indices& kept,
                     const planes::LabeledCloud& cloud,
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
void crop(Indices& kept, const planes::LabeledCloud& cloud, std::size_t count, Random& random) {
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

planes::LabeledCloud augment(const planes::LabeledCloud& cloud,
                             const AugmentOptions& options,
                             std::uint64_t seed) {
  Random random(seed);
  Indices kept(cloud.points.size());
  std::iota(kept.begin(), kept.end(), 0u);
  if (options.thinning < 1) thin(kept, options.thinning, seed, random);
  planes::LabeledCloud result;
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

// ---- Recipes ----

namespace {

enum RecipeStream : std::uint64_t { kIsScan = 101, kWhich, kVariation, kIsUniform };

TrainingRecipe planescope_recipe() {
  TrainingRecipe recipe;
  // 1 cm would bury the smallest objects in noise, so that nothing could be learned from them.
  recipe.objects.uniform_noise_m = 0.004;
  recipe.objects.gaussian_noise_m = 0.004;
  recipe.objects.tilt_deg = 2;
  recipe.objects.thinning = 0.5;
  recipe.scans = recipe.objects;
  // Scans stay like the app's input: the camera's own noise, the grid's density, and the world's x
  // axis in the viewing direction.
  recipe.scans.uniform_noise_m = recipe.scans.gaussian_noise_m = 0;
  recipe.scans.thinning = 1;
  recipe.scans.yaw_deg = 15;
  recipe.set.planes = 50;  // a plane of any slope teaches next to nothing about edges
  recipe.set.scans = 1400;
  recipe.scan_share = 0.6;
  recipe.uniform_share = 0.15;
  return recipe;
}

TrainingRecipe real_camera_recipe() {
  TrainingRecipe recipe = planescope_recipe();
  recipe.set.real_errors = true;
  return recipe;
}

TrainingRecipe paper_recipe() {
  TrainingRecipe recipe;
  recipe.set.boxes_on_floor = 0;
  recipe.set.scans = 0;
  recipe.train.edge_weight = 1;
  return recipe;
}

}  // namespace

const std::vector<std::string>& recipe_names() {
  static const std::vector<std::string> names = {"planescope", "real-camera", "paper"};
  return names;
}

TrainingRecipe make_recipe(const std::string& name) {
  TrainingRecipe recipe;
  if (name == "planescope") {
    recipe = planescope_recipe();
  } else if (name == "real-camera") {
    recipe = real_camera_recipe();
  } else if (name == "paper") {
    recipe = paper_recipe();
  } else {
    throw Error(fmt::format("unknown recipe \"{}\"; expected one of {}", name,
                            fmt::join(recipe_names(), ", ")));
  }
  recipe.name = name;
  return recipe;
}

planes::LabeledCloud vary(const TrainingRecipe& recipe,
                          const planes::LabeledCloud& cloud,
                          std::uint64_t number) {
  const std::uint64_t seed = recipe.train.seed;
  AugmentOptions options = recipe.augmentation_of(cloud);
  const bool uniform = random_uniform(seed, kIsUniform, number) < recipe.uniform_share;
  (uniform ? options.gaussian_noise_m : options.uniform_noise_m) = 0;
  return augment(cloud, options, random_bits(seed, kVariation, number));
}

planes::LabeledCloud draw_cloud(const TrainingRecipe& recipe,
                                const std::vector<planes::LabeledCloud>& set,
                                std::uint64_t number) {
  const std::uint64_t seed = recipe.train.seed;
  const int all_objects = recipe.set.stairs + recipe.set.boxes + recipe.set.planes;
  const auto objects = static_cast<std::uint64_t>(all_objects);
  const bool scan = random_uniform(seed, kIsScan, number) < recipe.scan_share;
  const std::uint64_t first = scan ? objects : 0, count = scan ? set.size() - objects : objects;
  return vary(recipe, set[first + random_bits(seed, kWhich, number) % count], number);
}

std::vector<ValidationSet> make_validation_sets(std::uint64_t seed, int count, int threads) {
  std::vector<ValidationSet> sets;
  for (const double noise_cm : {0.0, 0.1, 0.2, 0.3}) {
    ValidationSet& set = sets.emplace_back();
    set.name = fmt::format("stairs {} cm", noise_cm);
    set.clouds.resize(static_cast<std::size_t>(count));
    const StairsOptions options{.seed = seed, .noise_m = noise_cm / 100};
    const auto make = [&](std::size_t begin, std::size_t end) {
      for (std::size_t i = begin; i < end; ++i)
        set.clouds[i] = labeled(make_stairs(static_cast<int>(i), options));
    };
    parallel_for(set.clouds.size(), threads, make, 1);
  }
  sets.push_back({"scans", make_test_scans(seed, count, 0.02, threads)});
  return sets;
}

}  // namespace planescope::lab
