#include "app/desktop/labeling/label_facts.hpp"

namespace planescope::desktop {

LabelFacts facts_of(const FrameLabels& labels, const labels::LabelGrid& grid) {
  LabelFacts facts;
  facts.statistics = labels::statistics_of(labels, grid);
  facts.planes.resize(labels.planes.size());
  std::vector<int> place(kPlaneIgnore + 1, -1);  // in the list, by id
  for (std::size_t i = 0; i < labels.planes.size(); ++i)
    place[static_cast<std::size_t>(labels.planes[i].id)] = static_cast<int>(i);
  for (std::size_t i = 0; i < labels.plane.data.size(); ++i) {
    const int at = place[labels.plane.data[i]];
    if (at < 0) continue;
    PlaneFacts& plane = facts.planes[static_cast<std::size_t>(at)];
    ++plane.pixels;
    plane.area_m2 += grid.pixel_area_m2(static_cast<std::uint32_t>(i),
                                        &labels.planes[static_cast<std::size_t>(at)].normal);
  }
  return facts;
}

}  // namespace planescope::desktop
