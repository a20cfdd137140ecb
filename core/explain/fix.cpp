#include "core/explain/fix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "core/explain/option_scale.hpp"
#include "core/explain/trial.hpp"

namespace planescope {
namespace {

bool steers_segmentation(const OptionInfo& info) {
  return info.section == "criteria" || info.section == "refinements";
}

/// IoU of the target with the plane that overlaps it most; of a part the share that is in it.
double iou_of(const std::vector<std::int32_t>& plane_of, const FixTarget& target) {
  const std::int32_t planes =
      plane_of.empty() ? 0 : *std::max_element(plane_of.begin(), plane_of.end());
  std::vector<std::uint32_t> sizes(planes + 1, 0), shared(planes + 1, 0);
  for (const std::int32_t plane : plane_of) ++sizes[plane];
  for (const std::uint32_t voxel : target.voxels)
    if (voxel < plane_of.size()) ++shared[plane_of[voxel]];
  double best = 0;
  for (std::int32_t p = 1; p <= planes; ++p) {
    const auto wanted = static_cast<double>(target.voxels.size());
    best = std::max(best, shared[p] / (target.whole ? sizes[p] + wanted - shared[p] : wanted));
  }
  return best;
}

/// Tries values of one option, all others as they are.
class Search {
 public:
  Search(const Run& run, const FixTarget& target, const OptionInfo& info, std::stop_token stop)
      : run_(run), target_(target), info_(info), stop_(std::move(stop)), scale_(info) {}

  std::optional<Fix> by_number();
  std::optional<Fix> by_value(const std::string& value);
  /// Of a limit that recovers and a looser one that does not: the loosest that does, to 1 %.
  std::optional<Fix> by_limit(double recovers, double fails);

 private:
  bool recovers(const std::string& value) {
    PipelineOptions options = run_.options;
    info_.set(options, value);
    planes_ = planes_with(*run_.subject, options);
    return iou_of(planes_, target_) >= kDetectedIou;
  }
  bool recovers_at(double position) { return recovers(scale_.text_at(position)); }
  std::optional<double> nearest_success(double start);
  double bisect(double fails, double recovers, double start);
  double refine(double fails, double recovers, double start);
  Fix fix(const std::string& value, double change);

