#include "core/planes/segment/pixel_runs.hpp"

#include <numeric>
#include <utility>

namespace planescope::planes {

std::vector<MeasuredRun> make_pixel_runs(const PixelGrid& pixels,
                                         std::span<const std::uint32_t> order) {
  std::vector<std::uint32_t> morton(order.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) morton[order[i]] = i;
  std::vector<MeasuredRun> runs;
  runs.reserve(pixels.point.size() / 4);
  for (int y = 0; y < pixels.height; ++y) {
    const std::size_t end = pixels.at(0, y + 1);
    for (std::size_t i = pixels.at(0, y); i < end;) {
      const std::uint32_t point = pixels.point[i];
      runs.push_back(
          {static_cast<std::uint32_t>(i), point == PixelGrid::kNoPoint ? point : morton[point]});
      do ++i;
      while (i < end && pixels.point[i] == point);
    }
  }
  runs.push_back({static_cast<std::uint32_t>(pixels.point.size())});
  return runs;
}

PlaneRuns runs_by_plane(const PixelGrid& pixels,
                        std::span<const std::int32_t> planes,
                        std::size_t plane_count) {
  PlaneRuns result;
  std::vector<std::pair<std::int32_t, PlaneRuns::Run>> all;
  result.first.assign(plane_count + 1, 0);
  visit_plane_runs(pixels, planes, [&](std::int32_t k, int y, int begin, int end) {
    all.push_back({k,
                   {static_cast<std::uint32_t>(pixels.at(begin, y)),
                    static_cast<std::uint32_t>(pixels.at(end, y))}});
    ++result.first[k + 1];
  });
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  std::vector<std::uint32_t> next(result.first.begin(), result.first.end() - 1);
  result.runs.resize(all.size());
  for (const auto& [k, run] : all) result.runs[next[k]++] = run;
  return result;
}

}  // namespace planescope::planes
