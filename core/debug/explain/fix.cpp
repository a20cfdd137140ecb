// Searches for option changes that give a surface the requested result, cheapest first.

#include "core/debug/explain/fix.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <utility>

#include "core/debug/explain/compare.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::debug {
namespace {

// Share of a target that must be as requested; the second value applies if no change reaches
// the first.
constexpr std::array kEnough{0.5, 0.1};
constexpr double kMostBeyond = 0.5;    // share of a plane outside the requested surface ...
constexpr double kOfItsOwn = 0.25;     // ... and if it should be a separate plane
constexpr std::size_t kExplained = 3;  // number of fixes for which the decisive step is computed
constexpr std::size_t kVotes = 64;     // number of voxels sampled for it

std::size_t in_common(const std::vector<std::uint32_t>& voxels,
                      const std::vector<std::int32_t>& plane_of,
                      std::int32_t plane) {
  return static_cast<std::size_t>(
      std::ranges::count_if(voxels, [&](std::uint32_t voxel) { return plane_of[voxel] == plane; }));
}

/// How well a result satisfies a request.
struct Granted {
  bool enough = false;
  double share = 0;
  std::int32_t plane = 0;  // the plane that contains the target
  std::size_t voxels = 0;  // voxels of the target that are as requested
};

Granted granted(const std::vector<std::int32_t>& plane_of,
                const FixTarget& target,
                double enough = kEnough[0]) {
  const auto wanted = static_cast<double>(target.voxels.size());
  if (target.voxels.empty()) return {};
  const auto of = [&](std::size_t voxels) { return static_cast<double>(voxels) / wanted; };
  if (target.wish == Wish::no_plane) {
    const std::size_t none = in_common(target.voxels, plane_of, 0);
    const bool is_none = target.voxel < 0 || plane_of[target.voxel] == 0;
    return {is_none && of(none) >= enough, of(none), 0, none};
  }
  std::vector<std::uint32_t> sizes, shared;
  const std::int32_t planes = std::ranges::max(plane_of);
  sizes.assign(planes + 1, 0), shared.assign(planes + 1, 0);
  for (const std::int32_t plane : plane_of) ++sizes[plane];
  for (const std::uint32_t voxel : target.voxels) ++shared[plane_of[voxel]];
  if (target.wish == Wish::true_plane) {
    Granted best;
    for (std::int32_t p = 1; p <= planes; ++p)
      if (const double iou = shared[p] / (sizes[p] + wanted - shared[p]); iou > best.share)
        best = {iou >= kDetectedIou, iou, p, shared[p]};
    return best;
  }
  const std::int32_t most = static_cast<std::int32_t>(
      std::max_element(shared.begin() + 1, shared.end()) - shared.begin());
  const std::int32_t plane = target.voxel >= 0 ? plane_of[target.voxel] : planes > 0 ? most : 0;
  if (plane == 0) return {};
  Granted result{of(shared[plane]) >= enough, of(shared[plane]), plane, shared[plane]};
  if (target.wish == Wish::joined) {
    result.enough &= target.with < 0 || plane_of[target.with] == plane;
    return result;
  }
  if (target.with >= 0) {
    result.enough &= plane_of[target.with] != plane;
    return result;
  }
  const bool own = target.wish == Wish::own_plane;
  const auto& surface = own || target.surface.empty() ? target.voxels : target.surface;
  const double inside = static_cast<double>(in_common(surface, plane_of, plane));
  result.enough &= 1 - inside / sizes[plane] <= (own ? kOfItsOwn : kMostBeyond);
  return result;
}

/// Number of voxels outside the target that changed planes.
std::int32_t moved_elsewhere(const std::vector<std::int32_t>& before,
                             const std::vector<std::int32_t>& after,
                             const std::vector<std::uint32_t>& target) {
  const planes::TruthOverlap overlap = planes::count_truth_overlap(before, after);
  std::vector<std::int32_t> after_of(overlap.truth + 1, -1);  // -1: no counterpart
  after_of[0] = 0;
  for (const planes::PlanePair& pair : planes::pairs_by_overlap(overlap)) after_of[pair.a] = pair.b;
  const auto stays = [&](std::size_t i) { return after_of[before[i]] == after[i]; };
  std::int32_t moved = 0;
  for (std::size_t i = 0; i < before.size(); ++i) moved += !stays(i);
  for (const std::uint32_t voxel : target) moved -= !stays(voxel);
  return moved;
}

double cost_of(const Fix& fix) {
  return fix.change + fix.elsewhere / std::max(1.0, 1.0 * fix.gained);
}

bool is_better(const Fix& a, const Fix& b) {
  return a.restores != b.restores ? a.restores : cost_of(a) < cost_of(b);
}

/// The profile's value of an option.
std::string value_of_profile(const planes::OptionInfo& info,
                             const planes::PipelineOptions& options) {
  planes::PipelineOptions profile = options;
  profile.segment = planes::profile_options(options.segment.profile);
  return info.get(profile);
}

/// Searches the values of one option, with all others unchanged.
class Search {
 public:
  Search(const Run& run,
         const FixTarget& target,
         const planes::OptionInfo& info,
         double enough,
         std::stop_token stop)
      : run_(run),
        target_(target),
        info_(info),
        enough_(enough),
        stop_(std::move(stop)),
        has_(granted(run.segmentation.plane_of, target)) {}

