// Reference classifiers: PCA with nanoflann (Blanco and Rai 2014, a C++ header-only fork of FLANN),
// and a plain 3D-GCN.

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <nanoflann.hpp>
#include <numbers>
#include <numeric>

#include "core/lab/rivals/rivals.hpp"
#include "core/model/parallel.hpp"

namespace planescope::lab {
namespace {

/// nanoflann's interface to a cloud.
struct CloudView {
  std::span<const Vec3f> points;

  std::size_t kdtree_get_point_count() const { return points.size(); }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const {
    return points[i][static_cast<Eigen::Index>(axis)];
  }
  template <typename Box>
  bool kdtree_get_bbox(Box&) const {
    return false;  // the tree computes it
  }
};

using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, CloudView>,
                                                 CloudView,
                                                 3,
                                                 std::uint32_t>;

Vec3d normal_of(std::span<const Vec3f> points,
                std::span<const std::uint32_t> neighbors,
                const Vec3f& about) {
  Vec3d sum = Vec3d::Zero();
  Mat3d squares = Mat3d::Zero();
  for (const std::uint32_t j : neighbors) {
    const Vec3d d = (points[j] - about).cast<double>();
    sum += d;
    squares += d * d.transpose();
  }
  const double n = static_cast<double>(neighbors.size());
  Eigen::SelfAdjointEigenSolver<Mat3d> solver;
  solver.computeDirect(squares - sum * sum.transpose() / n);
  return solver.eigenvectors().col(0);
}

class NanoflannPcaClassifier final : public planes::Classifier {
 public:
  explicit NanoflannPcaClassifier(const planes::PcaClassifierOptions& options)
      : neighbors_(static_cast<std::size_t>(options.neighbors)),
        boundary_(std::cos(options.max_angle_deg * std::numbers::pi / 180)) {}

  std::string name() const override { return "nanoflann"; }

  planes::Classification classify(std::span<const Vec3f> points, int threads) const override {
    return planes::classify_finite(
        points, [&](std::span<const Vec3f> finite) { return label(finite, threads); });
  }

 private:
  planes::Classification label(std::span<const Vec3f> points, int threads) const {
    const CloudView view{points};
    const Tree tree(3, view, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize));
    planes::Classification result;
    result.labels.resize(points.size());
    result.margins.resize(points.size());
    // In tree order, so that consecutive searches share the cache.
    parallel_for(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> found(neighbors_);
      std::vector<float> distances(neighbors_);
      for (std::size_t n = begin; n < end; ++n) {
        const std::uint32_t i = tree.vAcc[n];
        const std::size_t count =
            tree.knnSearch(points[i].data(), neighbors_, found.data(), distances.data());
        const Vec3d normal = normal_of(points, std::span(found).first(count), points[i]);
        const double level = std::abs(normal.z()), lead = level - boundary_;
        result.labels[i] = lead >= 0 ? Label::h : Label::v;
        result.margins[i] =
            static_cast<float>(lead >= 0 ? lead / (1 - boundary_) : -lead / boundary_);
      }
    });
    return result;
  }

  static constexpr std::size_t kLeafSize = 10;
  std::size_t neighbors_;
  double boundary_;  // of the normal's z component
};

}  // namespace

std::unique_ptr<planes::Classifier> make_nanoflann_pca_classifier(
    const planes::PcaClassifierOptions& options) {
  return std::make_unique<NanoflannPcaClassifier>(options);
}

// Lin, Huang, Wang: Convolution in the Cloud: Learning Deformable Kernels in 3D Graph Convolution
// Networks for Point Cloud Analysis (CVPR 2020), Sec. 3.

