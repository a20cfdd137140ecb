// What the events do, a second time: the trace says what was decided, this what follows from it.
// Sums run in the order in which the segmentation made them, so that fits come out the same.

#include "core/replay/replay_trace.hpp"

#include "core/segment/criteria.hpp"

namespace planescope {
namespace {

class Replayer {
 public:
  Replayer(const Octree& octree, const SegmentOptions& options)
      : octree_(octree), options_(options) {
    plane_of_.assign(octree.order.size(), -1);
    result_.queued_at.assign(octree.nodes.size(), kNever);
    result_.visited_at = result_.decided_at = result_.queued_at;
    if (!octree.nodes.empty()) result_.queued_at[0] = 0;
  }

  ReplayedTrace run(const Trace& trace) {
    auto refit = trace.refits.begin();
    auto part = trace.parts.begin();
    for (const TraceEvent& event : trace.events) {
      ++step_;
      const bool refits =
          event.type == EventType::refine && (event.refinement == 6 || event.refinement == kSplit);
      if (refits)
        fit_anew(event.plane, *refit++);
      else if (event.type == EventType::found && event.refinement == kSplit)
        split_off(event, *part++);
      else
        apply(event);
    }
    return std::move(result_);
  }

 private:
  void apply(const TraceEvent& event) {
    switch (event.type) {
      case EventType::visit:
        result_.visited_at[event.node] = step_;
        break;
      case EventType::decide:
        settle(event.node, static_cast<Case>(event.node_case));
        break;
      case EventType::found:
        found(event);
        break;
      case EventType::merge:
        planes_[event.plane].moments += moments_of(event.node, event.label);
        fit_anew(event.plane, planes_[event.plane].moments);
        claim(event.node, event.label, event.plane);
        break;
      case EventType::assign:
        set(morton_of(event.point), event.plane);
        break;
      case EventType::refine:
        refine(event);
        break;
      case EventType::leave:
        if (event.refinement == kSplit)
          end_plane(event.plane, -1);
        else
          claim(event.node, event.label, -1);
        break;
      case EventType::drop:  // it was left over before
      case EventType::wait:
        break;
    }
  }

  void settle(std::int32_t index, Case decided) {
    const OctreeNode& node = octree_.nodes[index];
    result_.decided_at[index] = step_;
    for (std::int32_t child = 0; child < node.child_count; ++child)
      result_.queued_at[node.first_child + child] = step_;
    const Purity purity = purity_of(node, options_.use_labels);
    const Label outlier = purity.inlier == Label::h ? Label::v : Label::h;
    if (decided == Case::II || node.at_max_depth) {
      claim(index, Label::unknown, -1);
    } else if (decided == Case::IV ||
               (node.impure_fit && !has_enough_inliers(purity.n_out, options_))) {
      if (purity.n_out > 0) claim(index, outlier, -1);
    }
  }

  void found(const TraceEvent& event) {
    result_.plane_labels.push_back(event.label);
    planes_.emplace_back();
    fit_anew(event.plane, moments_of(event.node, event.label));
    claim(event.node, event.label, event.plane);
  }

  void split_off(const TraceEvent& event, std::span<const std::uint32_t> points) {
    Moments moments;
    for (const std::uint32_t i : points) {
      octree_.add_point(moments, i);
      set(i, event.plane);
    }
    result_.plane_labels.push_back(event.label);
    planes_.emplace_back();
    fit_anew(event.plane, moments);
  }

  void refine(const TraceEvent& event) {
    switch (event.refinement) {
      case 2:
        end_plane(event.plane, -1);
        break;
      case 5:
        set(morton_of(event.point), event.other);
        break;
      case 7:
        planes_[event.other].moments += planes_[event.plane].moments;
        fit_anew(event.other, planes_[event.other].moments);
        end_plane(event.plane, event.other);
        break;
    }
  }

  void fit_anew(std::int32_t plane, const Moments& moments) {
    planes_[plane].moments = moments;
    planes_[plane].fit = fit_plane(moments);
    record(plane);
  }

  /// Its points go where it goes, or to the leftovers.
  void end_plane(std::int32_t plane, std::int32_t into) {
    planes_[plane].alive = false;
    planes_[plane].into = into;
    record(plane);
    for (std::uint32_t i = 0; i < plane_of_.size(); ++i)
      if (plane_of_[i] == plane) set(i, into);
  }

  void record(std::int32_t plane) {
    planes_[plane].step = step_;
    result_.planes.push_back({plane, planes_[plane]});
  }

  /// A plane, or the leftovers, gets the points of one label in a node; of all for `unknown`.
  void claim(std::int32_t index, Label label, std::int32_t plane) {
    const OctreeNode& node = octree_.nodes[index];
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      if (label == Label::unknown || has_label(i, label)) set(i, plane);
  }

  Moments moments_of(std::int32_t index, Label label) const {
    const OctreeNode& node = octree_.nodes[index];
    Moments moments;
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      if (has_label(i, label)) octree_.add_point(moments, i);
    return moments;
  }

  bool has_label(std::uint32_t i, Label label) const {
    return !options_.use_labels || octree_.labels[i] == label;
  }

  std::uint32_t morton_of(std::int32_t point) {
    if (morton_of_.empty()) {
      morton_of_.resize(octree_.order.size());
      for (std::uint32_t i = 0; i < octree_.order.size(); ++i) morton_of_[octree_.order[i]] = i;
    }
    return morton_of_[point];
  }

  void set(std::uint32_t i, std::int32_t plane) {
    plane_of_[i] = plane;
    result_.points.push_back(
        {static_cast<std::int32_t>(octree_.order[i]), {step_, plane, plane < 0}});
  }

  const Octree& octree_;
  const SegmentOptions& options_;
  std::int32_t step_ = 0;
  std::vector<std::int32_t> plane_of_;    // per Morton-ordered point
  std::vector<std::uint32_t> morton_of_;  // per input point
  std::vector<PlaneChange> planes_;       // as they stand
  ReplayedTrace result_;
};

}  // namespace

ReplayedTrace replay_trace(const Trace& trace,
                           const Octree& octree,
                           const SegmentOptions& options) {
  return Replayer(octree, options).run(trace);
}

}  // namespace planescope
