#define PLANESCOPE_LANES 4
#include "core/planes/classify/neighbour_kernels.inl"

namespace planescope::planes {
namespace {

std::size_t count_within(const FloatGroup* squared, std::size_t groups, float limit) {
  std::int32_t counts[4] = {};  // as wide as the registers that every processor has
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t lane = 0; lane < kGroup; lane += 4)
      for (std::size_t i = 0; i < 4; ++i) counts[i] += squared[g].lane[lane + i] <= limit;
  const std::int32_t count = counts[0] + counts[1] + counts[2] + counts[3];
  return static_cast<std::size_t>(count);
}

void take_within(const FloatGroup* squared,
                 const IndexGroup* index,
                 std::size_t groups,
                 float limit,
                 std::uint32_t* row) {
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t lane = 0; lane < kGroup; ++lane) {
      *row = index[g].lane[lane];  // no branch: half of them would be mispredicted
      row += squared[g].lane[lane] <= limit;
    }
}

}  // namespace

const NeighbourKernels kNeighbourKernelsPlain{nearest, nearest_one};

}  // namespace planescope::planes
