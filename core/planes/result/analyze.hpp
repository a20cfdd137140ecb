#pragma once

// The complete result of a frame, as planes.json contains it: its planes with what they cover,
// where a foot may go on them, and the stairs that they make.

#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "core/model/json_fields.hpp"
#include "core/planes/foot/footholds.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/stairs/stairs.hpp"

namespace planescope::planes {

/// The figures of a plane. World frame: z up, meters.
struct PlaneSummary {
  int id = 0;  // from 1
  Label label = Label::unknown;
  Vec3d normal = Vec3d::UnitZ();  // unit
  Vec3d centroid = Vec3d::Zero();
  double offset_m = 0;  // normal . x = offset
  double tilt_deg = 0;  // against the horizontal: 0 a floor, 90 a wall; NaN: gravity is unknown
  std::uint64_t points = 0;  // input points
  std::uint64_t voxels = 0;
  double rms_m = 0;  // distance of its input points from the plane, root mean square
  // Area covered by points: occupied cells of a grid in the plane, as wide as a voxel (2 cm where
  // there is no voxel grid). Unlike the hull's area it does not count holes and bays.
  double area_m2 = 0;
  double margin = std::numeric_limits<double>::infinity();  // of PlaneRegion, as is `undecided`
  bool undecided = false;
  std::vector<Vec3d> hull;  // convex hull of its points on the plane, counter-clockwise seen from
                            // where the normal points
};

/// Of the grid in a plane that tells what it covers [m].
inline double cell_size_m(double voxel_size_m) { return voxel_size_m > 0 ? voxel_size_m : 0.02; }

/// One entry per plane, by id - 1.
std::vector<PlaneSummary> summarize_planes(const FrameResult& result, double voxel_size_m);

struct FramePlanes {
  // By id - 1.
  std::vector<PlaneSummary> summaries;
  std::vector<Outline> outlines;
  std::vector<Foothold> footholds;
  Stairs stairs;
  std::optional<std::vector<int>> tracks;  // of a map
};

/// The geometry of the planes that run_frame() found.
FramePlanes analyze_planes(const Frame& frame,
                           const FrameResult& result,
                           const PipelineOptions& options);

struct AnalyzedFrame : FrameResult {
  FramePlanes found;
};

/// run_frame() and analyze_planes(): everything about a frame in one call. Throws as run_frame().
AnalyzedFrame analyze(const Frame& frame,
                      const PipelineOptions& options,
                      const Classifier* classifier,
                      const FrameTruth* truth = nullptr);

// Files. Nothing but timings.json depends on time or on the number of threads.

/// schema "planescope.planes/4".
std::string planes_json(const Frame& frame,
                        const FrameResult& result,
                        const FramePlanes& found,
                        const PipelineOptions& options);
/// Milliseconds by stage and their sum.
std::string timings_json(const FrameTimings& timings);

// What planes.json, timings.json and report.json have in common.

/// The noise that was measured, and how far off a plane points may lie, one meter from the sensor
/// [m].
struct NoiseFigures {
  bool estimated = false, by_range = false;
  double sigma_m = 0, tau_m = 0;
};
inline NoiseFigures noise_figures(const NoiseModel& noise) {
  return {noise.estimated, noise.by_range, noise.sigma(1), noise.tau(1)};
}
void visit_fields(auto& fields, Same<NoiseFigures> auto& noise) {
  fields("estimated", noise.estimated);
  fields("by_range", noise.by_range);
  fields("sigma_at_1m_m", noise.sigma_m, kRounded);
  fields("tau_at_1m_m", noise.tau_m, kRounded);
}

/// The stages' times.
void visit_fields(auto& fields, Same<FrameTimings> auto& timings) {
  fields("load_ms", timings.load_ms);
  fields("cloud_ms", timings.cloud_ms);
  fields("t_d_ms", timings.t_d_ms);
  fields("t_c_ms", timings.t_c_ms);
  fields("t_b_ms", timings.t_b_ms);
  fields("t_s_ms", timings.t_s_ms);
}

template <typename Fields>
void gravity_fields(Fields& fields, Same<Gravity> auto& gravity) {
  if constexpr (Fields::kReads) fields("source", gravity.source);  // is there a direction?
  if (gravity.known())
    fields("direction", gravity.direction, kRounded);
  else if constexpr (!Fields::kReads)
    fields.null("direction");
  if constexpr (!Fields::kReads) fields("source", gravity.source);
  fields("confidence", gravity.confidence, kRounded);
  fields("note", gravity.note);
}

/// Of the points that are left out.
void dropped_fields(auto& fields, Same<CloudCounts> auto& counts) {
  fields("pixels", counts.pixels);
  fields("no_measurement", counts.no_measurement);
  fields("invalid", counts.invalid);
  fields("beyond_range", counts.beyond_range);
  fields("outside_cube", counts.outside_cube);
}

/// Of a Surface, or of what a report keeps of it: without its best place.
void surface_fields(auto& fields, auto& surface) {
  fields("slope_deg", surface.slope_deg, kRounded | kOrNull);
  fields("rough_rms_m", surface.rough_rms_m, kRounded);
  fields("rough_step_m", surface.rough_step_m, kRounded);
  fields("support", surface.support, kRounded);
  if constexpr (requires { surface.best_place; })
    fields("best_place", surface.best_place, kRounded);
  fields("clearance_m", surface.clearance_m, kRounded);
}

/// Of a SlopingPlane, or of what a report keeps of it.
void ramp_fields(auto& fields, auto& ramp) {
  fields.whole("plane", ramp.plane, kCompared, 1);
  fields("slope_deg", ramp.slope_deg, kCompared | kRounded);
  fields("rise_m", ramp.rise_m, kCompared | kRounded);
  fields("run_m", ramp.run_m, kCompared | kRounded);
  fields("width_m", ramp.width_m, kCompared | kRounded);
}

}  // namespace planescope::planes
