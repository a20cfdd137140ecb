#include "core/lab/experiments/steadiness.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/planes/evaluate/metrics.hpp"

namespace planescope::lab {

double Agreement::self_pq() const {
  return all.iou_sum / std::max(1.0, (all.planes + second_planes) / 2.0);
}

double Agreement::decided_pq() const { return decided.iou_sum / std::max(1, decided.planes); }

Agreement compare_planes_by_pixel(std::span<const std::int32_t> first,
                                  std::span<const std::int32_t> second,
                                  std::span<const std::uint8_t> undecided) {
  assert(first.size() == second.size());
  const planes::TruthOverlap overlap = planes::count_truth_overlap(first, second);
  Agreement result;
  result.partner.assign(static_cast<std::size_t>(overlap.truth), 0);
  for (int s = 1; s <= overlap.found; ++s) result.second_planes += overlap.found_size[s] > 0;
  for (int f = 1; f <= overlap.truth; ++f) {
    if (overlap.truth_size[f] == 0) continue;
    int best = 0;
    double iou = 0;
    for (int s = 1; s <= overlap.found; ++s)
      if (overlap.iou(f, s) > iou) {
        best = s;
        iou = overlap.iou(f, s);
      }
    const bool has_partner = iou > kSteadyPartnerIou;
    const auto count = [&](KeptPlanes& kept) {
      ++kept.planes;
      kept.partners += has_partner;
      if (has_partner) kept.iou_sum += iou;
      if (overlap.truth_size[f] < kBigPlanePixels) return;
      ++kept.big;
      kept.big_lost += !has_partner;
    };
    const auto at = static_cast<std::size_t>(f) - 1;
    count(result.all);
    if (at >= undecided.size() || !undecided[at]) count(result.decided);
    result.changed += iou < kSamePlaneIou;
    if (has_partner) result.partner[at] = best;
  }
  return result;
}

DepthMeters depth_meters(const Frame& frame, double max_range_m) {
  constexpr std::uint16_t kInvalid = 65535;
  DepthMeters depth{frame.intrinsics, {}};
  depth.intrinsics.width = frame.depth.width;
  depth.intrinsics.height = frame.depth.height;
  for (const std::uint16_t counts : frame.depth.data) {
    const double z = counts * frame.depth_unit_m;
    depth.depth_m.push_back(counts == kInvalid || z > max_range_m ? 0 : z);
  }
  return depth;
}

namespace {

bool depths_agree(double first_m, double second_m) {
  return first_m > 0 && second_m > 0 && std::abs(second_m - first_m) < kDepthAgreement * first_m;
}

}  // namespace

std::vector<std::int32_t> warp_planes(std::span<const std::int32_t> first_planes,
                                      const DepthMeters& first,
                                      const DepthMeters& second,
                                      const Pose& T_second_first) {
  constexpr double kNearest_m = 0.1;
  const Intrinsics &from = first.intrinsics, &to = second.intrinsics;
  std::vector<std::int32_t> warped(second.depth_m.size(), -1);
  for (std::size_t i = 0; i < first.depth_m.size(); ++i) {
    const double z = first.depth_m[i];
    if (!(z > 0)) continue;
    const auto u = static_cast<double>(i % from.width), v = static_cast<double>(i / from.width);
    const Vec3d p =
        T_second_first * Vec3d((u - from.cx) / from.fx * z, (v - from.cy) / from.fy * z, z);
    if (!(p.z() > kNearest_m)) continue;
    const double x = std::nearbyint(p.x() / p.z() * to.fx + to.cx);
    const double y = std::nearbyint(p.y() / p.z() * to.fy + to.cy);
    if (!(x >= 0 && x < to.width && y >= 0 && y < to.height)) continue;
    const std::size_t at = static_cast<std::size_t>(y) * to.width + static_cast<std::size_t>(x);
    // Of several pixels that land on one, the last counts.
    if (depths_agree(p.z(), second.depth_m[at])) warped[at] = first_planes[i];
  }
  return warped;
}

std::vector<std::int32_t> planes_in_place(std::span<const std::int32_t> first_planes,
                                          const DepthMeters& first,
                                          const DepthMeters& second) {
  assert(first.depth_m.size() == second.depth_m.size());
  std::vector<std::int32_t> placed(first_planes.begin(), first_planes.end());
  for (std::size_t i = 0; i < placed.size(); ++i)
    if (!depths_agree(first.depth_m[i], second.depth_m[i])) placed[i] = -1;
  return placed;
}

}  // namespace planescope::lab
