#pragma once

#include <vector>

#include "core/model/disjoint_sets.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::planes {

/// Cloud points begin <= i < end, all of one plane.
struct PointRun {
  std::size_t begin = 0, end = 0;
};

/// By id - 1, the points of each plane in the cloud's order.
inline std::vector<std::vector<PointRun>> runs_of_planes(const FrameResult& result) {
  std::vector<std::vector<PointRun>> runs(result.segmentation.planes.size());
  for (std::size_t begin = 0, end = 0; begin < result.plane_of.size(); begin = end) {
    end = end_of_run(result.plane_of, begin);
    if (const std::int32_t id = result.plane_of[begin]; id > 0)
      runs[static_cast<std::size_t>(id) - 1].push_back({begin, end});
  }
  return runs;
}

}  // namespace planescope::planes
