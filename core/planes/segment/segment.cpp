// Sun et al. 2023, Sec. IV: the method as one function, and the state that it changes.

#include "core/planes/segment/segment.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>
#include <numeric>

#include "core/model/error.hpp"
#include "core/planes/segment/cloud_regions.hpp"
#include "core/planes/segment/criteria.hpp"
#include "core/planes/segment/options.hpp"
#include "core/planes/segment/state.hpp"
#include "core/planes/segment/trace.hpp"

namespace planescope::planes {

// ---- Options ----

const char* to_string(Profile profile) {
  switch (profile) {
    case Profile::paper:
      return "paper";
    case Profile::paper_closest:
      return "paper-closest";
    case Profile::refined:
      return "refined";
  }
  return "?";
}

Profile parse_profile(const std::string& text) {
  for (const Profile p : {Profile::paper, Profile::paper_closest, Profile::refined})
    if (text == to_string(p)) return p;
  throw Error("unknown profile '" + text + "'; expected paper, paper-closest, or refined");
}

SegmentOptions profile_options(Profile profile) {
  SegmentOptions o;
  o.profile = profile;
  switch (profile) {
    case Profile::paper:
      break;  // the struct's defaults follow the text of the paper
    case Profile::paper_closest:
      // The interpretation that comes closest to the noise table in the paper.
      o.cube_anchor = CubeAnchor::min_corner;
      o.criterion4_n2 = false;
      o.merge_offset_m = 0.02;
      o.theta_n_in = 10;
      o.leftover_distance_m = 0.01;
      break;
    case Profile::refined:
      break;
  }
  return o;
}

// ---- Stages ----

namespace {

constexpr std::array kNames{"criteria", "merge",  "assign", "join",
                            "grow",     "hidden", "parts",  "list"};
constexpr std::size_t kOfPaper = 3;
constexpr std::array<StageInfo, kNames.size() - kOfPaper> kInfos{{
    {.title = "merge neighbors",
     .event_text =
         "{plane} merged into {other}: misfit {value:.3g}, less than the cost of a plane"},
    {.title = "grow over pixels",
     .event_text = "{plane} changes by {value:+.0f} px at its border",
     .why_dropped = "{value:.0f} px, too few to grow",
     .on_pixels = true},
    {.title = "merge hidden parts",
     .event_text = "{plane} merged into {other} behind an occluder: misfit {value:.3g}",
     .on_pixels = true},
    {.title = "split planes", .why_parted = "the parts do not touch"},
    {.title = "drop small planes",
     .event_text = "{plane} dropped: worth {value:.0f}, less than its cost",
     .why_dropped = "worth {value:.0f}, less than its cost"},
}};

}  // namespace

const char* to_string(Stage stage) { return kNames[static_cast<std::size_t>(stage)]; }

const StageInfo* info_of(Stage stage) {
  const auto index = static_cast<std::size_t>(stage);
  return index < kOfPaper ? nullptr : &kInfos[index - kOfPaper];
}

const std::vector<Stage>& stages() {
  static const std::vector<Stage> all = [] {
    std::vector<Stage> list;
    for (std::size_t k = 0; k < kNames.size(); ++k) list.push_back(static_cast<Stage>(k));
    return list;
  }();
  return all;
}

// ---- State ----

namespace {

/// The cube positioned according to `anchor`: unchanged, or starting at the points' lower corner.
Cube placed(const Cube& cube, std::span<const Vec3f> points, CubeAnchor anchor) {
  Cube result = cube;
  if (anchor == CubeAnchor::min_corner && !points.empty()) {
    Vec3f low = points[0];
    for (const Vec3f& p : points) low = low.cwiseMin(p);
    result.min_corner = low.cast<double>();
  }
  return result;
}

void trace_queued(SegmentState& state) {
  if (state.trace) state.trace->queued_at.resize(state.octree.nodes.size(), state.trace->steps());
}

void trace_plane(SegmentState& state, std::int32_t plane) {
  if (state.trace)
    state.trace->planes.push_back({plane, {state.planes[plane], state.trace->steps()}});
}

}  // namespace

SegmentState start_segmentation(std::span<const Vec3f> points,
                                std::span<const Label> labels,
                                const Cube& cube,
                                const Vec3d& sensor,
                                const SegmentOptions& options,
                                Trace* trace) {
  assert(points.size() == labels.size());
  SegmentState state{options, sensor, trace};
  state.octree = build_octree(points, labels, placed(cube, points, options.cube_anchor));
  state.plane_of.assign(points.size(), -1);
  trace_queued(state);
  return state;
}

void visit_node(SegmentState& state, std::int32_t node) {
  log(state, {.type = EventType::visit, .node = node});
  ++state.counts.nodes_visited;
  assert(!state.trace || state.trace->visited_at.size() == static_cast<std::size_t>(node));
  if (state.trace)  // nodes are visited and settled in order
    state.trace->visited_at.push_back(state.trace->steps());
}

void settle_node(SegmentState& state, std::int32_t index, Case decided) {
  OctreeNode& node = state.octree.nodes[index];
  node.decided = decided;
  ++state.counts.nodes_per_case[static_cast<int>(decided)];
  ++state.counts.nodes_per_case_depth[static_cast<int>(decided)][node.depth];
  if (state.trace) state.trace->decided_at.push_back(state.trace->steps());
}

void divide_node(SegmentState& state, std::int32_t node) {
  divide(state.octree, node);
  trace_queued(state);
}

std::int32_t found_plane(SegmentState& state, const GrowingPlane& plane) {
  const auto number = static_cast<std::int32_t>(state.planes.size());
  state.planes.push_back(plane);
  trace_plane(state, number);
  return number;
}

void fit_again(SegmentState& state, std::int32_t number, const Moments& moments) {
  GrowingPlane& plane = state.planes[number];
  plane.moments = moments;
  plane.fit = fit_plane(moments);
  trace_plane(state, number);
}

void end_plane(SegmentState& state, std::int32_t plane, std::int32_t into) {
  state.planes[plane].alive = false;
  state.planes[plane].into = into;
  trace_plane(state, plane);
}

void join_planes(SegmentState& state,
                 std::int32_t plane,
                 std::int32_t into,
                 std::span<const std::uint32_t> points) {
  grow_plane(state, into, state.planes[plane]);
  end_plane(state, plane, into);
  for (const std::uint32_t i : points) give_point(state, i, into);
}

void drop_plane(SegmentState& state, std::int32_t plane, std::span<const std::uint32_t> points) {
  end_plane(state, plane);
  for (const std::uint32_t i : points) leave_point(state, i);
}

Moments moments_of(const SegmentState& state, std::span<const std::uint32_t> points) {
  Moments moments;
  for (const std::uint32_t i : points) moments.add(state.point(i));
  return moments;
}

std::int32_t found_part(SegmentState& state,
                        Stage stage,
                        std::int32_t plane,
                        std::span<const std::uint32_t> points) {
  GrowingPlane part;
  part.label = state.planes[plane].label;
  part.moments = moments_of(state, points);
  part.fit = fit_plane(part.moments);
  log(state, {.type = EventType::found,
              .stage = stage,
              .label = part.label,
              .plane = static_cast<std::int32_t>(state.planes.size()),
              .other = plane});
  const std::int32_t number = found_plane(state, part);
  for (const std::uint32_t i : points) give_point(state, i, number);
  return number;
}

PlanePoints points_by_plane(const SegmentState& state) {
  PlanePoints result;
  result.first.assign(state.planes.size() + 1, 0);
  for (const std::int32_t plane : state.plane_of)
    if (plane >= 0) ++result.first[plane + 1];
  std::partial_sum(result.first.begin(), result.first.end(), result.first.begin());
  result.points.resize(result.first.back());
  std::vector<std::uint32_t> next(result.first.begin(), result.first.end() - 1);
  for (std::uint32_t i = 0; i < state.plane_of.size(); ++i)
    if (state.plane_of[i] >= 0) result.points[next[state.plane_of[i]]++] = i;
  return result;
}

// ---- The method ----

namespace {

using Clock = std::chrono::steady_clock;

double elapsed_ms(Clock::time_point since) {
  return std::chrono::duration<double, std::milli>(Clock::now() - since).count();
}

/// Numbers the remaining planes by size, and returns them with their points.
void conclude(SegmentState& state, Segmentation& result) {
  std::vector<std::uint32_t> points(state.planes.size(), 0);
  for (const std::int32_t plane : state.plane_of)
    if (plane >= 0) ++points[plane];
  std::vector<std::int32_t> order;
  for (std::size_t k = 0; k < state.planes.size(); ++k)
    if (state.planes[k].alive && points[k] > 0) order.push_back(static_cast<std::int32_t>(k));
  std::stable_sort(order.begin(), order.end(),
                   [&](auto a, auto b) { return points[a] > points[b]; });

  std::vector<std::int32_t> id(state.planes.size(), 0);
  const auto region_of = [&](std::int32_t k) {
    const GrowingPlane& plane = state.planes[k];
    PlaneRegion region;
    region.label = plane.label;
    region.fit = plane.fit;
    region.points = points[k];
    region.founded = k;
    region.fit.normal = outward_normal(plane.fit, plane.label, state.sensor);
    return region;
  };
  for (const std::int32_t k : order) {
    result.planes.push_back(region_of(k));
    id[k] = result.planes.back().id = static_cast<int>(result.planes.size());
  }
  result.plane_of.assign(state.plane_of.size(), 0);
  for (std::size_t i = 0; i < state.plane_of.size(); ++i) {
    const std::int32_t plane = state.plane_of[i];
    if (plane >= 0) result.plane_of[state.octree.order[i]] = id[plane];
    if (plane < 0 || id[plane] == 0) ++state.counts.unassigned;
  }
  result.octree = std::move(state.octree);
  result.noise = state.noise;
  result.counts = state.counts;
}

}  // namespace

Segmentation segment(std::span<const Vec3f> points,
                     std::span<const Label> labels,
                     const Cube& cube,
                     const Vec3d& sensor,
                     const SegmentOptions& options,
                     Trace* trace) {
  Segmentation result;
  const auto start = Clock::now();
  SegmentState state = start_segmentation(points, labels, cube, sensor, options, trace);
  result.timings.build_ms = elapsed_ms(start);

  const auto built = Clock::now();
  if (options.by_objective()) {
    const CloudScales scales = measure_scales(state, options.objective);
    state.noise = noise_of(scales, options.objective);
    traverse(state);
    find_cloud_regions(state, scales, options.objective);
  } else {
    traverse(state);  // Sec. IV-C, with merging (IV-D)
    assign_leftovers(state);
  }
  conclude(state, result);
  result.timings.traverse_ms = elapsed_ms(built);
  return result;
}

}  // namespace planescope::planes
