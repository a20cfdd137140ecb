#pragma once

// What ours is held against beside the rivals that the product has: methods of PCL and CGAL, and
// classifiers, their results and their speed.

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

/// A method of PCL or CGAL, on one thread and the same to the byte each time. Their options are
/// tuned by mean IoU and panoptic quality (docs/method.md, "Further rivals"): on depth images and
/// their 2 cm voxels, and `by_point` on the paper's stairs of 8192 points.
struct LibraryRival {
  const char* name;  // in results: "pcl-region-growing"
  planes::FoundPlanes (*on_pixels)(const planes::PixelPoints& pixels);  // of depth images, or null:
  planes::FoundPlanes (*on_points)(std::span<const Vec3f> points, bool by_point);
};
/// None in builds without -DPLANESCOPE_RIVALS=ON.
const std::vector<LibraryRival>& library_rivals();
/// Null where it is none of them.
const LibraryRival* find_library_rival(const std::string& name);

/// All rivals of this build by name, first those of the product. `images`: also those for depth
/// images alone.
std::vector<std::string> rival_names(bool images);

/// As run_frame(), of any method: `rival` null takes that of the options. Throws Error where one
/// for depth images is given a cloud.
planes::FrameResult run_method(const Frame& frame,
                               const planes::PipelineOptions& options,
                               const planes::Classifier* classifier,
                               const LibraryRival* rival);

// PCL 1.13 and CGAL 5.5, as Debian packages them.

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

/// PCA normals as they are commonly computed, nanoflann's k-d tree for the neighbours and Eigen's
/// closed form for the normal: what our classifiers' speed is held against. Labels differ from
/// those of make_pca_classifier() where several points are equally far, or a normal lies at the
/// boundary.
std::unique_ptr<planes::Classifier> make_nanoflann_pca_classifier(
    const planes::PcaClassifierOptions& options = {});

// 3D-GCN again, written straight from its equations: the reference for the fast one's results and
// speed.

template <typename Real>
struct PlainNetwork {
  planes::NetworkConfig config;
  std::vector<std::vector<Real>> tensors;  // by tensor_specs(config)
};

/// For each level its points, as indices of points of level 0, and for each point the nearest
/// others, as indices of this level.
struct PlainGraph {
  struct Level {
    std::vector<std::uint32_t> points;
    std::vector<std::vector<std::uint32_t>> neighbours;       // config.neighbours each, or fewer
    std::vector<std::vector<std::uint32_t>> pool_neighbours;  // config.pool_neighbours each
    std::vector<std::uint32_t> nearest;  // of each point of level 0 the nearest of this level
  };
  std::vector<Level> levels;
};

/// `points` in the order of a NeighbourGrid: every pool_rate-th goes on. All distances are tried.
PlainGraph make_plain_graph(std::span<const Vec3f> points, const planes::NetworkConfig& config);

/// Logits of each point, h then v.
template <typename Real>
std::vector<std::array<Real, 2>> plain_forward(const PlainNetwork<Real>& network,
                                               const PlainGraph& graph,
                                               std::span<const Vec3f> points);

}  // namespace planescope::lab
