#include "core/debug/explain/score.hpp"

#include <algorithm>
#include <map>

#include "core/planes/evaluate/plane_match.hpp"

namespace planescope::debug {
namespace {

TruthMatch match_of(const planes::TruthOverlap& overlap, int t) {
  TruthMatch match{t, 0, 0, static_cast<std::uint32_t>(overlap.truth_size[t])};
  std::uint64_t most = 0;
  for (int f = 1; f <= overlap.found; ++f)
    if (overlap.at(t, f) > most) {
      most = overlap.at(t, f);
      match.found = f;
    }
  if (most > 0) match.iou = overlap.iou(t, match.found);
  return match;
}

TruthVerdict verdict_of(const TruthMatch& match, const planes::TruthOverlap& overlap) {
  constexpr double kPart = 0.1;  // of a true plane, for a found one to be a part of it
  if (match.iou >= kDetectedIou) return TruthVerdict::detected;
  if (match.found == 0) return TruthVerdict::missed;
  for (int t = 1; t <= overlap.truth; ++t)
    if (t != match.truth && overlap.truth_size[t] > 0 &&
        2 * overlap.at(t, match.found) >= overlap.truth_size[t])
      return TruthVerdict::merged;
  int parts = 0;
  for (int f = 1; f <= overlap.found; ++f)
    parts += static_cast<double>(overlap.at(match.truth, f)) >= kPart * match.points;
  const std::uint64_t in_planes = match.points - overlap.at(match.truth, 0);
  return parts >= 2 && 2 * in_planes >= match.points ? TruthVerdict::split : TruthVerdict::missed;
}

}  // namespace

QuickScore quick_score(std::span<const std::int32_t> plane_of, const VoxelTruth& truth) {
  QuickScore score;
  const planes::TruthOverlap overlap = planes::count_truth_overlap(truth.plane, plane_of);
  score.found_planes = overlap.found;
  double in_truth = 0, in_none = 0;
  for (int t = 1; t <= overlap.truth; ++t) {
    if (overlap.truth_size[t] == 0) continue;
    const TruthMatch match = match_of(overlap, t);
    score.planes.push_back(match);
    score.detected += match.iou >= kDetectedIou;
    score.mean_iou += match.iou;
    in_truth += match.points;
    in_none += static_cast<double>(overlap.at(t, 0));
  }
  if (!score.planes.empty()) score.mean_iou /= static_cast<double>(score.planes.size());
  if (in_truth > 0) score.in_no_plane = in_none / in_truth;
  return score;
}

std::vector<TruthVerdict> verdicts_of(const QuickScore& score,
                                      std::span<const std::int32_t> plane_of,
                                      const VoxelTruth& truth) {
  const planes::TruthOverlap overlap = planes::count_truth_overlap(truth.plane, plane_of);
  std::vector<TruthVerdict> verdicts;
  for (const TruthMatch& match : score.planes) verdicts.push_back(verdict_of(match, overlap));
  return verdicts;
}

const char* to_string(TruthVerdict verdict) {
  static constexpr const char* kNames[] = {"detected", "missed", "merged", "split"};
  return kNames[static_cast<std::size_t>(verdict)];
}

std::int32_t most_common_plane(std::span<const std::int32_t> planes) {
  std::map<std::int32_t, std::size_t> counts{{0, 0}};
  for (const std::int32_t plane : planes)
    if (plane > 0) ++counts[plane];
  return std::ranges::max_element(counts, {}, &std::pair<const std::int32_t, std::size_t>::second)
      ->first;
}

}  // namespace planescope::debug
