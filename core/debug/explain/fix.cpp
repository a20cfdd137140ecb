#include "core/debug/explain/fix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include "core/planes/pipeline/options_table.hpp"

namespace planescope::debug {
namespace {

/// IoU of the target with the plane that overlaps it most; of a part the share that is in it.
double iou_of(const std::vector<std::int32_t>& plane_of, const FixTarget& target) {
  const std::int32_t planes = plane_of.empty() ? 0 : std::ranges::max(plane_of);
  std::vector<std::uint32_t> sizes(planes + 1, 0), shared(planes + 1, 0);
  for (const std::int32_t plane : plane_of) ++sizes[plane];
  for (const std::uint32_t voxel : target.voxels)
    if (voxel < plane_of.size()) ++shared[plane_of[voxel]];
  const auto wanted = static_cast<double>(target.voxels.size());
  double best = 0;
  for (std::int32_t p = 1; p <= planes; ++p)
    best = std::max(best, shared[p] / (target.whole ? sizes[p] + wanted - shared[p] : wanted));
  return best;
}

constexpr double kStep = 0.14;     // 15 %
constexpr double kFarthest = 4.7;  // a hundredfold

/// Tries values of one option, all others as they are.
class Search {
 public:
  Search(const Run& run,
         const FixTarget& target,
         const planes::OptionInfo& info,
         std::stop_token stop)
      : run_(run), target_(target), info_(info), stop_(std::move(stop)) {}

  /// Appends the option's smallest change that recovers the target or, of a switch or a choice,
  /// every one.
  void append_to(std::vector<Fix>& fixes) {
    const auto append = [&](std::optional<Fix> fix) {
      if (fix) fixes.push_back(std::move(*fix));
      return fix.has_value();
    };
    if (info_.kind == planes::OptionKind::on_off) {
      for (const char* value : {"on", "off"}) append(by_value(value));
    } else if (!info_.is_number()) {
      for (const std::string& value : info_.choices) append(by_value(value));
    } else if (info_.name != "merge_offset_m") {
      append(by_number());
    } else if (planes::number_of(info_, run_.options) == 0) {
      append(by_limit());
    } else if (!append(by_number())) {
      append(by_value("0"));  // asks nothing
    }
  }

 private:
  bool recovers(const std::string& value) {
    planes::PipelineOptions options = run_.options;
    info_.set(options, value);
    const Subject& subject = *run_.subject;
    if (planes::is_found_on_pixels(subject.frame, options) != subject.prepared.of_pixels)
      return false;  // a profile that finds planes in another way changes no decision of this one
    planes_ = planes_with(run_, options);
    return iou_of(planes_, target_) >= kDetectedIou;
  }

  /// Each value of a number is tried once.
  bool recovers_at(double position) {
    const auto [tried, is_new] = tried_.try_emplace(scale_value(info_, position));
    if (is_new) tried->second = recovers(tried->first);
    return tried->second;
  }

  Fix fix(const std::string& value, double change) {
    recovers(value);
    Fix fix{info_.name, info_.get(run_.options), value, change, iou_of(planes_, target_)};
    if (run_.subject->voxel_truth.known())
      fix.score = quick_score(planes_, run_.subject->voxel_truth);
    return fix;
  }

  /// Outwards on both sides in steps of 15 %, up to a hundredfold.
  std::optional<double> nearest_success(double start) {
    for (int k = 1; k * kStep <= kFarthest; ++k)
      for (const int side : {1, -1}) {
        if (stop_.stop_requested()) return {};
        const double position = start + side * k * kStep;
        if (recovers_at(position)) return position;
      }
    return {};
  }

  /// To 1 % of the change; without a start, of the value.
  double bisect(double fails, double recovers, std::optional<double> start) {
    while (std::abs(recovers - fails) > 0.01 * (start ? std::abs(recovers - *start) : 1) &&
           !stop_.stop_requested()) {
      const double middle = (fails + recovers) / 2;
      (recovers_at(middle) ? recovers : fails) = middle;
    }
    return recovers;
  }

