#include <algorithm>

#include "core/explain/fix.hpp"
#include "core/explain/option_scale.hpp"
#include "core/explain/trial.hpp"

namespace planescope {
namespace {

/// From a tenth to tenfold; the current value in the middle.
std::vector<std::string> values_around(const OptionInfo& info, const PipelineOptions& options) {
  constexpr int kSide = 12;
  constexpr double kReach = 2.302585092994046;
  const OptionScale scale(info);
  const double start = scale.position(number_of(info, options));
  std::vector<std::string> values;
  for (int k = -kSide; k <= kSide; ++k) {
    const std::string value =
        k == 0 ? info.get(options) : scale.text_at(start + k * kReach / kSide);
    if (values.empty() || values.back() != value) values.push_back(value);
  }
  return values;
}

}  // namespace

Sensitivity sensitivity_of(const Run& run, const std::string& option, std::stop_token stop) {
  const OptionInfo& info = find_option(option);
  Sensitivity result;
  result.option = option;
  result.against_truth = run.subject->voxel_truth.known();
  if (!info.is_number()) return result;
  for (const std::string& value : values_around(info, run.options)) {
    if (stop.stop_requested()) break;
    PipelineOptions options = run.options;
    info.set(options, value);
    const double number = number_of(info, options);
    if (!result.values.empty() && number <= result.values.back()) continue;
    const QuickScore score =
        quick_score(planes_with(*run.subject, options), run.subject->voxel_truth);
    result.values.push_back(number);
    result.scores.push_back(result.against_truth ? score.mean_iou : score.found_planes);
  }
  return result;
}

}  // namespace planescope
