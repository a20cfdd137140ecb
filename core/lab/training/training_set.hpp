#pragma once

// What the classifier learns from: the paper's staircases, boxes and planes (Sec. III), and views
// of scenes made of the same shapes through the camera model.

#include <cstdint>
#include <functional>
#include <vector>

#include "core/planes/classify/classifier.hpp"

namespace planescope::lab {

struct TrainingSetOptions {
  std::uint64_t seed = 1;
  int stairs = 200, boxes = 200, planes = 200;  // whole objects, the paper's ranges
  double boxes_on_floor = 0.5;                  // share of boxes that stand on a piece of floor
  int scans = 300;                              // views through the camera, on a voxel grid
  int points = 8192;                            // of each object, evenly spread
  double voxel_size_m = 0.02;                   // of the scans
  bool real_errors = false;  // of the scans: what real cameras add, and farther views

  int count() const { return stairs + boxes + planes + scans; }
};

/// Clean axis-aligned objects, then noisy scans, in the order of the options: each depends on the
/// seed, its kind and its number alone. `progress(done, all)` is called on the caller's thread; it
/// may be empty and may throw to stop.
std::vector<planes::LabelledCloud> make_training_set(
    const TrainingSetOptions& options,
    int threads,
    const std::function<void(int, int)>& progress = {});

struct AugmentOptions {
  double uniform_noise_m = 0.01;  // up to, either way, on every coordinate; the paper's +-1 cm
  double gaussian_noise_m = 0;    // standard deviation up to, drawn for each cloud
  int clusters = 4;               // up to so many round holes, as long as half of the points remain
  double cluster_radius_m = 0.1;  // up to
  double tilt_deg = 0;            // off level, up to, about a random horizontal axis
  int points = 2048;              // kept at most: the nearest ones to a random point; 0 all
  double thinning = 1;            // keeps a random share of the points, at least this one
  double yaw_deg = 180;           // turned about z, up to, either way
};

/// A new version of a cloud for one step of training, in its order; every point keeps its label.
/// The same for the same seed.
planes::LabelledCloud augment(const planes::LabelledCloud& cloud,
                              const AugmentOptions& options,
                              std::uint64_t seed);

}  // namespace planescope::lab
