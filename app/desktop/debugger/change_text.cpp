#include "app/desktop/debugger/change_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "core/model/text.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

/// Planes of `b` that more than half of a plane of `a` is in, and that are more than half in it.
int planes_kept(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  if (a.empty()) return 0;
  const auto count_a = static_cast<std::size_t>(std::ranges::max(a)) + 1,
             count_b = static_cast<std::size_t>(std::ranges::max(b)) + 1;
  std::vector<std::size_t> size_a(count_a, 0), size_b(count_b, 0), common(count_a * count_b, 0);
  for (std::size_t i = 0; i < a.size(); ++i) {
    ++size_a[a[i]];
    ++size_b[b[i]];
    ++common[a[i] * count_b + b[i]];
  }
  int kept = 0;
  for (std::size_t p = 1; p < count_a; ++p)
    for (std::size_t q = 1; q < count_b; ++q)
      kept += 2 * common[p * count_b + q] > size_a[p] && 2 * common[p * count_b + q] > size_b[q];
  return kept;
}

}  // namespace

bool same_options(const planes::PipelineOptions& a, const planes::PipelineOptions& b) {
  return std::ranges::all_of(planes::option_table(), [&](const planes::OptionInfo& info) {
    return info.get(a) == info.get(b);
  });
}

std::string change_text(const debug::Run& before, const debug::Run& after) {
  if (before.subject != after.subject) return {};
  std::vector<const planes::OptionInfo*> changed;
  for (const planes::OptionInfo& info : planes::option_table())
    if (info.get(before.options) != info.get(after.options)) changed.push_back(&info);
  if (changed.empty()) return {};
  std::string what = counted(changed.size(), "option");
  for (const planes::OptionInfo* info : changed)
    if (changed.size() == 1 || info->name == "profile")
      what = fmt::format("{} {} → {}", info->name, info->get(before.options),
                         info->get(after.options));
  const auto a = static_cast<int>(before.segmentation.planes.size()),
             b = static_cast<int>(after.segmentation.planes.size());
  const int kept = planes_kept(before.segmentation.plane_of, after.segmentation.plane_of);
  return fmt::format("{}: planes {} → {} (+{} −{})", what, a, b, b - kept, a - kept);
}

}  // namespace planescope::desktop