namespace {

template <typename Real>
using Matrix = std::vector<std::vector<Real>>;  // one row per point

float squared_distance(const Vec3f& a, const Vec3f& b) {
  const float x = a.x() - b.x(), y = a.y() - b.y(), z = a.z() - b.z();
  return x * x + y * y + z * z;
}

/// The `count` candidates nearest to a point, the nearest first.
std::vector<std::uint32_t> nearest(std::span<const Vec3f> points,
                                   const Vec3f& center,
                                   const std::vector<std::uint32_t>& candidates,
                                   std::uint32_t excluded,
                                   int count) {
  std::vector<std::pair<float, std::uint32_t>> order;
  for (std::uint32_t i = 0; i < candidates.size(); ++i)
    if (i != excluded) order.emplace_back(squared_distance(points[candidates[i]], center), i);
  const std::size_t kept = std::min(order.size(), static_cast<std::size_t>(count));
  std::partial_sort(order.begin(), order.begin() + static_cast<std::ptrdiff_t>(kept), order.end());
  std::vector<std::uint32_t> indices;
  for (std::size_t i = 0; i < kept; ++i) indices.push_back(order[i].second);
  return indices;
}

template <typename Real>
std::array<Real, 3> direction(const Vec3f& from, const Vec3f& to) {
  const Real x = to.x() - from.x(), y = to.y() - from.y(), z = to.z() - from.z();
  const Real length = std::sqrt(x * x + y * y + z * z);
  if (length == 0) return {0, 0, 0};
  return {x / length, y / length, z / length};
}

/// Normalized columns of a [3 x columns] tensor.
template <typename Real>
std::vector<std::array<Real, 3>> unit_columns(const std::vector<Real>& tensor) {
  const std::size_t columns = tensor.size() / 3;
  std::vector<std::array<Real, 3>> units(columns);
  for (std::size_t c = 0; c < columns; ++c) {
    const Real x = tensor[c], y = tensor[columns + c], z = tensor[2 * columns + c];
    const Real length = std::sqrt(x * x + y * y + z * z);
    if (length > 0) units[c] = {x / length, y / length, z / length};
  }
  return units;
}

template <typename Real>
Real relu(Real x) {
  return x > 0 ? x : 0;
}

/// Sum over supports of the maximum over neighbors of relu(direction . support) * feature. The
/// feature is 1 if `features` is empty. `features` has the supports side by side.
template <typename Real>
Matrix<Real> support_features(const PlainGraph::Level& level,
                              std::span<const Vec3f> points,
                              const std::vector<Real>& directions,
                              int supports,
                              const Matrix<Real>& features) {
  const std::vector<std::array<Real, 3>> units = unit_columns(directions);
  const std::size_t channels = units.size() / static_cast<std::size_t>(supports);
  Matrix<Real> sums(level.points.size(), std::vector<Real>(channels, 0));
  for (std::size_t i = 0; i < level.points.size(); ++i) {
    std::vector<Real> best(units.size(), 0);
    bool first = true;
    for (const std::uint32_t j : level.neighbors[i]) {
      const auto d = direction<Real>(points[level.points[i]], points[level.points[j]]);
      for (std::size_t c = 0; c < units.size(); ++c) {
        const auto& u = units[c];
        const Real theta = relu(d[0] * u[0] + d[1] * u[1] + d[2] * u[2]);
        const Real value = features.empty() ? theta : theta * features[j][c];
        best[c] = first ? value : std::max(best[c], value);
      }
      first = false;
    }
    for (std::size_t c = 0; c < units.size(); ++c) sums[i][c % channels] += best[c];
  }
  return sums;
}

/// x w + bias, w [in x out].
template <typename Real>
Matrix<Real> product(const Matrix<Real>& x,
                     const std::vector<Real>& w,
                     const std::vector<Real>& bias) {
  Matrix<Real> y(x.size(), bias);
  for (std::size_t i = 0; i < x.size(); ++i)
    for (std::size_t a = 0; a < x[i].size(); ++a)
      for (std::size_t b = 0; b < bias.size(); ++b) y[i][b] += x[i][a] * w[a * bias.size() + b];
  return y;
}

template <typename Real>
Matrix<Real> convolution(const PlainGraph::Level& level,
                         std::span<const Vec3f> points,
                         const Matrix<Real>& x,
                         const std::vector<Real>& weights,
                         const std::vector<Real>& bias,
                         const std::vector<Real>& directions,
                         int supports) {
  const Matrix<Real> all = product(x, weights, bias);
  const std::size_t channels = bias.size() / static_cast<std::size_t>(supports + 1);
  Matrix<Real> center, features;
  for (const auto& row : all) {
    const auto split = row.begin() + static_cast<std::ptrdiff_t>(channels);
    center.emplace_back(row.begin(), split);
    features.emplace_back(split, row.end());
  }
  const Matrix<Real> sums = support_features(level, points, directions, supports, features);
  for (std::size_t i = 0; i < center.size(); ++i)
    for (std::size_t c = 0; c < channels; ++c) center[i][c] += sums[i][c];
  return center;
}

template <typename Real>
void activate(Matrix<Real>& x) {
  for (auto& row : x)
    for (Real& value : row) value = relu(value);
}

/// For every rate-th point, the maximum over its neighbors, or its own value if it has none.
template <typename Real>
Matrix<Real> pool(const PlainGraph::Level& level, const Matrix<Real>& x, int rate) {
  Matrix<Real> pooled;
  for (std::size_t i = 0; i < x.size(); i += static_cast<std::size_t>(rate)) {
    const auto& row = level.pool_neighbors[i];
    pooled.push_back(row.empty() ? x[i] : x[row[0]]);
    for (const std::uint32_t j : row)
      for (std::size_t c = 0; c < x[j].size(); ++c)
        pooled.back()[c] = std::max(pooled.back()[c], x[j][c]);
  }
  return pooled;
}

}  // namespace

