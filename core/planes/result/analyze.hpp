#pragma once

// Complete result of a frame, as written to planes.json: planes with outlines and footholds, and
// the stairs they form.

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

/// Measurements of a plane. World frame: z up, meters.
struct PlaneSummary {
  int id = 0;  // from 1
  Label label = Label::unknown;
  Vec3d normal = Vec3d::UnitZ();  // unit
  Vec3d centroid = Vec3d::Zero();
  double offset_m = 0;       // normal . x = offset
  double tilt_deg = 0;       // from horizontal: 0 floor, 90 wall; NaN: gravity is unknown
  std::uint64_t points = 0;  // number of input points
  std::uint64_t voxels = 0;
  double rms_m = 0;  // root mean square distance of its input points from the plane
  // Area covered by points: occupied cells of a grid in the plane, one voxel wide (2 cm without
  // voxels). Unlike the hull's area, it excludes holes and concavities.
  double area_m2 = 0;
  double margin = std::numeric_limits<double>::infinity();  // from PlaneRegion, like `undecided`
  bool undecided = false;
  std::vector<Vec3d> hull;  // convex hull of its points in the plane, counter-clockwise seen from
                            // the side of the normal
};

/// Cell size of grids on planes [m].
inline double cell_size_m(double voxel_size_m) { return voxel_size_m > 0 ? voxel_size_m : 0.02; }

/// One entry per plane, by id - 1.
std::vector<PlaneSummary> summarize_planes(const FrameResult& result, double voxel_size_m);

struct FramePlanes {
  // By id - 1.
  std::vector<PlaneSummary> summaries;
  std::vector<Outline> outlines;
  std::vector<Foothold> footholds;
  Stairs stairs;
  std::optional<std::vector<int>> tracks;  // map tracks, if a map is used
};

/// Computes the geometry of the planes found by run_frame().
FramePlanes analyze_planes(const Frame& frame,
                           const FrameResult& result,
                           const PipelineOptions& options);

struct AnalyzedFrame : FrameResult {
  FramePlanes found;
};

/// run_frame() followed by analyze_planes(). Throws like run_frame().
AnalyzedFrame analyze(const Frame& frame,
                      const PipelineOptions& options,
                      const Classifier* classifier,
                      const FrameTruth* truth = nullptr);

// Files. Only timings.json depends on time and on the number of threads.

/// Schema "planescope.planes/4".
std::string planes_json(const Frame& frame,
                        const FrameResult& result,
                        const FramePlanes& found,
                        const PipelineOptions& options);
/// Milliseconds by stage and their sum.
std::string timings_json(const FrameTimings& timings);

// Fields shared by planes.json, timings.json and report.json.

/// Measured noise sigma and largest point-to-plane distance tau, at 1 m from the sensor [m].
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

/// Times of the stages.
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
  if constexpr (Fields::kReads)
    fields("source", gravity.source);  // a reader needs it to know
                                       // whether a direction follows
  if (gravity.known())
    fields("direction", gravity.direction, kRounded);
  else if constexpr (!Fields::kReads)
    fields.null("direction");
  if constexpr (!Fields::kReads) fields("source", gravity.source);
  fields("confidence", gravity.confidence, kRounded);
  fields("note", gravity.note);
}

/// Counts of dropped points.
void dropped_fields(auto& fields, Same<CloudCounts> auto& counts) {
  fields("pixels", counts.pixels);
  fields("no_measurement", counts.no_measurement);
  fields("invalid", counts.invalid);
  fields("beyond_range", counts.beyond_range);
  fields("outside_cube", counts.outside_cube);
}

/// Fields of a Surface, or of a report's copy without best_place.
void surface_fields(auto& fields, auto& surface) {
  fields("slope_deg", surface.slope_deg, kRounded | kOrNull);
  fields("rough_rms_m", surface.rough_rms_m, kRounded);
  fields("rough_step_m", surface.rough_step_m, kRounded);
  fields("support", surface.support, kRounded);
  if constexpr (requires { surface.best_place; })
    fields("best_place", surface.best_place, kRounded);
  fields("clearance_m", surface.clearance_m, kRounded);
}

/// Fields of a SlopingPlane, or of a report's copy.
void ramp_fields(auto& fields, auto& ramp) {
  fields.whole("plane", ramp.plane, kCompared, 1);
  fields("slope_deg", ramp.slope_deg, kCompared | kRounded);
  fields("rise_m", ramp.rise_m, kCompared | kRounded);
  fields("run_m", ramp.run_m, kCompared | kRounded);
  fields("width_m", ramp.width_m, kCompared | kRounded);
}

}  // namespace planescope::planes
