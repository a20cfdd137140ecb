// Estimates which way is down from the scene: floors and treads are perpendicular to gravity, walls
// and risers parallel to it. Every direction that one plane (as a floor) or two planes (as walls)
// propose is scored against all planes of the image, under a prior on how people and robots hold
// cameras.

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>

#include "core/model/plane.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "core/planes/cloud/image_planes.hpp"

namespace planescope::planes {
namespace {

constexpr double kMostArea_m2 = 0.6;     // a plane larger than this counts no more
constexpr double kAngleSigma_deg = 3;    // how far from right angles real corners are measured
constexpr double kWallShare = 0.5;       // a wall fixes one angle of gravity, a floor both
constexpr double kWallPull = 0.25;       // walls of real rooms lean more than their floors do
constexpr double kUndersideShare = 0.3;  // of a floor's weight: ceilings are seldom in view
constexpr double kRollSigma_deg = 25;    // prior: cameras are seldom rolled,
constexpr double kPitchFrom_deg = -10;   // look ahead or down,
constexpr double kPitchTo_deg = 50;
constexpr double kPitchSigma_deg = 15;  // and beyond that less and less often
constexpr double kSameAnswer_deg = 10;  // candidates closer than this are one
constexpr double kLeastPixels = 0.02;   // of the image must lie on the planes that agree
constexpr double kLeastConfidence = 0.03;
constexpr double kNoFloor = 0.15;  // confidence left to a scene of walls alone
constexpr double kFirm = 0.15;  // support of gravity's least supported angle that halves confidence
constexpr double kOnePlaneConfidence = 0.4;  // where nothing but the prior tells floor from wall

double radians(double degrees) { return degrees * std::numbers::pi / 180; }
double degrees(double radians) { return radians * 180 / std::numbers::pi; }
double bell(double x, double sigma) { return std::exp(-x * x / (2 * sigma * sigma)); }

struct Voter {
  Vec3d normal;
  double weight = 0;
  double nearness = 1;  // 1 for the plane nearest to the camera's foot, less for those beyond
  double sigma_deg = 0;
  double image_share = 0;
};

/// Whether the plane faces up for any camera that does not look straight down at it.
bool may_be_ground(const ImagePlane& plane) { return plane.normal.y() < -0.17; }

std::vector<Voter> make_voters(const std::vector<ImagePlane>& planes, std::size_t pixels) {
  // A camera's carrier mostly stands on level ground: of a floor and a ramp, the nearer is level.
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const ImagePlane& plane : planes)
    if (may_be_ground(plane)) nearest_m = std::min(nearest_m, plane.nearest_m);
  std::vector<Voter> voters;
  for (const ImagePlane& plane : planes) {
    Voter voter;
    voter.normal = plane.normal;
    voter.sigma_deg = std::hypot(kAngleSigma_deg, plane.angle_sigma_deg);
    // The square root: ten small planes say more than one large one, but not ten times more.
    voter.weight = std::sqrt(std::min(plane.area_m2, kMostArea_m2)) *
                   std::pow(kAngleSigma_deg / voter.sigma_deg, 2);
    if (may_be_ground(plane)) voter.nearness = std::pow(nearest_m / plane.nearest_m, 2);
    voter.image_share = plane.pixels / static_cast<double>(pixels);
    voters.push_back(voter);
  }
  return voters;
}

/// How well a plane fits gravity as something level and as something upright, each 0..1, and how
/// much it counts if level.
struct Fit {
  double level = 0;
  double wall = 0;
  bool faces_up = false;
  double share = 1;

