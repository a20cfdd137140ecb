#include "core/planes/segment/depth_kernels.hpp"

namespace planescope::planes {

const DepthKernels& depth_kernels(Simd simd) {
#if defined(__x86_64__)
  if (simd == Simd::avx512) return kDepthKernelsAvx512;
  if (simd == Simd::avx2) return kDepthKernelsAvx2;
#endif
  (void)simd;
  return kDepthKernelsPlain;
}

}  // namespace planescope::planes
