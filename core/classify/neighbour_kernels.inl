// Selection by threshold: instead of sorting the candidates by distance, find a distance that so
// many of them do not exceed. Each source that includes this brings its own
//   std::size_t count_within(const DistanceGroup* d, std::size_t groups, float limit);
//   void take_within(const DistanceGroup* d, const CandidateGroup* c, std::size_t groups,
//                    float limit, std::uint32_t* row);  // may write up to kGroup beyond the last

#include "core/classify/neighbour_kernels.hpp"

namespace planescope {
namespace {

std::size_t count_within(const DistanceGroup* d, std::size_t groups, float limit);
void take_within(const DistanceGroup* d,
                 const CandidateGroup* c,
                 std::size_t groups,
                 float limit,
                 std::uint32_t* row);

// Floats that are not negative are ordered like their bits.
std::int32_t to_bits(float v) {
  std::int32_t bits;
  __builtin_memcpy(&bits, &v, sizeof bits);
  return bits;
}
float to_float(std::int32_t bits) {
  float v;
  __builtin_memcpy(&v, &bits, sizeof v);
  return v;
}

void measure(const CandidateGroup& c, const float* p, DistanceGroup& d) {
  for (std::size_t lane = 0; lane < kGroup; ++lane) {
    const float dx = c.x[lane] - p[0], dy = c.y[lane] - p[1], dz = c.z[lane] - p[2];
    d.squared[lane] = dx * dx + dy * dy + dz * dz;
  }
}

/// All that are nearer than `tie`, and the first `ties` of those exactly there.
void take_with_ties(const DistanceGroup* d,
                    const CandidateGroup* c,
                    std::size_t groups,
                    float tie,
                    std::size_t ties,
                    std::uint32_t* row) {
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t lane = 0; lane < kGroup; ++lane) {
      const float squared = d[g].squared[lane];
      const bool tied = squared == tie && ties > 0;
      ties -= tied;
      *row = c[g].index[lane];
      row += squared < tie || tied;
    }
}

bool nearest(const CandidateGroup* groups,
             std::size_t group_count,
             const float* p,
             std::size_t k,
             float within,
             DistanceGroup* scratch,
             std::uint32_t* row) {
  for (std::size_t g = 0; g < group_count; ++g) measure(groups[g], p, scratch[g]);
  std::int32_t low = -1, high = to_bits(within);  // fewer than k are within low, k or more in high
  std::size_t in_low = 0, in_high = count_within(scratch, group_count, within);
  if (in_high < k) return false;
  for (int step = 0; in_high > k && high - low > 1; ++step) {
    // The count grows about linearly with the square of the distance, for points lie on surfaces:
    // a few guesses hit a distance between those of the k-th and the next. Where these are equal or
    // the guesses poor, bisection of the bits ends the search.
    std::int32_t guess = low + (high - low) / 2;
    if (step < 8) {
      const float from = low < 0 ? 0 : to_float(low), to = to_float(high);
      const float share =
          (static_cast<float>(k - in_low) + 0.5f) / static_cast<float>(in_high - in_low);
      const std::int32_t bits = to_bits(from + (to - from) * share);
      if (bits > low && bits < high) guess = bits;
    }
    const std::size_t count = count_within(scratch, group_count, to_float(guess));
    if (count < k) {
      low = guess;
      in_low = count;
    } else {
      high = guess;
      in_high = count;
    }
  }
  if (in_high == k)
    take_within(scratch, groups, group_count, to_float(high), row);
  else
    take_with_ties(scratch, groups, group_count, to_float(high), k - in_low, row);
  return true;
}

float nearest_one(const CandidateGroup* groups,
                  std::size_t group_count,
                  const float* p,
                  std::uint32_t* found) {
  float best = __builtin_inff();
  *found = groups[0].index[0];  // stays where all distances overflow
  for (std::size_t g = 0; g < group_count; ++g) {
    DistanceGroup d;
    measure(groups[g], p, d);
    float least = best;  // NaN is never less
    for (std::size_t lane = 0; lane < kGroup; ++lane)
      least = d.squared[lane] < least ? d.squared[lane] : least;
    if (!(least < best)) continue;
    best = least;
    std::size_t lane = 0;
    while (d.squared[lane] != best) ++lane;
    *found = groups[g].index[lane];
  }
  return best;
}

}  // namespace
}  // namespace planescope
