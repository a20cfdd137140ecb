// Matches found planes to true planes, and computes the metrics.

#include "core/planes/evaluate/metrics.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <unordered_map>

#include "core/model/plane.hpp"

namespace planescope::planes {

// ---- Matching ----

std::vector<int> best_assignment(const std::vector<double>& value, int rows, int columns) {
  // Square cost matrix, padded with zeros; 1-based rows and columns, as is usual for this method.
  const int n = std::max(rows, columns);
  const auto cost = [&](int row, int column) {
    return row <= rows && column <= columns
               ? -value[static_cast<std::size_t>(row - 1) * columns + (column - 1)]
               : 0.0;
  };
  std::vector<double> row_potential(n + 1, 0), column_potential(n + 1, 0);
  std::vector<int> row_of(n + 1, 0), way(n + 1, 0);
  for (int row = 1; row <= n; ++row) {
    row_of[0] = row;
    int column = 0;
    std::vector<double> least(n + 1, std::numeric_limits<double>::infinity());
    std::vector<bool> used(n + 1, false);
    do {
      used[column] = true;
      const int from = row_of[column];
      double delta = std::numeric_limits<double>::infinity();
      int next = 0;
      for (int c = 1; c <= n; ++c) {
        if (used[c]) continue;
        const double reduced = cost(from, c) - row_potential[from] - column_potential[c];
        if (reduced < least[c]) {
          least[c] = reduced;
          way[c] = column;
        }
        if (least[c] < delta) {
          delta = least[c];
          next = c;
        }
      }
      for (int c = 0; c <= n; ++c) {
        if (used[c]) {
          row_potential[row_of[c]] += delta;
          column_potential[c] -= delta;
        } else {
          least[c] -= delta;
        }
      }
      column = next;
    } while (row_of[column] != 0);
    for (; column != 0; column = way[column]) row_of[column] = row_of[way[column]];
  }
  std::vector<int> result(rows, -1);
  for (int c = 1; c <= columns; ++c)
    if (row_of[c] <= rows && cost(row_of[c], c) < 0) result[row_of[c] - 1] = c - 1;
  return result;
}

double TruthOverlap::iou(int t, int f) const {
  const std::uint64_t both = at(t, f), all = truth_size[t] + found_size[f] - both;
  return all > 0 ? static_cast<double>(both) / static_cast<double>(all) : 0;
}

TruthOverlap count_truth_overlap(std::span<const std::int32_t> truth,
                                 std::span<const std::int32_t> found,
                                 int last_truth,
                                 int last_found) {
  TruthOverlap o;
  o.truth = last_truth;
  o.found = last_found;
  for (const std::int32_t t : truth) o.truth = std::max(o.truth, t);
  for (const std::int32_t f : found) o.found = std::max(o.found, f);
  o.shared.assign(static_cast<std::size_t>(o.truth + 1) * (o.found + 1), 0);
  o.truth_size.assign(o.truth + 1, 0);
  o.found_size.assign(o.found + 1, 0);
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i] < 0) continue;
    const int t = truth[i], f = std::max(0, found[i]);
    ++o.shared[static_cast<std::size_t>(t) * (o.found + 1) + f];
    ++o.truth_size[t];
    ++o.found_size[f];
  }
  return o;
}

std::vector<int> found_of_truth(const TruthOverlap& o) {
  std::vector<double> iou;
  for (int t = 1; t <= o.truth; ++t)
    for (int f = 1; f <= o.found; ++f) iou.push_back(o.iou(t, f));
  std::vector<int> match = best_assignment(iou, o.truth, o.found);
  for (int& column : match) ++column;
  return match;
}

std::vector<PlanePair> pairs_by_overlap(const TruthOverlap& overlap) {
  std::vector<PlanePair> touching, pairs;
  for (int a = 1; a <= overlap.truth; ++a)
    for (int b = 1; b <= overlap.found; ++b)
      if (overlap.at(a, b) > 0) touching.push_back({a, b, overlap.iou(a, b)});
  std::ranges::stable_sort(touching, std::ranges::greater{}, &PlanePair::iou);
  std::vector<std::uint8_t> has_a(overlap.truth + 1, 0), has_b(overlap.found + 1, 0);
  for (const PlanePair& pair : touching) {
    if (has_a[pair.a] || has_b[pair.b]) continue;
    has_a[pair.a] = has_b[pair.b] = 1;
    pairs.push_back(pair);
  }
  return pairs;
}

double plane_angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::min(1.0, std::abs(a.dot(b)))) * 180 / std::numbers::pi;
}

// ---- Labels ----

