#define PLANESCOPE_LANES 8
#include "core/planes/segment/depth_kernels.inl"

namespace planescope::planes {

const DepthKernels kDepthKernelsAvx512{see, reach, lay_on};

}  // namespace planescope::planes
