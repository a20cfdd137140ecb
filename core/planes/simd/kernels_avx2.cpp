// Kernels compiled for AVX2.

#define PLANESCOPE_LANES 8
#define PLANESCOPE_TILE 4
#include "core/planes/simd/gcn_kernels.inl"
#include "core/planes/simd/pixel_kernels.inl"

namespace planescope::planes {

const gcn::Kernels gcn::kKernelsAvx2{direct, support, product, outer};
const PixelKernels kPixelKernelsAvx2{project, add_to_patches, find_on_plane, lay_flat, find_cells};

}  // namespace planescope::planes
