#include "core/planes/pipeline/rival.hpp"

#include <cassert>
#include <chrono>

#include "core/model/error.hpp"
#include "core/planes/segment/outward.hpp"

namespace planescope::planes {
namespace {

bool looks_at_pixels(Method method, const Frame& frame) {
  if (method == Method::pcl_multi_plane && frame.is_cloud())
    throw Error(std::string("method ") + to_string(method) +
                " is for depth images, this frame is a cloud");
  return !frame.is_cloud() &&
         (method == Method::pcl_multi_plane || method == Method::region_growing);
}

FoundPlanes find_on_pixels(const Frame& frame,
                           const PreparedFrame& prepared,
                           const PipelineOptions& options) {
  const Cloud& cloud = prepared.cloud;
  const PixelPoints pixels{.points = cloud.points,
                           .pixel = cloud.source,
                           .kept = cloud.kept,
                           .sensor = prepared.sensor().cast<float>(),
                           .view = cloud.T_world_sensor.linear().col(2).cast<float>(),
                           .width = frame.depth.width,
                           .height = frame.depth.height};
  return options.method == Method::pcl_multi_plane
             ? pcl_multi_plane(pixels, options.rivals.pcl_multi_plane)
             : grow_regions(pixels, options.rivals.region_growing);
}

FoundPlanes find_on_voxels(const PreparedFrame& prepared, const PipelineOptions& options) {
  const std::vector<Vec3f>& points = prepared.voxels.points;
  const RivalOptions& rivals = options.rivals;
  switch (options.method) {
    case Method::ransac:
      return find_planes_ransac(points, rivals.ransac);
    case Method::region_growing:
      return grow_regions(points, rivals.region_growing);
    case Method::pcl_region_growing:
      return pcl_region_growing(points, rivals.pcl_region_growing);
    case Method::cgal_ransac:
      return cgal_ransac(points, rivals.cgal_ransac);
    case Method::cgal_region_growing:
      return cgal_region_growing(points, rivals.cgal_region_growing);
    case Method::ours:
    case Method::pcl_multi_plane:
      break;
  }
  assert(false);
  return {};
}

std::vector<PlaneRegion> regions_of(const std::vector<PlaneFit>& planes,
                                    const PreparedFrame& prepared) {
  std::vector<PlaneRegion> regions;
  for (const PlaneFit& fit : planes) {
    PlaneRegion region;
    region.founded = static_cast<std::int32_t>(regions.size());
    region.id = region.founded + 1;
    if (prepared.gravity.known()) region.label = label_of_normal(fit.normal);  // of a whole plane
    region.fit = fit;
    region.fit.normal = outward_normal(fit, region.label, prepared.sensor());
    regions.push_back(region);
  }
  return regions;
}

}  // namespace

FoundRegions find_rival_regions(const Frame& frame,
                                const PreparedFrame& prepared,
                                const PipelineOptions& options) {
  const auto start = std::chrono::steady_clock::now();
  FoundRegions found;
  Segmentation& segmentation = found.segmentation;
  const bool on_pixels = looks_at_pixels(options.method, frame);
  FoundPlanes planes =
      on_pixels ? find_on_pixels(frame, prepared, options) : find_on_voxels(prepared, options);
  if (on_pixels) {
    found.plane_of = std::move(planes.plane_of);
    segmentation.plane_of = vote_instances(prepared.voxels, found.plane_of);
  } else {
    segmentation.plane_of = std::move(planes.plane_of);
  }
  segmentation.planes = regions_of(planes.planes, prepared);
  for (const std::int32_t id : segmentation.plane_of) {
    if (id > 0)
      ++segmentation.planes[static_cast<std::size_t>(id) - 1].points;
    else
      ++segmentation.counts.unassigned;
  }
  const std::chrono::duration<double, std::milli> elapsed =
      std::chrono::steady_clock::now() - start;
  segmentation.timings.traverse_ms = elapsed.count();
  return found;
}

std::vector<Label> labels_of_planes(const Segmentation& segmentation) {
  std::vector<Label> labels;
  labels.reserve(segmentation.plane_of.size());
  for (const std::int32_t id : segmentation.plane_of)
    labels.push_back(id > 0 ? segmentation.planes[static_cast<std::size_t>(id) - 1].label
                            : Label::unknown);
  return labels;
}

}  // namespace planescope::planes
