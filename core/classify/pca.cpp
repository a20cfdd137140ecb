// Sun et al. 2023, Eq. (1): the angle between the local surface normal and gravity, the normal here
// by PCA of the nearest neighbours.

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "core/base/error.hpp"
#include "core/base/parallel.hpp"
#include "core/classify/classifier.hpp"
#include "core/classify/finite.hpp"
#include "core/classify/neighbour_grid.hpp"
#include "core/geometry/plane.hpp"

namespace planescope {
namespace {

double degrees(double radians) { return radians * 180 / std::numbers::pi; }

struct Verdict {
  Label label = Label::h;
  float margin = 0;
};

/// `moments`: of the neighbours, about the point itself.
Verdict judge(const Moments& moments, double max_angle_deg) {
  // Fewer than three points, or all in one place or line, have no normal: a best guess, unsure.
  constexpr double kFlat = 1e-9;  // of the largest eigenvalue: beyond what float coordinates carry
  const PlaneFit fit = fit_plane(moments);
  if (fit.eigenvalues[2] <= 0) return {Label::h, 0};
  if (fit.eigenvalues[1] <= kFlat * fit.eigenvalues[2]) {
    const Vec3d line = eigen_symmetric(moments.scatter()).vectors.col(2);
    return {std::abs(line.z()) > std::numbers::sqrt2 / 2 ? Label::v : Label::h, 0};
  }
  const double angle_deg = degrees(std::acos(std::min(1.0, std::abs(fit.normal.z()))));
  if (angle_deg <= max_angle_deg)
    return {Label::h, static_cast<float>((max_angle_deg - angle_deg) / max_angle_deg)};
  return {Label::v, static_cast<float>((angle_deg - max_angle_deg) / (90 - max_angle_deg))};
}

class PcaClassifier final : public Classifier {
 public:
  explicit PcaClassifier(const PcaClassifierOptions& options) : options_(options) {
    if (options.neighbours < 3 || options.neighbours > 1024)
      throw Error("pca neighbours is " + std::to_string(options.neighbours) +
                  ", expected 3 to 1024");
    if (!(options.max_angle_deg > 0 && options.max_angle_deg < 90))
      throw Error("pca max_angle_deg is " + std::to_string(options.max_angle_deg) +
                  ", expected a number between 0 and 90");
  }

  std::string name() const override { return "pca"; }

  Classification classify(std::span<const Vec3f> points, int threads) const override {
    return classify_finite(points,
                           [&](std::span<const Vec3f> finite) { return label(finite, threads); });
  }

 private:
  Classification label(std::span<const Vec3f> input, int threads) const {
    const NeighbourGrid grid(input, options_.neighbours);
    const std::span<const Vec3f> points = grid.points();
    Classification result;
    result.labels.resize(points.size());
    result.margins.resize(points.size());
    const auto k = static_cast<std::size_t>(options_.neighbours);
    parallel_for(points.size(), threads, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> rows((end - begin) * k);
      grid.nearest(options_.neighbours, begin, end, rows.data());
      const std::uint32_t* row = rows.data();
      for (std::size_t i = begin; i < end; ++i, row += k) {
        Moments moments;
        for (std::size_t j = 0; j < k && row[j] != kNoNeighbour; ++j)
          moments.add((points[row[j]] - points[i]).cast<double>());
        const Verdict verdict = judge(moments, options_.max_angle_deg);
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

}  // namespace planescope
