#include <immintrin.h>

#define PLANESCOPE_LANES 8
#include "core/planes/classify/neighbour_kernels.inl"

namespace planescope::planes {
namespace {

unsigned mask_within(const float* squared, float limit) {
  const __m256 within = _mm256_cmp_ps(_mm256_load_ps(squared), _mm256_set1_ps(limit), _CMP_LE_OQ);
  return static_cast<unsigned>(_mm256_movemask_ps(within));
}

std::size_t count_within(const FloatGroup* squared, std::size_t groups, float limit) {
  std::size_t count = 0;
  for (std::size_t g = 0; g < groups; ++g)
    count += static_cast<unsigned>(__builtin_popcount(
        mask_within(squared[g].lane, limit) | mask_within(squared[g].lane + 8, limit) << 8));
  return count;
}

/// For each mask of eight lanes, which lanes are set, one byte each.
struct LaneTable {
  std::uint64_t lanes[256] = {};
  constexpr LaneTable() {
    for (unsigned mask = 0; mask < 256; ++mask)
      for (unsigned lane = 0, to = 0; lane < 8; ++lane)
        if (mask >> lane & 1) lanes[mask] |= std::uint64_t{lane} << 8 * to++;
  }
};
constexpr LaneTable kLaneTable;

void take_within(const FloatGroup* squared,
                 const IndexGroup* index,
                 std::size_t groups,
                 float limit,
                 std::uint32_t* row) {
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t lane = 0; lane < kGroup; lane += 8) {
      const unsigned mask = mask_within(squared[g].lane + lane, limit);
      const __m256i lanes =
          _mm256_cvtepu8_epi32(_mm_cvtsi64_si128(static_cast<long long>(kLaneTable.lanes[mask])));
      const __m256i all = _mm256_load_si256(reinterpret_cast<const __m256i*>(index[g].lane + lane));
      _mm256_storeu_si256(reinterpret_cast<__m256i*>(row), _mm256_permutevar8x32_epi32(all, lanes));
      row += __builtin_popcount(mask);
    }
}

}  // namespace

const NeighbourKernels kNeighbourKernelsAvx2{nearest, nearest_one};

}  // namespace planescope::planes
