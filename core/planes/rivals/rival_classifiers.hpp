#pragma once

// Classifiers that ours are held against: their results and their speed.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "core/model/types.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/classify/weights.hpp"

namespace planescope::planes {

/// PCA normals as they are commonly computed, nanoflann's k-d tree for the neighbours and Eigen's
/// closed form for the normal: what our classifiers' speed is held against. Labels differ from
/// those of make_pca_classifier() where several points are equally far, or a normal lies at the
/// boundary.
std::unique_ptr<Classifier> make_nanoflann_pca_classifier(const PcaClassifierOptions& options = {});

// 3D-GCN again, written straight from its equations: the reference for the fast one's results and
// speed.

template <typename Real>
struct PlainNetwork {
  NetworkConfig config;
  std::vector<std::vector<Real>> tensors;  // by tensor_specs(config)
};

/// For each level its points, as indices of points of level 0, and for each point the nearest
/// others, as indices of this level.
struct PlainGraph {
  struct Level {
    std::vector<std::uint32_t> points;
    std::vector<std::vector<std::uint32_t>> neighbours;       // config.neighbours each, or fewer
    std::vector<std::vector<std::uint32_t>> pool_neighbours;  // config.pool_neighbours each
    std::vector<std::uint32_t> nearest;  // of each point of level 0 the nearest of this level
  };
  std::vector<Level> levels;
};

/// `points` in the order of a NeighbourGrid: every pool_rate-th goes on. All distances are tried.
PlainGraph make_plain_graph(std::span<const Vec3f> points, const NetworkConfig& config);

/// Logits of each point, h then v.
template <typename Real>
std::vector<std::array<Real, 2>> plain_forward(const PlainNetwork<Real>& network,
                                               const PlainGraph& graph,
                                               std::span<const Vec3f> points);

}  // namespace planescope::planes
