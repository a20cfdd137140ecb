#pragma once

// What a 3D-GCN sees of a cloud: which points are whose neighbours, at every level, and in which
// direction. Nothing here depends on weights.

#include <cstdint>
#include <span>
#include <vector>

#include "core/model/buffer.hpp"
#include "core/model/simd.hpp"
#include "core/model/types.hpp"
#include "core/planes/classify/weights.hpp"

namespace planescope::planes::gcn {

struct GraphLevel {
  std::size_t n = 0;
  int neighbours = 0;               // k, fewer where there are not so many other points
  std::vector<std::uint32_t> rows;  // [n x k] the nearest other points
  Buffer directions;                // [n x 3 x k] unit vectors to them; zero to an equal point
  // The pooling that leads to the next level, which keeps points 0, rate, 2 rate, ...
  int pool_neighbours = 0;
  std::vector<std::uint32_t> pool_rows;  // [n of the next level x pool_neighbours]
  std::vector<std::uint32_t> nearest;  // not at level 0: of each point of level 0 the nearest here
};

/// Points are in the order of a NeighbourGrid, so that neither neighbours nor pooling know in which
/// order the cloud came.
struct Graph {
  std::vector<std::uint32_t> order;  // order[i]: where point i of level 0 was in the input
  std::vector<GraphLevel> levels;
};

/// `points` must be finite, and at least one. `graph` may hold an older one, whose memory is used.
void make_graph(std::span<const Vec3f> points,
                const NetworkConfig& config,
                int threads,
                Simd simd,
                Graph& graph);

}  // namespace planescope::planes::gcn
