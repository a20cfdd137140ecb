#include "core/model/plane.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace planescope {

Eigen3 eigen_symmetric(const Mat3d& matrix) {
  Mat3d a = matrix;
  Mat3d v = Mat3d::Identity();
  for (int sweep = 0; sweep < 32; ++sweep) {
    const double off = std::abs(a(0, 1)) + std::abs(a(0, 2)) + std::abs(a(1, 2));
    if (off == 0) break;
    for (int p = 0; p < 2; ++p) {
      for (int q = p + 1; q < 3; ++q) {
        const double apq = a(p, q);
        const double scale = std::abs(a(p, p)) + std::abs(a(q, q));
        if (apq == 0 || scale + std::abs(apq) * 1e-3 == scale) {
          a(p, q) = a(q, p) = 0;
          continue;
        }
        // Golub & Van Loan, Sec. 8.5.2: the smaller of the two rotations that zero a(p, q).
        const double theta = (a(q, q) - a(p, p)) / (2 * apq);
        const double t =
            (theta >= 0 ? 1.0 : -1.0) / (std::abs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1);
        const double s = t * c;
        const int r = 3 - p - q;
        a(p, p) -= t * apq;
        a(q, q) += t * apq;
        a(p, q) = a(q, p) = 0;
        const double arp = a(r, p), arq = a(r, q);
        a(r, p) = a(p, r) = c * arp - s * arq;
        a(r, q) = a(q, r) = s * arp + c * arq;
        for (int k = 0; k < 3; ++k) {
          const double vkp = v(k, p), vkq = v(k, q);
          v(k, p) = c * vkp - s * vkq;
          v(k, q) = s * vkp + c * vkq;
        }
      }
    }
  }
  std::array<int, 3> order{0, 1, 2};
  std::stable_sort(order.begin(), order.end(), [&](int i, int j) { return a(i, i) < a(j, j); });
  Eigen3 result;
  for (int k = 0; k < 3; ++k) {
    result.values[k] = a(order[k], order[k]);
    result.vectors.col(k) = v.col(order[k]);
  }
  return result;
}

PlaneFit fit_plane(const Moments& moments) {
  PlaneFit fit;
  fit.count = moments.count;
  if (moments.count < 1) return fit;
  fit.centroid = moments.mean();
  if (moments.count < 3) return fit;
  const Eigen3 eigen = eigen_symmetric(moments.scatter());
  fit.eigenvalues = eigen.values.cwiseMax(0.0);  // rounding may leave -1e-17
  fit.normal = eigen.vectors.col(0).normalized();
  Eigen::Index largest = 0;
  fit.normal.cwiseAbs().maxCoeff(&largest);
  if (fit.normal[largest] < 0) fit.normal = -fit.normal;
  return fit;
}

double PlaneFit::rms_m() const { return count > 0 ? std::sqrt(eigenvalues[0] / count) : 0; }

}  // namespace planescope
