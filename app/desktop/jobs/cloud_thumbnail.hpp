#pragma once

// A small picture of a frame that has no image: its voxels from above, in the colours of their
// planes.

#include "core/debug/replay/run.hpp"
#include "core/model/image.hpp"

namespace planescope::desktop {

/// width x 3/4 width pixels, x of the world to the right, y upwards; the highest voxel of a pixel
/// shows. The outermost percent of the voxels on each side may be cut off.
Image8 cloud_thumbnail(const debug::Run& run, int width);

}  // namespace planescope::desktop
