// The voxel grid of a 640x480 frame compared with Open3D's VoxelDownSample. Each round runs both;
// counters give the medians and their ratio. With PLANESCOPE_DATA, also on a real frame.

#include <benchmark/benchmark.h>
#include <open3d/geometry/PointCloud.h>

#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
#include "core/lab/bench/measuring.hpp"
#include "core/planes/cloud/cloud.hpp"
#include "support/render_depth.hpp"

namespace planescope {
namespace {

constexpr double kVoxel_m = 0.02;

Frame stairs_frame() {
  std::vector<test::Parallelogram> scene{{Vec3d(-5, -5, 0), Vec3d(10, 0, 0), Vec3d(0, 10, 0)},
                                         {Vec3d(2.5, -5, 0), Vec3d(0, 10, 0), Vec3d(0, 0, 3)}};
  for (int step = 0; step < 4; ++step)
    test::add_box(scene, Vec3d(0.6 + 0.28 * step, -0.6, 0), Vec3d(0.28, 1.2, 0.16 * (step + 1)),
                  0.1);
  return test::render_depth(scene, {});
}

void voxel_grid(benchmark::State& state, const Frame& frame, double max_range_m) {
  planes::CloudOptions options;
  options.max_range_m = max_range_m;
  Gravity gravity;
  gravity.direction = Vec3d(0, 0.87, 0.5);
  const planes::Cloud cloud = planes::make_cloud(frame, gravity, options);
  open3d::geometry::PointCloud theirs;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.kept[i]) theirs.points_.push_back(cloud.points[i].cast<double>());
  std::vector<double> ours_ms, open3d_ms;
  for (auto _ : state) {
    ours_ms.push_back(
        lab::thread_ms([&] { benchmark::DoNotOptimize(planes::voxelize(cloud, kVoxel_m)); }));
    open3d_ms.push_back(
        lab::thread_ms([&] { benchmark::DoNotOptimize(theirs.VoxelDownSample(kVoxel_m)); }));
  }
  state.counters["points"] = static_cast<double>(cloud.counts.kept);
  state.counters["ours_ms"] = lab::median(ours_ms);
  state.counters["open3d_ms"] = lab::median(open3d_ms);
  state.counters["ratio"] = lab::median(open3d_ms) / lab::median(ours_ms);
}

void add(const std::string& name, const Frame& frame) {
  for (const double max_range_m : {1.5, 4.0})
    benchmark::RegisterBenchmark(
        ("voxel_grid/" + name + (max_range_m < 2 ? "/to_1.5m" : "/to_4m")).c_str(),
        [frame, max_range_m](benchmark::State& state) { voxel_grid(state, frame, max_range_m); })
        ->Unit(benchmark::kMillisecond);
}

}  // namespace
}  // namespace planescope

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  planescope::add("stairs", planescope::stairs_frame());
  if (const char* data = std::getenv("PLANESCOPE_DATA")) {
    const auto recording =
        planescope::io::open_recording(std::filesystem::path(data) / "felixchenfy_d4xx_640x480");
    planescope::add("room", recording->frame(0));
  }
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
