#include "core/world/poses/pose_graph.hpp"

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>

namespace planescope::world {
namespace {

using Vec6d = Eigen::Matrix<double, 6, 1>;

constexpr int kMostRounds = 20;
constexpr double kSettled = 1e-9;   // of a step [rad, m]
constexpr double kCauchy = 3;       // sigmas
constexpr double kAnchored = 1e12;  // information of the pose that stays
constexpr double kLoose = 1e-6;     // ... and of poses that nothing holds

Vec3d log_of(const Mat3d& rotation) {
  const Eigen::AngleAxisd turn(rotation);
  return turn.angle() * turn.axis();
}

Mat3d exp_of(const Vec3d& turn) {
  const double angle = turn.norm();
  if (!(angle > 0)) return Mat3d::Identity();
  return Eigen::AngleAxisd(angle, turn / angle).toRotationMatrix();
}

Mat3d cross_matrix(const Vec3d& v) {
  Mat3d m;
  m << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
  return m;
}

Vec6d error_of(const PoseEdge& edge, const std::vector<Pose>& poses) {
  const Pose off = edge.T_from_to.inverse() * poses[edge.from].inverse() * poses[edge.to];
  Vec6d error;
  error << log_of(off.linear()), off.translation();
  return error;
}

}  // namespace

namespace {

constexpr double kLeastDamping = 1e-6, kMostDamping = 1e6;

/// What is made small: loops that agree with nothing count little (Cauchy).
double cost_of(const std::vector<PoseEdge>& edges, const std::vector<Pose>& poses) {
  double cost = 0;
  for (const PoseEdge& edge : edges) {
    const Vec6d error = error_of(edge, poses);
    const double squares = error.dot(edge.information * error), c2 = kCauchy * kCauchy;
    cost += edge.loop ? c2 * std::log1p(squares / c2) : squares;
  }
  return cost;
}

struct Normal {
  Eigen::SparseMatrix<double> h;
  Eigen::VectorXd b;
};

/// Poses move by turns and shifts in their own axes. To first order the error of `to` moves with
/// its own, and against that of `from`, seen from `to`.
Normal normal_of(const std::vector<PoseEdge>& edges, const std::vector<Pose>& poses) {
  const auto n = static_cast<Eigen::Index>(poses.size());
  Normal normal{Eigen::SparseMatrix<double>(6 * n, 6 * n), Eigen::VectorXd::Zero(6 * n)};
  std::vector<Eigen::Triplet<double>> entries;
  const auto add = [&](int row, int column, const Mat6d& block) {
    for (int r = 0; r < 6; ++r)
      for (int c = 0; c < 6; ++c) entries.emplace_back(6 * row + r, 6 * column + c, block(r, c));
  };
  for (int i = 0; i < n; ++i) add(i, i, Mat6d::Identity() * (i == 0 ? kAnchored : kLoose));
  for (const PoseEdge& edge : edges) {
    const Vec6d error = error_of(edge, poses);
    double weight = 1;
    if (edge.loop) weight = 1 / (1 + error.dot(edge.information * error) / (kCauchy * kCauchy));
    const Mat6d information = weight * edge.information;
    const Pose T_to_from = poses[edge.to].inverse() * poses[edge.from];
    Mat6d of_from = Mat6d::Zero();
    of_from.topLeftCorner<3, 3>() = -T_to_from.linear();
    of_from.bottomRightCorner<3, 3>() = -T_to_from.linear();
    of_from.bottomLeftCorner<3, 3>() =
        T_to_from.linear() * cross_matrix(T_to_from.inverse().translation());
    const Mat6d a = of_from.transpose() * information;
    add(edge.from, edge.from, a * of_from);
    add(edge.from, edge.to, a);
    add(edge.to, edge.from, a.transpose());
    add(edge.to, edge.to, information);
    normal.b.segment<6>(6 * edge.from) -= a * error;
    normal.b.segment<6>(6 * edge.to) -= information * error;
  }
  normal.h.setFromTriplets(entries.begin(), entries.end());
  return normal;
}

std::vector<Pose> moved(const std::vector<Pose>& poses, const Eigen::VectorXd& step) {
  std::vector<Pose> moved = poses;
  for (std::size_t i = 0; i < poses.size(); ++i) {
    Pose move = Pose::Identity();
    move.linear() = exp_of(step.segment<3>(6 * static_cast<Eigen::Index>(i)));
    move.translation() = step.segment<3>(6 * static_cast<Eigen::Index>(i) + 3);
    moved[i] = poses[i] * move;
  }
  return moved;
}

}  // namespace

// Levenberg and Marquardt's: a step is taken only where it makes the cost smaller, so that edges
// which say little of some direction throw no pose away along it.
void optimise_poses(std::vector<Pose>& poses, const std::vector<PoseEdge>& edges) {
  if (poses.size() < 2 || edges.empty()) return;
  Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver;
  double damping = kLeastDamping, cost = cost_of(edges, poses);
  for (int round = 0; round < kMostRounds && damping < kMostDamping; ++round) {
    const Normal normal = normal_of(edges, poses);
    bool better = false;
    while (!better && damping < kMostDamping) {
      Eigen::SparseMatrix<double> h = normal.h;
      for (Eigen::Index i = 0; i < h.rows(); ++i) h.coeffRef(i, i) *= 1 + damping;
      solver.compute(h);
      if (solver.info() != Eigen::Success) return;
      const Eigen::VectorXd step = solver.solve(normal.b);
      if (!step.allFinite()) return;
      std::vector<Pose> next = moved(poses, step);
      const double next_cost = cost_of(edges, next);
      better = next_cost < cost;
      damping = better ? std::max(kLeastDamping, damping / 10) : damping * 10;
      if (!better) continue;
      poses = std::move(next);
      cost = next_cost;
      if (step.norm() < kSettled * static_cast<double>(poses.size())) return;
    }
  }
}

}  // namespace planescope::world
