#pragma once

// Training data of the classifier: the paper's staircases, boxes and planes (Sec. III), and views
// of scenes of the same shapes through the camera model; and recipes, which define a whole
// training: its data, augmentation and loss.

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "core/lab/synthetic/d435.hpp"
#include "core/lab/synthetic/scene.hpp"
#include "core/lab/training/train.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/cloud/cloud.hpp"

namespace planescope::lab {

// ---- Scans ----

/// The classifier's input for a scene: its view through the camera with the scene's pose, leveled
/// by the true gravity, within `max_range_m` of depth, on a voxel grid. A voxel has the label of
/// most of its pixels; voxels of curved surfaces are omitted. `mark_edges` also marks voxels near
/// an edge, within 2 cm of a measured pixel of the other label. The seed affects only the noise.
planes::LabeledCloud make_scan(const Scene& scene,
                               const D435Model& model,
                               double voxel_size_m,
                               std::uint64_t seed,
                               bool mark_edges = false,
                               double max_range_m = planes::CloudOptions{}.max_range_m);

/// A view of a composed scene with varying camera noise. With `real_errors`, half of the noisy
/// views have bows, flying pixels and holes, and half of all views reach farther than the usual
/// crop. Views that show next to nothing, or only one label, are rejected.
planes::LabeledCloud make_training_scan(std::uint64_t seed,
                                        double voxel_size_m,
                                        bool real_errors = false);

/// Held out from training, with the unmodified camera: a view of a composed scene like those in
/// training, and one of the named scenes, cycling by `index`.
planes::LabeledCloud make_composed_test_scan(std::uint64_t seed,
                                             int index,
                                             double voxel_size_m = 0.02);
planes::LabeledCloud make_test_scan(std::uint64_t seed, int index, double voxel_size_m = 0.02);

/// make_test_scan() of 0 to count - 1.
std::vector<planes::LabeledCloud> make_test_scans(std::uint64_t seed,
                                                  int count,
                                                  double voxel_size_m = 0.02,
                                                  int threads = 1);

// ---- The set ----

struct TrainingSetOptions {
  std::uint64_t seed = 1;
  int stairs = 200, boxes = 200, planes = 200;  // whole objects, the paper's ranges
  double boxes_on_floor = 0.5;                  // share of boxes on a piece of floor
  int scans = 300;                              // views through the camera, on a voxel grid
  int points = 8192;                            // of each object, evenly spread
  double voxel_size_m = 0.02;                   // of the scans
  bool real_errors = false;  // of the scans: errors of real cameras, and farther views

  int count() const { return stairs + boxes + planes + scans; }
};

/// Clean axis-aligned objects, then noisy scans, in the order of the options. Each depends only on
/// the seed, its kind and its number. `progress(done, all)` is called on the caller's thread; it
/// may be empty and may throw to stop.
std::vector<planes::LabeledCloud> make_training_set(
    const TrainingSetOptions& options,
    int threads,
    const std::function<void(int, int)>& progress = {});

struct AugmentOptions {
  double uniform_noise_m = 0.01;  // maximum, either way, on every coordinate; the paper's +-1 cm
  double gaussian_noise_m = 0;    // maximum standard deviation, drawn for each cloud
  int clusters = 4;               // maximum number of round holes, while half of the points remain
  double cluster_radius_m = 0.1;  // maximum
  double tilt_deg = 0;            // maximum angle off level, about a random horizontal axis
  int points = 2048;              // maximum kept: the nearest ones to a random point; 0 all
  double thinning = 1;            // keeps a random share of the points, at least this one
  double yaw_deg = 180;           // maximum rotation about z, either way
};

/// A new version of a cloud for one step of training, in the same order; every point keeps its
/// label. Deterministic for a seed.
planes::LabeledCloud augment(const planes::LabeledCloud& cloud,
                             const AugmentOptions& options,
                             std::uint64_t seed);

// ---- Recipes ----

struct TrainingRecipe {
  std::string name;
  TrainOptions train;
  TrainingSetOptions set;
  AugmentOptions objects;  // variation of a cloud each time it is drawn
  AugmentOptions scans;
  double scan_share = 0;     // of the clouds drawn
  double uniform_share = 1;  // of the objects drawn: with uniform noise, the others with Gaussian

  const AugmentOptions& augmentation_of(const planes::LabeledCloud& cloud) const {
    return cloud.kind == "scan" ? scans : objects;
  }
};

/// "planescope", the default: more than half of it scans, mixed noise, and a loss with more weight
/// near edges. "real-camera": the same, with errors of real cameras in scans, also beyond the crop.
/// "paper": the text of Sec. III, only objects, plain cross-entropy.
const std::vector<std::string>& recipe_names();

/// Throws Error that lists the recipes.
TrainingRecipe make_recipe(const std::string& name);

/// Varies a cloud of the recipe's set for the step that draws cloud `number`.
planes::LabeledCloud vary(const TrainingRecipe& recipe,
                          const planes::LabeledCloud& cloud,
                          std::uint64_t number);

/// Cloud `number` of a training with this recipe: one of its set, varied.
planes::LabeledCloud draw_cloud(const TrainingRecipe& recipe,
                                const std::vector<planes::LabeledCloud>& set,
                                std::uint64_t number);

/// Clouds that no recipe trains on.
struct ValidationSet {
  std::string name;
  std::vector<planes::LabeledCloud> clouds;
};
/// Stairs of 8192 points with 0, 0.1, 0.2 and 0.3 cm of noise, `count` of each, and as many scans.
std::vector<ValidationSet> make_validation_sets(std::uint64_t seed, int count, int threads);

}  // namespace planescope::lab
