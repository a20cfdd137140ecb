#include "core/planes/segment/stages.hpp"

#include <array>

namespace planescope::planes {
namespace {

constexpr std::array kNames{"criteria", "merge",  "assign", "join",
                            "grow",     "hidden", "parts",  "list"};
constexpr std::size_t kOfPaper = 3;
constexpr std::array<StageInfo, kNames.size() - kOfPaper> kInfos{{
    {.title = "merge neighbors",
     .says = "{plane} merged into {other}: misfit {value:.3g}, less than the cost of a plane"},
    {.title = "grow over pixels",
     .says = "{plane} changes by {value:+.0f} px at its border",
     .why_dropped = "{value:.0f} px, too few to grow",
     .on_pixels = true},
    {.title = "merge hidden parts",
     .says = "{plane} merged into {other} behind an occluder: misfit {value:.3g}",
     .on_pixels = true},
    {.title = "split planes", .why_parted = "the parts do not touch"},
    {.title = "drop small planes",
     .says = "{plane} dropped: worth {value:.0f}, less than its cost",
     .why_dropped = "worth {value:.0f}, less than its cost"},
}};

}  // namespace

const char* to_string(Stage stage) { return kNames[static_cast<std::size_t>(stage)]; }

const StageInfo* info_of(Stage stage) {
  const auto index = static_cast<std::size_t>(stage);
  return index < kOfPaper ? nullptr : &kInfos[index - kOfPaper];
}

const std::vector<Stage>& stages() {
  static const std::vector<Stage> all = [] {
    std::vector<Stage> list;
    for (std::size_t k = 0; k < kNames.size(); ++k) list.push_back(static_cast<Stage>(k));
    return list;
  }();
  return all;
}

}  // namespace planescope::planes
