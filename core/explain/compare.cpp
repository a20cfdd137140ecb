#include "core/explain/compare.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <tuple>

#include "core/explain/correspondence.hpp"

namespace planescope {
namespace {

/// Planes of the same points in two divisions of them: a first, b second; 0 none, a < 0 not
/// compared.
struct TwoPlanes {
  std::int32_t a = 0, b = 0;
};

std::vector<PlanePair> match_planes(const std::vector<TwoPlanes>& points,
                                    int count_a,
                                    int count_b) {
  std::vector<std::uint32_t> shared(static_cast<std::size_t>(count_a + 1) * (count_b + 1), 0);
  std::vector<std::uint32_t> size_a(count_a + 1, 0), size_b(count_b + 1, 0);
  for (const TwoPlanes& point : points) {
    if (point.a < 0) continue;
    ++shared[static_cast<std::size_t>(point.a) * (count_b + 1) + point.b];
    ++size_a[point.a];
    ++size_b[point.b];
  }
  std::vector<PlanePair> touching;
  for (int a = 1; a <= count_a; ++a)
    for (int b = 1; b <= count_b; ++b)
      if (const std::uint32_t both = shared[static_cast<std::size_t>(a) * (count_b + 1) + b])
        touching.push_back({a, b, static_cast<double>(both) / (size_a[a] + size_b[b] - both)});
  std::stable_sort(touching.begin(), touching.end(),
                   [](const PlanePair& x, const PlanePair& y) { return x.iou > y.iou; });

  std::vector<std::uint8_t> matched_a(count_a + 1, 0), matched_b(count_b + 1, 0);
  std::vector<PlanePair> pairs;
  for (const PlanePair& pair : touching) {
    if (matched_a[pair.a] || matched_b[pair.b]) continue;
    matched_a[pair.a] = matched_b[pair.b] = 1;
    pairs.push_back(pair);
  }
  for (int a = 1; a <= count_a; ++a)
    if (!matched_a[a] && size_a[a] > 0) pairs.push_back({a, 0, 0});
  for (int b = 1; b <= count_b; ++b)
    if (!matched_b[b] && size_b[b] > 0) pairs.push_back({0, b, 0});
  return pairs;
}

/// The plane of b that answers to each plane of a.
std::vector<std::int32_t> counterparts(const std::vector<PlanePair>& pairs, int count_a) {
  std::vector<std::int32_t> counterpart(count_a + 1, -1);
  counterpart[0] = 0;
  for (const PlanePair& pair : pairs)
    if (pair.a > 0 && pair.b > 0) counterpart[pair.a] = pair.b;
  return counterpart;
}

std::int32_t plane_of_source(const Run& run, std::size_t source) {
  const std::uint32_t voxel = run.subject->voxel_of_source(source);
  return voxel == kNoVoxel ? -1 : run.segmentation.plane_of[voxel];
}

/// Events and nodes are ours alone.
bool leave_traces(const Run& a, const Run& b, Comparison& result) {
  if (a.is_ours() && b.is_ours()) return true;
  result.divergence =
      fmt::format("A is {}, B is {}: their planes are compared, there are no steps to compare",
                  to_string(a.options.method), to_string(b.options.method));
  return false;
}

void find_divergence(const Run& a, const Run& b, const Correspondence& same, Comparison& result) {
  std::int32_t step = 1;
  while (step <= a.steps() && step <= b.steps() &&
         same.same_event(*a.event_at(step), *b.event_at(step)))
    ++step;
  if (step > a.steps() && step > b.steps()) {
    result.divergence = "the same to the last event";
    return;
  }
  const auto says = [step](const Run& run) {
    return step <= run.steps() ? describe_event(run, step) : std::string("the end");
  };
  if (step <= a.steps()) result.diverging_step_a = step;
  if (step <= b.steps()) result.diverging_step_b = step;
  result.divergence = fmt::format("step {}: A has {}; B has {}", step, says(a), says(b));
}

void compare_nodes(const Run& a, const Run& b, Comparison& result) {
  const Correspondence to_b(a, b), to_a(b, a);
  const auto& nodes_a = a.octree().nodes;
  const auto& nodes_b = b.octree().nodes;
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(nodes_a.size()); ++n) {
    const std::int32_t other = to_b.node(n);
    const Case there = other >= 0 ? nodes_b[other].decided : Case::none;
    if (nodes_a[n].decided != there) result.nodes.push_back({n, other, nodes_a[n].decided, there});
  }
  for (std::int32_t n = 0; n < static_cast<std::int32_t>(nodes_b.size()); ++n)
    if (to_a.node(n) < 0) result.nodes.push_back({-1, n, Case::none, nodes_b[n].decided});

