#include "core/planes/segment/trace.hpp"

#include <fmt/format.h>

#include <array>
#include <cassert>
#include <cctype>

#include "core/planes/segment/stages.hpp"

namespace planescope::planes {
namespace {

constexpr std::array kPaperStages{"criteria", "merge", "assign"};
#define PLANESCOPE_INFO(name) &name::kInfo,
constexpr const RefinementInfo* kRefinements[] = {
    &kJoinInfo,  &kGrowInfo, &kHiddenInfo,
    &kPartsInfo, &kListInfo, PLANESCOPE_REFINEMENTS(PLANESCOPE_INFO)};
#undef PLANESCOPE_INFO
#define PLANESCOPE_NAME(name) #name,
constexpr const char* kSwitches[] = {nullptr, nullptr, nullptr,
                                     nullptr, nullptr, PLANESCOPE_REFINEMENTS(PLANESCOPE_NAME)};
#undef PLANESCOPE_NAME

}  // namespace

std::string heading_of(const RefinementInfo& refinement) {
  const bool numbered = refinement.name[0] == 'R' && std::isdigit(refinement.name[1]);
  return numbered ? fmt::format("{}: {}", refinement.name, refinement.title) : refinement.title;
}

const RefinementInfo* refinement_of(Stage stage) {
  const auto index = static_cast<std::size_t>(stage);
  return index < kPaperStages.size() ? nullptr : kRefinements[index - kPaperStages.size()];
}

const char* switch_of(Stage stage) {
  assert(refinement_of(stage));
  return kSwitches[static_cast<std::size_t>(stage) - kPaperStages.size()];
}

const char* to_string(Stage stage) {
  const RefinementInfo* refinement = refinement_of(stage);
  return refinement ? refinement->name : kPaperStages[static_cast<std::size_t>(stage)];
}

const std::vector<Stage>& stages() {
  static const std::vector<Stage> all = [] {
    std::vector<Stage> list;
    for (std::size_t k = 0; k < kPaperStages.size() + std::size(kRefinements); ++k)
      list.push_back(static_cast<Stage>(k));
    return list;
  }();
  return all;
}

}  // namespace planescope::planes
