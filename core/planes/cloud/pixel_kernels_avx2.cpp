#define PLANESCOPE_LANES 4
#include "core/planes/cloud/pixel_kernels.inl"

namespace planescope::planes {

const PixelKernels kPixelKernelsAvx2{project, add_to_patches, find_on_plane, lay_flat, find_cells};

}  // namespace planescope::planes
