// Gravity from options, the recording, picked surfaces, or a vote of the scene's planes.

#include "core/planes/cloud/gravity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <sstream>
#include <string>

#include "core/model/error.hpp"
#include "core/model/plane.hpp"

namespace planescope::planes {

GravityOptions parse_gravity(const std::string& text) {
  GravityOptions options;
  if (text == "auto") return options;
  if (text == "imu") {
    options.mode = GravityMode::imu;
    return options;
  }
  if (text == "estimate") {
    options.mode = GravityMode::estimate;
    return options;
  }
  if (text == "none") {
    options.mode = GravityMode::none;
    return options;
  }
  std::istringstream in(text);
  in.imbue(std::locale::classic());
  Vec3d direction;
  char comma1 = 0, comma2 = 0, rest = 0;
  in >> direction.x() >> comma1 >> direction.y() >> comma2 >> direction.z();
  if (in.fail() || comma1 != ',' || comma2 != ',' || in >> rest || !direction.allFinite() ||
      !(direction.norm() > 0))
    throw Error("gravity is \"" + text +
                "\"; expected auto, imu, estimate, none, or a nonzero direction X,Y,Z");
  options.mode = GravityMode::fixed;
  options.direction = direction;
  return options;
}

namespace {

/// The direction in which things fall before a camera that looks level, or in a cloud with z up.
Vec3d lower_edge(const Frame& frame) {
  const bool z_is_up = frame.is_cloud() && !frame.cloud->optical;
  return z_is_up ? Vec3d(-Vec3d::UnitZ()) : Vec3d(Vec3d::UnitY());
}

}  // namespace

Gravity unknown_gravity(const Frame& frame, const std::string& why) {
  Gravity gravity;
  gravity.direction = lower_edge(frame);
  gravity.source = GravitySource::none;
  gravity.confidence = 0;
  gravity.note = why;
  return gravity;
}

namespace {

constexpr double kFacing_deg = 15;    // largest angle between the normal of a facing plane and the
                                      // optical axis
constexpr double kFacingShare = 0.5;  // smallest share of the measured pixels covered by such
                                      // a plane
constexpr double kContraryShare = 0.1;  // largest share covered by planes of other directions

/// Whether a plane facing the camera covers most of the image.
bool one_plane_faces_camera(const Frame& frame, std::size_t measured) {
  double facing = 0, contrary = 0;
  for (const ImagePlane& plane : find_image_planes(frame)) {
    const bool faces = std::abs(plane.normal.z()) > std::cos(kFacing_deg * std::numbers::pi / 180);
    (faces ? facing : contrary) += plane.pixels;
  }
  const auto all = static_cast<double>(measured);
  return facing > kFacingShare * all && contrary < kContraryShare * all;
}

struct WhyUnknown {
  std::string why;
  bool gravity_helps = true;  // whether specifying gravity, or --gravity none, would help
};

/// Explains why a depth image does not determine gravity.
WhyUnknown why_unknown(const Frame& frame, double max_range_m) {
  std::size_t measured = 0;
  std::uint16_t nearest = 65535, farthest = 0;
  for (const std::uint16_t count : frame.depth.data) {
    if (count == 0 || count == 65535) continue;
    ++measured;
    nearest = std::min(nearest, count);
    farthest = std::max(farthest, count);
  }
  if (measured == 0)
    return {fmt::format("contains no depth: all pixels are 0{}",
                        std::ranges::count(frame.depth.data, 65535) > 0 ? " or 65535" : ""),
            false};
  if (max_range_m > 0 && nearest * frame.depth_unit_m > max_range_m)
    return {fmt::format("all depths are between {:.4g} and {:.4g} m, beyond --max-range {:.6g} m: "
                        "is --depth-unit {:.6g} correct?",
                        nearest * frame.depth_unit_m, farthest * frame.depth_unit_m, max_range_m,
                        frame.depth_unit_m),
            false};
  if (one_plane_faces_camera(frame, measured))
    return {
        "one plane faces the camera: a wall straight ahead (--gravity 0,1,0), or a floor under a "
        "camera that looks down (--gravity 0,0,1)"};
  return {"gravity cannot be estimated from the scene"};
}

/// Returns nullopt and the reason if no source determines gravity.
std::optional<Gravity> found_gravity(const Frame& frame,
                                     const GravityOptions& options,
                                     double max_range_m,
                                     WhyUnknown& why_not) {
  if (options.mode == GravityMode::imu) {
    if (frame.gravity && frame.gravity->source == GravitySource::imu) return frame.gravity;
    why_not.why = "the recording has no accelerometer data";
    return std::nullopt;
  }
  if (options.mode == GravityMode::automatic) {
    if (frame.gravity) return frame.gravity;
    if (frame.is_cloud())
      return Gravity{lower_edge(frame), GravitySource::assumed, 1,
                     frame.cloud->optical ? "assumed: the cloud's camera looks level, y is down"
                                          : "assumed: the cloud's z axis points up"};
  }
  if (frame.is_cloud()) {
    why_not.why = "gravity can be estimated only from depth images";
    return std::nullopt;
  }
  std::optional<Gravity> estimated = estimate_gravity(frame, options);
  if (!estimated) why_not = why_unknown(frame, max_range_m);
  return estimated;
}

}  // namespace

Gravity resolve_gravity(const Frame& frame, const GravityOptions& options, double max_range_m) {
  if (options.mode == GravityMode::none)
    return unknown_gravity(frame, "unknown because of --gravity none");
  if (options.mode == GravityMode::fixed) {
    Gravity gravity;
    // Scale first, so that squares of tiny components do not underflow.
    const Vec3d scaled = options.direction / options.direction.cwiseAbs().maxCoeff();
    if (!scaled.allFinite()) throw Error("gravity is not a direction; expected a nonzero X,Y,Z");
    gravity.direction = scaled.normalized();
    gravity.source = GravitySource::option;
    gravity.note = "given by the user";
    return gravity;
  }
  WhyUnknown why_not;
  if (const auto found = found_gravity(frame, options, max_range_m, why_not)) return *found;
  if (options.none_where_unknown) return unknown_gravity(frame, why_not.why);
  std::string text = "frame " + frame.name + ": " + why_not.why;
  if (why_not.gravity_helps)
    text += std::string("; ") + kHowToGiveGravity +
            "; --gravity none finds planes without distinguishing h from v";
  throw Error(text);
}

namespace {

// A wall less upright than this (by the gravity known so far) was probably picked instead of a
// floor, or the known gravity is too inaccurate.
constexpr double kLeastUpright_deg = 30;
// Normals closer to parallel than this amplify their errors more than threefold.
constexpr double kLeastCorner_deg = 20;

double in_degrees(double radians) { return radians * 180 / std::numbers::pi; }

constexpr double kDoubt_deg = 20;
constexpr double kClearConfidence = 0.3;  // smallest confidence of an estimate that may contradict
                                          // the given direction

std::string whole_degrees(double angle_deg) {
  return std::to_string(static_cast<int>(std::lround(angle_deg))) + "\u00b0";
}

std::optional<Vec3d> of_one_wall(const Vec3d& normal, const Vec3d& before, std::string& why_not) {
  const double upright_deg = in_degrees(std::acos(std::min(1.0, std::abs(normal.dot(before)))));
  if (upright_deg < kLeastUpright_deg) {
    why_not = "that surface is tilted only " + whole_degrees(upright_deg) +
              " from horizontal; expected a wall, not a floor";
    return std::nullopt;
  }
  return Vec3d(before - before.dot(normal) * normal).normalized();
}

}  // namespace

std::string doubt_in_gravity(const Frame& frame,
                             const Vec3d& given,
                             const GravityOptions& options) {
  const Vec3d direction = given.normalized();
  if (frame.is_cloud()) return "";
  const auto seen = estimate_gravity(frame, options);
  if (!seen || seen->confidence < kClearConfidence) return "";
  const double off_deg =
      in_degrees(std::acos(std::clamp(direction.dot(seen->direction), -1.0, 1.0)));
  if (off_deg <= kDoubt_deg) return "";
  const Vec3d& d = seen->direction;
  return fmt::format(
      "gravity {:.3f},{:.3f},{:.3f} disagrees with the scene by {}: the scene suggests "
      "{:.3f},{:.3f},{:.3f} "
      "({}, confidence {:.2f})",
      direction.x(), direction.y(), direction.z(), whole_degrees(off_deg), d.x(), d.y(), d.z(),
      seen->note, seen->confidence);
}

Vec3d gravity_of_floor(const Vec3d& normal) { return -normal.normalized(); }

std::optional<Vec3d> gravity_of_walls(std::span<const Vec3d> normals,
                                      const Vec3d& before,
                                      std::string* why_not) {
  std::string why;
  std::optional<Vec3d> direction;
  if (normals.size() == 1) {
    direction = of_one_wall(normals[0], before.normalized(), why);
  } else if (!normals.empty()) {
    double corner_deg = 0;  // the largest angle between two normals
    Mat3d squares = Mat3d::Zero();
    for (const Vec3d& a : normals) {
      squares += a * a.transpose();
      for (const Vec3d& b : normals)
        corner_deg = std::max(corner_deg, in_degrees(std::acos(std::min(1.0, std::abs(a.dot(b))))));
    }
    if (corner_deg < kLeastCorner_deg) {
      why = "the walls are parallel to within " + whole_degrees(corner_deg) +
            ": click a wall at an angle to them";
    } else {
      const Vec3d across = eigen_symmetric(squares).vectors.col(0);
      direction = across.dot(before) < 0 ? Vec3d(-across) : across;
    }
  }
  if (!direction && why_not) *why_not = why;
  return direction;
}

// Estimates the direction of gravity from the scene: floors and treads are perpendicular to it,
// walls and risers parallel. Each direction proposed by one plane (as a floor) or two planes
// (as walls) is scored against all planes of the image, with a prior on how people and robots
// hold cameras.

namespace {

constexpr double kMostArea_m2 = 0.6;     // planes larger than this gain no more weight
constexpr double kAngleSigma_deg = 3;    // deviation of measured real corners from right angles
constexpr double kWallShare = 0.5;       // a wall fixes one angle of gravity, a floor both
constexpr double kWallPull = 0.25;       // walls of real rooms lean more than floors
constexpr double kUndersideShare = 0.3;  // share of a floor's weight: ceilings are seldom visible
constexpr double kRollSigma_deg = 25;    // prior: cameras are seldom rolled,
constexpr double kPitchFrom_deg = -10;   // look ahead or down
constexpr double kPitchTo_deg = 50;
constexpr double kPitchSigma_deg = 15;  // and become unlikely beyond that range
constexpr double kSameAnswer_deg = 10;  // candidates closer than this are one candidate
constexpr double kLeastPixels = 0.02;   // smallest share of the image on planes that agree
constexpr double kLeastConfidence = 0.03;
constexpr double kNoFloor = 0.15;  // confidence factor of a scene with walls only
constexpr double kFirm = 0.15;  // support of the least supported angle at which confidence halves
constexpr double kOnePlaneConfidence = 0.4;  // largest confidence if only the prior distinguishes
                                             // floor from wall

double radians(double degrees) { return degrees * std::numbers::pi / 180; }
double degrees(double radians) { return radians * 180 / std::numbers::pi; }
double bell(double x, double sigma) { return std::exp(-x * x / (2 * sigma * sigma)); }

struct Voter {
  Vec3d normal;
  double weight = 0;
  double nearness = 1;  // 1 for the plane nearest to the camera's base, less for those beyond
  double sigma_deg = 0;
  double image_share = 0;
};

/// Whether the plane faces up for every camera that does not look straight down at it.
bool may_be_ground(const ImagePlane& plane) { return plane.normal.y() < -0.17; }

std::vector<Voter> make_voters(const std::vector<ImagePlane>& planes, std::size_t pixels) {
  // Cameras are mostly carried on level ground: between a floor and a ramp, the nearer one
  // is level.
  double nearest_m = std::numeric_limits<double>::infinity();
  for (const ImagePlane& plane : planes)
    if (may_be_ground(plane)) nearest_m = std::min(nearest_m, plane.nearest_m);
  std::vector<Voter> voters;
  for (const ImagePlane& plane : planes) {
    Voter voter;
    voter.normal = plane.normal;
    voter.sigma_deg = std::hypot(kAngleSigma_deg, plane.angle_sigma_deg);
    // Square root: ten small planes count more than one large one, but not ten times as much.
    voter.weight = std::sqrt(std::min(plane.area_m2, kMostArea_m2)) *
                   std::pow(kAngleSigma_deg / voter.sigma_deg, 2);
    if (may_be_ground(plane)) voter.nearness = std::pow(nearest_m / plane.nearest_m, 2);
    voter.image_share = plane.pixels / static_cast<double>(pixels);
    voters.push_back(voter);
  }
  return voters;
}

/// How well a plane fits gravity as level and as upright, each 0..1, and its weight if level.
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

/// Prior over gravity directions in the sensor frame (y down, z forward).
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

/// Weighted least squares: |n x g| = 0 for floors, n . g = 0 for walls.
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

/// Support of the least constrained angle of gravity: small if all walls are parallel.
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

/// Counts of the planes that agree with a direction.
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
  double runner_up = 0;  // including candidates beyond the tilt limit: their support lowers
                         // the confidence
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
