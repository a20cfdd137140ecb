// Segmentation of an 8192-point staircase compared with the simple reference, and building the
// octree compared with Open3D, in the same run. Quote the ratios that scripts/bench prints.

#include <benchmark/benchmark.h>
#include <open3d/geometry/Octree.h>
#include <open3d/geometry/PointCloud.h>

#include "core/debug/replay/timeline.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/planes/segment/segment.hpp"
#include "support/reference_segment.hpp"
#include "support/scenes.hpp"

namespace planescope {
namespace {

const test::LabeledCloud& staircase() {
  static const test::LabeledCloud cloud = [] {
    lab::StairsOptions options;
    options.noise_m = 0.002;
    const lab::Stairs stairs = lab::make_stairs(0, options);
    test::LabeledCloud c;
    c.points = stairs.cloud.points;
    for (const std::uint8_t l : stairs.cloud.label) c.labels.push_back(static_cast<Label>(l));
    c.cube = test::cube_around(c.points);
    return c;
  }();
  return cloud;
}

void ours(benchmark::State& state, planes::Profile profile) {
  const planes::SegmentOptions options = planes::profile_options(profile);
  const test::LabeledCloud& c = staircase();
  for (auto _ : state)
    benchmark::DoNotOptimize(planes::segment(c.points, c.labels, c.cube, Vec3d::Zero(), options));
}

/// As in the debugger.
void traced(benchmark::State& state, planes::Profile profile) {
  const planes::SegmentOptions options = planes::profile_options(profile);
  const test::LabeledCloud& c = staircase();
  for (auto _ : state) {
    planes::Trace trace;
    const planes::Segmentation s =
        planes::segment(c.points, c.labels, c.cube, Vec3d::Zero(), options, &trace);
    benchmark::DoNotOptimize(debug::Timeline(trace, s));
  }
}

void plain(benchmark::State& state, planes::Profile profile) {
  const planes::SegmentOptions options = planes::profile_options(profile);
  const test::LabeledCloud& c = staircase();
  for (auto _ : state)
    benchmark::DoNotOptimize(reference::segment(c.points, c.labels, c.cube, options));
}

void octree_ours(benchmark::State& state) {
  const test::LabeledCloud& c = staircase();
  for (auto _ : state) benchmark::DoNotOptimize(planes::build_octree(c.points, c.labels, c.cube));
}

/// Our octree divided down to the leaves, like Open3D's; the method never needs that.
void octree_ours_divided(benchmark::State& state) {
  const test::LabeledCloud& c = staircase();
  for (auto _ : state) {
    planes::Octree octree = planes::build_octree(c.points, c.labels, c.cube);
    for (std::size_t i = 0; i < octree.nodes.size(); ++i)
      if (octree.nodes[i].depth < c.cube.max_depth)
        planes::divide(octree, static_cast<std::int32_t>(i));
    benchmark::DoNotOptimize(octree.nodes.data());
  }
}

void octree_open3d(benchmark::State& state) {
  open3d::geometry::PointCloud cloud;
  for (const Vec3f& p : staircase().points) cloud.points_.push_back(p.cast<double>());
  for (auto _ : state) {
    open3d::geometry::Octree octree(static_cast<std::size_t>(staircase().cube.max_depth));
    octree.ConvertFromPointCloud(cloud, 0.0);
    benchmark::DoNotOptimize(octree.root_node_);
  }
}

BENCHMARK_CAPTURE(ours, paper, planes::Profile::paper)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(traced, paper, planes::Profile::paper)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plain, paper, planes::Profile::paper)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ours, paper_closest, planes::Profile::paper_closest)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plain, paper_closest, planes::Profile::paper_closest)
    ->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(ours, refined, planes::Profile::refined)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(traced, refined, planes::Profile::refined)->Unit(benchmark::kMicrosecond);
BENCHMARK_CAPTURE(plain, refined, planes::Profile::refined)->Unit(benchmark::kMicrosecond);
BENCHMARK(octree_ours)->Unit(benchmark::kMicrosecond);
BENCHMARK(octree_ours_divided)->Unit(benchmark::kMicrosecond);
BENCHMARK(octree_open3d)->Unit(benchmark::kMicrosecond);

}  // namespace
}  // namespace planescope

BENCHMARK_MAIN();
