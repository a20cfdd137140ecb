// Segments a depth image into planes by one objective in inverse depth: the sequence of stages.

#include "core/planes/depth/segment_depth.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>

#include "core/planes/depth/regions.hpp"

namespace planescope::planes {
namespace {

constexpr int kRounds = 3;           // of growing and joining
constexpr double kCrumb = 100;       // px: smaller regions are dropped before growing
constexpr int kLeastBorder = 8;      // px: shortest border of regions joined after growing
constexpr double kStep = 3;          // sigma: regions separated by a larger step of rho do not
                                     // share a border
constexpr double kWorthWidth = 640;  // px: image width for which worth_px is defined
constexpr double kPrecision = 0.75;  // exponent of a plane's precision in its worth
constexpr double kSideways = 0.25;   // share of the lateral error's variance excused in a
                                     // plane's roughness
constexpr double kWorthCounts = 2;   // weight of a plane's worth in its margin
constexpr double kLargePart =
    0.2;  // smallest share of a region; smaller parts do not affect its margin
constexpr double kMinor = 0.5;  // share of the smallest worth at which a plane is listed as minor

using Clock = std::chrono::steady_clock;
double elapsed_ms(Clock::time_point since) {
  return std::chrono::duration<double, std::milli>(Clock::now() - since).count();
}

/// Fills in the octree data used by replay and pictures; the traversal adds the nodes.
void prepare_octree(Octree& octree, const DepthInput& input, const DepthSegmentation& s) {
  octree.image = input.space;
  octree.cube.max_depth = s.cells.depth();
  octree.image->root_px = DepthCells::side_px(s.cells.depth());
  octree.image->px_per_inverse_m = kPxPerInverseMeter;
}

void trace_octree(Octree& octree, const DepthInput& input, DepthSegmentation& s, Trace* trace) {
  const std::vector<std::uint32_t>& pixels = s.cells.pixels;
  std::vector<std::uint32_t> point_of(input.image.pixels(), 0);
  for (std::uint32_t k = 0; k < input.pixel.size(); ++k) point_of[input.pixel[k]] = k;
  octree.order.reserve(pixels.size());
  s.traced.position.resize(input.image.pixels());
  for (std::uint32_t i = 0; i < pixels.size(); ++i) {
    octree.order.push_back(point_of[pixels[i]]);
    octree.points.push_back(input.points[octree.order.back()]);
    s.traced.position[pixels[i]] = i;
  }
  for (const DepthCell& leaf : s.cells.levels[0])
    octree.keys.insert(octree.keys.end(), leaf.end_pixel - leaf.first_pixel, leaf.code);
  octree.labels.assign(pixels.size(), Label::unknown);
  octree.h_before.assign(pixels.size() + 1, 0);
  s.traced.trace = trace;
  s.traced.points = octree.points;
  s.traced.gravity_known = input.gravity_known;
  if (!pixels.empty()) trace->queued_at.push_back(0);
}

/// Drops small regions, which frees their pixels for others to grow over.
void drop_crumbs(DepthSegmentation& s) {
  bool any = false;
  for (std::size_t k = 0; k < s.regions.size(); ++k)
    if (DepthRegion& region = s.regions[k]; region.alive && region.moments.n < kCrumb) {
      log_drop(s, Stage::grow, static_cast<std::int32_t>(k), region.moments.n);
      region.alive = false;
      any = true;
    }
  if (any) free_pixels_of_ended(s);
}

/// The 3D plane fitted in inverse depth. Eigenvalues are relative to that plane.
PlaneFit fit_in_space(const Moments& moments, const InversePlane& plane, const DepthInput& input) {
  PlaneFit fit = fit_plane(moments);
  // rho = a (u - u0) + b (v - v0) + c with u = fx x / z + cx: 1 = a fx x + b fy y + c' z.
  const ImageSpace& k = input.space;
  const double u0 = 0.5 * (input.image.width - 1), v0 = 0.5 * (input.image.height - 1);
  const Vec3d camera(plane.a * k.fx, plane.b * k.fy,
                     plane.c + plane.a * (k.cx - u0) + plane.b * (k.cy - v0));
  const double norm = camera.norm();
  if (!(norm > 0)) return fit;
  const Vec3d normal = k.T_local_camera.linear() * (camera / norm);
  const double offset = 1 / norm + normal.dot(k.T_local_camera.translation());
  const double shift = offset - normal.dot(fit.centroid);
  const Mat3d scatter = moments.scatter();
  fit.eigenvalues[0] = std::max(0.0, normal.dot(scatter * normal)) + fit.count * shift * shift;
  fit.eigenvalues[0] = std::min(fit.eigenvalues[0], fit.eigenvalues[1]);
  fit.centroid += shift * normal;
  fit.normal = normal.dot(fit.normal) < 0 ? Vec3d(-normal) : normal;
  return fit;
}

/// Distance of the objective from losing a region: the minimum over not listing it, joining it with
/// a neighbor at least as large, and not having joined its parts.
double margin_of(const DepthSegmentation& s, std::int32_t k) {
  const DepthRegion& region = s.regions[k];
  double margin = kWorthCounts * (worth_px(s, region) / s.options.worth_px - 1);
  for (const DearJoin& join : region.dear_joins)
    if (join.smaller_px >= kLargePart * region.moments.n)
      margin = std::min(margin, s.options.merge_cost / join.cost - 1);
  for (const DepthNeighbor& near : region.near)
    if (s.regions[near.region].alive && s.regions[near.region].moments.n >= region.moments.n)
      margin = std::min(margin, std::sqrt(s.join_cost(k, near.region) / s.options.merge_cost) - 1);
  return std::max(0.0, margin);
}

struct Listing {
  std::vector<std::int32_t> planes, minor;  // regions, largest first
};

/// Lists a plane if it is worth its cost.
Listing list_planes(DepthSegmentation& s) {
  Listing listing;
  for (DepthRegion& region : s.regions)
    if (region.alive && region.known > 0 && !s.lies_on(region, s.known[region.known - 1]))
      region.known = 0;
  for (std::size_t k = 0; k < s.regions.size(); ++k) {
    const auto region = static_cast<std::int32_t>(k);
    if (!s.regions[k].alive) continue;
    const double worth = worth_px(s, s.regions[k]);
    if (worth >= s.options.worth_px || s.regions[k].known > 0) {
      listing.planes.push_back(region);
      continue;
    }
    log_drop(s, Stage::list, region, worth);
    if (worth >= kMinor * s.options.worth_px) listing.minor.push_back(region);
  }
  const auto size = [&](std::int32_t region) { return -s.regions[region].moments.n; };
  std::ranges::stable_sort(listing.planes, {}, size);
  std::ranges::stable_sort(listing.minor, {}, size);
  return listing;
}

/// Restores the regions of previously found planes.
Listing restore_given(DepthSegmentation& s, const GivenPlanes& given) {
  s.regions.resize(given.margins.size());
  for (std::uint32_t pixel = 0; pixel < s.region_of.size(); ++pixel) {
    const int id = given.plane_of.data[pixel];
    if (id == 0) continue;
    s.region_of[pixel] = id - 1;
    s.regions[id - 1].moments.add(s.u(pixel), s.v(pixel), s.image.rho[pixel]);
  }
  Listing listing;
  for (int k = 0; k < std::ssize(s.regions); ++k) {
    s.regions[k].plane = s.regions[k].moments.fit();
    (k < given.listed ? listing.planes : listing.minor).push_back(k);
  }
  return listing;
}

void conclude(DepthSegmentation& s,
              const DepthInput& input,
              const Listing& listing,
              Segmentation& result) {
  std::vector<std::int32_t> slot(s.regions.size(), -1);  // first planes, then minor planes
  for (const std::int32_t region : listing.planes)
    slot[region] = static_cast<std::int32_t>(result.planes.size()), result.planes.emplace_back();
  const auto planes = static_cast<std::int32_t>(result.planes.size());
  for (const std::int32_t region : listing.minor)
    slot[region] = planes + static_cast<std::int32_t>(result.minor.size()),
    result.minor.emplace_back();

  result.minor_points.resize(result.minor.size());
  result.plane_of.assign(input.pixel.size(), 0);
  result.plane_of_pixel.assign(input.image.pixels(), 0);
  std::vector<Moments> moments(result.planes.size() + result.minor.size());
  for (std::uint32_t k = 0; k < input.pixel.size(); ++k) {
    const std::int32_t region = s.region_of[input.pixel[k]];
    const std::int32_t at = region >= 0 ? slot[region] : -1;
    if (at < 0 || at >= planes) ++s.counts.unassigned;
    if (at < 0) continue;
    moments[at].add(input.points[k].cast<double>());
    if (at < planes)
      result.plane_of[k] = result.plane_of_pixel[input.pixel[k]] = at + 1;
    else
      result.minor_points[at - planes].push_back(k);
  }

  const auto fill = [&](PlaneRegion& region, std::int32_t from, int id) {
    region.id = id;
    const Moments& of = moments[slot[from]];
    region.fit = fit_in_space(of, s.regions[from].plane, input);
    if (input.gravity_known) region.label = label_of_normal(region.fit.normal);
    region.fit.normal = outward_normal(region.fit, region.label, input.sensor);
    region.points = static_cast<std::uint32_t>(of.count);
    region.founded = from;
    if (const int known = s.regions[from].known; known > 0)
      region.known = input.known[known - 1].id;
    region.margin = input.given ? input.given->margins[from] : margin_of(s, from);
    region.undecided = region.margin < s.options.undecided;
  };
  for (std::size_t k = 0; k < listing.planes.size(); ++k)
    fill(result.planes[k], listing.planes[k], static_cast<int>(k) + 1);
  for (std::size_t k = 0; k < listing.minor.size(); ++k) fill(result.minor[k], listing.minor[k], 0);
}

}  // namespace

double worth_px(const DepthSegmentation& s, const DepthRegion& region) {
  const double n = region.moments.n, scale = kWorthWidth / s.image.width;
  // The lateral error makes a grazing plane rough along the ray; that is weak evidence against it.
  const DepthNoise& noise = s.noise;
  const double across = 1 + kSideways * noise.sideways2(region.plane) /
                                (noise.white * noise.white + noise.bow * noise.bow);
  const double variance = std::max(1e-18, region.plane.sse / std::max(1.0, n - 3) / across);
  const double mean_rho = region.moments.r / n;
  return n * scale * scale * std::pow(0.01 * mean_rho * noise.white / variance, kPrecision);
}

Segmentation segment_depth(const DepthInput& input, const SegmentOptions& options, Trace* trace) {
  Segmentation result;
  const auto start = Clock::now();
  DepthSegmentation s{input.image, options.objective, input.known};
  s.cells = make_depth_cells(input.image);
  s.noise = measure_depth_noise(s.cells.blocks, s.cells.block_columns, input.image.width,
                                input.image.unit_m, options.objective);
  s.region_of.assign(input.image.pixels(), kNoRegion);
  prepare_octree(result.octree, input, s);
  if (trace) trace_octree(result.octree, input, s, trace);
  result.timings.build_ms = elapsed_ms(start);

  const auto built = Clock::now();
  Listing listing;
  if (input.given) {
    listing = restore_given(s, *input.given);
  } else if (s.noise.white > 0) {
    divide_image(s, result.octree);
    find_neighbors(s, 1, 0, std::numeric_limits<double>::infinity());
    merge_regions(s);
    result.covered = found_known_regions(s);
    drop_crumbs(s);
    for (int round = 0; round < kRounds; ++round) {
      grow_regions(s);
      find_neighbors(s, kLeastBorder, 1, kStep * (s.noise.white + s.noise.bow));
      merge_regions(s);
    }
    join_hidden_parts(s);
    listing = list_planes(s);
  }
  conclude(s, input, listing, result);
  // sigma_z = sigma_rho z^2.
  result.noise.estimated = result.noise.by_range = s.noise.white > 0;
  result.noise.growth_per_m = s.noise.wide;
  result.noise.reach_sigma = options.objective.reach_sigma;
  result.counts = s.counts;
  result.timings.traverse_ms = elapsed_ms(built);
  return result;
}

// Writes the trace of a depth image's segmentation.

namespace {

void write_plane(DepthTrace& traced, std::int32_t region) {
  traced.trace->planes.push_back({region, {traced.planes[region], traced.trace->steps()}});
}

void refit(GrowingPlane& plane) {
  if (plane.moments.count >= 3) plane.fit = fit_plane(plane.moments);
}

}  // namespace

void log_founded(DepthSegmentation& s,
                 const Octree& octree,
                 std::int32_t region,
                 std::int32_t node) {
  DepthTrace& traced = s.traced;
  if (!traced.trace) return;
  GrowingPlane plane;
  for (std::uint32_t i = octree.nodes[node].begin; i < octree.nodes[node].end; ++i) {
    const Vec3d at = octree.points[i].cast<double>();
    plane.moments.add(at);
  }
  refit(plane);
  plane.label = traced.label_of(plane.fit);
  traced.trace->events.push_back(
      {.type = EventType::found, .label = plane.label, .node = node, .plane = region});
  traced.planes.push_back(plane);
  write_plane(traced, region);
  for (std::uint32_t i = octree.nodes[node].begin; i < octree.nodes[node].end; ++i)
    traced.trace->points.push_back({i, {traced.trace->steps(), region, false}});
}

void log_join(
    DepthSegmentation& s, Stage stage, std::int32_t from, std::int32_t into, double cost) {
  DepthTrace& traced = s.traced;
  if (!traced.trace) return;
  traced.trace->events.push_back({.type = EventType::refine,
                                  .stage = stage,
                                  .plane = from,
                                  .other = into,
                                  .value = static_cast<float>(cost)});
  GrowingPlane &gone = traced.planes[from], &grown = traced.planes[into];
  grown.moments += gone.moments;
  refit(grown);
  gone.alive = false;
  gone.into = into;  // its points follow: Timeline uses this link
  write_plane(traced, from);
  write_plane(traced, into);
}

void log_growth(DepthSegmentation& s, const std::vector<std::int32_t>& before) {
  DepthTrace& traced = s.traced;
  if (!traced.trace) return;
  // One event for each region that gains or loses pixels, in order.
  std::vector<std::vector<std::uint32_t>> taken(s.regions.size()), freed(s.regions.size());
  std::vector<std::uint32_t> lost(s.regions.size(), 0);
  std::vector<Moments> moments(s.regions.size());
  for (const std::uint32_t pixel : s.cells.pixels) {
    const std::int32_t was = before[pixel], is = s.region_of[pixel];
    if (is >= 0) {
      const Vec3d at = traced.points[traced.position[pixel]].cast<double>();
      moments[is].add(at);
    }
    if (was == is) continue;
    if (was >= 0) ++lost[was];
    if (is >= 0)
      taken[is].push_back(traced.position[pixel]);
    else
      freed[was].push_back(traced.position[pixel]);
  }
  for (std::int32_t region = 0; region < static_cast<std::int32_t>(taken.size()); ++region) {
    GrowingPlane& plane = traced.planes[region];
    if (!plane.alive || (taken[region].empty() && lost[region] == 0)) continue;
    const bool ends = !s.regions[region].alive;
    traced.trace->events.push_back({.type = EventType::refine,
                                    .stage = Stage::grow,
                                    .plane = region,
                                    .value = ends ? static_cast<float>(s.regions[region].moments.n)
                                                  : static_cast<float>(taken[region].size()) -
                                                        static_cast<float>(lost[region])});
    plane.moments = moments[region];
    refit(plane);
    plane.alive = !ends;
    write_plane(traced, region);
    for (const std::uint32_t i : taken[region])
      traced.trace->points.push_back({i, {traced.trace->steps(), region, false}});
    for (const std::uint32_t i : freed[region])
      traced.trace->points.push_back({i, {traced.trace->steps(), kNoRegion, true}});
  }
}

void log_drop(DepthSegmentation& s, Stage stage, std::int32_t region, double value) {
  DepthTrace& traced = s.traced;
  if (!traced.trace) return;
  traced.trace->events.push_back({.type = EventType::refine,
                                  .stage = stage,
                                  .plane = region,
                                  .value = static_cast<float>(value)});
  traced.planes[region].alive = false;
  write_plane(traced, region);
  for (const std::uint32_t pixel : s.cells.pixels)
    if (s.region_of[pixel] == region)
      traced.trace->points.push_back(
          {traced.position[pixel], {traced.trace->steps(), kNoRegion, true}});
}

}  // namespace planescope::planes
