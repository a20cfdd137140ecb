#define PLANESCOPE_LANES 2
#include "core/planes/cloud/pixel_kernels.inl"

namespace planescope::planes {

const PixelKernels kPixelKernelsPlain{project, add_to_patches, find_on_plane, lay_flat, find_cells};

const PixelKernels& pixel_kernels(Simd simd) {
#if defined(__x86_64__)
  if (simd == Simd::avx512) return kPixelKernelsAvx512;
  if (simd == Simd::avx2) return kPixelKernelsAvx2;
#endif
  (void)simd;
  return kPixelKernelsPlain;
}

}  // namespace planescope::planes
