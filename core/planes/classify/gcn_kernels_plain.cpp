#define PLANESCOPE_LANES 4
#define PLANESCOPE_TILE 4
#include "core/planes/classify/gcn_kernels.inl"

namespace planescope::planes::gcn {

const Kernels kKernelsPlain{direct, support, product, outer};

}  // namespace planescope::planes::gcn
