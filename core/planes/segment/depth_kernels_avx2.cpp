#define PLANESCOPE_LANES 4
#include "core/planes/segment/depth_kernels.inl"

namespace planescope::planes {

const DepthKernels kDepthKernelsAvx2{see, reach, lay_on};

}  // namespace planescope::planes
