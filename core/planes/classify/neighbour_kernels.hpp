#pragma once

// The inner loops of the neighbor search.

#include <cstddef>
#include <cstdint>

#include "core/model/parallel.hpp"
namespace planescope::planes {

inline constexpr std::size_t kGroup = 16;
struct alignas(64) FloatGroup {
  float lane[kGroup];
};
struct alignas(64) IndexGroup {
  std::uint32_t lane[kGroup];
};

/// Points in ascending grid order, in groups. Unused lanes at the end have x = NaN.
struct Candidates {
  const FloatGroup* x;
  const FloatGroup* y;
  const FloatGroup* z;
  const IndexGroup* index;
  std::size_t groups;
};

/// Writes the indices of the k candidates nearest to p to `row` (room for k + kGroup), ascending.
/// Returns false if fewer than k have a squared distance <= `within`. `scratch`: one per group.
bool nearest_candidates(const Candidates& candidates,
                        const float* p,
                        std::size_t k,
                        float within,
                        FloatGroup* scratch,
                        std::uint32_t* row);
/// Returns the squared distance to the nearest of one or more candidates, and writes its index.
float nearest_candidate(const Candidates& candidates, const float* p, std::uint32_t* found);

}  // namespace planescope::planes
