// Weights of a 3D-GCN padded to registers, and the neighbor graph of a cloud.

#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

#include "core/model/parallel.hpp"
#include "core/planes/classify/gcn_forward.hpp"
#include "core/planes/classify/neighbour_grid.hpp"
#include "core/planes/simd/gcn_kernels.hpp"

namespace planescope::planes::gcn {

// ---- Weights ----

namespace {

int padded(int channels) { return (channels + kLanes - 1) / kLanes * kLanes; }

/// Calls visit(value, entry) for every entry of a [rows x (blocks x columns)] tensor and the
/// corresponding entry of a matrix with padded blocks.
template <typename Tensor, typename Matrix, typename Visit>
void visit_blocks(Tensor& tensor, Matrix& matrix, int rows, int blocks, int columns, Visit visit) {
  const int wide = padded(columns);
  for (int a = 0; a < rows; ++a)
    for (int b = 0; b < blocks; ++b)
      for (int c = 0; c < columns; ++c)
        visit(tensor[(a * blocks + b) * columns + c], matrix[(a * blocks + b) * wide + c]);
}

/// Rows of the head's first matrix for the concatenated features, in order.
std::vector<int> fused_rows(const NetworkConfig& config) {
  std::vector<int> rows;
  int row = 0;
  const auto append = [&](int channels) {
    for (int c = 0; c < channels; ++c) rows.push_back(row + c);
    row += padded(channels);
  };
  for (const auto& level : config.levels)
    for (const int channels : level) append(channels);
  if (config.global_feature) append(config.levels.back().back());
  return rows;
}

/// Calls visit(value, entry) for every weight and bias and the corresponding entry of the layers,
/// and visit_directions(tensor, layer) for every tensor of directions.
template <typename Tensors, typename LayersT, typename Visit, typename VisitDirections>
void visit_parameters(Tensors& tensors,
                      LayersT& layers,
                      Visit visit,
                      VisitDirections visit_directions) {
  const NetworkConfig& config = layers.config;
  auto tensor = tensors.begin();
  auto layer = layers.convolutions.begin();
  int in = 0;
  for (const auto& level : config.levels)
    for (const int out : level) {
      if (in > 0) {
        visit_blocks(*tensor++, layer->weights, in, config.supports + 1, out, visit);
        visit_blocks(*tensor++, layer->bias, 1, config.supports + 1, out, visit);
      }
      visit_directions(*tensor++, *layer++, out);
      in = out;
    }
  std::vector<int> rows = fused_rows(config);
  std::vector<int> widths = config.head;
  widths.push_back(2);
  for (std::size_t h = 0; h < widths.size(); ++h) {
    auto& weights = *tensor++;
    auto& bias = *tensor++;
    auto& head = layers.head[h];
    for (int b = 0; b < widths[h]; ++b) {
      for (std::size_t a = 0; a < rows.size(); ++a)
        visit(weights[b * rows.size() + a], head.weights[rows[a] * head.out + b]);
      visit(bias[b], head.bias[b]);
    }
    rows.resize(widths[h]);
    for (int a = 0; a < widths[h]; ++a) rows[a] = a;
  }
  assert(tensor == tensors.end());
}

}  // namespace

Layers make_layers(const NetworkConfig& config) {
  Layers layers;
  layers.config = config;
  int in = 0, fused = 0, last = 0;
  for (std::size_t l = 0; l < config.levels.size(); ++l) {
    int column = 0;
    for (const int channels : config.levels[l]) {
      ConvolutionLayer& layer = layers.convolutions.emplace_back();
      layer.level = static_cast<int>(l);
      layer.in = in;
      layer.out = padded(channels);
      layer.column = column;
      layer.directions = Buffer(std::size_t{3} * config.supports * layer.out, 0);
      const std::size_t columns = std::size_t{1} * (config.supports + 1) * layer.out;
      if (in > 0) {
        layer.weights = Buffer(in * columns, 0);
        layer.bias = Buffer(columns, 0);
      }
      column += layer.out;
      in = last = layer.out;
    }
    layers.widths.push_back(column);
    fused += column;
  }
  layers.convolutions.back().relu = false;
  in = fused + (config.global_feature ? last : 0);
  std::vector<int> widths = config.head;
  widths.push_back(2);
  for (const int width : widths) {
    HeadLayer& layer = layers.head.emplace_back();
    layer.in = in;
    layer.out = padded(width);
    layer.weights = Buffer(std::size_t{1} * layer.in * layer.out, 0);
    layer.bias = Buffer(static_cast<std::size_t>(layer.out), 0);
    in = layer.out;
  }
  return layers;
}

Layers make_layers(const NetworkWeights& weights) {
  Layers layers = make_layers(weights.config);
  visit_parameters(
      weights.tensors, layers, [](float value, float& entry) { entry = value; },
      [&](const std::vector<float>& tensor, ConvolutionLayer& layer, int out) {
        const int supports = weights.config.supports, columns = supports * out;
        for (int s = 0; s < supports; ++s)
          for (int c = 0; c < out; ++c) {
            const float* d = tensor.data() + s * out + c;
            const float length =
                std::sqrt(d[0] * d[0] + d[columns] * d[columns] + d[2 * columns] * d[2 * columns]);
            for (int axis = 0; axis < 3; ++axis)
              layer.directions[(axis * supports + s) * layer.out + c] =
                  length > 0 ? d[axis * columns] / length : 0.0f;
          }
      });
  return layers;
}

std::vector<std::vector<float>> tensor_gradients(const NetworkWeights& weights,
                                                 const Layers& gradients) {
  std::vector<std::vector<float>> result;
  for (const auto& tensor : weights.tensors) result.emplace_back(tensor.size());
  visit_parameters(
      result, gradients, [](float& value, float entry) { value = entry; },
      [&](std::vector<float>& tensor, const ConvolutionLayer& layer, int out) {
        const std::vector<float>& raw = weights.tensors[&tensor - result.data()];
        const int supports = weights.config.supports, columns = supports * out;
        for (int s = 0; s < supports; ++s)
          for (int c = 0; c < out; ++c) {
            // u = d / |d|: the gradient's component perpendicular to u, divided by |d|.
            double d[3], g[3], length = 0, along = 0;
            for (int axis = 0; axis < 3; ++axis) {
              d[axis] = raw[axis * columns + s * out + c];
              g[axis] = layer.directions[(axis * supports + s) * layer.out + c];
              length += d[axis] * d[axis];
            }
            length = std::sqrt(length);
            if (length <= 0) continue;
            for (int axis = 0; axis < 3; ++axis) along += g[axis] * d[axis] / length;
            for (int axis = 0; axis < 3; ++axis)
              tensor[axis * columns + s * out + c] =
                  static_cast<float>((g[axis] - along * d[axis] / length) / length);
          }
      });
  return result;
}

// ---- Graph ----

namespace {

constexpr std::size_t kTiledPoints = 1024;  // points whose neighbors are searched in one batch

float squared_distance(const Vec3f& a, const Vec3f& b) {
  const float x = a.x() - b.x(), y = a.y() - b.y(), z = a.z() - b.z();
  return x * x + y * y + z * z;
}

/// Removes the point itself from its row. If more coincident points exist than fit, the row may
/// lack the point itself; any one entry is dropped instead.
void drop_self(std::span<const std::uint32_t> found,
               std::uint32_t self,
               std::span<std::uint32_t> row) {
  std::size_t kept = 0;
  for (std::size_t j = 0; kept < row.size(); ++j) {
    row[kept] = found[j];
    kept += found[j] != self;
  }
}

/// Writes the `count` nearest points of a row; ties go to the earlier one.
void choose_nearest(std::span<const Vec3f> points,
                    std::size_t i,
                    std::span<const std::uint32_t> row,
                    int count,
                    std::vector<float>& distance,
                    std::uint32_t* chosen) {
  distance.clear();
  for (const std::uint32_t j : row) distance.push_back(squared_distance(points[j], points[i]));
  for (int c = 0; c < count; ++c) {
    const auto nearest = std::min_element(distance.begin(), distance.end());
    *chosen++ = row[nearest - distance.begin()];
    *nearest = std::numeric_limits<float>::infinity();
  }
}

/// Finds the nearest point of `pool` for points begin..end of level 0. `in_pool`: per level-0
/// point, its index in the pool or none. If any pool point is among a point's neighbors, so is the
/// nearest one.
void find_nearest(const NeighborGrid& grid,
                  const GraphLevel& level,
                  const NeighborGrid& pool,
                  const std::vector<std::uint32_t>& in_pool,
                  std::size_t begin,
                  std::size_t end,
                  std::uint32_t* nearest) {
  const auto points = grid.points();
  for (std::size_t i = begin; i < end; ++i) {
    nearest[i] = in_pool[i];
    if (nearest[i] != kNoNeighbor) continue;
    float smallest = std::numeric_limits<float>::infinity();
    for (int k = 0; k < level.neighbors; ++k) {
      const std::uint32_t j = level.rows[i * level.neighbors + k];
      if (in_pool[j] == kNoNeighbor) continue;
      const float distance = squared_distance(points[j], points[i]);
      if (distance >= smallest) continue;
      smallest = distance;
      nearest[i] = in_pool[j];
    }
    if (nearest[i] == kNoNeighbor) pool.nearest_to(points.subspan(i, 1), nearest + i);
  }
}

}  // namespace

void make_graph(std::span<const Vec3f> points,
                const NetworkConfig& config,
                int threads,
                Simd simd,
                Graph& graph) {
  std::vector<NeighborGrid> grids;
  grids.emplace_back(points, config.neighbors + 1);
  while (grids.size() < config.levels.size()) grids.push_back(grids.back().every(config.pool_rate));

  // Per level-0 point: its index in each level, or none.
  std::vector<std::vector<std::uint32_t>> in_level(grids.size());
  std::size_t rate = 1;
  for (std::vector<std::uint32_t>& in : in_level) {
    in.assign(points.size(), kNoNeighbor);
    for (std::size_t i = 0; i < in.size(); i += rate) in[i] = static_cast<std::uint32_t>(i / rate);
    rate *= static_cast<std::size_t>(config.pool_rate);
  }

  graph.order.assign(grids[0].order().begin(), grids[0].order().end());
  graph.levels.resize(grids.size());
  for (std::size_t l = 0; l < grids.size(); ++l) {
    GraphLevel& level = graph.levels[l];
    level.n = grids[l].size();
    level.neighbors = std::min(config.neighbors, static_cast<int>(level.n) - 1);
    level.rows.resize(level.n * level.neighbors);
    level.directions.resize(level.n * level.neighbors * 3);
    if (l > 0) level.nearest.resize(grids[0].size());
    level.pool_neighbors = 0;
    if (l + 1 == grids.size()) continue;
    level.pool_neighbors = std::min(config.pool_neighbors, level.neighbors);
    level.pool_rows.resize(grids[l + 1].size() * level.pool_neighbors);
  }

  run_team(std::min<int>(threads, static_cast<int>(points.size() / 256)), [&](TeamMember& member) {
    std::vector<std::uint32_t> found;
    std::vector<float> distance;
    for (std::size_t l = 0; l < grids.size(); ++l) {
      GraphLevel& level = graph.levels[l];
      const auto [first, last] = member.share(level.n);
      const auto k = static_cast<std::size_t>(level.neighbors);
      for (std::size_t begin = first; begin < last && k > 0; begin += kTiledPoints) {
        const std::size_t end = std::min(last, begin + kTiledPoints);
        found.resize((end - begin) * (k + 1));
        grids[l].nearest(level.neighbors + 1, begin, end, found.data());
        for (std::size_t i = begin; i < end; ++i) {
          const std::span row(level.rows.data() + i * k, k);
          drop_self({found.data() + (i - begin) * (k + 1), k + 1}, static_cast<std::uint32_t>(i),
                    row);
          if (level.pool_neighbors > 0 && i % config.pool_rate == 0)
            choose_nearest(grids[l].points(), i, row, level.pool_neighbors, distance,
                           level.pool_rows.data() + i / config.pool_rate * level.pool_neighbors);
        }
        kernels(simd).direct({.begin = begin,
                              .end = end,
                              .neighbors = level.neighbors,
                              .points = grids[l].points()[0].data(),
                              .rows = level.rows.data(),
                              .directions = level.directions.data()});
      }
      const auto [begin, end] = member.share(points.size());
      if (l > 0)
        find_nearest(grids[0], graph.levels[0], grids[l], in_level[l], begin, end,
                     level.nearest.data());
    }
  });
}

}  // namespace planescope::planes::gcn