  const auto key = [&](const NodeChange& change) {
    const OctreeNode& node = change.a >= 0 ? nodes_a[change.a] : nodes_b[change.b];
    return std::tuple(node.depth, -static_cast<std::int64_t>(node.size()), node.code);
  };
  std::stable_sort(result.nodes.begin(), result.nodes.end(),
                   [&](const NodeChange& x, const NodeChange& y) { return key(x) < key(y); });
}

}  // namespace

Comparison compare_runs(const Run& a, const Run& b) {
  Comparison result;
  const Correspondence same(a, b);
  if (leave_traces(a, b, result)) {
    find_divergence(a, b, same, result);
    compare_nodes(a, b, result);
  }

  const std::size_t sources =
      std::min(a.subject->point_of_source.size(), b.subject->point_of_source.size());
  std::vector<TwoPlanes> by_source(sources);
  for (std::size_t i = 0; i < sources; ++i) {
    by_source[i] = {plane_of_source(a, i), plane_of_source(b, i)};
    if (by_source[i].b < 0) by_source[i].a = -1;  // cropped in one of them
  }
  std::vector<TwoPlanes> by_voxel;
  if (same.same_voxels())
    for (std::size_t i = 0; i < a.segmentation.plane_of.size(); ++i)
      by_voxel.push_back({a.segmentation.plane_of[i], b.segmentation.plane_of[i]});
  const int count_a = static_cast<int>(a.segmentation.planes.size());
  const int count_b = static_cast<int>(b.segmentation.planes.size());
  result.planes = match_planes(same.same_voxels() ? by_voxel : by_source, count_a, count_b);

  const std::vector<std::int32_t> counterpart = counterparts(result.planes, count_a);
  for (std::size_t i = 0; i < sources; ++i) {
    if (by_source[i].a < 0) continue;
    ++result.compared_sources;
    if (by_source[i].b != counterpart[by_source[i].a])
      result.changed_sources.push_back(static_cast<std::uint32_t>(i));
  }
  return result;
}

Comparison compare_with_truth(const Run& run) {
  Comparison result;
  const VoxelTruth& truth = run.subject->voxel_truth;
  if (!truth.known()) return result;
  std::vector<TwoPlanes> by_voxel;
  for (std::size_t i = 0; i < truth.plane.size(); ++i)
    by_voxel.push_back({truth.plane[i], run.segmentation.plane_of[i]});
  result.planes =
      match_planes(by_voxel, truth.plane_count, static_cast<int>(run.segmentation.planes.size()));

  const std::vector<std::int32_t> counterpart = counterparts(result.planes, truth.plane_count);
  for (std::size_t i = 0; i < run.subject->point_of_source.size(); ++i) {
    const std::uint32_t voxel = run.subject->voxel_of_source(i);
    if (voxel == kNoVoxel || truth.plane[voxel] < 0) continue;
    ++result.compared_sources;
    if (run.segmentation.plane_of[voxel] != counterpart[truth.plane[voxel]])
      result.changed_sources.push_back(static_cast<std::uint32_t>(i));
  }
  return result;
}

}  // namespace planescope
