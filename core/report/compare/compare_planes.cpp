#include "core/report/compare/compare_planes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/planes/evaluate/plane_match.hpp"

namespace planescope::report {
namespace {

constexpr double kLeastIou = 0.3;      // of two planes that are one
constexpr double kMostOfPart = 0.5;    // a part lies for the most part in the whole
constexpr double kLeastOfWhole = 0.1;  // and is not a mere scrap of it
constexpr double kSameCentroidM = 0.1, kSameAngleDeg = 20;  // without samples

double angle_deg(const PlaneSummary& a, const PlaneSummary& b) {
  return std::acos(std::min(1.0, std::abs(a.normal.dot(b.normal)))) * 180 / std::numbers::pi;
}

class Comparer {
 public:
  Comparer(const ComparedPlanes& baseline, const ComparedPlanes& now, const FateLimits& limits)
      : baseline_(baseline.planes), now_(now.planes), limits_(limits) {
    std::vector<int> before, after;
    const RegionSample &b = baseline.sample, &n = now.sample;
    if (b.step == n.step && b.columns == n.columns && b.rows == n.rows) {
      before = b.plane_of();
      after = n.plane_of();
    }
    overlap_ = planes::count_truth_overlap(before, after, planes_before(), planes_now());
    taken_.assign(now_.size() + 1, 0);
  }

  std::vector<PlaneComparison> run() {
    result_.resize(baseline_.size());
    for (std::size_t k = 0; k < baseline_.size(); ++k) {
      result_[k].fate = PlaneFate::lost;
      result_[k].baseline = static_cast<int>(k) + 1;
    }
    find_splits();
    find_merges();
    match();
    match_small();
    for (int f = 1; f <= planes_now(); ++f)
      if (!taken_[f]) {
        result_.emplace_back();
        result_.back().fate = PlaneFate::gained;
        result_.back().now = f;
      }
    return std::move(result_);
  }

 private:
  int planes_before() const { return static_cast<int>(baseline_.size()); }
  int planes_now() const { return static_cast<int>(now_.size()); }
  PlaneComparison& of(int baseline) { return result_[static_cast<std::size_t>(baseline) - 1]; }
  bool is_open(int baseline) { return of(baseline).fate == PlaneFate::lost; }
  double shared(int t, int f) const { return static_cast<double>(overlap_.at(t, f)); }

  bool is_part(double common, std::uint64_t part, std::uint64_t whole) const {
    return common > 0 && common >= kMostOfPart * static_cast<double>(part) &&
           common >= kLeastOfWhole * static_cast<double>(whole);
  }

  void find_splits() {
    for (int t = 1; t <= planes_before(); ++t) {
      std::vector<int> parts;
      for (int f = 1; f <= planes_now(); ++f)
        if (is_part(shared(t, f), overlap_.found_size[f], overlap_.truth_size[t]))
          parts.push_back(f);
      if (parts.size() < 2) continue;
      std::stable_sort(parts.begin(), parts.end(),
                       [&](int a, int b) { return shared(t, a) > shared(t, b); });
      pair(t, parts[0], PlaneFate::split);
      of(t).others.assign(parts.begin() + 1, parts.end());
      for (const int f : parts) taken_[f] = 1;
    }
  }

  void find_merges() {
    for (int f = 1; f <= planes_now(); ++f) {
      std::vector<int> parts;
      for (int t = 1; t <= planes_before(); ++t)
        if (is_open(t) && is_part(shared(t, f), overlap_.truth_size[t], overlap_.found_size[f]))
          parts.push_back(t);
      if (taken_[f] || parts.size() < 2) continue;
      for (const int t : parts) {
        pair(t, f, PlaneFate::merged);
        for (const int other : parts)
          if (other != t) of(t).others.push_back(other);
      }
    }
  }

  void match() {
    const std::vector<int> partner = planes::found_of_truth(overlap_);
    for (int t = 1; t <= planes_before(); ++t) {
      const int f = partner[static_cast<std::size_t>(t) - 1];
      if (f > 0 && is_open(t) && !taken_[f] && overlap_.iou(t, f) >= kLeastIou) pair_judged(t, f);
    }
  }

  void match_small() {
    for (int t = 1; t <= planes_before(); ++t) {
      if (!is_open(t) || overlap_.truth_size[t] > 0) continue;
      const PlaneSummary& plane = baseline_[static_cast<std::size_t>(t) - 1];
      int nearest = 0;
      double least = kSameCentroidM;
      for (int f = 1; f <= planes_now(); ++f) {
        const PlaneSummary& other = now_[static_cast<std::size_t>(f) - 1];
        const double distance = (other.centroid - plane.centroid).norm();
        if (taken_[f] || other.label != plane.label || distance > least ||
            angle_deg(plane, other) > kSameAngleDeg)
          continue;
        nearest = f;
        least = distance;
      }
      if (nearest > 0) pair_judged(t, nearest);
    }
  }

  void pair_judged(int t, int f) {
    pair(t, f, PlaneFate::same);
    PlaneComparison& pair = of(t);
    if (pair.offset_m > limits_.offset_m || pair.angle_deg > limits_.angle_deg)
      pair.fate = PlaneFate::moved;
    else if (std::max(pair.area_ratio, 1 / pair.area_ratio) > limits_.area_ratio)
      pair.fate = PlaneFate::resized;
  }

  void pair(int t, int f, PlaneFate fate) {
    const PlaneSummary& before = baseline_[static_cast<std::size_t>(t) - 1];
    const PlaneSummary& after = now_[static_cast<std::size_t>(f) - 1];
    PlaneComparison& pair = of(t);
    pair.fate = fate;
    pair.now = f;
    pair.iou = overlap_.iou(t, f);
    pair.offset_m = std::max(std::abs(after.normal.dot(before.centroid) - after.offset_m),
                             std::abs(before.normal.dot(after.centroid) - before.offset_m));
    pair.angle_deg = angle_deg(before, after);
    pair.area_ratio = before.area_m2 > 0 ? after.area_m2 / before.area_m2 : 1;
    taken_[f] = 1;
  }

  const std::vector<PlaneSummary>& baseline_;
  const std::vector<PlaneSummary>& now_;
  const FateLimits& limits_;
  planes::TruthOverlap overlap_;
  std::vector<std::uint8_t> taken_;  // by id of now
  std::vector<PlaneComparison> result_;
};

}  // namespace

const char* to_string(PlaneFate fate) {
  switch (fate) {
    case PlaneFate::same:
      return "same";
    case PlaneFate::resized:
      return "resized";
    case PlaneFate::moved:
      return "moved";
    case PlaneFate::lost:
      return "lost";
    case PlaneFate::merged:
      return "merged";
    case PlaneFate::split:
      return "split";
    case PlaneFate::gained:
      return "gained";
  }
  return "?";
}

std::vector<PlaneComparison> compare_planes(const ComparedPlanes& baseline,
                                            const ComparedPlanes& now,
                                            const FateLimits& limits) {
  return Comparer(baseline, now, limits).run();
}

}  // namespace planescope::report