  /// The profile's value, if the option currently has another.
  std::optional<Fix> restored() {
    const std::string value = value_of_profile(info_, run_.options);
    if (value == info_.get(run_.options)) return {};
    // Accept a plane that extends far beyond the surface, because the profile produces it.
    const bool is_back = grants(value) || (target_.wish == Wish::plane && target_.voxel >= 0 &&
                                           planes_[target_.voxel] > 0);
    if (!is_back || stop_.stop_requested()) return {};
    Fix fix = tried(value, 1);
    fix.restores = true;
    if (info_.is_number())
      fix.change = std::abs(scale_position(info_, std::stod(value)) -
                            scale_position(info_, planes::number_of(info_, run_.options)));
    return fix;
  }

  /// The cheapest change of the option.
  std::optional<Fix> best() {
    std::optional<Fix> best;
    const auto offer = [&](std::optional<Fix> fix) {
      if (fix && (!best || is_better(*fix, *best))) best = std::move(fix);
    };
    if (info_.kind == planes::OptionKind::on_off) {
      for (const char* value : {"on", "off"}) offer(by_value(value));
    } else if (!info_.is_number()) {
      if (target_.far || info_.name != "profile")
        for (const std::string& value : info_.choices) offer(by_value(value));
    } else if (info_.name == "merge_offset_m" && planes::number_of(info_, run_.options) == 0) {
      offer(by_limit());
    } else {
      for (const int side : {1, -1}) offer(by_number(side));
      if (info_.name == "merge_offset_m" && !best) offer(by_value("0"));  // 0 disables the test
    }
    return best;
  }

 private:
  bool grants(const std::string& value) {
    planes::PipelineOptions options = run_.options;
    options.threads = 1;  // options are tried in parallel
    info_.set(options, value);
    const Subject& subject = *run_.subject;
    if (planes::is_found_on_pixels(subject.frame, options) != subject.prepared.of_pixels)
      return false;  // a profile that switches between pixels and voxels is not comparable
    planes_ = planes_with(run_, options);
    return granted(planes_, target_, enough_).enough;
  }

  /// Tries each value of a number once.
  bool grants_with(const std::string& value) {
    const auto [tried, is_new] = tried_.try_emplace(value);
    if (is_new) tried->second = grants(value);
    return tried->second;
  }
  bool grants_at(double position) { return grants_with(scale_value(info_, position)); }

  Fix tried(const std::string& value, double change) {
    grants(value);
    const Granted gets = granted(planes_, target_);
    Fix fix{.option = info_.name,
            .before = info_.get(run_.options),
            .after = value,
            .change = change,
            .share = gets.share,
            .gained = static_cast<std::int32_t>(gets.voxels)};
    if (target_.wish != Wish::own_plane) fix.gained -= static_cast<std::int32_t>(has_.voxels);
    fix.elsewhere = moved_elsewhere(run_.segmentation.plane_of, planes_, target_.voxels);
    fix.planes_before = static_cast<int>(run_.segmentation.planes.size());
    fix.planes_after = planes_.empty() ? 0 : std::ranges::max(planes_);
    if (run_.subject->voxel_truth.known())
      fix.score = quick_score(planes_, run_.subject->voxel_truth);
    return fix;
  }

  /// The smallest change in one direction: outward in steps, then bisected. Changes smaller than
  /// the first step are not considered, because their effect is random.
  std::optional<Fix> by_number(int side) {
    static constexpr std::array kSteps{0.048, 0.14, 0.35, 0.69, 1.0987, 1.6, 2.3, 3.2, 4.61};
    const double start = scale_position(info_, planes::number_of(info_, run_.options));
    double fails = 0;
    for (const double step : std::span(kSteps).first(target_.far ? kSteps.size() : 5)) {
      if (stop_.stop_requested()) return {};
      if (!grants_at(start + side * step)) {
        fails = step;
        continue;
      }
      const double nearest = step == kSteps.front()
                                 ? start + side * step
                                 : bisect(start + side * fails, start + side * step, start);
      const std::string value = rounded(scale_value(info_, nearest), start, side);
      if (stop_.stop_requested()) return {};
      return tried(value, std::abs(scale_position(info_, std::stod(value)) - start));
    }
    return {};
  }

