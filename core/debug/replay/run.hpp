#pragma once

// One run of the segmentation on a subject, with all that stepping, searching and explaining it
// needs. Immutable once made; shared by whoever shows it.

#include <memory>
#include <vector>

#include "core/debug/replay/subject.hpp"
#include "core/debug/replay/timeline.hpp"
#include "core/planes/segment/criteria.hpp"

namespace planescope::debug {

/// What the criteria saw of a node, recomputed by the functions that the traversal called. The fit
/// is there for every node, also where the traversal never came to make it.
struct NodeFacts {
  planes::Purity purity;
  PlaneFit fit;          // of the inliers
  double e_n = 0;        // Criterion 3's value, in the normalisation or as RMS, as the options ask
  double theta_e_n = 0;  // and its threshold here: theta_e_n_m2, or theta_rms(range)
  double sigma_ang = 0;  // [rad]
  // Ground truth of its points; 0 where unknown.
  std::int32_t truth_plane = 0;    // the plane most of them belong to
  std::uint32_t truth_points = 0;  // how many do
  std::uint32_t truth_known = 0;   // how many belong to any
  std::uint32_t truth_planes = 0;  // distinct planes among them
};

struct Run {
  std::shared_ptr<const Subject> subject;
  planes::PipelineOptions options;
  planes::SegmentOptions segment_options;  // as they held for this frame
  planes::Segmentation segmentation;
  planes::Trace trace;
  Timeline timeline;
  std::vector<NodeFacts> facts;     // per octree node
  std::vector<std::uint8_t> wrong;  // per event: it disagrees with ground truth (truth_check.hpp)

  /// Our own method alone has an octree and leaves a trace: of the others there are planes, from
  /// step 0 on, and no node, no event, no label of a point.
  bool is_ours() const { return options.method == planes::Method::ours; }
  const planes::Octree& octree() const { return segmentation.octree; }
  std::int32_t steps() const { return timeline.steps(); }
  /// The event that led to step k; null at step 0.
  const planes::TraceEvent* event_at(std::int32_t step) const {
    return step > 0 ? &trace.events[static_cast<std::size_t>(step - 1)] : nullptr;
  }
  double theta_rms(const Vec3d& p) const;  // [m] thresholds in force at a place
  double tau(const Vec3d& p) const;
};

/// Runs the method of the options; ours with a trace. A millisecond or two for a depth frame.
std::shared_ptr<const Run> make_run(std::shared_ptr<const Subject> subject,
                                    const planes::PipelineOptions& options);

/// Name of a plane of the trace, "P1" for the first founded.
std::string plane_name(std::int32_t plane);
/// One line for people: "node 41 (depth 5): case III, e_n 0.0071 > 0.005 m²".
std::string describe_event(const Run& run, std::int32_t step);

}  // namespace planescope::debug
