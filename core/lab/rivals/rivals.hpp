#pragma once

// Comparisons besides the product's own rivals: methods of PCL and CGAL, and classifiers for
// reference results and speed.

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/model/types.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/classify/weights.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::lab {

/// A method of PCL or CGAL, single-threaded and byte-identical every time. Their options are tuned
/// by mean IoU and panoptic quality (docs/method.md, "Further rivals"): on depth images and their 2
/// cm voxels, and with `by_point` on the paper's stairs of 8192 points.
struct LibraryRival {
  const char* name;  // in results: "pcl-region-growing"
  planes::FoundPlanes (*on_pixels)(const planes::PixelPoints& pixels);  // depth images; or null:
  planes::FoundPlanes (*on_points)(std::span<const Vec3f> points, bool by_point);
};
/// Empty in builds without -DPLANESCOPE_RIVALS=ON.
const std::vector<LibraryRival>& library_rivals();
/// Null if there is no such method.
const LibraryRival* find_library_rival(const std::string& name);

/// Names of all rivals in this build, those of the product first. `images`: also those only for
/// depth images.
std::vector<std::string> rival_names(bool images);

/// Like run_frame(), with any method: null `rival` uses the method in the options. Throws Error if
/// a method only for depth images gets a cloud.
planes::FrameResult run_method(const Frame& frame,
                               const planes::PipelineOptions& options,
                               const planes::Classifier* classifier,
                               const LibraryRival* rival);

// PCL 1.13 and CGAL 5.5, as packaged by Debian.

/// OrganizedMultiPlaneSegmentation (Trevor et al. 2013) with its refinement, on normals from
/// integral images (Holzer et al. 2012).
planes::FoundPlanes pcl_multi_plane(const planes::PixelPoints& input);
/// RegionGrowing (Rabbani et al. 2006).
planes::FoundPlanes pcl_region_growing(std::span<const Vec3f> points, bool by_point);
/// Efficient RANSAC (Schnabel et al. 2007).
planes::FoundPlanes cgal_ransac(std::span<const Vec3f> points, bool by_point);
/// Region growing on point sets (Lafarge & Mallet 2012).
planes::FoundPlanes cgal_region_growing(std::span<const Vec3f> points, bool by_point);

// ---- Classifiers ----

/// Conventional PCA normals, with nanoflann's k-d tree for the neighbors and Eigen's closed form
/// for the normal: the reference for our classifiers' speed. Labels differ from those of
/// make_pca_classifier() if several points are equally far, or if a normal is at the boundary.
std::unique_ptr<planes::Classifier> make_nanoflann_pca_classifier(
    const planes::PcaClassifierOptions& options = {});

// A second 3D-GCN, written directly from its equations: the reference for the fast one's results
// and speed.

template <typename Real>
struct PlainNetwork {
  planes::NetworkConfig config;
  std::vector<std::vector<Real>> tensors;  // by tensor_specs(config)
};

/// The points of each level, as indices of level 0, and the nearest other points of each point, as
/// indices of this level.
struct PlainGraph {
  struct Level {
    std::vector<std::uint32_t> points;
    std::vector<std::vector<std::uint32_t>> neighbors;       // config.neighbors each, or fewer
    std::vector<std::vector<std::uint32_t>> pool_neighbors;  // config.pool_neighbors each
    std::vector<std::uint32_t> nearest;  // in this level, of each point of level 0
  };
  std::vector<Level> levels;
};

/// `points` in the order of a NeighborGrid: each level keeps every pool_rate-th. Brute force.
PlainGraph make_plain_graph(std::span<const Vec3f> points, const planes::NetworkConfig& config);

/// Logits of each point, h then v.
template <typename Real>
std::vector<std::array<Real, 2>> plain_forward(const PlainNetwork<Real>& network,
                                               const PlainGraph& graph,
                                               std::span<const Vec3f> points);

}  // namespace planescope::lab
