// Jose Luis Blanco, Pranjal Kumar Rai: nanoflann, a C++ header-only fork of FLANN (2014).

#include "core/planes/rivals/nanoflann_pca.hpp"

#include <Eigen/Eigenvalues>
#include <cmath>
#include <nanoflann.hpp>
#include <numbers>

#include "core/model/parallel.hpp"
#include "core/planes/classify/classifier.hpp"

namespace planescope::planes {
namespace {

/// The interface through which nanoflann reads a cloud.
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
                std::span<const std::uint32_t> neighbours,
                const Vec3f& about) {
  Vec3d sum = Vec3d::Zero();
  Mat3d squares = Mat3d::Zero();
  for (const std::uint32_t j : neighbours) {
    const Vec3d d = (points[j] - about).cast<double>();
    sum += d;
    squares += d * d.transpose();
  }
  const double n = static_cast<double>(neighbours.size());
  Eigen::SelfAdjointEigenSolver<Mat3d> solver;
  solver.computeDirect(squares - sum * sum.transpose() / n);
  return solver.eigenvectors().col(0);
}

class NanoflannPcaClassifier final : public Classifier {
 public:
  explicit NanoflannPcaClassifier(const PcaClassifierOptions& options)
      : neighbours_(static_cast<std::size_t>(options.neighbours)),
        boundary_(std::cos(options.max_angle_deg * std::numbers::pi / 180)) {}

  std::string name() const override { return "nanoflann"; }

  Classification classify(std::span<const Vec3f> points, int threads) const override {
    return classify_finite(points,
                           [&](std::span<const Vec3f> finite) { return label(finite, threads); });
  }

 private:
  Classification label(std::span<const Vec3f> points, int threads) const {
    const CloudView view{points};
    const Tree tree(3, view, nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize));
    Classification result;
    result.labels.resize(points.size());
    result.margins.resize(points.size());
    // In the tree's order, so that one search finds in the cache what the last one read.
    parallel_for(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> found(neighbours_);
      std::vector<float> distances(neighbours_);
      for (std::size_t n = begin; n < end; ++n) {
        const std::uint32_t i = tree.vAcc[n];
        const std::size_t count =
            tree.knnSearch(points[i].data(), neighbours_, found.data(), distances.data());
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
  std::size_t neighbours_;
  double boundary_;  // of the normal's z component
};

}  // namespace

std::unique_ptr<Classifier> make_nanoflann_pca_classifier(const PcaClassifierOptions& options) {
  return std::make_unique<NanoflannPcaClassifier>(options);
}

}  // namespace planescope::planes
