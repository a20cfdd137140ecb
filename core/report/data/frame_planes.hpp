#pragma once

// Everything that a frame's files tell about its planes.

#include <optional>
#include <vector>

#include "core/planes/foot/footholds.hpp"
#include "core/planes/outline/outline.hpp"
#include "core/planes/stairs/stairs.hpp"
#include "core/report/data/plane_summary.hpp"

namespace planescope::report {

struct FramePlanes {
  // By id - 1.
  std::vector<PlaneSummary> summaries;
  std::vector<planes::Outline> outlines;
  std::vector<planes::Foothold> footholds;
  planes::Stairs stairs;
  std::optional<std::vector<int>> tracks;  // of a map
};

FramePlanes frame_planes(const Frame& frame,
                         const planes::FrameResult& result,
                         const planes::PipelineOptions& options);

}  // namespace planescope::report
