#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "app/desktop/state/session.hpp"
#include "core/debug/explain/compare.hpp"

namespace planescope::desktop {
namespace {

using Voxels = std::vector<std::uint32_t>;

/// Where a report has no samples: a disk about the plane's centre, as large as the plane.
Voxels voxels_about(const planes::PlaneSummary& plane, const debug::Subject& subject) {
  constexpr double kThickness = 0.02;  // [m]
  const double radius2 = std::max(plane.area_m2, 1e-4) / 3.14159;
  Voxels voxels;
  for (std::uint32_t i = 0; i < subject.voxel_count(); ++i) {
    const Vec3d p = subject.prepared.voxels.points[i].cast<double>() +
                    subject.prepared.cloud.origin - plane.centroid;
    if (std::abs(p.dot(plane.normal)) < kThickness && p.squaredNorm() < radius2)
      voxels.push_back(i);
  }
  return voxels;
}

/// Planes of a report, and where they are in run B.
struct Region {
  const report::ReportFrame& frame;
  std::vector<int> planes;
  Voxels voxels = {};
};

/// The voxels of the planes' samples, ascending. `whole`: of all pixels that a sample stands for.
Voxels voxels_of(const Region& region, const debug::Subject& subject, bool whole = false) {
  const auto& [frame, planes, in_b] = region;
  const report::RegionSample& sample = frame.regions;
  if (sample.runs.empty())
    return voxels_about(frame.planes[static_cast<std::size_t>(planes[0]) - 1].summary, subject);
  const Image16& depth = subject.frame.depth;
  const int width = depth.empty() ? static_cast<int>(subject.point_of_source.size()) : depth.width;
  const int height = depth.empty() ? 1 : depth.height;
  const int reach = whole && !depth.empty() ? sample.step : 1;
  const std::vector<int> plane_of = sample.plane_of();
  Voxels voxels;
  for (std::size_t i = 0; i < plane_of.size(); ++i) {
    if (std::ranges::find(planes, plane_of[i]) == planes.end()) continue;
    const int u = static_cast<int>(i % static_cast<std::size_t>(sample.columns)) * sample.step;
    const int v = static_cast<int>(i / static_cast<std::size_t>(sample.columns)) * sample.step;
    for (int y = v; y < std::min(v + reach, height); ++y)
      for (int x = u; x < std::min(u + reach, width); ++x)
        if (const std::uint32_t voxel =
                subject.voxel_of_source(static_cast<std::size_t>(y) * width + x);
            voxel != planes::kNoVoxel)
          voxels.push_back(voxel);
  }
  std::ranges::sort(voxels);
  voxels.erase(std::unique(voxels.begin(), voxels.end()), voxels.end());
  return voxels;
}

std::string name_of(std::int32_t plane) { return fmt::format("P{}", plane); }

/// To where the plane of the result was founded.
void go_to_founding(const debug::Run& run, std::int32_t plane, RunArrival& arrival) {
  arrival.plane = run.segmentation.planes[static_cast<std::size_t>(plane) - 1].founded;
  arrival.step = run.timeline.changes_of_plane(arrival.plane).front().step;
}

class Guide {
 public:
  Guide(const ReportPlace& place, const debug::Run* a, const debug::Run& b)
      : place_(place), a_(a), b_(b) {}

  RunArrival to_plane_of_now() const {
    Region region{place_.now, {place_.plane}};
    region.voxels = voxels_of(region, *b_.subject);
    const std::int32_t plane = debug::plane_of_region(b_, region.voxels);
    RunArrival arrival;
    if (plane == 0) {
      arrive_at_loss(region, fmt::format("plane {}", place_.plane), arrival);
      arrival.message += ": this version does not find it";
      return arrival;
    }
    go_to_founding(b_, plane, arrival);
    arrival.message = fmt::format("plane {} is {}", place_.plane, name_of(plane));
    if (is(report::PlaneFate::merged)) {
      arrive_at_merge(arrival);
    } else if (b_.is_ours()) {
      arrival.message += fmt::format(", created at step {}", arrival.step);
    }
    return arrival;
  }

