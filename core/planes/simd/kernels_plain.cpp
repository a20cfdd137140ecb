// Kernels for the baseline processor, and the choice between the three sets.

#define PLANESCOPE_LANES 4
#define PLANESCOPE_TILE 4
#include "core/planes/simd/gcn_kernels.inl"
#include "core/planes/simd/pixel_kernels.inl"

namespace planescope::planes {

const gcn::Kernels gcn::kKernelsPlain{direct, support, product, outer};
const PixelKernels kPixelKernelsPlain{project, add_to_patches, find_on_plane, lay_flat, find_cells};

const PixelKernels& pixel_kernels(Simd simd) {
#if defined(__x86_64__)
  if (simd == Simd::avx512) return kPixelKernelsAvx512;
  if (simd == Simd::avx2) return kPixelKernelsAvx2;
#endif
  (void)simd;
  return kPixelKernelsPlain;
}

namespace gcn {

const Kernels& kernels(Simd simd) {
#if defined(__x86_64__)
  if (simd == Simd::avx512) return kKernelsAvx512;
  if (simd == Simd::avx2) return kKernelsAvx2;
#endif
  (void)simd;
  return kKernelsPlain;
}

}  // namespace gcn

}  // namespace planescope::planes
