#define PLANESCOPE_LANES 2
#include "core/planes/segment/depth_kernels.inl"

namespace planescope::planes {

const DepthKernels kDepthKernelsPlain{see, reach, lay_on};

}  // namespace planescope::planes
