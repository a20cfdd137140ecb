#include "app/desktop/debugger/change_text.hpp"

#include <fmt/format.h>

#include <vector>

#include "core/model/text.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

/// Planes of `b` that more than half of a plane of `a` is in, and that are more than half in it.
int planes_kept(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  const planes::TruthOverlap overlap = planes::count_truth_overlap(a, b);
  int kept = 0;
  for (int p = 1; p <= overlap.truth; ++p)
    for (int q = 1; q <= overlap.found; ++q)
      kept += 2 * overlap.at(p, q) > overlap.truth_size[p] &&
              2 * overlap.at(p, q) > overlap.found_size[q];
  return kept;
}

}  // namespace

std::string change_text(const debug::Run& before, const debug::Run& after) {
  if (before.subject != after.subject) return {};
  std::vector<const planes::OptionInfo*> changed;
  for (const planes::OptionInfo& info : planes::option_table())
    if (info.get(before.options) != info.get(after.options)) changed.push_back(&info);
  if (changed.empty()) return {};
  std::string what = counted(changed.size(), "option");
  for (const planes::OptionInfo* info : changed)
    if (changed.size() == 1 || info->name == "profile")
      what = fmt::format("{} {} → {}", info->title, info->get(before.options),
                         info->get(after.options));
  const auto a = static_cast<int>(before.segmentation.planes.size()),
             b = static_cast<int>(after.segmentation.planes.size());
  const int kept = planes_kept(before.segmentation.plane_of, after.segmentation.plane_of);
  return fmt::format("{} · planes {} → {} (+{} −{})", what, a, b, b - kept, a - kept);
}

}  // namespace planescope::desktop
