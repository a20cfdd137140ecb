#define PLANESCOPE_LANES 16
#define PLANESCOPE_TILE 8
#include "core/planes/classify/gcn_kernels.inl"

namespace planescope::planes::gcn {

const Kernels kKernelsAvx512{direct, support, product, outer};

}  // namespace planescope::planes::gcn
