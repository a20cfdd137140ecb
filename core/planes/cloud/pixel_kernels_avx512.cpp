#define PLANESCOPE_LANES 8
#include "core/planes/cloud/pixel_kernels.inl"

namespace planescope::planes {

const PixelKernels kPixelKernelsAvx512{project, add_to_patches, find_on_plane, lay_flat,
                                       find_cells};

}  // namespace planescope::planes
