#include "core/planes/segment/stages.hpp"

#include <array>

namespace planescope::planes {
namespace {

constexpr std::array kNames{"criteria", "merge",  "assign", "join",
                            "grow",     "hidden", "parts",  "list"};
constexpr std::size_t kOfPaper = 3;
constexpr std::array<StageInfo, kNames.size() - kOfPaper> kInfos{{
    {.title = "join neighbors",
     .says = "{plane} joins {other}: their misfit costs {value:.3g}, less than a plane"},
    {.title = "grow over pixels",
     .says = "{plane} changes by {value:+.0f} px at its border",
     .why_dropped = "it has {value:.0f} px, too few to grow",
     .on_pixels = true},
    {.title = "join hidden parts",
     .says = "{plane} joins {other} behind what hides them from each other: their misfit costs "
             "{value:.3g}",
     .on_pixels = true},
    {.title = "part planes", .why_parted = "they do not touch"},
    {.title = "list planes",
     .says = "{plane} is not listed: it is worth {value:.0f}, less than it costs",
     .why_dropped = "it is worth {value:.0f}, less than it costs"},
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