  double floor() const { return share * level; }
};

Fit fit(const Voter& voter, const Vec3d& gravity) {
  const double cosine = std::clamp(voter.normal.dot(gravity), -1.0, 1.0);
  const double from_level_deg = degrees(std::acos(std::abs(cosine)));
  Fit result;
  result.level = bell(from_level_deg, voter.sigma_deg);
  result.wall = bell(90 - from_level_deg, voter.sigma_deg);
  result.faces_up = cosine < 0;  // normals face the sensor
  result.share = result.faces_up ? voter.nearness : kUndersideShare;
  return result;
}

/// Sensor frame: y down, z forward.
double prior(const Vec3d& gravity) {
  const double roll_deg = degrees(std::asin(std::clamp(gravity.x(), -1.0, 1.0)));
  const double pitch_deg = degrees(std::asin(std::clamp(gravity.z(), -1.0, 1.0)));  // down
  const double beyond_deg = std::max({0.0, kPitchFrom_deg - pitch_deg, pitch_deg - kPitchTo_deg});
  return bell(roll_deg, kRollSigma_deg) * bell(beyond_deg, kPitchSigma_deg);
}

bool within_limit(const Vec3d& gravity, const GravityOptions& options) {
  return gravity.y() > std::cos(radians(options.max_tilt_deg));
}

struct Candidate {
  Vec3d gravity = Vec3d::UnitY();
  double score = 0;
};

double support(const std::vector<Voter>& voters, const Vec3d& gravity) {
  double sum = 0;
  for (const Voter& voter : voters) {
    const Fit f = fit(voter, gravity);
    sum += voter.weight * (f.floor() + kWallShare * f.wall);
  }
  return sum;
}

/// Weighted least squares: floors ask for |n x g| = 0, walls for n . g = 0.
Vec3d refine(const std::vector<Voter>& voters, Vec3d gravity) {
  for (int round = 0; round < 5; ++round) {
    Mat3d squares = Mat3d::Zero();
    for (const Voter& voter : voters) {
      const Fit f = fit(voter, gravity);
      const Mat3d along = voter.normal * voter.normal.transpose();
      const double precision = voter.weight / (voter.sigma_deg * voter.sigma_deg);
      squares += precision * f.floor() * (Mat3d::Identity() - along);
      squares += precision * kWallPull * f.wall * along;
    }
    const Vec3d direction = eigen_symmetric(squares).vectors.col(0);
    gravity = direction.dot(gravity) < 0 ? Vec3d(-direction) : direction;
  }
  return gravity;
}

/// Support of the angle about which the planes say least: small where all walls are parallel.
double firmness(const std::vector<Voter>& voters, const Vec3d& gravity) {
  const PlaneBasis basis = plane_basis(gravity);
  Eigen::Matrix2d sum = Eigen::Matrix2d::Zero();
  for (const Voter& voter : voters) {
    const Fit f = fit(voter, gravity);
    const Vec2d across(voter.normal.dot(basis.u), voter.normal.dot(basis.v));
    sum += voter.weight * f.floor() * Eigen::Matrix2d::Identity();
    sum += voter.weight * f.wall * across * across.transpose();
  }
  const double half_trace = sum.trace() / 2;
  return half_trace - std::sqrt(std::max(0.0, half_trace * half_trace - sum.determinant()));
}

/// The planes that agree with a direction.
struct Tally {
  int floors = 0, walls = 0;
  double image_share = 0;
};

Tally count(const std::vector<Voter>& voters, const Vec3d& gravity) {
  Tally tally;
  for (const Voter& voter : voters) {
    const Fit f = fit(voter, gravity);
    tally.floors += f.faces_up && f.level > 0.5;
    tally.walls += f.wall > 0.5;
    tally.image_share += voter.image_share * std::max(f.level, f.wall);
  }
  return tally;
}

std::vector<Candidate> make_candidates(const std::vector<Voter>& voters) {
  std::vector<Candidate> candidates;
  const auto propose = [&](Vec3d direction) {
    if (direction.y() < 0) direction = -direction;
    direction = refine(voters, direction);
    candidates.push_back({direction, support(voters, direction) * prior(direction)});
  };
  for (std::size_t i = 0; i < voters.size(); ++i) {
    propose(voters[i].normal);
    for (std::size_t j = i + 1; j < voters.size(); ++j) {
      const Vec3d cross = voters[i].normal.cross(voters[j].normal);
      if (cross.norm() > 0.5) propose(cross.normalized());
    }
  }
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const auto& a, const auto& b) { return a.score > b.score; });
  return candidates;
}

}  // namespace

std::optional<Gravity> estimate_gravity(const Frame& frame, const GravityOptions& options) {
  const std::vector<Voter> voters = make_voters(find_image_planes(frame), frame.depth.pixels());
  const std::vector<Candidate> candidates = make_candidates(voters);
  const auto found = std::find_if(candidates.begin(), candidates.end(), [&](const auto& c) {
    return c.score > 0 && within_limit(c.gravity, options);
  });
  if (found == candidates.end()) return std::nullopt;
  const Candidate& best = *found;
  double runner_up = 0;  // also beyond the limit: its support counts against the answer
  for (const Candidate& other : candidates)
    if (other.gravity.dot(best.gravity) < std::cos(radians(kSameAnswer_deg)))
      runner_up = std::max(runner_up, other.score);

  const Tally tally = count(voters, best.gravity);
  Gravity gravity;
  gravity.direction = best.gravity;
  gravity.source = GravitySource::estimate;
  gravity.note = "estimated from " + std::to_string(tally.floors) + " level and " +
                 std::to_string(tally.walls) + " upright planes";
  const double firm = firmness(voters, best.gravity);
  gravity.confidence =
      std::max(0.0, 1 - runner_up / best.score) * firm / (firm + kFirm) * prior(best.gravity);
  if (tally.floors == 0) gravity.confidence *= kNoFloor;
  if (tally.floors + tally.walls < 2)
    gravity.confidence = std::min(gravity.confidence, kOnePlaneConfidence);
  if (tally.image_share < kLeastPixels || gravity.confidence < kLeastConfidence)
    return std::nullopt;
  return gravity;
}

}  // namespace planescope::planes