  const Run& run_;
  const FixTarget& target_;
  const OptionInfo& info_;
  std::stop_token stop_;
  OptionScale scale_;
  std::vector<std::int32_t> planes_;  // of the last trial
};

Fix Search::fix(const std::string& value, double change) {
  recovers(value);
  Fix fix;
  fix.option = info_.name;
  fix.before = info_.get(run_.options);
  fix.after = value;
  fix.change = change;
  fix.iou = iou_of(planes_, target_);
  if (run_.subject->voxel_truth.known())
    fix.score = quick_score(planes_, run_.subject->voxel_truth);
  return fix;
}

constexpr double kStep = 0.14;     // 15 %
constexpr double kFarthest = 4.7;  // a hundredfold

/// Outwards on both sides in steps of 15 %, up to a hundredfold.
std::optional<double> Search::nearest_success(double start) {
  std::string last[2] = {info_.get(run_.options), info_.get(run_.options)};
  for (int k = 1; k * kStep <= kFarthest; ++k)
    for (const int side : {1, -1}) {
      if (stop_.stop_requested()) return {};
      const double position = start + side * k * kStep;
      const std::string value = scale_.text_at(position);
      if (value == last[side > 0]) continue;  // at the range's end, or between whole numbers
      last[side > 0] = value;
      if (recovers(value)) return position;
    }
  return {};
}

/// To 1 % of the change.
double Search::bisect(double fails, double recovers, double start) {
  while (std::abs(recovers - fails) > 0.01 * std::abs(recovers - start) &&
         !stop_.stop_requested()) {
    const double middle = (fails + recovers) / 2;
    const std::string value = scale_.text_at(middle);
    if (info_.kind == OptionKind::whole && value == scale_.text_at(recovers))
      recovers = middle;
    else if (info_.kind == OptionKind::whole && value == scale_.text_at(fails))
      fails = middle;
    else
      (recovers_at(middle) ? recovers : fails) = middle;
  }
  return recovers;
}

/// What recovers is not always all that lies beyond a value: where less of the change does too,
/// that is taken.
double Search::refine(double fails, double recovers, double start) {
  double best = bisect(fails, recovers, start);
  for (int round = 0; round < 8; ++round) {
    double less = best;
    for (const double share : {0.98, 0.95, 0.9, 0.8, 0.6, 0.4}) {
      const double position = start + share * (best - start);
      if (scale_.text_at(position) != scale_.text_at(best) && recovers_at(position))
        less = position;
    }
    if (less == best || stop_.stop_requested()) break;
    best = bisect(start, less, start);
  }
  return best;
}

std::optional<Fix> Search::by_number() {
  const double start = scale_.position(number_of(info_, run_.options));
  const std::optional<double> success = nearest_success(start);
  if (!success) return {};
  const double fails = *success > start ? *success - kStep : *success + kStep;
  const double best = refine(fails, *success, start);
  if (stop_.stop_requested()) return {};
  const std::string value = scale_.text_at(best);
  return fix(value, std::abs(scale_.position(std::stod(value)) - start));
}

std::optional<Fix> Search::by_value(const std::string& value) {
  if (stop_.stop_requested() || value == info_.get(run_.options) || !recovers(value)) return {};
  PipelineOptions changed = run_.options;
  info_.set(changed, value);
  double changes = 0;  // a profile sets many
  for (const OptionInfo& info : option_table())
    changes += info.name != "profile" && info.get(changed) != info.get(run_.options);
  return fix(value, std::max(1.0, changes));
}

std::optional<Fix> Search::by_limit(double recovers, double fails) {
  double tight = scale_.position(recovers), loose = scale_.position(fails);
  while (loose - tight > 0.01 && !stop_.stop_requested()) {
    const double middle = (tight + loose) / 2;
    (recovers_at(middle) ? tight : loose) = middle;
  }
  return by_value(scale_.text_at(tight));
}

/// What a switch or a choice can be.
std::vector<std::string> values_of(const OptionInfo& info) {
  if (info.kind == OptionKind::on_off) return {"on", "off"};
  return info.choices;
}

/// merge_offset_m asks nothing at 0: the mildest limit that does something is the largest.
void search_number(Search& search,
                   const OptionInfo& info,
                   const Run& run,
                   std::vector<Fix>& fixes) {
  const auto add = [&](std::optional<Fix> fix) {
    if (fix) fixes.push_back(std::move(*fix));
    return fix.has_value();
  };
  if (info.name == "merge_offset_m") {
    if (number_of(info, run.options) > 0) {
      if (!add(search.by_number())) add(search.by_value("0"));
      return;
    }
    double looser = 0.3;
    for (const double limit :
         {0.2, 0.15, 0.1, 0.07, 0.05, 0.04, 0.03, 0.02, 0.015, 0.01, 0.007, 0.005}) {
      if (search.by_value(fmt::format("{}", limit))) {
        add(search.by_limit(limit, looser));
        return;
      }
      looser = limit;
    }
    return;
  }
  add(search.by_number());
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
  std::vector<const OptionInfo*> options;
  for (const OptionInfo& info : option_table())
    if (steers_segmentation(info)) options.push_back(&info);
  for (std::size_t i = 0; i < options.size() && !stop.stop_requested(); ++i) {
    Search search(run, target, *options[i], stop);
    if (options[i]->is_number()) {
      search_number(search, *options[i], run, fixes);
    } else {
      for (const std::string& value : values_of(*options[i]))
        if (auto fix = search.by_value(value)) fixes.push_back(std::move(*fix));
    }
    if (progress) progress(static_cast<int>(i) + 1, static_cast<int>(options.size()));
  }
  std::stable_sort(fixes.begin(), fixes.end(),
                   [](const Fix& a, const Fix& b) { return a.change < b.change; });
  return fixes;
}

FixEffect effect_of(const Run& before, const PipelineOptions& after) {
  const Subject& subject = *before.subject;
  const QuickScore was = quick_score(before.segmentation.plane_of, subject.voxel_truth);
  const QuickScore is = quick_score(planes_with(subject, after), subject.voxel_truth);
  FixEffect effect;
  effect.frame = subject.frame.index;
  effect.planes_truth = static_cast<int>(was.planes.size());
  effect.detected_before = was.detected;
  effect.detected_after = is.detected;
  effect.iou_before = was.mean_iou;
  effect.iou_after = is.mean_iou;
  for (std::size_t i = 0; i < was.planes.size(); ++i) {
    const bool had = was.planes[i].iou >= kDetectedIou, has = is.planes[i].iou >= kDetectedIou;
    if (has && !had) effect.recovered.push_back(was.planes[i].truth);
    if (had && !has) effect.broken.push_back(was.planes[i].truth);
  }
  return effect;
}

}  // namespace planescope
