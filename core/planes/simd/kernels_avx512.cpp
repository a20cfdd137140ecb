// Kernels compiled for AVX-512.

#define PLANESCOPE_LANES 16
#define PLANESCOPE_TILE 8
#include "core/planes/simd/gcn_kernels.inl"
#include "core/planes/simd/pixel_kernels.inl"

namespace planescope::planes {

const gcn::Kernels gcn::kKernelsAvx512{direct, support, product, outer};
const PixelKernels kPixelKernelsAvx512{project, add_to_patches, find_on_plane, lay_flat,
                                       find_cells};

}  // namespace planescope::planes
