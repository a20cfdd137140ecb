// PCA classifier: labels each point by the normal of its neighborhood.

#include "core/planes/classify/classifier.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>

#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/model/plane.hpp"
#include "core/planes/classify/neighbour_grid.hpp"

namespace planescope::planes {

Classification classify_about_origin(const Classifier& classifier,
                                     std::span<const Vec3d> points,
                                     int threads) {
  Bounds bounds;
  for (const Vec3d& p : points)
    if (p.allFinite()) bounds.add(p);
  std::vector<Vec3f> local;
  local.reserve(points.size());
  for (const Vec3d& p : points) local.push_back((p - bounds.min).cast<float>());
  return classifier.classify(local, threads);
}

// Sun et al. 2023, Eq. (1): the angle between the local surface normal and gravity. The normal is
// estimated by PCA of the nearest neighbors.

namespace {

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

struct Verdict {
  Label label = Label::h;
  float margin = 0;
};

/// Unit eigenvector of the smallest eigenvalue, if that eigenvalue is well separated. Much faster
/// than Jacobi rotations, and accurate to nearly full double precision.
std::optional<Vec3d> clear_normal(const Mat3d& scatter) {
  const double trace = scatter.trace();
  if (!(trace > 0)) return std::nullopt;
  Mat3d a = scatter / trace;
  // Newton's method from 0 toward the smallest root of l^3 - l^2 + minors l - det; it never
  // overshoots.
  const Vec3d minors = a.row(1).cross(a.row(2));
  const double det = a.row(0).dot(minors);
  const double sum_of_minors = minors.x() + (a(0, 0) * a(2, 2) - a(0, 2) * a(0, 2)) +
                               (a(0, 0) * a(1, 1) - a(0, 1) * a(0, 1));
  double root = 0, step = 1;
  for (int i = 0; i < 12 && std::abs(step) > 1e-14; ++i) {
    const double value = ((root - 1) * root + sum_of_minors) * root - det;
    const double slope = (3 * root - 2) * root + sum_of_minors;
    if (!(slope > 1e-3)) return std::nullopt;  // (l1 - root) (l2 - root), at the root
    step = value / slope;
    root -= step;
  }
  if (std::abs(step) > 1e-14) return std::nullopt;
  a.diagonal().array() -= root;
  Vec3d normal = Vec3d::Zero();  // orthogonal to all rows; two rows are independent
  for (int row = 0; row < 3; ++row) {
    const Vec3d candidate = a.row(row).cross(a.row((row + 1) % 3));
    if (candidate.squaredNorm() > normal.squaredNorm()) normal = candidate;
  }
  return normal.normalized();
}

Verdict classify_normal(const Vec3d& normal, double max_angle_deg) {
  const double angle_deg = degrees(std::acos(std::min(1.0, std::abs(normal.z()))));
  if (angle_deg <= max_angle_deg)
    return {Label::h, static_cast<float>((max_angle_deg - angle_deg) / max_angle_deg)};
  return {Label::v, static_cast<float>((angle_deg - max_angle_deg) / (90 - max_angle_deg))};
}

/// `moments`: of the neighbors, relative to the point.
Verdict classify_moments(const Moments& moments, double max_angle_deg) {
  const Mat3d scatter = moments.scatter();
  if (const auto normal = clear_normal(scatter)) return classify_normal(*normal, max_angle_deg);
  // Fewer than three points, or points that coincide or are collinear, have no normal: return the
  // best guess with margin 0.
  constexpr double kFlat = 1e-9;  // fraction of the largest eigenvalue; below float precision of
                                  // the coordinates
  const Eigen3 eigen = eigen_symmetric(scatter);
  if (moments.count < 3 || eigen.values[2] <= 0) return {Label::h, 0};
  if (eigen.values[1] <= kFlat * eigen.values[2]) {
    const Vec3d line = eigen.vectors.col(2);
    return {std::abs(line.z()) > std::numbers::sqrt2 / 2 ? Label::v : Label::h, 0};
  }
  return classify_normal(eigen.vectors.col(0).normalized(), max_angle_deg);
}

class PcaClassifier final : public Classifier {
 public:
  explicit PcaClassifier(const PcaClassifierOptions& options) : options_(options) {
    if (options.neighbors < 3 || options.neighbors > 1024)
      throw Error("pca_neighbours is " + std::to_string(options.neighbors) +
                  "; expected 3 to 1024");
    if (!(options.max_angle_deg > 0 && options.max_angle_deg < 90))
      throw Error("pca_max_angle_deg is " + std::to_string(options.max_angle_deg) +
                  "; expected a number between 0 and 90");
  }

  std::string name() const override { return "pca"; }

  Classification classify(std::span<const Vec3f> points, int threads) const override {
    return classify_finite(points,
                           [&](std::span<const Vec3f> finite) { return label(finite, threads); });
  }

 private:
  Classification label(std::span<const Vec3f> input, int threads) const {
    const NeighborGrid grid(input, options_.neighbors);
    const std::span<const Vec3f> points = grid.points();
    Classification result;
    result.labels.resize(points.size());
    result.margins.resize(points.size());
    const auto k = static_cast<std::size_t>(options_.neighbors);
    parallel_for(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> rows((end - begin) * k);
      grid.nearest(options_.neighbors, begin, end, rows.data());
      const std::uint32_t* row = rows.data();
      for (std::size_t i = begin; i < end; ++i, row += k) {
        Moments moments;
        for (std::size_t j = 0; j < k && row[j] != kNoNeighbor; ++j)
          moments.add((points[row[j]] - points[i]).cast<double>());
        const Verdict verdict = classify_moments(moments, options_.max_angle_deg);
        result.labels[grid.order()[i]] = verdict.label;
        result.margins[grid.order()[i]] = verdict.margin;
      }
    });
    return result;
  }

  PcaClassifierOptions options_;
};

}  // namespace

std::unique_ptr<Classifier> make_pca_classifier(const PcaClassifierOptions& options) {
  return std::make_unique<PcaClassifier>(options);
}

}  // namespace planescope::planes