namespace {

double percent_of(std::uint64_t part, std::uint64_t whole) {
  return whole > 0 ? 100 * static_cast<double>(part) / static_cast<double>(whole) : 100.0;
}

}  // namespace

double LabelAccuracy::percent() const { return percent_of(edge_right + inner_right, edge + inner); }
double LabelAccuracy::edge_percent() const { return percent_of(edge_right, edge); }
double LabelAccuracy::inner_percent() const { return percent_of(inner_right, inner); }

LabelAccuracy& LabelAccuracy::operator+=(const LabelAccuracy& other) {
  edge_right += other.edge_right;
  edge += other.edge;
  inner_right += other.inner_right;
  inner += other.inner;
  return *this;
}

std::vector<std::uint8_t> near_other_label(std::span<const Vec3f> points,
                                           std::span<const Label> labels,
                                           std::span<const Vec3f> reference_points,
                                           std::span<const Label> reference_labels) {
  const auto key = [](std::int64_t x, std::int64_t y, std::int64_t z) {
    return (x & 0x1fffff) | (y & 0x1fffff) << 21 | (z & 0x1fffff) << 42;
  };
  const auto cell = [](float v) {
    return static_cast<std::int64_t>(std::floor(v / kEdgeDistanceM));
  };
  std::unordered_map<std::int64_t, std::vector<std::uint32_t>> grid;
  for (std::uint32_t i = 0; i < reference_points.size(); ++i) {
    const Vec3f& p = reference_points[i];
    if (reference_labels[i] != Label::unknown)
      grid[key(cell(p.x()), cell(p.y()), cell(p.z()))].push_back(i);
  }
  std::vector<std::uint8_t> near(points.size(), 0);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const auto x = cell(points[i].x()), y = cell(points[i].y()), z = cell(points[i].z());
    for (int d = 0; d < 27 && !near[i]; ++d) {
      const auto found = grid.find(key(x + d % 3 - 1, y + d / 3 % 3 - 1, z + d / 9 - 1));
      if (found == grid.end()) continue;
      for (const std::uint32_t j : found->second)
        if (reference_labels[j] != labels[i] &&
            (reference_points[j] - points[i]).squaredNorm() <
                static_cast<float>(kEdgeDistanceM * kEdgeDistanceM))
          near[i] = 1;
    }
  }
  return near;
}

LabelAccuracy label_accuracy(std::span<const Label> truth,
                             std::span<const Label> found,
                             std::span<const std::uint8_t> near_edge) {
  LabelAccuracy accuracy;
  for (std::size_t i = 0; i < truth.size(); ++i) {
    if (truth[i] == Label::unknown) continue;
    const bool right = truth[i] == found[i];
    ++(near_edge[i] ? accuracy.edge : accuracy.inner);
    (near_edge[i] ? accuracy.edge_right : accuracy.inner_right) += right;
  }
  return accuracy;
}

LabelAccuracy label_accuracy(const LabeledCloud& cloud, std::span<const Label> found) {
  if (!cloud.near_edge.empty()) return label_accuracy(cloud.labels, found, cloud.near_edge);
  return label_accuracy(cloud.labels, found,
                        near_other_label(cloud.points, cloud.labels, cloud.points, cloud.labels));
}

// ---- Metrics ----

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

/// Sec. V: mean angle between the normal of each found plane and the normal of the true plane that
/// contains most of its points.
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

/// Classifies the unmatched found planes as pieces of true planes or ghosts.
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
  LabelAccuracy accuracy;  // near_other_label() takes longer than the rest of the evaluation
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

/// Truth without planes too small to be scored.
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

/// Found planes without those mostly on unscored points, which are neither right nor wrong (like
/// void in panoptic quality).
std::vector<std::int32_t> scored_planes(const MetricsInput& input) {
  std::vector<std::int32_t> found(input.found.begin(), input.found.end());
  std::vector<std::array<int, 2>> size(1);  // points on scored truth, and elsewhere
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
  double labeled = 0;  // number of frames with labels
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
      ++labeled;
    }
    mean.points += m.points;
  }
  const auto n = static_cast<double>(metrics.size());
  for (double* v : {&mean.alpha_deg, &mean.r_m, &mean.point_accuracy, &mean.mean_iou, &mean.pq})
    *v /= n;
  for (double* v : {&mean.label_accuracy_edge, &mean.label_accuracy_inner})
    *v = labeled > 0 ? *v / labeled : std::nan("");
  if (mean.planes_truth > 0) mean.r_p = 100.0 * mean.planes_found / mean.planes_truth;
  return mean;
}

}  // namespace planescope::planes
