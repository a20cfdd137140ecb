#include "core/report/data/plane_summary.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/model/plane.hpp"
#include "core/planes/pipeline/plane_runs.hpp"
#include "core/report/data/plane_cover.hpp"

namespace planescope::report {
namespace {

constexpr int kMostRegionSamples = 8192;

}  // namespace

std::vector<PlaneSummary> summarize_planes(const planes::FrameResult& result, double voxel_size_m) {
  const std::size_t n = result.segmentation.planes.size();
  const std::vector<std::vector<planes::PointRun>> runs = planes::runs_of_planes(result);
  const double cell_m = cell_size_m(voxel_size_m);
  std::vector<PlaneSummary> summaries(n);
  for (std::size_t k = 0; k < n; ++k) {
    const planes::PlaneRegion& plane = result.segmentation.planes[k];
    PlaneSummary& s = summaries[k];
    s.id = plane.id;
    s.label = plane.label;
    s.normal = plane.fit.normal;
    s.centroid = result.cloud.origin + plane.fit.centroid;
    s.offset_m = s.normal.dot(s.centroid);
    s.tilt_deg = result.gravity.known()
                     ? std::acos(std::min(1.0, std::abs(s.normal.z()))) * 180 / std::numbers::pi
                     : std::nan("");
    s.voxels = plane.points;
    s.margin = plane.margin;
    s.undecided = plane.undecided;

    const PlaneBasis basis = plane_basis(s.normal);
    const FlatPoints flat(result.cloud.points, runs[k], basis, s.normal, plane.fit.centroid);
    s.points = flat.size();
    const Cover cover = cover_of(flat, cell_m);
    if (s.points > 0) s.rms_m = std::sqrt(cover.squares_m2 / static_cast<double>(s.points));
    s.area_m2 = static_cast<double>(cover.cells) * cell_m * cell_m;
    for (const Vec2d& corner : cover.hull)
      s.hull.push_back(s.centroid + corner.x() * basis.u + corner.y() * basis.v);
  }
  return summaries;
}

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
