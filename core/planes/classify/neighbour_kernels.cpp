// Selection by threshold: instead of sorting the candidates by distance, find a distance that
// exactly k of them do not exceed. Versions for AVX2 and AVX-512 made the PCA classifier 1.14 to
// 1.19 times as fast (TUM fr1/rpy, 2 cm voxels, one core of an AMD EPYC): not worth their code.

#include "core/planes/classify/neighbour_kernels.hpp"

namespace planescope::planes {
namespace {

// Non-negative floats sort like their bit patterns.
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

// Register width of the baseline processor. Explicit, because the compiler would shuffle whole
// groups instead.
constexpr std::size_t kLanes = 4;
using Floats [[gnu::vector_size(4 * kLanes), gnu::may_alias]] = float;
using Ints [[gnu::vector_size(4 * kLanes)]] = std::int32_t;

const Floats& lanes(const FloatGroup& group, std::size_t from) {
  return *reinterpret_cast<const Floats*>(group.lane + from);
}

Floats squared_distances(const Candidates& c, std::size_t g, std::size_t from, const float* p) {
  const Floats dx = lanes(c.x[g], from) - p[0];
  const Floats dy = lanes(c.y[g], from) - p[1];
  const Floats dz = lanes(c.z[g], from) - p[2];
  return dx * dx + dy * dy + dz * dz;
}

/// Counts the distances <= limit.
std::size_t count_within(const FloatGroup* squared, std::size_t groups, float limit) {
  std::int32_t counts[4] = {};
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t lane = 0; lane < kGroup; lane += 4)
      for (std::size_t i = 0; i < 4; ++i) counts[i] += squared[g].lane[lane + i] <= limit;
  const std::int32_t count = counts[0] + counts[1] + counts[2] + counts[3];
  return static_cast<std::size_t>(count);
}

/// Writes the index of each distance <= limit; may write up to kGroup entries past the last.
void write_within(const FloatGroup* squared,
                  const IndexGroup* index,
                  std::size_t groups,
                  float limit,
                  std::uint32_t* row) {
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t lane = 0; lane < kGroup; ++lane) {
      *row = index[g].lane[lane];  // no branch: half of the branches would be mispredicted
      row += squared[g].lane[lane] <= limit;
    }
}

/// Writes the index of each distance < tie, and of the first `ties` equal to it.
void write_with_ties(const FloatGroup* squared,
                     const IndexGroup* index,
                     std::size_t groups,
                     float tie,
                     std::size_t ties,
                     std::uint32_t* row) {
  for (std::size_t g = 0; g < groups; ++g)
    for (std::size_t i = 0; i < kGroup; ++i) {
      const bool tied = squared[g].lane[i] == tie && ties > 0;
      ties -= tied;
      *row = index[g].lane[i];
      row += squared[g].lane[i] < tie || tied;
    }
}

}  // namespace

bool nearest_candidates(const Candidates& c,
                        const float* p,
                        std::size_t k,
                        float within,
                        FloatGroup* squared,
                        std::uint32_t* row) {
  for (std::size_t g = 0; g < c.groups; ++g)
    for (std::size_t i = 0; i < kGroup; i += kLanes)
      *reinterpret_cast<Floats*>(squared[g].lane + i) = squared_distances(c, g, i, p);
  std::int32_t low = -1, high = to_bits(within);  // fewer than k are <= low, k or more <= high
  std::size_t in_low = 0, in_high = count_within(squared, c.groups, within);
  if (in_high < k) return false;
  for (int step = 0; in_high > k && high - low > 1; ++step) {
    // The count grows roughly linearly with the squared distance because the points sample
    // surfaces: a few guesses usually find a distance between the k-th and the next. If these are
    // equal or the guesses are poor, bisection of the bit patterns ends the search.
    std::int32_t guess = low + (high - low) / 2;
    if (step < 8) {
      const float from = low < 0 ? 0 : to_float(low), to = to_float(high);
      const float share =
          (static_cast<float>(k - in_low) + 0.5f) / static_cast<float>(in_high - in_low);
      const std::int32_t bits = to_bits(from + (to - from) * share);
      if (bits > low && bits < high) guess = bits;
    }
    const std::size_t count = count_within(squared, c.groups, to_float(guess));
    if (count < k) {
      low = guess;
      in_low = count;
    } else {
      high = guess;
      in_high = count;
    }
  }
  if (in_high == k)
    write_within(squared, c.index, c.groups, to_float(high), row);
  else
    write_with_ties(squared, c.index, c.groups, to_float(high), k - in_low, row);
  return true;
}

float nearest_candidate(const Candidates& c, const float* p, std::uint32_t* found) {
  Floats least = Floats{} + __builtin_inff();  // minimum per lane and its position, valid even
  Ints where = {};                             // if all distances overflow
  for (std::size_t g = 0; g < c.groups; ++g)
    for (std::size_t i = 0; i < kGroup; i += kLanes) {
      const Floats squared = squared_distances(c, g, i, p);
      const Ints at = Ints{} + static_cast<std::int32_t>(g * kGroup + i);
      const Ints less = squared < least;
      least = less ? squared : least;
      where = less ? at : where;
    }
  std::uint64_t best = ~std::uint64_t{0};  // distance, then position
  for (std::uint32_t i = 0; i < kLanes; ++i) {
    const std::uint64_t lane = static_cast<std::uint64_t>(to_bits(least[i])) << 32 |
                               (static_cast<std::uint32_t>(where[i]) + i);
    best = lane < best ? lane : best;
  }
  const auto at = static_cast<std::uint32_t>(best);
  *found = c.index[at / kGroup].lane[at % kGroup];
  return to_float(static_cast<std::int32_t>(best >> 32));
}

}  // namespace planescope::planes
