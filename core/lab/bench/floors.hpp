#pragma once

// Lower bounds of stage times: input and output bytes at the speed of memory, or the necessary sums
// at the speed of the arithmetic units, whichever takes longer. Searches, sorting and branches are
// not counted: a floor is a bound, not a goal.

#include <cstddef>

#include "core/model/parallel.hpp"
#include "core/planes/classify/weights.hpp"

namespace planescope::lab {

/// Peak rates of one core of this machine.
struct Peaks {
  double bytes_per_s = 0;  // read and written by memcpy of 64 MiB
  double flops_per_s = 0;  // single precision, multiplications and additions as two instructions
};
/// Takes half a second. `simd`: registers to use.
Peaks measure_peaks(Simd simd = best_simd());

/// Minimum work of a stage.
struct Work {
  double bytes = 0;  // each input read once, each output written once
  double flops = 0;  // multiplications and additions
};

struct Floor {
  double ms = 0;
  bool by_bytes = true;  // else by flops
};
Floor floor_of(const Work& work, const Peaks& peaks);

// The stages of a frame. `frame_bytes`: 2 for each pixel of its depth image, 12 for each point of a
// cloud. A point has 12 bytes, an index 4, a label or flag 1.

Work load_work(std::size_t frame_bytes, std::size_t color_bytes);  // written
Work gravity_work(std::size_t frame_bytes);                        // read
/// Ray times depth, then rotation: 17 for each point.
Work cloud_work(std::size_t frame_bytes, std::size_t points);
/// Cells and sums of the points, a mean for each voxel: 9 and 3.
Work voxel_work(std::size_t points, std::size_t kept, std::size_t voxels);
/// Mean and scatter of the neighbors of each point: 15 each.
Work pca_work(std::size_t points, int neighbors);
/// The network's matrices and, for each kernel, its angle with every neighbor.
Work gcn_work(std::size_t points, const planes::NetworkConfig& network);
/// Cells: 6 for each point; writes points, labels, keys, order and counts of labels.
Work octree_work(std::size_t points);
/// Mean and scatter of every point's node once, 15; writes a plane id for each of `points` and
/// `pixel_points`. `reads_pixels`: also reads the latter, as the profile `refined` does.
Work segment_work(std::size_t points, std::size_t pixel_points, bool reads_pixels);

}  // namespace planescope::lab
