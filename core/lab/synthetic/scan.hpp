#pragma once

#include <cstdint>
#include <vector>

#include "core/lab/synthetic/d435.hpp"
#include "core/lab/synthetic/scene.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/cloud/cloud.hpp"

namespace planescope::lab {

/// What the classifier is given of a scene: its view through the camera with the scene's pose,
/// levelled by the true gravity, within `max_range_m` of depth, on a voxel grid. A voxel has the
/// label of most of its pixels; voxels of curved surfaces are left out. With `mark_edges` it is
/// also known which lie near an edge: within 2 cm of a measured pixel of the other label. The seed
/// drives the noise alone.
planes::LabelledCloud make_scan(const Scene& scene,
                                const D435Model& model,
                                double voxel_size_m,
                                std::uint64_t seed,
                                bool mark_edges = false,
                                double max_range_m = planes::CloudOptions{}.max_range_m);

/// A view of a composed scene with a camera more or less noisy than the usual one; with
/// `real_errors` half of those that err have bows, flying pixels and holes, and half of all reach
/// farther than the usual crop. Views that show next to nothing, or one label only, are rejected.
planes::LabelledCloud make_training_scan(std::uint64_t seed,
                                         double voxel_size_m,
                                         bool real_errors = false);

/// Held out from training, through the camera as it is: a view of a composed scene such as training
/// has them, and one of the named scenes, in turn by `index`.
planes::LabelledCloud make_composed_test_scan(std::uint64_t seed,
                                              int index,
                                              double voxel_size_m = 0.02);
planes::LabelledCloud make_test_scan(std::uint64_t seed, int index, double voxel_size_m = 0.02);

/// make_test_scan() of 0 to count - 1.
std::vector<planes::LabelledCloud> make_test_scans(std::uint64_t seed,
                                                   int count,
                                                   double voxel_size_m = 0.02,
                                                   int threads = 1);

}  // namespace planescope::lab
