#include "core/planes/classify/gcn_kernels.hpp"

namespace planescope::planes::gcn {

const Kernels& kernels(Simd simd) {
#if defined(__x86_64__)
  if (simd == Simd::avx512) return kKernelsAvx512;
  if (simd == Simd::avx2) return kKernelsAvx2;
#endif
  (void)simd;
  return kKernelsPlain;
}

}  // namespace planescope::planes::gcn
