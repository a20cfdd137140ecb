// Fits planes to moments: 3x3 eigenvalues by Jacobi rotations, convex hulls and polygon areas.

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
  std::array<int, 3> order{0, 1, 2};  // by value; equal values keep their order
  for (const int k : {0, 1, 0})
    if (a(order[k + 1], order[k + 1]) < a(order[k], order[k])) std::swap(order[k], order[k + 1]);
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

namespace {

double cross(const Vec2d& o, const Vec2d& a, const Vec2d& b) {
  return (a.x() - o.x()) * (b.y() - o.y()) - (a.y() - o.y()) * (b.x() - o.x());
}

}  // namespace

PlaneBasis plane_basis(const Vec3d& normal) {
  // The world axis farthest from the normal, so that the basis is stable under small changes.
  const Vec3d axis = std::abs(normal.z()) < 0.9 ? Vec3d::UnitZ() : Vec3d::UnitX();
  PlaneBasis basis;
  basis.u = axis.cross(normal).normalized();
  basis.v = normal.cross(basis.u);
  return basis;
}

std::vector<Vec2d> convex_hull(std::vector<Vec2d> points) {
  // Andrew's monotone chain.
  std::sort(points.begin(), points.end(), [](const Vec2d& a, const Vec2d& b) {
    return a.x() < b.x() || (a.x() == b.x() && a.y() < b.y());
  });
  points.erase(std::unique(points.begin(), points.end()), points.end());
  if (points.size() < 3) return points;
  std::vector<Vec2d> hull;
  const auto extend = [&](const Vec2d& p, std::size_t keep) {
    while (hull.size() >= keep + 2 && cross(hull[hull.size() - 2], hull.back(), p) <= 0)
      hull.pop_back();
    hull.push_back(p);
  };
  for (const Vec2d& p : points) extend(p, 0);
  const std::size_t lower = hull.size() - 1;
  for (auto it = points.rbegin() + 1; it != points.rend(); ++it) extend(*it, lower);
  hull.pop_back();
  return hull;
}

double polygon_area(std::span<const Vec2d> polygon) {
  double twice = 0;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec2d& a = polygon[i];
    const Vec2d& b = polygon[(i + 1) % polygon.size()];
    twice += a.x() * b.y() - a.y() * b.x();
  }
  return twice / 2;
}

}  // namespace planescope
