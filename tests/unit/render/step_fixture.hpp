#pragma once

// A depth frame of two steps, run with a trace; and what was known of it on its way.

#include <memory>

#include "core/debug/replay/run.hpp"
#include "support/render_depth.hpp"

namespace planescope::test {

inline std::shared_ptr<const debug::Run> stairs_run(
    planes::Profile profile = planes::Profile::refined) {
  std::vector<Parallelogram> scene = {{{-1, -2, 0}, {4, 0, 0}, {0, 4, 0}}};
  add_box(scene, {0.7, -0.3, 0}, {0.8, 0.6, 0.17});
  add_box(scene, {1.0, -0.3, 0.17}, {0.5, 0.6, 0.17});
  planescope::test::Camera camera;
  Frame frame = render_depth(scene, camera);
  frame.gravity = Gravity{true_gravity(camera), GravitySource::imu, 1, ""};
  planes::PipelineOptions options;
  options.segment = planes::profile_options(profile);
  const auto classifier = planes::make_pca_classifier();
  return debug::make_run(
      debug::make_subject(std::move(frame), std::nullopt, options, classifier.get()), options);
}

/// What was known after `step` events, and no more.
inline debug::Run stopped_at(const debug::Run& run, std::int32_t step) {
  debug::Run stopped = run;
  planes::Trace& trace = stopped.trace;
  trace.events.resize(static_cast<std::size_t>(step));
  const auto later = [&](const auto& record) { return record.change.step > step; };
  std::erase_if(trace.points, later);
  std::erase_if(trace.planes, later);
  for (auto* at : {&trace.queued_at, &trace.visited_at, &trace.decided_at})
    std::erase_if(*at, [&](std::int32_t k) { return k > step; });
  std::vector<planes::OctreeNode>& nodes = stopped.segmentation.octree.nodes;
  nodes.resize(trace.queued_at.size());
  for (std::size_t n = trace.decided_at.size(); n < nodes.size(); ++n) {
    nodes[n].decided = planes::Case::none;
    nodes[n].at_max_depth = nodes[n].impure_fit = false;
    nodes[n].first_child = -1;
    nodes[n].child_count = 0;
  }
  stopped.segmentation.plane_of.clear();
  stopped.segmentation.planes.clear();
  stopped.facts.clear();
  stopped.timeline = debug::Timeline(stopped.trace, stopped.segmentation);
  return stopped;
}

/// The first step whose event is of this type.
inline std::int32_t first_step(const debug::Run& run, planes::EventType type) {
  for (std::int32_t k = 1; k <= run.steps(); ++k)
    if (run.event_at(k)->type == type) return k;
  return -1;
}

}  // namespace planescope::test
