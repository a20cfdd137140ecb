#pragma once

// Planes of a cloud by one objective: misfit over the measured noise, a cost for each plane, and a
// cost for each unexplained point. The octree's case IV nodes are the first regions. What happens
// to a region or a point afterwards is decided by how it changes the objective.

#include "core/planes/segment/state.hpp"

namespace planescope::planes {

/// The scales of a cloud.
struct CloudScales {
  double white_m = 0;     // standard deviation of a point across its surface
  double measured_m = 0;  // likewise, before the floor
  double bow_m = 0;       // likewise, of the error that all points of a region share
  double spacing_m = 0;   // of points on a surface
  double variance_m2() const { return white_m * white_m + bow_m * bow_m; }  // of a point
};
CloudScales measure_scales(const SegmentState& state, const ObjectiveOptions& options);

/// The same for Criterion 3 and for what judges distances to planes afterwards.
NoiseModel noise_of(const CloudScales& scales, const ObjectiveOptions& options);

/// From the traversal's planes, one for each case IV node, and its leftovers to the final planes.
void find_cloud_regions(SegmentState& state,
                        const CloudScales& scales,
                        const ObjectiveOptions& options);

}  // namespace planescope::planes
