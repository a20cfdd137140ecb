#include "core/explain/score.hpp"

#include <algorithm>
#include <cassert>

namespace planescope {
namespace {

/// How many voxels each pair of a true and a found plane share; row and column 0 are no plane.
class Overlap {
 public:
  Overlap(std::span<const std::int32_t> plane_of, const VoxelTruth& truth)
      : truths_(truth.plane_count + 1), founds_(1 + max_of(plane_of)) {
    assert(plane_of.size() == truth.plane.size());
    shared_.assign(static_cast<std::size_t>(truths_) * founds_, 0);
    truth_size_.assign(truths_, 0);
    found_size_.assign(founds_, 0);
    for (std::size_t i = 0; i < plane_of.size(); ++i) {
      const std::int32_t t = truth.plane[i];
      if (t < 0) continue;  // not scored
      ++shared_[static_cast<std::size_t>(t) * founds_ + plane_of[i]];
      ++truth_size_[t];
      ++found_size_[plane_of[i]];
    }
  }

  int truths() const { return truths_; }
  int founds() const { return founds_; }
  std::uint32_t shared(int t, int f) const {
    return shared_[static_cast<std::size_t>(t) * founds_ + f];
  }
  std::uint32_t truth_size(int t) const { return truth_size_[t]; }
  std::uint32_t found_size(int f) const { return found_size_[f]; }

 private:
  static int max_of(std::span<const std::int32_t> plane_of) {
    return plane_of.empty() ? 0 : std::max(0, *std::max_element(plane_of.begin(), plane_of.end()));
  }

  int truths_ = 1, founds_ = 1;
  std::vector<std::uint32_t> shared_, truth_size_, found_size_;
};

TruthMatch match_of(const Overlap& overlap, int t) {
  TruthMatch match{t, 0, 0, overlap.truth_size(t)};
  std::uint32_t most = 0;
  for (int f = 1; f < overlap.founds(); ++f)
    if (overlap.shared(t, f) > most) {
      most = overlap.shared(t, f);
      match.found = f;
    }
  if (most > 0)
    match.iou = static_cast<double>(most) / (match.points + overlap.found_size(match.found) - most);
  return match;
}

TruthVerdict verdict_of(const TruthMatch& match, const Overlap& overlap) {
  constexpr double kPart = 0.1;  // of a true plane, for a found one to be a part of it
  if (match.iou >= kDetectedIou) return TruthVerdict::detected;
  if (match.found == 0) return TruthVerdict::missed;
  for (int t = 1; t < overlap.truths(); ++t)
    if (t != match.truth && overlap.truth_size(t) > 0 &&
        2 * overlap.shared(t, match.found) >= overlap.truth_size(t))
      return TruthVerdict::merged;
  int parts = 0;
  for (int f = 1; f < overlap.founds(); ++f)
    parts += overlap.shared(match.truth, f) >= kPart * match.points;
  const std::uint32_t in_planes = match.points - overlap.shared(match.truth, 0);
  return parts >= 2 && 2 * in_planes >= match.points ? TruthVerdict::split : TruthVerdict::missed;
}

}  // namespace

QuickScore quick_score(std::span<const std::int32_t> plane_of, const VoxelTruth& truth) {
  QuickScore score;
  for (const std::int32_t plane : plane_of)
    score.found_planes = std::max(score.found_planes, plane);
  if (!truth.known()) return score;
  const Overlap overlap(plane_of, truth);
  double in_truth = 0, in_none = 0;
  for (int t = 1; t < overlap.truths(); ++t) {
    if (overlap.truth_size(t) == 0) continue;
    const TruthMatch match = match_of(overlap, t);
    score.planes.push_back(match);
    score.detected += match.iou >= kDetectedIou;
    score.mean_iou += match.iou;
    in_truth += match.points;
    in_none += overlap.shared(t, 0);
  }
  if (!score.planes.empty()) score.mean_iou /= static_cast<double>(score.planes.size());
  if (in_truth > 0) score.in_no_plane = in_none / in_truth;
  return score;
}

std::vector<TruthVerdict> verdicts_of(const QuickScore& score,
                                      std::span<const std::int32_t> plane_of,
                                      const VoxelTruth& truth) {
  const Overlap overlap(plane_of, truth);
  std::vector<TruthVerdict> verdicts;
  for (const TruthMatch& match : score.planes) verdicts.push_back(verdict_of(match, overlap));
  return verdicts;
}

const char* to_string(TruthVerdict verdict) {
  switch (verdict) {
    case TruthVerdict::detected:
      return "detected";
    case TruthVerdict::missed:
      return "missed";
    case TruthVerdict::merged:
      return "merged";
    case TruthVerdict::split:
      return "split";
  }
  return "?";
}

}  // namespace planescope