  /// Rounds to few digits, away from the current value, if that adds little to the change and also
  /// satisfies the request.
  std::string rounded(const std::string& value, double start, int side) {
    const double number = std::stod(value);
    if (!(number > 0)) return value;
    const double change = std::abs(scale_position(info_, number) - start);
    for (const int digits : {2, 3, 4}) {
      const double unit = std::pow(10.0, std::floor(std::log10(number)) + 1 - digits);
      const double whole = unit * (side > 0 ? std::ceil(number / unit) : std::floor(number / unit));
      const double position = scale_position(info_, whole);
      if (std::abs(position - start) - change < 0.1 * change && grants_at(position))
        return scale_value(info_, position);
    }
    return value;
  }

  /// Bisects to 2 % of the change; without a start, to 1 % of the value.
  double bisect(double fails, double grants, std::optional<double> start) {
    while (std::abs(grants - fails) > (start ? 0.02 * std::abs(grants - *start) : 0.01) &&
           !stop_.stop_requested()) {
      const double middle = (fails + grants) / 2;
      (grants_at(middle) ? grants : fails) = middle;
    }
    return grants;
  }

  std::optional<Fix> by_value(const std::string& value) {
    if (stop_.stop_requested() || value == info_.get(run_.options) || !grants(value)) return {};
    planes::PipelineOptions changed = run_.options;
    info_.set(changed, value);
    double changes = 0;  // a profile changes many options
    for (const planes::OptionInfo& info : planes::option_table())
      changes += info.name != "profile" && info.get(changed) != info.get(run_.options);
    return tried(value, std::max(1.0, changes));
  }

  /// For a limit that is currently disabled: the loosest value that recovers the surface, to 1 %.
  std::optional<Fix> by_limit() {
    double looser = 0.3;
    for (const double limit :
         {0.2, 0.15, 0.1, 0.07, 0.05, 0.04, 0.03, 0.02, 0.015, 0.01, 0.007, 0.005}) {
      if (by_value(fmt::format("{}", limit))) {
        const double loosest =
            bisect(scale_position(info_, looser), scale_position(info_, limit), std::nullopt);
        return by_value(rounded(scale_value(info_, loosest), scale_position(info_, 1), -1));
      }
      looser = limit;
    }
    return {};
  }

  const Run& run_;
  const FixTarget& target_;
  const planes::OptionInfo& info_;
  const double enough_;
  std::stop_token stop_;
  const Granted has_;  // result without a change
  std::map<std::string, bool> tried_{{info_.get(run_.options), false}};
  std::vector<std::int32_t> planes_;  // from the last trial
};

/// Options in the order in which they are tried: options that decided on the target first.
std::vector<const planes::OptionInfo*> options_to_try(const Run& run, const FixTarget& target) {
  std::vector<const planes::OptionInfo*> options;
  for (const planes::OptionInfo& info : planes::option_table())
    if (info.steers_segmentation() && !planes::is_idle(info, run.options, run.is_on_image()))
      options.push_back(&info);
  const auto voxel = static_cast<std::uint32_t>(
      target.voxel >= 0 ? target.voxel : target.voxels[target.voxels.size() / 2]);
  const std::string decided = why_not(run, source_of_voxel(*run.subject, voxel)).remedy.option;
  std::ranges::stable_partition(options, [&](const auto* info) {
    return info->name == decided || info->name == "merge_cost" || info->name == "theta_coplane";
  });
  return options;
}

/// The step of the run at which the history of most of the target first differs.
std::int32_t step_decided_by(const Run& run, const FixTarget& target, const Fix& fix) {
  planes::PipelineOptions options = run.options;
  planes::set_option(options, fix.option, fix.after);
  std::vector<std::uint32_t> votes;
  const std::size_t stride = std::max<std::size_t>(1, target.voxels.size() / kVotes);
  for (std::size_t i = 0; i < target.voxels.size(); i += stride) votes.push_back(target.voxels[i]);
  return first_difference(run, *make_run(run.subject, options), votes).step;
}

}  // namespace

