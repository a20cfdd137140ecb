#pragma once

// One frame, made ready for segmentation once, however often it is then run; and one run of the
// segmentation on it, with all that stepping, searching and explaining it needs. Immutable once
// made; shared by whoever shows it.

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

/// Ground truth by voxel, by majority of its points. Empty vectors where the frame has none.
struct VoxelTruth {
  std::vector<std::uint8_t> label;  // 0 unknown, 1 h, 2 v
  std::vector<std::int32_t> plane;  // truth plane id from 1, 0 none, -1 not scored
  int plane_count = 0;              // greatest id

  bool known() const { return !plane.empty(); }
};

struct Subject {
  Frame frame;
  planes::PreparedFrame prepared;
  std::optional<planes::SourceTruth> truth;
  VoxelTruth voxel_truth;
  std::vector<std::uint32_t> point_of_source;  // pixel v * width + u, or index in the file -> cloud
                                               // point; kNoVoxel where nothing was measured

  std::size_t voxel_count() const { return prepared.voxels.points.size(); }
  /// kNoVoxel where nothing was measured, or it was cropped.
  std::uint32_t voxel_of_source(std::size_t source) const;
  /// Of all these sources, ascending, none twice.
  std::vector<std::uint32_t> voxels_of_sources(std::span<const std::uint32_t> sources) const;
};

/// Throws as prepare_frame() does.
std::shared_ptr<const Subject> make_subject(Frame frame,
                                            std::optional<planes::SourceTruth> truth,
                                            const planes::PipelineOptions& options,
                                            const planes::Classifier* classifier);

/// What the criteria saw of a node, recomputed by the functions that the traversal called. The fit
/// is there for every node, also where the traversal never came to make it. On a depth image all
/// points are inliers, and e_n and theta_e_n are of the criterion that decided: Trace::image_terms
/// has the others.
struct NodeFacts {
  planes::Purity purity;
  PlaneFit fit;          // of the inliers
  double e_n = 0;        // Criterion 3's value, in the normalisation or as RMS, as the options ask
  double theta_e_n = 0;  // and its threshold here
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
  std::vector<std::int32_t> plane_of;  // per cloud point: plane id, 0 none
  planes::Trace trace;
  Timeline timeline;
  std::vector<NodeFacts> facts;     // per octree node
  std::vector<std::uint8_t> wrong;  // per event: it disagrees with ground truth (wrong_decisions())

  /// Only our own method has an octree and leaves a trace. A run of a rival has its planes from
  /// step 0 on, and no nodes, no events and no labels of points.
  bool is_ours() const { return options.method == planes::Method::ours; }
  const planes::Octree& octree() const { return segmentation.octree; }
  /// The octree divides a depth image: no labels of points take part.
  bool is_on_image() const { return octree().image.has_value(); }
  std::int32_t steps() const { return timeline.steps(); }
  /// The event that led to step k; null at step 0.
  const planes::TraceEvent* event_at(std::int32_t step) const {
    return step > 0 ? &trace.events[static_cast<std::size_t>(step - 1)] : nullptr;
  }
};

/// Runs the method of the options; ours with a trace. A millisecond or two for a depth frame.
std::shared_ptr<const Run> make_run(std::shared_ptr<const Subject> subject,
                                    const planes::PipelineOptions& options);

/// The node that a step's event is about: its own, that of its point, or the one that founded its
/// plane; -1 where there is none.
std::int32_t node_at_step(const Run& run, std::int32_t step);

/// Name of a plane of the trace, "P1" for plane 1 of the result: Timeline::number_of_plane(). "-"
/// for none, -1.
std::string plane_name(const Run& run, std::int32_t plane);
/// "case III, variance 3.4 > 2 × the expected": how a node was settled.
std::string decision_text(const Run& run, std::int32_t node);
/// What a stage says of its event, StageInfo::says or why_dropped, filled in.
std::string filled_in(const char* text, const Run& run, const planes::TraceEvent& event);
/// One line for people: "node 41 (depth 5): case III, e_n 0.0071 > 0.005 m²".
std::string describe_event(const Run& run, std::int32_t step);

// Decisions against ground truth: the one rule that filters, histograms and colours share.

/// Points of a second true plane, and more of them than Criterion 1 tolerates of a second label.
bool is_mixed_in_truth(const NodeFacts& facts, const planes::SegmentOptions& options);

/// One true plane's, up to what Criterion 1 tolerates of others', and enough for Criterion 2.
bool is_pure_in_truth(const NodeFacts& facts, const planes::SegmentOptions& options);

/// Per event, 1 where it is wrong:
///  - a node of mixed truth is settled as case IV, one pure in truth as I or III;
///  - a plane is founded for a true plane that another one stands for already;
///  - a candidate, or a leftover point, joins a plane that stands for another true plane;
///  - a point of a true plane is dropped;
///  - on a depth image, where a cell founds no plane yet: planes that stand for two true planes are
///    joined, or the last that stands for a true plane is not listed.
/// A plane stands for the true plane that most of its points belong to. Empty without truth.
std::vector<std::uint8_t> wrong_decisions(const Run& run);

}  // namespace planescope::debug
