// What a change of the options makes of a run.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/debug/explain/fix.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::debug {
namespace {

bool is_share(const planes::OptionInfo& info) { return info.range.min == 0 && info.range.max == 1; }

/// From a tenth to tenfold; the current value in the middle.
std::vector<std::string> values_around(const planes::OptionInfo& info,
                                       const planes::PipelineOptions& options) {
  constexpr int kSide = 12;
  constexpr double kReach = 2.302585092994046;
  const double start = scale_position(info, planes::number_of(info, options));
  std::vector<std::string> values;
  for (int k = -kSide; k <= kSide; ++k)
    values.push_back(k == 0 ? info.get(options) : scale_value(info, start + k * kReach / kSide));
  return values;
}

}  // namespace

std::vector<std::int32_t> planes_with(const Run& run, const planes::PipelineOptions& options) {
  const Subject& subject = *run.subject;
  return planes::find_regions(subject.frame, subject.prepared, options).segmentation.plane_of;
}

double scale_position(const planes::OptionInfo& info, double value) {
  constexpr double kLeast = 1e-4;
  if (!is_share(info)) return std::log(std::max(value, kLeast));
  value = std::clamp(value, kLeast, 1 - kLeast);
  return std::log(value / (1 - value));
}

std::string scale_value(const planes::OptionInfo& info, double position) {
  const double e = std::exp(position);
  // Six digits are more than any search resolves, and can be read.
  return planes::number_text(info,
                             std::stod(fmt::format("{:.6g}", is_share(info) ? e / (1 + e) : e)));
}

FixEffect effect_of(const Run& before, const planes::PipelineOptions& after) {
  const Subject& subject = *before.subject;
  const QuickScore was = quick_score(before.segmentation.plane_of, subject.voxel_truth);
  const QuickScore is = quick_score(planes_with(before, after), subject.voxel_truth);
  FixEffect effect{subject.frame.index, was.detected,
                   is.detected,         static_cast<int>(was.planes.size()),
                   was.mean_iou,        is.mean_iou};
  for (std::size_t i = 0; i < was.planes.size(); ++i) {
    const bool had = was.planes[i].iou >= kDetectedIou, has = is.planes[i].iou >= kDetectedIou;
    if (has && !had) effect.recovered.push_back(was.planes[i].truth);
    if (had && !has) effect.broken.push_back(was.planes[i].truth);
  }
  return effect;
}

Sensitivity sensitivity_of(const Run& run, const std::string& option, std::stop_token stop) {
  const planes::OptionInfo& info = planes::find_option(option);
  Sensitivity result{option};
  result.against_truth = run.subject->voxel_truth.known();
  if (!info.is_number()) return result;
  for (const std::string& value : values_around(info, run.options)) {
    if (stop.stop_requested()) break;
    planes::PipelineOptions options = run.options;
    info.set(options, value);
    const double number = planes::number_of(info, options);
    if (!result.values.empty() && number <= result.values.back()) continue;
    const QuickScore score = quick_score(planes_with(run, options), run.subject->voxel_truth);
    result.values.push_back(number);
    result.scores.push_back(result.against_truth ? score.mean_iou : score.found_planes);
  }
  return result;
}

}  // namespace planescope::debug
