#define PLANESCOPE_LANES 8
#define PLANESCOPE_TILE 4
#include "core/planes/classify/gcn_kernels.inl"

namespace planescope::planes::gcn {

const Kernels kKernelsAvx2{direct, support, product, outer};

}  // namespace planescope::planes::gcn
