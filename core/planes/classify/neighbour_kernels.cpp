#include "core/planes/classify/neighbour_kernels.hpp"

namespace planescope::planes {

const NeighbourKernels& neighbour_kernels(Simd simd) {
#if defined(__x86_64__)
  if (simd == Simd::avx512) return kNeighbourKernelsAvx512;
  if (simd == Simd::avx2) return kNeighbourKernelsAvx2;
#endif
  (void)simd;
  return kNeighbourKernelsPlain;
}

}  // namespace planescope::planes
