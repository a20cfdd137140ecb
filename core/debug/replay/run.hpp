#pragma once

// Subject: one frame prepared for segmentation, shared by many runs. Run: one run of the
// segmentation, with all data for stepping, searching and explaining. Both are immutable
// and shared.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/debug/replay/timeline.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/planes/pipeline/truth.hpp"
#include "core/planes/segment/criteria.hpp"

namespace planescope::debug {

/// Ground truth by voxel: majority of its points. Empty if the frame has none.
struct VoxelTruth {
  std::vector<std::uint8_t> label;  // 0 unknown, 1 h, 2 v
  std::vector<std::int32_t> plane;  // truth plane id from 1, 0 none, -1 not scored
  int plane_count = 0;              // largest id

  bool known() const { return !plane.empty(); }
};

struct Subject {
  Frame frame;
  planes::PreparedFrame prepared;
  std::optional<planes::SourceTruth> truth;
  VoxelTruth voxel_truth;
  std::vector<std::uint32_t> point_of_source;  // pixel v * width + u, or index in the file -> cloud
                                               // point; kNoVoxel if unmeasured

  std::size_t voxel_count() const { return prepared.voxels.points.size(); }
  /// kNoVoxel if unmeasured or cropped.
  std::uint32_t voxel_of_source(std::size_t source) const;
  /// Voxels of all these sources, ascending and unique.
  std::vector<std::uint32_t> voxels_of_sources(std::span<const std::uint32_t> sources) const;
};

/// Throws like prepare_frame().
std::shared_ptr<const Subject> make_subject(Frame frame,
                                            std::optional<planes::SourceTruth> truth,
                                            const planes::PipelineOptions& options,
                                            const planes::Classifier* classifier);

/// Inputs of the criteria for a node, recomputed by the same functions as in the traversal. The
/// fit is computed for every node, even if the traversal did not need it. On depth images all
/// points are inliers, and e_n and theta_e_n belong to the deciding criterion; the others are
/// in Trace::image_terms.
struct NodeFacts {
  planes::Purity purity;
  PlaneFit fit;          // of the inliers
  double e_n = 0;        // value of Criterion 3: normalized e_n or RMS, depending on the options
  double theta_e_n = 0;  // its threshold for this node
  // Ground truth of the node's points; 0 if unknown.
  std::int32_t truth_plane = 0;    // plane of most points
  std::uint32_t truth_points = 0;  // number of points on that plane
  std::uint32_t truth_known = 0;   // number of points on any true plane
  std::uint32_t truth_planes = 0;  // number of distinct true planes
};

struct Run {
  std::shared_ptr<const Subject> subject;
  planes::PipelineOptions options;
  planes::SegmentOptions segment_options;  // effective options for this frame
  planes::Segmentation segmentation;
  std::vector<std::int32_t> plane_of;  // per cloud point: plane id, 0 none
  planes::Trace trace;
  Timeline timeline;
  std::vector<NodeFacts> facts;     // per octree node
  std::vector<std::uint8_t> wrong;  // per event: contradicts ground truth (wrong_decisions())

  /// Only our own method has an octree and a trace. A run of a rival has its planes from step 0 on,
  /// and no nodes, events or point labels.
  bool is_ours() const { return options.method == planes::Method::ours; }
  const planes::Octree& octree() const { return segmentation.octree; }
  /// The octree divides a depth image; point labels are not used.
  bool is_on_image() const { return octree().image.has_value(); }
  std::int32_t steps() const { return timeline.steps(); }
  /// The event that led to step k; null at step 0.
  const planes::TraceEvent* event_at(std::int32_t step) const {
    return step > 0 ? &trace.events[static_cast<std::size_t>(step - 1)] : nullptr;
  }
};

/// Runs the method of the options, with a trace if it is ours. Takes a millisecond or two for a
/// depth frame.
std::shared_ptr<const Run> make_run(std::shared_ptr<const Subject> subject,
                                    const planes::PipelineOptions& options);

/// Node of a step's event: its own node, its point's node, or the node that created its plane; -1
/// if none.
std::int32_t node_at_step(const Run& run, std::int32_t step);

/// Name of a plane of the trace: "P1" for plane 1 of the result (see Timeline::number_of_plane()),
/// "-" for -1.
std::string plane_name(const Run& run, std::int32_t plane);
/// Decision on a node: "case III, variance 3.4 > 2 × the expected".
std::string decision_text(const Run& run, std::int32_t node);
/// Fills in the placeholders of StageInfo::event_text or why_dropped for an event.
std::string filled_in(const char* text, const Run& run, const planes::TraceEvent& event);
/// One line for users: "node 41 (depth 5): case III, e_n 0.0071 > 0.005 m²".
std::string describe_event(const Run& run, std::int32_t step);

// Decisions compared with ground truth; the same rule for filters, histograms and colors.

/// The node contains points of a second true plane, more than Criterion 1 tolerates of a
/// second label.
bool is_mixed_in_truth(const NodeFacts& facts, const planes::SegmentOptions& options);

/// The node contains one true plane, apart from outliers within Criterion 1, and enough points for
/// Criterion 2.
bool is_pure_in_truth(const NodeFacts& facts, const planes::SegmentOptions& options);

/// Per event, 1 if it is wrong:
///  - a node of mixed truth is settled as case IV, or a node of pure truth as I or III;
///  - a plane is created for a true plane that another plane already represents;
///  - a candidate or leftover point joins a plane that represents another true plane;
///  - a point of a true plane is dropped;
///  - on depth images, where cells create regions but not yet planes: planes that represent two
///    true planes are joined, or the last plane that represents a true plane is dropped.
/// A plane represents the true plane of most of its points. Empty without truth.
std::vector<std::uint8_t> wrong_decisions(const Run& run);

}  // namespace planescope::debug