PlainGraph make_plain_graph(std::span<const Vec3f> points, const planes::NetworkConfig& config) {
  PlainGraph graph;
  std::vector<std::uint32_t> kept(points.size());
  std::iota(kept.begin(), kept.end(), 0u);
  for (std::size_t l = 0; l < config.levels.size(); ++l) {
    PlainGraph::Level& level = graph.levels.emplace_back();
    level.points = kept;
    for (std::uint32_t i = 0; i < kept.size(); ++i) {
      const Vec3f& p = points[kept[i]];
      level.neighbors.push_back(nearest(points, p, kept, i, config.neighbors));
      level.pool_neighbors.push_back(nearest(points, p, kept, i, config.pool_neighbors));
    }
    for (const Vec3f& p : points)
      level.nearest.push_back(
          nearest(points, p, kept, std::numeric_limits<std::uint32_t>::max(), 1)[0]);
    std::vector<std::uint32_t> next;
    for (std::size_t i = 0; i < kept.size(); i += static_cast<std::size_t>(config.pool_rate))
      next.push_back(kept[i]);
    kept = next;
  }
  return graph;
}

template <typename Real>
std::vector<std::array<Real, 2>> plain_forward(const PlainNetwork<Real>& network,
                                               const PlainGraph& graph,
                                               std::span<const Vec3f> points) {
  const planes::NetworkConfig& config = network.config;
  auto tensor = network.tensors.begin();
  Matrix<Real> x;
  Matrix<Real> fused(points.size());
  for (std::size_t l = 0; l < config.levels.size(); ++l) {
    const PlainGraph::Level& level = graph.levels[l];
    if (l > 0) x = pool(graph.levels[l - 1], x, config.pool_rate);
    for (std::size_t c = 0; c < config.levels[l].size(); ++c) {
      if (x.empty()) {
        x = support_features<Real>(level, points, *tensor++, config.supports, {});
      } else {
        const auto& weights = *tensor++;
        const auto& bias = *tensor++;
        x = convolution(level, points, x, weights, bias, *tensor++, config.supports);
      }
      const bool last = l + 1 == config.levels.size() && c + 1 == config.levels[l].size();
      if (!last) activate(x);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const auto& row = x[level.nearest[i]];
        fused[i].insert(fused[i].end(), row.begin(), row.end());
      }
    }
  }
  if (config.global_feature) {
    std::vector<Real> global = x[0];
    for (const auto& row : x)
      for (std::size_t c = 0; c < row.size(); ++c) global[c] = std::max(global[c], row[c]);
    for (auto& row : fused) row.insert(row.end(), global.begin(), global.end());
  }
  for (std::size_t h = 0; h <= config.head.size(); ++h) {
    const auto& weights = *tensor++;  // [out x in]
    const auto& bias = *tensor++;
    const std::size_t in = fused[0].size();
    std::vector<Real> transposed(weights.size());
    for (std::size_t b = 0; b < bias.size(); ++b)
      for (std::size_t a = 0; a < in; ++a) transposed[a * bias.size() + b] = weights[b * in + a];
    fused = product(fused, transposed, bias);
    if (h < config.head.size()) activate(fused);
  }
  std::vector<std::array<Real, 2>> logits;
  for (const auto& row : fused) logits.push_back({row[0], row[1]});
  return logits;
}

template std::vector<std::array<float, 2>> plain_forward(const PlainNetwork<float>&,
                                                         const PlainGraph&,
                                                         std::span<const Vec3f>);
template std::vector<std::array<double, 2>> plain_forward(const PlainNetwork<double>&,
                                                          const PlainGraph&,
                                                          std::span<const Vec3f>);

}  // namespace planescope::lab