FixTarget target_of_truth(const Run& run, std::int32_t truth_plane) {
  FixTarget target;
  target.name = fmt::format("true plane {}", truth_plane);
  const std::vector<std::int32_t>& planes = run.subject->voxel_truth.plane;
  for (std::uint32_t voxel = 0; voxel < planes.size(); ++voxel)
    if (planes[voxel] == truth_plane) target.voxels.push_back(voxel);
  return target;
}

FixTarget target_of_click(const Run& run,
                          std::uint32_t voxel,
                          Wish wish,
                          std::vector<std::uint32_t> surface) {
  const std::vector<std::int32_t>& plane_of = run.segmentation.plane_of;
  FixTarget target{.voxels = {}, .name = "this surface", .wish = wish, .voxel = voxel};
  const auto all_in = [&](std::int32_t plane) {
    std::vector<std::uint32_t> voxels;
    for (std::uint32_t i = 0; i < plane_of.size(); ++i)
      if (plane_of[i] == plane) voxels.push_back(i);
    return voxels;
  };
  const std::int32_t own = plane_of[voxel];
  if (wish == Wish::no_plane) {
    target.voxels = all_in(own);
    return target;
  }
  if (!std::ranges::binary_search(surface, voxel)) {
    surface = all_in(own);
    const auto left = [&](std::uint32_t of) {
      return run.timeline.point_at(static_cast<std::int32_t>(of), run.steps()).step;
    };
    if (own == 0)
      std::erase_if(surface, [&, step = left(voxel)](auto other) { return left(other) != step; });
  }
  target.voxels = surface;
  if (wish == Wish::plane || wish == Wish::own_plane)
    std::erase_if(target.voxels, [&](std::uint32_t other) { return plane_of[other] != own; });
  target.surface = std::move(surface);
  return target;
}

bool is_granted(const Run& run, const FixTarget& target) {
  return granted(run.segmentation.plane_of, target).enough;
}

std::vector<Fix> find_fixes(const Run& run,
                            const FixTarget& wanted,
                            std::stop_token stop,
                            const FixProgress& progress) {
  std::vector<Fix> fixes;
  FixTarget target = wanted;  // a region may have been marked on a finer grid
  const auto is_absent = [&](std::uint32_t voxel) { return voxel >= run.subject->voxel_count(); };
  std::erase_if(target.voxels, is_absent);
  std::erase_if(target.surface, is_absent);
  const auto voxels = static_cast<std::int64_t>(run.subject->voxel_count());
  if (target.voxel >= voxels || target.with >= voxels) return fixes;
  if (target.voxels.empty() || is_granted(run, target)) return fixes;
  if (target.wish == Wish::plane) {  // a plane may also take unassigned voxels
    std::vector<std::uint8_t> takes(run.subject->voxel_count(), 0);
    for (const std::uint32_t voxel : target.voxels) takes[voxel] = 1;
    for (const std::uint32_t voxel : target.surface) takes[voxel] = 1;
    target.surface.clear();
    for (std::uint32_t i = 0; i < takes.size(); ++i)
      if (takes[i] || run.segmentation.plane_of[i] == 0) target.surface.push_back(i);
  }
  const std::vector<const planes::OptionInfo*> options = options_to_try(run, target);
  const auto total = static_cast<int>(options.size());
  std::vector<std::optional<Fix>> found(options.size());
  const auto add = [&](int i) {
    if (!found[i]) return;
    const auto place = std::ranges::upper_bound(fixes, *found[i], is_better);
    fixes.insert(place, std::move(*found[i]));
    found[i].reset();
  };
  const auto search = [&](int i, double enough) {
    return Search(run, target, *options[i], enough, stop);
  };
  std::vector<std::uint8_t> is_restored(options.size(), 0);
  work_in_order(
      total, run.options.threads, [&](int i) { found[i] = search(i, kEnough.back()).restored(); },
      [&](int i) {
        is_restored[i] = found[i].has_value();
        add(i);
      });
  const std::size_t restoring = fixes.size();
  if (progress) progress(0, total, fixes);
  for (const double enough : kEnough) {
    work_in_order(
        total, run.options.threads,
        [&](int i) {
          if (!is_restored[i]) found[i] = search(i, enough).best();
        },
        [&](int i) {
          add(i);
          if (progress && !stop.stop_requested()) progress(i + 1, total, fixes);
        });
    if (fixes.size() > restoring || target.wish == Wish::true_plane) break;
  }
  for (std::size_t i = 0; i < std::min(kExplained, fixes.size()) && !stop.stop_requested(); ++i)
    fixes[i].step = step_decided_by(run, target, fixes[i]);
  return fixes;
}

}  // namespace planescope::debug
