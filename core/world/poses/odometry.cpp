// Odometry from depth frames: registers frames, detects loops and optimizes the pose graph.

#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <memory>

#include "core/labels/review/carry.hpp"
#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/world/poses/poses.hpp"

namespace planescope::world {

// ---- Pose graph ----

namespace {

using Vec6d = Eigen::Matrix<double, 6, 1>;

constexpr int kMostRounds = 20;
constexpr double kSettled = 1e-9;   // size of a step [rad, m]
constexpr double kCauchy = 3;       // sigmas
constexpr double kAnchored = 1e12;  // information of the fixed pose
constexpr double kLoose = 1e-6;     // ... and of unconstrained poses

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

/// Cost to minimize; inconsistent loops have little weight (Cauchy).
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

/// Poses change by rotations and translations in their own axes. To first order, the error of an
/// edge changes with the motion of `to`, and against the motion of `from` as seen from `to`.
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

// Levenberg-Marquardt: a step is accepted only if it reduces the cost, so that weakly constrained
// directions do not diverge.
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

// ---- Odometry ----
// Frames are registered with key frames (projective ICP with brightness, as for carrying labels),
// so the error grows with distance, not with the number of frames. Loops are closed when key frames
// meet again, and a pose graph distributes the residual error.

namespace {

using labels::LabelGrid;
using labels::Registration;
using Grid = std::shared_ptr<const LabelGrid>;

constexpr double kLeastMeasured = 0.02;  // share of a frame's pixels
constexpr int kMostLost = 10;            // consecutive frames before a new segment begins
constexpr double kEffective = 200;       // number of correlated partners worth one
                                         // independent measurement

Grid grid_of(const OdometryJob& job, int index) {
  return registration_grid(*job.recording, index, true);
}

struct Key {
  int frame = 0;
  int segment = 0;
  Pose T_segment_key = Pose::Identity();
};

struct Followed {
  CameraPose pose;
  int key = 0;
  Pose T_key_frame = Pose::Identity();
};

/// The edge from registering a key frame with an earlier one; see PoseEdge.
PoseEdge edge_of(int source, int target, const Registration& registration, bool loop) {
  PoseEdge edge;
  edge.from = source;
  edge.to = target;
  edge.T_from_to = registration.T_to_from.inverse();
  edge.information = effective_information(registration);
  edge.loop = loop;
  return edge;
}

class Following {
 public:
  explicit Following(const OdometryJob& job) : job_(job), options_(job.options) {}

  void take(int frame, const Grid& grid) {
    if (!grid) {
      ++lost_;
      return;
    }
    if (keys_.empty()) return begin_segment(frame, grid);
    const double frames = 1 + lost_;
    // Start from the last camera position. Extrapolating the motion diverges on a floor, where
    // depth does not constrain it and brightness does so for only a few pixels.
    Registration found = labels::register_frames(*grid, *key_grid_, job_.stop, {}, T_key_last_);
    if (!is_credible_step(found, frames) && lost_ == 0) {
      const Registration going =
          labels::register_frames(*grid, *key_grid_, job_.stop, {}, T_key_last_ * step_);
      if (going.fitness > found.fitness) found = going;
    }
    if (!is_credible_step(found, frames)) {
      if (++lost_ > kMostLost) begin_segment(frame, grid);
      return;
    }
    lost_ = 0;
    step_ = T_key_last_.inverse() * found.T_to_from;
    T_key_last_ = found.T_to_from;
    follow(frame, found);
    if (found.fitness < options_.key_fitness ||
        found.T_to_from.translation().norm() > options_.key_distance_m ||
        turn_deg(found.T_to_from) > options_.key_angle_deg)
      make_key(frame, grid, found);
  }

  Trajectory result() {
    if (options_.loops) close_loops();
    Trajectory trajectory{"odometry", {}, true};
    for (Followed& followed : followed_) {
      followed.pose.T_world_camera = keys_[followed.key].T_segment_key * followed.T_key_frame;
      trajectory.poses.push_back(followed.pose);
    }
    return trajectory;
  }

 private:
  bool is_credible_step(const Registration& found, double frames) const {
    return is_credible(found, T_key_last_.inverse() * found.T_to_from, frames, options_);
  }

  void begin_segment(int frame, const Grid& grid) {
    keys_.push_back({frame, keys_.empty() ? 0 : keys_.back().segment + 1, Pose::Identity()});
    key_grid_ = grid;
    T_key_last_ = step_ = Pose::Identity();
    lost_ = 0;
    Registration none;
    none.fitness = none.rms_m = std::nan("");
    follow(frame, none);
  }

  void follow(int frame, const Registration& found) {
    Followed followed;
    followed.pose.frame = frame;
    followed.pose.timestamp_s = job_.recording->timestamp_s(frame);
    followed.pose.segment = keys_.back().segment;
    followed.pose.fitness = found.fitness;
    followed.pose.rms_m = found.rms_m;
    followed.key = static_cast<int>(keys_.size()) - 1;
    followed.T_key_frame = found.T_to_from;
    followed_.push_back(followed);
  }

