#pragma once

// The planes of one frame, in world coordinates.

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "core/model/frame.hpp"
#include "core/planes/foot/footholds.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::world {

inline double squared(double x) { return x * x; }

struct ObservedPlane {
  int id = 0;          // in its frame, from 1
  int known = 0;       // the track it was predicted from (expected.hpp), 0: none
  bool minor = false;  // below the listing threshold
  Label label = Label::unknown;
  // World [m]:
  Vec3d normal = Vec3d::UnitZ();  // unit; of an h upwards, else to the camera's side
  Vec3d centroid = Vec3d::Zero();
  Moments moments;              // of the points it was fitted to, about the camera
  planes::Certainty certainty;  // axes in the world
  planes::Outline outline;      // in the world
  std::uint32_t pixels = 0;     // measurements on it
  double rms_m = 0;             // of its voxels
  double margin = 0;            // as PlaneRegion has it
  bool undecided = false;       // as PlaneRegion has it

  double distance_m(const Vec3d& p) const { return normal.dot(p - centroid); }
};

struct ObservedFrame {
  int frame = 0;
  double timestamp_s = 0;
  int segment = 0;
  Pose T_world_camera = Pose::Identity();
  std::optional<Vec3d> gravity;  // unit, in the camera, that its planes were found with
  Intrinsics intrinsics;
  Image16 depth;  // counts
  double depth_unit_m = 0;
  double max_range_m = 0;  // depths beyond it were left out; 0: none
  planes::NoiseModel noise;
  Image16 plane_of;                         // per pixel: id, 0 none
  std::vector<planes::KnownCover> covered;  // tracks that the planes of larger ones stand for
  std::vector<ObservedPlane> planes;        // by id - 1, the minor ones last

  Vec3d camera() const { return T_world_camera.translation(); }
};

/// Of a depth image, run with the gravity of its pose, so that `result` is upright as the world is.
ObservedFrame observe(const Frame& frame,
                      planes::FrameResult result,
                      const planes::PipelineOptions& options,
                      const Pose& T_world_camera,
                      int segment);

/// Sets what follows from the frame, its pose and the options.
void take_frame(ObservedFrame& seen,
                const Frame& frame,
                const planes::PipelineOptions& options,
                const Pose& T_world_camera,
                int segment);

/// Of points with this fit, about `origin`; `axes`: unit, in the plane, the longer extent first.
Moments moments_of(const PlaneFit& fit, const Vec3d axes[2], const Vec3d& origin);
/// The same points seen from elsewhere: of X, those of T X.
Moments moved(const Moments& moments, const Pose& T);
/// How far the narrower of two sets of points is from the plane of the other [m].
struct Apart {
  double middle_m = 0;  // signed, along the other's normal
  double rim_m = 0;     // at its rim: of its middle, and what its tilt adds to it
};
Apart apart(const Moments& a, const Moments& b);
/// As if so many measurements of each had been made.
Moments scaled(const Moments& moments, double weight);

}  // namespace planescope::world