  /// What recovers is not always all that lies beyond a value: where less of the change does too,
  /// that is taken.
  double refine(double fails, double recovers, double start) {
    double best = bisect(fails, recovers, start);
    for (int round = 0; round < 8; ++round) {
      double less = best;
      for (const double share : {0.98, 0.95, 0.9, 0.8, 0.6, 0.4}) {
        const double position = start + share * (best - start);
        if (scale_value(info_, position) != scale_value(info_, best) && recovers_at(position))
          less = position;
      }
      if (less == best || stop_.stop_requested()) break;
      best = bisect(start, less, start);
    }
    return best;
  }

  std::optional<Fix> by_number() {
    const double start = scale_position(info_, planes::number_of(info_, run_.options));
    const std::optional<double> success = nearest_success(start);
    if (!success) return {};
    const double fails = *success > start ? *success - kStep : *success + kStep;
    const std::string value = scale_value(info_, refine(fails, *success, start));
    if (stop_.stop_requested()) return {};
    return fix(value, std::abs(scale_position(info_, std::stod(value)) - start));
  }

  std::optional<Fix> by_value(const std::string& value) {
    if (stop_.stop_requested() || value == info_.get(run_.options) || !recovers(value)) return {};
    planes::PipelineOptions changed = run_.options;
    info_.set(changed, value);
    double changes = 0;  // a profile sets many
    for (const planes::OptionInfo& info : planes::option_table())
      changes += info.name != "profile" && info.get(changed) != info.get(run_.options);
    return fix(value, std::max(1.0, changes));
  }

  /// For a limit that is not in force yet: the loosest that recovers, to 1 %.
  std::optional<Fix> by_limit() {
    double looser = 0.3;
    for (const double limit :
         {0.2, 0.15, 0.1, 0.07, 0.05, 0.04, 0.03, 0.02, 0.015, 0.01, 0.007, 0.005}) {
      if (by_value(fmt::format("{}", limit)))
        return by_value(scale_value(info_, bisect(scale_position(info_, looser),
                                                  scale_position(info_, limit), std::nullopt)));
      looser = limit;
    }
    return {};
  }

  const Run& run_;
  const FixTarget& target_;
  const planes::OptionInfo& info_;
  std::stop_token stop_;
  std::map<std::string, bool> tried_{{info_.get(run_.options), false}};
  std::vector<std::int32_t> planes_;  // of the last trial
};

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

FixTarget target_of_truth(const Run& run, std::int32_t truth_plane) {
  FixTarget target;
  target.name = fmt::format("truth plane {}", truth_plane);
  const std::vector<std::int32_t>& planes = run.subject->voxel_truth.plane;
  for (std::uint32_t voxel = 0; voxel < planes.size(); ++voxel)
    if (planes[voxel] == truth_plane) target.voxels.push_back(voxel);
  return target;
}

bool is_recovered(const Run& run, const FixTarget& target) {
  return iou_of(run.segmentation.plane_of, target) >= kDetectedIou;
}

std::vector<Fix> find_fixes(const Run& run,
                            const FixTarget& wanted,
                            std::stop_token stop,
                            const FixProgress& progress) {
  std::vector<Fix> fixes;
  FixTarget target = wanted;  // a region may have been marked on a finer grid
  std::erase_if(target.voxels,
                [&](std::uint32_t voxel) { return voxel >= run.subject->voxel_count(); });
  if (target.voxels.empty() || is_recovered(run, target)) return fixes;
  std::vector<const planes::OptionInfo*> options;  // those that steer the segmentation
  for (const planes::OptionInfo& info : planes::option_table())
    if (info.steers_segmentation() && !planes::is_idle(info, run.options)) options.push_back(&info);
  for (std::size_t i = 0; i < options.size() && !stop.stop_requested(); ++i) {
    Search(run, target, *options[i], stop).append_to(fixes);
    if (progress) progress(static_cast<int>(i) + 1, static_cast<int>(options.size()));
  }
  std::ranges::stable_sort(fixes, {}, &Fix::change);
  return fixes;
}

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
