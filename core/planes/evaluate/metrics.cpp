#include "core/planes/evaluate/metrics.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "core/model/plane.hpp"
#include "core/planes/evaluate/label_accuracy.hpp"
#include "core/planes/evaluate/plane_match.hpp"

namespace planescope::planes {
namespace {

constexpr double kOverlap = 0.8;  // SegComp (Hoover et al. 1996): a match is 80 % of the points

std::vector<Vec3d> truth_normals(const MetricsInput& input, int planes) {
  std::vector<Vec3d> normals(planes + 1, Vec3d::Zero());
  std::vector<Moments> moments(planes + 1);
  for (std::size_t i = 0; i < input.truth.size(); ++i)
    if (input.truth[i] > 0) moments[input.truth[i]].add(input.points[i].cast<double>());
  for (int t = 1; t <= planes; ++t) {
    const auto given = static_cast<std::size_t>(t - 1);
    if (given < input.truth_normals.size() && input.truth_normals[given].norm() > 0)
      normals[t] = input.truth_normals[given].normalized();
    else
      normals[t] = fit_plane(moments[t]).normal;
  }
  return normals;
}

/// Sec. V: mean angle between each found plane's normal and that of the true plane which most of
/// its points belong to.
double mean_normal_error(const MetricsInput& input, const TruthOverlap& o) {
  const std::vector<Vec3d> normals = truth_normals(input, o.truth);
  double sum = 0;
  int count = 0;
  for (int f = 1; f <= o.found; ++f) {
    int majority = 0;
    for (int t = 1; t <= o.truth; ++t)
      if (o.at(t, f) > 0 && (majority == 0 || o.at(t, f) > o.at(majority, f))) majority = t;
    if (majority == 0) continue;
    sum += plane_angle_deg(input.found_normals[f - 1], normals[majority]);
    ++count;
  }
  return count > 0 ? sum / count : 0;
}

/// Of the found planes that match no true one: pieces of true planes, and ghosts.
void sort_unmatched(const TruthOverlap& o, const std::vector<bool>& is_matched, Metrics& m) {
  for (int f = 1; f <= o.found; ++f) {
    if (o.found_size[f] == 0 || is_matched[f]) continue;
    bool is_piece = false;
    for (int t = 1; t <= o.truth; ++t) is_piece = is_piece || 2 * o.at(t, f) >= o.found_size[f];
    ++(is_piece ? m.pieces : m.ghosts);
  }
}

void score_matches(const TruthOverlap& o, Metrics& m) {
  const std::vector<int> match = found_of_truth(o);
  std::uint64_t correct = 0, in_planes = 0;
  double sum = 0, recognised_sum = 0;
  std::vector<bool> is_matched(o.found + 1, false);
  for (int t = 1; t <= o.truth; ++t) {
    in_planes += o.truth_size[t];
    if (match[t - 1] == 0) continue;
    correct += o.at(t, match[t - 1]);
    const double value = o.iou(t, match[t - 1]);
    sum += value;
    if (value >= kOverlap) ++m.detected_iou80;
    if (value > 0.5) {
      recognised_sum += value;
      is_matched[match[t - 1]] = true;
    }
  }
  sort_unmatched(o, is_matched, m);
  // Kirillov et al. 2019: TP + FP / 2 + FN / 2 = (true + found) / 2.
  const int planes = m.planes_truth + m.planes_found;
  if (planes > 0) m.pq = 100 * recognised_sum / (0.5 * planes);
  if (in_planes > 0)
    m.point_accuracy = 100 * static_cast<double>(correct) / static_cast<double>(in_planes);
  if (m.planes_truth > 0) m.mean_iou = 100 * sum / m.planes_truth;
}

/// SegComp: correct, over- and under-segmented, missed and noise regions at 80 % overlap.
void classify_regions(const TruthOverlap& o, Metrics& m) {
  const auto mostly = [](std::uint64_t part, std::uint64_t whole) {
    return whole > 0 && static_cast<double>(part) >= kOverlap * static_cast<double>(whole);
  };
  std::vector<bool> truth_done(o.truth + 1, false), found_done(o.found + 1, false);
  for (int t = 1; t <= o.truth; ++t)
    for (int f = 1; f <= o.found; ++f)
      if (mostly(o.at(t, f), o.truth_size[t]) && mostly(o.at(t, f), o.found_size[f])) {
        truth_done[t] = found_done[f] = true;
        ++m.correct;  // more than half of both: no plane has two such partners
      }
  for (int t = 1; t <= o.truth; ++t) {
    if (truth_done[t]) continue;
    std::vector<int> parts;
    std::uint64_t covered = 0;
    for (int f = 1; f <= o.found; ++f)
      if (!found_done[f] && mostly(o.at(t, f), o.found_size[f])) {
        parts.push_back(f);
        covered += o.at(t, f);
      }
    if (parts.size() < 2 || !mostly(covered, o.truth_size[t])) continue;
    ++m.over_segmented;
    truth_done[t] = true;
    for (const int f : parts) found_done[f] = true;
  }
  for (int f = 1; f <= o.found; ++f) {
    if (found_done[f]) continue;
    std::vector<int> parts;
    std::uint64_t covered = 0;
    for (int t = 1; t <= o.truth; ++t)
      if (!truth_done[t] && mostly(o.at(t, f), o.truth_size[t])) {
        parts.push_back(t);
        covered += o.at(t, f);
      }
    if (parts.size() < 2 || !mostly(covered, o.found_size[f])) continue;
    ++m.under_segmented;
    found_done[f] = true;
    for (const int t : parts) truth_done[t] = true;
  }
  for (int t = 1; t <= o.truth; ++t) m.missed += o.truth_size[t] > 0 && !truth_done[t];
  for (int f = 1; f <= o.found; ++f) m.noise += o.found_size[f] > 0 && !found_done[f];
}

void score_labels(const MetricsInput& input, Metrics& m) {
  if (input.truth_labels.empty() || input.found_labels.empty()) return;
  const bool any =
      std::ranges::any_of(input.truth_labels, [](Label label) { return label != Label::unknown; });
  LabelAccuracy accuracy;  // which points lie near another label takes longer than all else
  if (any)
    accuracy = label_accuracy(
        input.truth_labels, input.found_labels,
        near_other_label(input.points, input.truth_labels, input.points, input.truth_labels));
  if (accuracy.edge + accuracy.inner == 0) {
    m.label_accuracy_inner = m.label_accuracy_edge = std::nan("");
    return;
  }
  m.label_accuracy_inner = accuracy.inner_percent();
  m.label_accuracy_edge = accuracy.edge_percent();
}

/// Truth without the planes that are too small to be scored.
std::vector<std::int32_t> scored_truth(const MetricsInput& input) {
  std::vector<std::int32_t> truth(input.truth.begin(), input.truth.end());
  std::vector<int> size(1, 0);
  for (const std::int32_t t : truth) {
    if (t >= static_cast<std::int32_t>(size.size())) size.resize(static_cast<std::size_t>(t) + 1);
    if (t > 0) ++size[t];
  }
  for (std::int32_t& t : truth)
    if (t > 0 && size[t] < input.min_truth_points) t = -1;
  return truth;
}

/// Found planes without those that lie mostly on what is not scored: they are neither right nor
/// wrong (as with the void of panoptic quality).
std::vector<std::int32_t> scored_planes(const MetricsInput& input) {
  std::vector<std::int32_t> found(input.found.begin(), input.found.end());
  std::vector<std::array<int, 2>> size(1);  // on what is scored, and elsewhere
  for (std::size_t i = 0; i < found.size(); ++i) {
    if (found[i] >= static_cast<std::int32_t>(size.size()))
      size.resize(static_cast<std::size_t>(found[i]) + 1);
    if (found[i] > 0) ++size[found[i]][input.truth[i] < 0];
  }
  for (std::int32_t& f : found)
    if (f > 0 && size[f][1] > size[f][0]) f = 0;
  return found;
}

}  // namespace

Metrics evaluate(const MetricsInput& given) {
  assert(given.points.size() == given.truth.size() && given.points.size() == given.found.size());
  Metrics m;
  const std::vector<std::int32_t> truth = scored_truth(given);
  MetricsInput input = given;
  input.truth = truth;
  const std::vector<std::int32_t> found = scored_planes(input);
  input.found = found;
  const TruthOverlap o = count_truth_overlap(input.truth, input.found);
  std::uint64_t missing = 0, in_planes = 0;
  for (int t = 1; t <= o.truth; ++t) {
    m.planes_truth += o.truth_size[t] > 0;
    in_planes += o.truth_size[t];
    missing += o.at(t, 0);
  }
  for (int f = 1; f <= o.found; ++f) m.planes_found += o.found_size[f] > 0;
  for (int t = 0; t <= o.truth; ++t) m.points += o.truth_size[t];
  m.alpha_deg = mean_normal_error(input, o);
  if (m.planes_truth > 0) m.r_p = 100.0 * m.planes_found / m.planes_truth;
  if (in_planes > 0) m.r_m = 100 * static_cast<double>(missing) / static_cast<double>(in_planes);
  score_matches(o, m);
  classify_regions(o, m);
  score_labels(input, m);
  return m;
}

double plane_precision(const Metrics& m) {
  return m.planes_found > 0 ? 100.0 * m.correct / m.planes_found : 0;
}

double plane_recall(const Metrics& m) {
  return m.planes_truth > 0 ? 100.0 * m.correct / m.planes_truth : 0;
}

Metrics mean_of(std::span<const Metrics> metrics) {
  Metrics mean;
  if (metrics.empty()) return mean;
  double labelled = 0;  // frames
  for (const Metrics& m : metrics) {
    mean.planes_truth += m.planes_truth;
    mean.planes_found += m.planes_found;
    mean.alpha_deg += m.alpha_deg;
    mean.r_m += m.r_m;
    mean.point_accuracy += m.point_accuracy;
    mean.mean_iou += m.mean_iou;
    mean.pq += m.pq;
    mean.detected_iou80 += m.detected_iou80;
    mean.correct += m.correct;
    mean.over_segmented += m.over_segmented;
    mean.under_segmented += m.under_segmented;
    mean.missed += m.missed;
    mean.noise += m.noise;
    mean.pieces += m.pieces;
    mean.ghosts += m.ghosts;
    if (!std::isnan(m.label_accuracy_edge)) {
      mean.label_accuracy_edge += m.label_accuracy_edge;
      mean.label_accuracy_inner += m.label_accuracy_inner;
      ++labelled;
    }
    mean.points += m.points;
  }
  const auto n = static_cast<double>(metrics.size());
  for (double* v : {&mean.alpha_deg, &mean.r_m, &mean.point_accuracy, &mean.mean_iou, &mean.pq})
    *v /= n;
  for (double* v : {&mean.label_accuracy_edge, &mean.label_accuracy_inner})
    *v = labelled > 0 ? *v / labelled : std::nan("");
  if (mean.planes_truth > 0) mean.r_p = 100.0 * mean.planes_found / mean.planes_truth;
  return mean;
}

}  // namespace planescope::planes
