#include <immintrin.h>

#define PLANESCOPE_LANES 16
#include "core/planes/classify/neighbour_kernels.inl"

namespace planescope::planes {
namespace {

__mmask16 mask_within(const FloatGroup& squared, float limit) {
  return _mm512_cmp_ps_mask(_mm512_load_ps(squared.lane), _mm512_set1_ps(limit), _CMP_LE_OQ);
}

std::size_t count_within(const FloatGroup* squared, std::size_t groups, float limit) {
  std::size_t count = 0;
  for (std::size_t g = 0; g < groups; ++g)
    count += static_cast<unsigned>(__builtin_popcount(mask_within(squared[g], limit)));
  return count;
}

void take_within(const FloatGroup* squared,
                 const IndexGroup* index,
                 std::size_t groups,
                 float limit,
                 std::uint32_t* row) {
  for (std::size_t g = 0; g < groups; ++g) {
    const __mmask16 mask = mask_within(squared[g], limit);
    // Compressed in the register, then stored whole: some processors take long over both in one.
    _mm512_storeu_si512(row, _mm512_maskz_compress_epi32(mask, _mm512_load_si512(index[g].lane)));
    row += __builtin_popcount(mask);
  }
}

}  // namespace

const NeighbourKernels kNeighbourKernelsAvx512{nearest, nearest_one};

}  // namespace planescope::planes
