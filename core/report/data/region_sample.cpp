#include "core/report/data/region_sample.hpp"

#include <cstdint>

namespace planescope::report {
namespace {

constexpr int kMostRegionSamples = 8192;

}  // namespace

std::vector<int> RegionSample::plane_of() const {
  std::vector<int> result;
  for (const Run& run : runs)
    result.insert(result.end(), static_cast<std::size_t>(run.count), run.plane);
  return result;
}

std::vector<RegionSample::Run> runs_of(std::span<const int> plane_of) {
  std::vector<RegionSample::Run> runs;
  for (const int plane : plane_of) {
    if (runs.empty() || runs.back().plane != plane) runs.push_back({plane, 0});
    ++runs.back().count;
  }
  return runs;
}

RegionSample sample_regions(const Frame& frame, const planes::FrameResult& result) {
  const planes::Cloud& cloud = result.cloud;
  const int width =
      frame.is_cloud() ? static_cast<int>(frame.cloud->points.size()) : frame.depth.width;
  const int height = frame.is_cloud() ? 1 : frame.depth.height;
  RegionSample sample;
  const auto measure = [&] {
    sample.columns = (width + sample.step - 1) / sample.step;
    sample.rows = (height + sample.step - 1) / sample.step;
  };
  for (measure(); std::int64_t{sample.columns} * sample.rows > kMostRegionSamples; measure())
    sample.step *= 2;
  std::vector<int> plane_of(static_cast<std::size_t>(sample.columns) * sample.rows, -1);
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    if (!cloud.kept[i]) continue;
    const int u = static_cast<int>(cloud.source[i] % width);
    const int v = static_cast<int>(cloud.source[i] / width);
    if (u % sample.step == 0 && v % sample.step == 0)
      plane_of[static_cast<std::size_t>(v / sample.step) * sample.columns + u / sample.step] =
          result.plane_of[i];
  }
  sample.runs = runs_of(plane_of);
  return sample;
}

}  // namespace planescope::report
