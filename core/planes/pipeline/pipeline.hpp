#pragma once

// Recording -> Frame -> Cloud -> voxel grid -> labels -> Octree -> traverse -> merge -> assign. All
// intermediate results are kept, so the desktop and the report can show any stage.

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/model/disjoint_sets.hpp"
#include "core/model/frame.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/cloud/cloud.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "core/planes/depth/inverse_depth.hpp"
#include "core/planes/result/options.hpp"
#include "core/planes/rivals/rivals.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::planes {

// ---- Methods ----

enum class Method : std::uint8_t {
  ours,
  ransac,  // from the paper; only in programs built with Open3D (has_ransac())
  region_growing,
};
/// Name as passed to --method: "region-growing".
const char* to_string(Method method);
Method parse_method(const std::string& text);  // throws Error listing the methods of this build
const std::vector<Method>& built_methods();    // ours first; constant for the process

/// Options of all methods except ours, which uses SegmentOptions.
struct RivalOptions {
  RansacOptions ransac;
  RegionGrowingOptions region_growing;
};

/// All user options for processing one frame.
struct PipelineOptions {
  CloudOptions cloud;
  GravityOptions gravity;
  PcaClassifierOptions pca;
  Method method = Method::ours;
  SegmentOptions segment = profile_options(Profile::refined);  // for our method
  RivalOptions rivals;                                         // for other methods
  FootOptions foot;                                            // footholds
  StairsOptions stairs;                                        // stairs
  std::string classifier = "gcn";  // gcn | pca | truth | path of a weights file
  int threads = 1;
};

/// Milliseconds, named as in Table IV of the paper.
struct FrameTimings {
  double load_ms = 0;
  double cloud_ms = 0;  // back-projection, crop, alignment
  double t_d_ms = 0;    // voxel grid
  double t_c_ms = 0;    // classification
  double t_b_ms = 0;    // octree
  double t_s_ms = 0;    // everything after the octree
};

/// Ground truth on the points of a frame's cloud, from label files or from the cloud's own fields.
struct FrameTruth {
  std::vector<std::uint8_t> label;     // per cloud point: 0 unknown, 1 h, 2 v
  std::vector<std::int32_t> instance;  // per cloud point: plane id, 0 none, -1 not scored
};

/// A frame prepared for segmentation: voxels and their labels.
struct PreparedFrame {
  Gravity gravity;
  Cloud cloud;
  VoxelCloud voxels;              // N_d = voxels.points.size()
  Classification classification;  // per voxel; unknown with margin 0 for rivals and if gravity
                                  // is unknown
  bool from_cloud = false;        // the frame is a cloud, with unknown sensor position
  bool of_pixels = false;         // is_found_on_pixels(): each voxel is a pixel
  FrameTimings timings;

  Vec3d sensor() const { return cloud.T_world_sensor.translation() - cloud.origin; }
};

struct FrameResult : PreparedFrame {
  Segmentation segmentation;           // per voxel
  std::vector<std::int32_t> plane_of;  // per cloud point: plane id, 0 none
};

/// `classifier`: from make_classifier() with these options; null to use the labels of `truth`.
/// Neither is needed for rivals and for frames whose gravity is `none`. Throws Error if gravity
/// cannot be resolved, or if both are null but one is needed.
PreparedFrame prepare_frame(const Frame& frame,
                            const PipelineOptions& options,
                            const Classifier* classifier,
                            const FrameTruth* truth = nullptr);

/// Whether planes of depth images are found on their pixels.
bool finds_on_pixels(const PipelineOptions& options);
/// Whether planes of this frame are found on its pixels, by segment_depth(). Each voxel is then
/// one pixel.
bool is_found_on_pixels(const Frame& frame, const PipelineOptions& options);

/// Effective segment options for this frame: labels are used only if gravity is known.
SegmentOptions segment_options(const PreparedFrame& prepared, const PipelineOptions& options);

