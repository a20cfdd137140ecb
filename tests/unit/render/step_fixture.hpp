#pragma once

// A depth frame of two steps, run with a trace; and the same run stopped on its way.

#include <memory>

#include "core/replay/run.hpp"
#include "core/segment/snapshot.hpp"
#include "support/render_depth.hpp"

namespace planescope::test {

inline std::shared_ptr<const Run> stairs_run(Profile profile = Profile::refined) {
  std::vector<Parallelogram> scene = {{{-1, -2, 0}, {4, 0, 0}, {0, 4, 0}}};
  add_box(scene, {0.7, -0.3, 0}, {0.8, 0.6, 0.17});
  add_box(scene, {1.0, -0.3, 0.17}, {0.5, 0.6, 0.17});
  planescope::test::Camera camera;
  Frame frame = render_depth(scene, camera);
  frame.gravity = Gravity{true_gravity(camera), GravitySource::imu, 1, ""};
  PipelineOptions options;
  options.segment = profile_options(profile);
  const auto classifier = make_pca_classifier();
  return make_run(make_subject(std::move(frame), std::nullopt, options, classifier.get()), options);
}

/// What was known after `step` events, and no more.
inline Run stopped_at(const Run& run, std::int32_t step) {
  const PreparedFrame& prepared = run.subject->prepared;
  Run stopped = run;
  stopped.trace.events.resize(static_cast<std::size_t>(step));
  stopped.segmentation.octree.nodes =
      segment_until(prepared.voxels.points, prepared.classification.labels, prepared.cloud.cube,
                    prepared.sensor(), run.segment_options, static_cast<std::size_t>(step),
                    more_measurements(prepared, run.segment_options))
          .nodes;
  stopped.segmentation.plane_of.clear();
  stopped.segmentation.planes.clear();
  stopped.facts.clear();
  stopped.timeline = Timeline(stopped.trace, stopped.segmentation, stopped.segment_options);
  return stopped;
}

/// The first step whose event is of this type.
inline std::int32_t first_step(const Run& run, EventType type) {
  for (std::int32_t k = 1; k <= run.steps(); ++k)
    if (run.event_at(k)->type == type) return k;
  return -1;
}

}  // namespace planescope::test