  RunArrival to_plane_of_baseline() const {
    const debug::Subject& subject = *b_.subject;
    Region region{*place_.baseline, {place_.plane}};
    region.voxels = voxels_of(region, subject);
    const std::int32_t plane = debug::plane_of_region(b_, region.voxels);
    const std::string name = fmt::format("the baseline's plane {}", place_.plane);
    RunArrival arrival;
    arrival.marked = voxels_of(region, subject, true);
    if (is(report::PlaneFate::merged) && plane > 0) {
      go_to_founding(b_, plane, arrival);
      arrival.message = fmt::format("{} is part of {}", name, name_of(plane));
      arrive_at_merge(arrival);
    } else if (is(report::PlaneFate::split) && plane > 0) {
      std::erase_if(region.voxels,
                    [&](std::uint32_t voxel) { return b_.segmentation.plane_of[voxel] == plane; });
      arrive_at_loss(region,
                     fmt::format("{} was split, {} is its largest part", name, name_of(plane)),
                     arrival);
    } else if (plane > 0) {
      go_to_founding(b_, plane, arrival);
      arrival.message =
          is(report::PlaneFate::lost) ? "the report lost it, this version does not: " : "";
      arrival.message += fmt::format("{} is {}", name, name_of(plane));
    } else {
      arrive_at_loss(region, name + " is lost", arrival);
    }
    return arrival;
  }

 private:
  bool is(report::PlaneFate fate) const { return place_.fate && place_.fate->fate == fate; }

  void arrive_at_loss(const Region& region, const std::string& what, RunArrival& arrival) const {
    arrival.message = what;
    const Voxels& voxels = region.voxels;
    if (!voxels.empty()) arrival.voxel = static_cast<std::int32_t>(voxels[voxels.size() / 2]);
    const debug::RegionDecision loss = debug::loss_of_region(b_, voxels);
    if (loss.step > 0)
      arrive_at(region, loss, "unassigned at", arrival);
    else
      arrive_at(region, debug::joining_of_region(b_, voxels), "merged at", arrival);
  }

  /// Where the planes that are one now became one.
  void arrive_at_merge(RunArrival& arrival) const {
    Region region{*place_.baseline, place_.fate->others};
    region.planes.push_back(place_.fate->baseline);
    region.voxels = voxels_of(region, *b_.subject);
    arrive_at(region, debug::joining_of_region(b_, region.voxels), "merged at", arrival);
  }

  /// Where B first decided otherwise than A, or A did what B never asked. Where neither is so for
  /// more than a tenth of the region: at `otherwise`.
  void arrive_at(const Region& region,
                 const debug::RegionDecision& otherwise,
                 const char* verb,
                 RunArrival& arrival) const {
    const auto counts = [](const debug::RegionDecision& decision, const Voxels& voxels) {
      return 10 * decision.points > voxels.size();
    };
    if (a_) {
      const debug::RegionDecision in_b = debug::first_difference(b_, *a_, region.voxels);
      if (counts(in_b, region.voxels))
        return stand_at(in_b, region.voxels, "A and B part at", arrival);
      const Voxels there = voxels_of(region, *a_->subject);
      const debug::RegionDecision in_a = debug::first_difference(*a_, b_, there);
      if (counts(in_a, there)) {
        arrival.in_a = true;
        return stand_at(in_a, there, "A alone has", arrival);
      }
    }
    if (otherwise.step > 0) stand_at(otherwise, region.voxels, verb, arrival);
  }

  static void stand_at(const debug::RegionDecision& decision,
                       const Voxels& voxels,
                       const char* verb,
                       RunArrival& arrival) {
    arrival.step = decision.step;
    arrival.voxel = decision.voxel;
    arrival.plane = -1;
    const std::string more =
        decision.alike > 1 ? fmt::format(" (one of {})", decision.alike) : std::string();
    arrival.message += fmt::format(": {} step {}{}, {} of {} sampled voxels", verb, decision.step,
                                   more, decision.points, voxels.size());
  }

  const ReportPlace& place_;
  const debug::Run* a_;
  const debug::Run& b_;
};

}  // namespace

RunArrival arrival_at(const ReportPlace& place, const debug::Run* a, const debug::Run& b) {
  const Guide guide(place, a, b);
  RunArrival arrival;
  if (place.plane > 0)
    arrival = place.of_baseline ? guide.to_plane_of_baseline() : guide.to_plane_of_now();
  const std::string between = arrival.message.empty() || place.note.empty() ? "" : "; ";
  arrival.message = place.note + between + arrival.message;
  return arrival;
}

}  // namespace planescope::desktop
