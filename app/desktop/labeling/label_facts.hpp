#pragma once

// What panels tell of a frame's planes beyond what their list has.

#include <memory>
#include <vector>

#include "core/labels/review/audit.hpp"

namespace planescope::desktop {

struct PlaneFacts {
  std::size_t pixels = 0;
  double area_m2 = 0;
};
struct LabelFacts {
  labels::LabelStatistics statistics;
  std::vector<PlaneFacts> planes;  // as FrameLabels::planes
};
LabelFacts facts_of(const FrameLabels& labels, const labels::LabelGrid& grid);

/// Kept while the labels stay as they are.
struct KeptLabelFacts {
  std::weak_ptr<const FrameLabels> of;
  LabelFacts facts;
};

}  // namespace planescope::desktop