/// Result of find_regions(). For rivals, the segmentation contains only planes and points: no
/// octree, no counts except `unassigned`, and an empty trace; a plane is h if its normal is within
/// 45 degrees of gravity. If gravity is unknown, planes are neither h nor v, and normals point
/// toward the sensor.
struct FoundRegions {
  Segmentation segmentation;           // per voxel
  std::vector<std::int32_t> plane_of;  // per cloud point: plane id, 0 none
};
/// Finds the planes of a prepared frame with the method in `options`, which must agree with the
/// options of prepare_frame() on pixels or voxels. `known`: candidate planes, used only if planes
/// are found on pixels and without a trace.
FoundRegions find_regions(const Frame& frame,
                          const PreparedFrame& prepared,
                          const PipelineOptions& options,
                          Trace* trace = nullptr,
                          std::span<const KnownPlane> known = {});

/// Measurements of a depth image, as input of methods that work on pixels.
PixelPoints pixel_points(const Frame& frame, const PreparedFrame& prepared);
/// Result of find_regions() for planes found by a rival, per pixel_points() point or per voxel.
FoundRegions regions_of_rival(const PreparedFrame& prepared, FoundPlanes planes, bool on_pixels);

/// Runs one frame: prepare_frame() and find_regions(). `trace` may be null. For rivals,
/// `classification` contains the labels of the voxels' planes, unknown elsewhere.
FrameResult run_frame(const Frame& frame,
                      const PipelineOptions& options,
                      const Classifier* classifier,
                      const FrameTruth* truth = nullptr,
                      Trace* trace = nullptr,
                      std::span<const KnownPlane> known = {});

// Sums of a frame's timings [ms].

/// From voxel grid to planes, summed as in Table IV of the paper: t_d + t_c + t_b + t_s.
inline double paper_ms(const FrameTimings& t) { return t.t_d_ms + t.t_c_ms + t.t_b_ms + t.t_s_ms; }

/// Includes reading and back-projection.
inline double total_ms(const FrameTimings& t) {
  return t.load_ms + t.cloud_ms + t.t_d_ms + t.t_c_ms + t.t_b_ms + t.t_s_ms;
}

/// Cloud points begin <= i < end, all on one plane.
struct PointRun {
  std::size_t begin = 0, end = 0;
};

/// Points of each plane in cloud order, by id - 1.
inline std::vector<std::vector<PointRun>> runs_of_planes(const FrameResult& result) {
  std::vector<std::vector<PointRun>> runs(result.segmentation.planes.size());
  for (std::size_t begin = 0, end = 0; begin < result.plane_of.size(); begin = end) {
    end = end_of_run(result.plane_of, begin);
    if (const std::int32_t id = result.plane_of[begin]; id > 0)
      runs[static_cast<std::size_t>(id) - 1].push_back({begin, end});
  }
  return runs;
}

/// Number of frames to process in parallel and, if fewer than threads, threads per frame.
struct FrameThreads {
  int at_once = 1;
  PipelineOptions pipeline;  // for one frame
};

inline FrameThreads threads_for_frames(const PipelineOptions& options, int frames) {
  FrameThreads threads{std::clamp(options.threads, 1, std::max(1, frames)), options};
  threads.pipeline.threads = std::max(1, options.threads / threads.at_once);
  return threads;
}

// ---- Classifiers ----

/// Identifies the weights of a classifier and their training.
struct WeightsRecord {
  std::string file;      // file name without folders
  std::string sha256;    // of the file
  std::string network;   // "compact, 27714 parameters"
  std::string training;  // JSON object: training record
};

struct ChosenClassifier {
  std::shared_ptr<const Classifier> classifier;  // null: use truth labels
  std::optional<WeightsRecord> weights;          // if it is a network
};

/// Whether `name` is a weights file rather than a classifier: contains '.' or '/', or exists.
bool names_weights_file(const std::string& name);

/// gcn | pca | truth | FILE. `shipped_weights`: weights of gcn. Throws Error if the weights cannot
/// be read; there is no fallback.
ChosenClassifier make_classifier(const PipelineOptions& options,
                                 const std::filesystem::path& shipped_weights);

}  // namespace planescope::planes
