// Rival methods from the Point Cloud Library.

#include <pcl/features/integral_image_normal.h>
#include <pcl/features/normal_3d.h>
#include <pcl/point_cloud.h>
#include <pcl/point_types.h>
#include <pcl/search/kdtree.h>
#include <pcl/segmentation/organized_multi_plane_segmentation.h>
#include <pcl/segmentation/region_growing.h>

#include <cassert>
#include <limits>
#include <numbers>

#include "core/lab/rivals/rivals.hpp"

namespace planescope::lab {
namespace {

using Points = pcl::PointCloud<pcl::PointXYZ>;
using Normals = pcl::PointCloud<pcl::Normal>;

// For the multi-plane segmentation.
constexpr float kNormalPx = 20;             // edge of the square for a normal
constexpr float kLargestDepthStep = 0.02F;  // within a normal's square, relative to depth
constexpr unsigned kFewestPixels = 300;     // of a plane, before refinement
constexpr double kNeighborsDeg = 2.5;       // between neighbors' normals
constexpr double kNeighborsM = 0.02;        // between neighbors' plane offsets, at a depth of 1 m
constexpr double kMostCurvature = 0.03;     // of a region: least eigenvalue / sum of all
constexpr float kRefineM = 0.01F;           // of a pixel that joins a plane beside it

double radians(double degrees) { return degrees * std::numbers::pi / 180; }

Points::Ptr unordered_cloud(std::span<const Vec3f> points) {
  auto cloud = pcl::make_shared<Points>();
  cloud->reserve(points.size());
  for (const Vec3f& p : points) cloud->emplace_back(p.x(), p.y(), p.z());
  return cloud;
}

/// An organized cloud in the camera's axes, NaN for unmeasured pixels. The roll about the optical
/// axis is arbitrary, since nothing depends on it.
Points::Ptr organised_cloud(const planes::PixelPoints& input) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  auto cloud = pcl::make_shared<Points>(static_cast<std::uint32_t>(input.width),
                                        static_cast<std::uint32_t>(input.height),
                                        pcl::PointXYZ(nan, nan, nan));
  cloud->is_dense = false;
  const Eigen::Matrix3f R_camera_points =
      Eigen::Quaternionf::FromTwoVectors(input.view, Vec3f::UnitZ()).toRotationMatrix();
  for (std::size_t i = 0; i < input.points.size(); ++i) {
    if (!input.kept[i]) continue;
    const Vec3f p = R_camera_points * (input.points[i] - input.sensor);
    (*cloud)[input.pixel[i]] = pcl::PointXYZ(p.x(), p.y(), p.z());
  }
  return cloud;
}

Normals::Ptr normals_of_image(const Points::Ptr& cloud) {
  using Estimation = pcl::IntegralImageNormalEstimation<pcl::PointXYZ, pcl::Normal>;
  Estimation estimation;
  estimation.setNormalEstimationMethod(Estimation::COVARIANCE_MATRIX);
  estimation.setMaxDepthChangeFactor(kLargestDepthStep);
  estimation.setNormalSmoothingSize(kNormalPx);
  estimation.setInputCloud(cloud);
  auto normals = pcl::make_shared<Normals>();
  estimation.compute(*normals);
  return normals;
}

/// Groups from 1 on, 0 none.
std::vector<std::int32_t> groups_of(const std::vector<pcl::PointIndices>& regions,
                                    std::size_t count) {
  std::vector<std::int32_t> group_of(count, 0);
  for (std::size_t r = 0; r < regions.size(); ++r)
    for (const pcl::index_t i : regions[r].indices) group_of[i] = static_cast<std::int32_t>(r + 1);
  return group_of;
}

}  // namespace

planes::FoundPlanes pcl_multi_plane(const planes::PixelPoints& input) {
  assert(input.points.size() == input.pixel.size() && input.points.size() == input.kept.size());
  if (input.width < 2 || input.height < 2)
    return planes::found_planes(input.points, groups_of({}, input.points.size()));
  const Points::Ptr cloud = organised_cloud(input);

  pcl::OrganizedMultiPlaneSegmentation<pcl::PointXYZ, pcl::Normal, pcl::Label> segmentation;
  segmentation.setMinInliers(kFewestPixels);
  segmentation.setAngularThreshold(radians(kNeighborsDeg));
  segmentation.setDistanceThreshold(kNeighborsM);
  segmentation.setMaximumCurvature(kMostCurvature);
  auto refinement =
      pcl::make_shared<pcl::PlaneRefinementComparator<pcl::PointXYZ, pcl::Normal, pcl::Label>>();
  refinement->setDistanceThreshold(kRefineM, true);
  segmentation.setRefinementComparator(refinement);
  segmentation.setInputNormals(normals_of_image(cloud));
  segmentation.setInputCloud(cloud);

  std::vector<pcl::PlanarRegion<pcl::PointXYZ>,
              Eigen::aligned_allocator<pcl::PlanarRegion<pcl::PointXYZ>>>
      outlines;
  std::vector<pcl::ModelCoefficients> models;
  std::vector<pcl::PointIndices> regions, labeled, boundaries;
  auto labels = pcl::make_shared<pcl::PointCloud<pcl::Label>>();
  segmentation.segmentAndRefine(outlines, models, regions, labels, labeled, boundaries);

  const std::vector<std::int32_t> group_of_pixel = groups_of(regions, cloud->size());
  std::vector<std::int32_t> group_of(input.points.size(), 0);
  for (std::size_t i = 0; i < group_of.size(); ++i)
    if (input.kept[i]) group_of[i] = group_of_pixel[input.pixel[i]];
  return planes::found_planes(input.points, group_of);
}

planes::FoundPlanes pcl_region_growing(std::span<const Vec3f> points, bool by_point) {
  if (points.empty()) return {};
  const Points::Ptr cloud = unordered_cloud(points);
  const auto search = pcl::make_shared<pcl::search::KdTree<pcl::PointXYZ>>();

  pcl::NormalEstimation<pcl::PointXYZ, pcl::Normal> estimation;
  estimation.setSearchMethod(search);
  estimation.setKSearch(by_point ? 12 : 20);
  estimation.setInputCloud(cloud);
  auto normals = pcl::make_shared<Normals>();
  estimation.compute(*normals);

  pcl::RegionGrowing<pcl::PointXYZ, pcl::Normal> growing;
  growing.setSearchMethod(search);
  growing.setNumberOfNeighbours(30);
  growing.setSmoothnessThreshold(static_cast<float>(radians(by_point ? 17 : 12)));
  growing.setCurvatureThreshold(by_point ? 0.05F : 0.08F);
  growing.setMinClusterSize(by_point ? 100 : 40);
  growing.setInputCloud(cloud);
  growing.setInputNormals(normals);
  std::vector<pcl::PointIndices> regions;
  growing.extract(regions);
  return planes::found_planes(points, groups_of(regions, points.size()));
}

}  // namespace planescope::lab