  void make_key(int frame, const Grid& grid, const Registration& found) {
    const int number = static_cast<int>(keys_.size());
    edges_.push_back(edge_of(number, number - 1, found, false));
    keys_.push_back({frame, keys_.back().segment, keys_.back().T_segment_key * found.T_to_from});
    followed_.back().key = number;
    followed_.back().T_key_frame = Pose::Identity();
    key_grid_ = grid;
    T_key_last_ = Pose::Identity();
  }

  /// For each key frame, registers the nearest earlier one by the current estimate, excluding its
  /// immediate predecessors.
  void close_loops() {
    std::vector<std::pair<int, int>> pairs;
    for (int i = 0; i < std::ssize(keys_); ++i) {
      int best = -1;
      double nearest = 1;
      for (int j = 0; j + options_.loop_gap <= i; ++j) {
        if (keys_[j].segment != keys_[i].segment) continue;
        const Pose motion = keys_[j].T_segment_key.inverse() * keys_[i].T_segment_key;
        const double off = std::max(motion.translation().norm() / options_.loop_distance_m,
                                    turn_deg(motion) / options_.loop_angle_deg);
        if (off < nearest) nearest = off, best = j;
      }
      if (best >= 0) pairs.emplace_back(i, best);
    }
    std::vector<Registration> found(pairs.size());
    work_through(
        static_cast<int>(pairs.size()), job_.threads,
        [&](int p) {
          const auto [i, j] = pairs[p];
          const Grid source = grid_of(job_, keys_[i].frame), target = grid_of(job_, keys_[j].frame);
          if (!source || !target) return;
          found[p] =
              labels::register_frames(*source, *target, job_.stop, {},
                                      keys_[j].T_segment_key.inverse() * keys_[i].T_segment_key);
        },
        [&](int, int) {
          if (job_.stop.stop_requested()) throw Cancelled();
        });
    for (std::size_t p = 0; p < pairs.size(); ++p)
      if (found[p].fitness >= options_.loop_fitness)
        edges_.push_back(edge_of(pairs[p].first, pairs[p].second, found[p], true));
    // Each segment has its own graph and its own fixed first pose.
    for (std::size_t first = 0, end = 0; first < keys_.size(); first = end) {
      end = first;
      while (end < keys_.size() && keys_[end].segment == keys_[first].segment) ++end;
      std::vector<Pose> poses;
      for (std::size_t k = first; k < end; ++k) poses.push_back(keys_[k].T_segment_key);
      std::vector<PoseEdge> edges;
      bool any_loop = false;
      for (PoseEdge edge : edges_)
        if (edge.from >= static_cast<int>(first) && edge.from < static_cast<int>(end)) {
          any_loop |= edge.loop;
          edge.from -= static_cast<int>(first);
          edge.to -= static_cast<int>(first);
          edges.push_back(edge);
        }
      if (!any_loop) continue;
      optimise_poses(poses, edges);
      for (std::size_t k = first; k < end; ++k) keys_[k].T_segment_key = poses[k - first];
    }
  }

  const OdometryJob& job_;
  const OdometryOptions& options_;
  std::vector<Key> keys_;
  std::vector<PoseEdge> edges_;
  std::vector<Followed> followed_;
  Grid key_grid_;
  Pose T_key_last_ = Pose::Identity();
  Pose step_ = Pose::Identity();  // of the last frame
  int lost_ = 0;                  // consecutive lost frames
};

}  // namespace

Grid registration_grid(const io::Recording& recording, int index, bool color) {
  try {
    Frame frame = recording.frame(index);
    if (!color) frame.color = {};
    auto grid = std::make_shared<LabelGrid>(labels::make_label_grid(frame, Gravity{}));
    if (static_cast<double>(grid->measured_count) <
        kLeastMeasured * static_cast<double>(grid->pixels()))
      return nullptr;
    return grid;
  } catch (const Error&) {  // reported when the frame is processed
    return nullptr;
  }
}

bool is_credible(const Registration& found,
                 const Pose& step,
                 double frames,
                 const OdometryOptions& options) {
  return found.fitness >= options.least_fitness &&
         step.translation().norm() <= options.most_step_m * frames &&
         turn_deg(step) <= options.most_step_deg * frames;
}

Eigen::Matrix<double, 6, 6> effective_information(const Registration& registration) {
  return registration.information * (kEffective / std::max(kEffective, registration.partners));
}

Trajectory estimate_trajectory(const OdometryJob& job) {
  const auto count = static_cast<int>(job.frames.size());
  std::vector<Grid> grids(count);
  Following following(job);
  const auto make = [&](int i) {
    if (!job.stop.stop_requested()) grids[i] = grid_of(job, job.frames[i]);
  };
  const auto take = [&](int i) {
    if (job.stop.stop_requested()) throw Cancelled();
    following.take(job.frames[i], grids[i]);
    grids[i].reset();
    if (job.progress) job.progress(i + 1, count);
  };
  work_in_order(count, job.threads, make, take);
  return following.result();
}

}  // namespace planescope::world
