// State of nodes, points and planes at any step, computed from the changes in a trace.

#include "core/debug/replay/timeline.hpp"

#include <algorithm>
#include <cassert>
#include <numeric>

namespace planescope::debug {
namespace {

/// Row `index` of a compressed sparse table (CSR).
template <typename Change>
std::span<const Change> row(const std::vector<Change>& changes,
                            const std::vector<std::uint32_t>& first,
                            std::int32_t index) {
  assert(index >= 0 && static_cast<std::size_t>(index) + 1 < first.size());
  return {changes.data() + first[index], changes.data() + first[index + 1]};
}

/// The last change up to `step`; null before the first.
template <typename Change>
const Change* last_until(std::span<const Change> changes, std::int32_t step) {
  const auto after =
      std::upper_bound(changes.begin(), changes.end(), step,
                       [](std::int32_t k, const Change& change) { return k < change.step; });
  return after == changes.begin() ? nullptr : &*(after - 1);
}

/// Groups records by `row_of`, preserving their order within a row.
template <typename Record, typename RowOf, typename Change>
void to_rows(const std::vector<Record>& records,
             RowOf row_of,
             std::size_t rows,
             std::vector<std::uint32_t>& first,
             std::vector<Change>& changes) {
  first.assign(rows + 1, 0);
  for (const Record& record : records) ++first[row_of(record) + 1];
  std::partial_sum(first.begin(), first.end(), first.begin());
  changes.resize(records.size());
  std::vector<std::uint32_t> next(first.begin(), first.end() - 1);
  for (const Record& record : records) changes[next[row_of(record)]++] = record.change;
}

}  // namespace

Timeline::Timeline(const planes::Trace& trace, const planes::Segmentation& segmentation)
    : steps_(trace.steps()),
      queued_at_(trace.queued_at),
      visited_at_(trace.visited_at),
      decided_at_(trace.decided_at) {
  const planes::Octree& octree = segmentation.octree;
  for (auto* at : {&queued_at_, &visited_at_, &decided_at_})
    at->resize(octree.nodes.size(), planes::kNever);
  std::size_t planes = 0;
  for (const planes::Trace::Plane& plane : trace.planes)
    planes = std::max(planes, static_cast<std::size_t>(plane.plane) + 1);
  to_rows(
      trace.points, [&](const planes::Trace::Point& record) { return octree.order[record.point]; },
      octree.order.size(), points_first_, point_changes_);
  to_rows(
      trace.planes, [](const planes::Trace::Plane& record) { return record.plane; }, planes,
      planes_first_, plane_changes_);
  joins_.resize(planes);
  for (const planes::Trace::Plane& record : trace.planes)
    if (record.change.into >= 0 && joins_[record.plane].into < 0)
      joins_[record.plane] = {record.change.step, record.change.into};
  result_of_plane_.assign(planes, 0);
  for (const planes::PlaneRegion& region : segmentation.planes)
    if (region.founded < plane_count()) result_of_plane_[region.founded] = region.id;
  number_planes(segmentation);

  leaf_of_point_.assign(octree.order.size(), -1);
  for (std::size_t n = 0; n < octree.nodes.size(); ++n) {
    const planes::OctreeNode& node = octree.nodes[n];
    parents_.push_back(node.parent);
    if (node.first_child >= 0) continue;
    for (std::uint32_t i = node.begin; i < node.end; ++i)
      leaf_of_point_[octree.order[i]] = static_cast<std::int32_t>(n);
  }
}

Timeline::Timeline(const planes::Segmentation& segmentation, std::span<const Vec3f> points) {
  const std::size_t count = segmentation.planes.size();
  std::vector<Moments> moments(count);
  points_first_ = {0};
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int32_t id = segmentation.plane_of[i];
    if (id > 0) moments[static_cast<std::size_t>(id) - 1].add(points[i].cast<double>());
    point_changes_.push_back({.plane = id > 0 ? id - 1 : -1, .leftover = id <= 0});
    points_first_.push_back(static_cast<std::uint32_t>(i + 1));
  }
  for (std::size_t k = 0; k < count; ++k) {
    const planes::PlaneRegion& region = segmentation.planes[k];
    planes::PlaneChange& change = plane_changes_.emplace_back();
    change.label = region.label;
    change.moments = moments[k];
    change.fit = region.fit;
    planes_first_.push_back(static_cast<std::uint32_t>(k + 1));
    result_of_plane_.push_back(region.id);
  }
  joins_.resize(count);
  number_planes(segmentation);
  leaf_of_point_.assign(points.size(), -1);
}

