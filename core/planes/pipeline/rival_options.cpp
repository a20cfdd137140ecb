// The options of the methods that ours is measured against.

#include "core/planes/pipeline/option_row.hpp"

namespace planescope::planes {
namespace {

/// The rows of one rival, whose options are a member of RivalOptions.
template <typename Options>
class RivalRows {
 public:
  RivalRows(std::vector<OptionInfo>& table, Method method, Options RivalOptions::*options)
      : table_(table), method_(method), options_(options) {}

  template <typename T>
  void number(const char* name,
              const char* unit,
              const char* meaning,
              T Options::*field,
              OptionRange range = {}) {
    add(planescope::planes::number(kSection, name, unit, meaning, in(field), range));
  }
  void on_off(const char* name, const char* meaning, bool Options::*field) {
    add(flag(kSection, name, meaning, in(field)));
  }

 private:
  static constexpr const char* kSection = "rivals";

  template <typename T>
  auto in(T Options::*field) const {
    return [ options = options_, field ](auto& o) -> auto& { return o.rivals.*options.*field; };
  }
  void add(OptionInfo row) {
    row.method = method_;
    table_.push_back(std::move(row));
  }

  std::vector<OptionInfo>& table_;
  Method method_;
  Options RivalOptions::*options_;
};

constexpr OptionRange kDistance{0, 100, true};  // [m]
constexpr OptionRange kAngle{0, 180};           // [deg]
constexpr OptionRange kLeastPoints{3, 1e9};
constexpr OptionRange kNeighbours{3, 1000};

void append_ransac(std::vector<OptionInfo>& table) {
  using Options = RansacOptions;
  RivalRows rows(table, Method::ransac, &RivalOptions::ransac);
  rows.number("ransac_theta_pf_m", "m", "RANSAC: inlier distance", &Options::theta_pf_m, kDistance);
  rows.number("ransac_iterations", "tries", "RANSAC: most iterations per plane",
              &Options::iterations, {1, 1e6});
  rows.number("ransac_min_points", "points", "RANSAC: fewest points of a plane",
              &Options::min_points, kLeastPoints);
  rows.number("ransac_seed", "1", "RANSAC: random seed", &Options::seed);
}

void append_region_growing(std::vector<OptionInfo>& table) {
  using Options = RegionGrowingOptions;
  RivalRows rows(table, Method::region_growing, &RivalOptions::region_growing);
  rows.number("region_patch_px", "px", "Region growing: cell edge in depth images",
              &Options::patch_px, {2, 1000});
  rows.number("region_voxel_size_m", "m", "Region growing: cell edge in unordered clouds",
              &Options::voxel_size_m, kDistance);
  rows.number("region_threshold_m2", "m2",
              "Region growing: threshold of planar region identification",
              &Options::region_threshold_m2);
  rows.number("region_merge_threshold", "1",
              "Region growing: smallest cosine between the normals of merged regions",
              &Options::merge_threshold, {-1, 1});
  rows.on_off("region_refine_boundaries",
              "Region growing: refine points along the borders of regions",
              &Options::refine_boundaries);
}

void append_pcl(std::vector<OptionInfo>& table) {
  {
    using Options = PclMultiPlaneOptions;
    RivalRows rows(table, Method::pcl_multi_plane, &RivalOptions::pcl_multi_plane);
    rows.number("pcl_multi_plane_normal_px", "px",
                "PCL multi-plane: edge of the square that a pixel's normal is computed from",
                &Options::normal_px, {2, 1000});
    rows.number("pcl_multi_plane_depth_step", "share",
                "PCL multi-plane: no normal across a larger change of depth", &Options::depth_step,
                {0, 1, true});
    rows.number("pcl_multi_plane_min_points", "points", "PCL multi-plane: a plane has at least",
                &Options::min_points, kLeastPoints);
    rows.number("pcl_multi_plane_angle_deg", "deg", "PCL multi-plane: between neighbours' normals",
                &Options::angle_deg, kAngle);
    rows.number("pcl_multi_plane_distance_m", "m",
                "PCL multi-plane: between neighbours' plane offsets, at a depth of 1 m",
                &Options::distance_m, kDistance);
    rows.number("pcl_multi_plane_curvature", "1", "PCL multi-plane: of a region, at most",
                &Options::curvature, {0, 1});
    rows.number("pcl_multi_plane_refine_distance_m", "m",
                "PCL multi-plane: of a pixel that joins a plane beside it",
                &Options::refine_distance_m, kDistance);
  }
  using Options = PclRegionGrowingOptions;
  RivalRows rows(table, Method::pcl_region_growing, &RivalOptions::pcl_region_growing);
  rows.number("pcl_region_normal_neighbours", "points",
              "PCL region growing: nearest points that a normal is computed from",
              &Options::normal_neighbours, kNeighbours);
  rows.number("pcl_region_neighbours", "points", "PCL region growing: nearest points looked at",
              &Options::neighbours, kNeighbours);
  rows.number("pcl_region_smoothness_deg", "deg", "PCL region growing: between neighbours' normals",
              &Options::smoothness_deg, kAngle);
  rows.number("pcl_region_curvature", "1",
              "PCL region growing: where there is more, a region goes no further",
              &Options::curvature, {0, 1});
  rows.number("pcl_region_min_points", "points", "PCL region growing: a plane has at least",
              &Options::min_points, kLeastPoints);
}

void append_cgal(std::vector<OptionInfo>& table) {
  {
    using Options = CgalRansacOptions;
    RivalRows rows(table, Method::cgal_ransac, &RivalOptions::cgal_ransac);
    rows.number("cgal_ransac_normal_neighbours", "points",
                "CGAL RANSAC: nearest points that a normal is computed from",
                &Options::normal_neighbours, kNeighbours);
    rows.number("cgal_ransac_epsilon_m", "m", "CGAL RANSAC: a point this near is on the plane",
                &Options::epsilon_m, kDistance);
    rows.number("cgal_ransac_cluster_epsilon_m", "m", "CGAL RANSAC: points this near are connected",
                &Options::cluster_epsilon_m, kDistance);
    rows.number("cgal_ransac_normal_cosine", "1",
                "CGAL RANSAC: least cosine between a point's normal and the plane's",
                &Options::normal_cosine, {0, 1});
    rows.number("cgal_ransac_min_points", "points", "CGAL RANSAC: a plane has at least",
                &Options::min_points, kLeastPoints);
    rows.number("cgal_ransac_probability", "share", "CGAL RANSAC: of missing the largest plane",
                &Options::probability, {0, 1, true});
    rows.number("cgal_ransac_seed", "1", "CGAL RANSAC: random seed", &Options::seed);
  }
  using Options = CgalRegionGrowingOptions;
  RivalRows rows(table, Method::cgal_region_growing, &RivalOptions::cgal_region_growing);
  rows.number("cgal_region_normal_neighbours", "points",
              "CGAL region growing: nearest points that a normal is computed from",
              &Options::normal_neighbours, kNeighbours);
  rows.number("cgal_region_neighbours", "points", "CGAL region growing: nearest points looked at",
              &Options::neighbours, kNeighbours);
  rows.number("cgal_region_distance_m", "m", "CGAL region growing: of a point from the plane",
              &Options::distance_m, kDistance);
  rows.number("cgal_region_angle_deg", "deg",
              "CGAL region growing: between a point's normal and the plane's", &Options::angle_deg,
              kAngle);
  rows.number("cgal_region_min_points", "points", "CGAL region growing: a plane has at least",
              &Options::min_points, kLeastPoints);
}

}  // namespace

void append_rivals(std::vector<OptionInfo>& table) {
  if (has_ransac()) append_ransac(table);
  append_region_growing(table);
  if (!has_pcl_and_cgal()) return;
  append_pcl(table);
  append_cgal(table);
}

}  // namespace planescope::planes
