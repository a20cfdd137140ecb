#include "core/lab/training/training_set.hpp"

#include <cassert>

#include "core/lab/synthetic/counter_random.hpp"
#include "core/lab/synthetic/scan.hpp"
#include "core/lab/training/training_shapes.hpp"
#include "core/model/parallel.hpp"

namespace planescope::lab {
namespace {

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

}  // namespace planescope::lab
