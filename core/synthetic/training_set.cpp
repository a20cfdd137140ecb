#include "core/synthetic/training_set.hpp"

#include <algorithm>
#include <atomic>
#include <cassert>

#include "core/base/parallel.hpp"
#include "core/synthetic/counter_random.hpp"
#include "core/synthetic/scan.hpp"
#include "core/synthetic/training_shapes.hpp"

namespace planescope {
namespace {

enum Kind : std::uint64_t { kStairs = 1, kBox = 2, kPlane = 3, kScan = 4 };

LabelledCloud make_cloud_of_set(const TrainingSetOptions& options, int index) {
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
  return make_training_scan(seed(kScan), options.voxel_size_m);
}

}  // namespace

std::vector<LabelledCloud> make_training_set(const TrainingSetOptions& options,
                                             int threads,
                                             const std::function<void(int, int)>& progress) {
  assert(options.points > 0);
  const int count = options.count();
  std::vector<LabelledCloud> set(static_cast<std::size_t>(count));
  std::atomic<int> next = 0, done = 0;  // scans take longer: whoever is free takes the next one
  const auto work = [&](std::size_t first_worker, std::size_t) {
    try {
      for (int i = next++; i < count; i = next++) {
        set[static_cast<std::size_t>(i)] = make_cloud_of_set(options, i);
        ++done;
        if (progress && first_worker == 0) progress(done, count);
      }
    } catch (...) {
      next = count;
      throw;
    }
  };
  const auto workers = static_cast<std::size_t>(std::clamp(threads, 1, std::max(1, count)));
  parallel_for(workers, static_cast<int>(workers), work, 1);
  return set;
}

}  // namespace planescope