void Timeline::number_planes(const planes::Segmentation& segmentation) {
  plane_of_number_.assign(segmentation.planes.size() + 1, -1);
  for (std::int32_t plane = 0; plane < plane_count(); ++plane) {
    std::int32_t number = result_of_plane_[plane];
    if (number == 0) {
      number = static_cast<std::int32_t>(plane_of_number_.size());
      plane_of_number_.push_back(plane);
    }
    plane_of_number_[number] = plane;
    number_of_plane_.push_back(number);
  }
}

std::int32_t Timeline::plane_of_number(std::int32_t number) const {
  return number > 0 && number <= greatest_number() ? plane_of_number_[number] : -1;
}

std::int32_t Timeline::greatest_number() const {
  return std::max(0, static_cast<std::int32_t>(plane_of_number_.size()) - 1);
}

NodeState Timeline::node_state(std::int32_t node, std::int32_t step) const {
  if (decided_at_[node] <= step) return NodeState::settled;
  if (visited_at_[node] <= step) return NodeState::visited;
  return queued_at_[node] <= step ? NodeState::queued : NodeState::unborn;
}

std::vector<planes::PointChange> Timeline::changes_of_point(std::int32_t point) const {
  const std::span<const planes::PointChange> written = row(point_changes_, points_first_, point);
  std::vector<planes::PointChange> changes;
  for (std::size_t k = 0; k < written.size(); ++k) {
    changes.push_back(written[k]);
    const std::int32_t until = k + 1 < written.size() ? written[k + 1].step : planes::kNever;
    for (std::int32_t plane = written[k].plane; plane >= 0 && joins_[plane].step < until;
         plane = joins_[plane].into)
      changes.push_back({joins_[plane].step, joins_[plane].into});
  }
  return changes;
}

planes::PointChange Timeline::point_at(std::int32_t point, std::int32_t step) const {
  const planes::PointChange* written = last_until(row(point_changes_, points_first_, point), step);
  if (!written) return {};
  planes::PointChange change = *written;
  while (change.plane >= 0 && joins_[change.plane].step <= step)
    change = {joins_[change.plane].step, joins_[change.plane].into};
  return change;
}

std::int32_t Timeline::node_of_point(std::int32_t point, std::int32_t step) const {
  std::int32_t node = leaf_of_point_[point];
  while (node >= 0 && parents_[node] >= 0 && queued_at_[node] > step) node = parents_[node];
  return node;
}

std::vector<std::int32_t> Timeline::path_of_point(std::int32_t point) const {
  std::vector<std::int32_t> path;
  for (std::int32_t node = leaf_of_point_[point]; node >= 0; node = parents_[node])
    path.push_back(node);
  std::reverse(path.begin(), path.end());
  return path;
}

std::span<const planes::PlaneChange> Timeline::changes_of_plane(std::int32_t plane) const {
  return row(plane_changes_, planes_first_, plane);
}

std::int32_t Timeline::joined_plane(std::int32_t plane, std::int32_t step) const {
  while (joins_[plane].step <= step) plane = joins_[plane].into;
  return plane;
}

const planes::PlaneChange* Timeline::plane_at(std::int32_t plane, std::int32_t step) const {
  return last_until(changes_of_plane(plane), step);
}

}  // namespace planescope::debug
