#pragma once

// Planes of a cloud by one objective: misfit over the measured noise, a cost for each plane, and a
// cost for each unexplained point. The octree's case IV nodes are the first regions. What happens
// to a region or a point afterwards is decided by how it changes the objective.

#include "core/planes/segment/cloud_scales.hpp"

namespace planescope::planes {

/// From the traversal's planes, one for each case IV node, and its leftovers to the final planes.
void find_cloud_regions(SegmentState& state,
                        const CloudScales& scales,
                        const ObjectiveOptions& options);

}  // namespace planescope::planes
