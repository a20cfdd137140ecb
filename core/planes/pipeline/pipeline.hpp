#pragma once

// Recording -> Frame -> Cloud -> voxel grid -> labels -> Octree -> traverse -> merge -> assign,
// every intermediate kept, so that the desktop and the report can show any stage.

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
  ransac,  // the paper's rivals; this one only in programs that have Open3D (has_ransac())
  region_growing,
};
/// As --method has it: "region-growing".
const char* to_string(Method method);
Method parse_method(const std::string& text);  // throws Error naming those that this build has
const std::vector<Method>& built_methods();    // ours first; the same for the whole process

/// Options of all methods but ours, which has SegmentOptions.
struct RivalOptions {
  RansacOptions ransac;
  RegionGrowingOptions region_growing;
};

/// Everything a user can set about the processing of one frame.
struct PipelineOptions {
  CloudOptions cloud;
  GravityOptions gravity;
  PcaClassifierOptions pca;
  Method method = Method::ours;
  SegmentOptions segment = profile_options(Profile::refined);  // of ours
  RivalOptions rivals;                                         // of all others
  FootOptions foot;                                            // of what is told about planes
  StairsOptions stairs;                                        // likewise
  std::string classifier = "gcn";  // gcn | pca | truth | path of a weights file
  int threads = 1;
};

/// Milliseconds, named as in the paper's table IV.
struct FrameTimings {
  double load_ms = 0;
  double cloud_ms = 0;  // back-projection, crop, alignment
  double t_d_ms = 0;    // voxel grid
  double t_c_ms = 0;    // classification
  double t_b_ms = 0;    // octree
  double t_s_ms = 0;    // all that follows
};

/// Truth of a frame on its cloud's points, from label files or from a cloud's own fields.
struct FrameTruth {
  std::vector<std::uint8_t> label;     // per cloud point: 0 unknown, 1 h, 2 v
  std::vector<std::int32_t> instance;  // per cloud point: plane id, 0 none, -1 not scored
};

/// A frame up to what the segmentation takes: voxels and their labels.
struct PreparedFrame {
  Gravity gravity;
  Cloud cloud;
  VoxelCloud voxels;              // N_d = voxels.points.size()
  Classification classification;  // per voxel; of rivals, and where gravity is not known: unknown,
                                  // with margins of 0
  bool from_cloud = false;        // the frame is a cloud: nobody knows where its sensor stood
  bool of_pixels = false;         // is_found_on_pixels() of the options: voxels are pixels
  FrameTimings timings;

  Vec3d sensor() const { return cloud.T_world_sensor.translation() - cloud.origin; }
};

struct FrameResult : PreparedFrame {
  Segmentation segmentation;           // per voxel
  std::vector<std::int32_t> plane_of;  // per cloud point: plane id, 0 none
};

/// `classifier`: of these options (make_classifier()), null to take the labels of `truth`. Rivals,
/// and frames whose gravity is `none`, need neither. Throws Error where gravity cannot be found, or
/// both are null.
PreparedFrame prepare_frame(const Frame& frame,
                            const PipelineOptions& options,
                            const Classifier* classifier,
                            const FrameTruth* truth = nullptr);

/// Whether the planes of depth images are found on their pixels.
bool finds_on_pixels(const PipelineOptions& options);
/// Whether the planes of this frame are found on its pixels, by segment_depth(). Its voxels are its
/// pixels then.
bool is_found_on_pixels(const Frame& frame, const PipelineOptions& options);

/// The segment options as they hold for this frame: labels are used only where gravity is known.
SegmentOptions segment_options(const PreparedFrame& prepared, const PipelineOptions& options);

/// Finds the planes of a prepared frame with the method of the options. Of a rival, the
/// segmentation has planes and points alone: no octree, no counts but `unassigned`, an empty trace;
/// a plane is h where its normal is within 45 degrees of gravity. Where gravity is not known,
/// planes are neither h nor v, and their normals point to the sensor's side.
struct FoundRegions {
  Segmentation segmentation;           // per voxel
  std::vector<std::int32_t> plane_of;  // per cloud point: plane id, 0 none
};
/// `known`: candidates where planes are found on pixels, without a trace.
/// The options find planes where those of prepare_frame() do, on pixels or not.
FoundRegions find_regions(const Frame& frame,
                          const PreparedFrame& prepared,
                          const PipelineOptions& options,
                          Trace* trace = nullptr,
                          std::span<const KnownPlane> known = {});

/// The measurements of a depth image, as methods for pixels take them.
PixelPoints pixel_points(const Frame& frame, const PreparedFrame& prepared);
/// find_regions() of a rival that found these planes, in points of pixel_points() or in voxels.
FoundRegions regions_of_rival(const PreparedFrame& prepared, FoundPlanes planes, bool on_pixels);

/// Runs one frame: prepare_frame() and find_regions(). `trace` may be null. Of a rival, the labels
/// are those of the voxels' planes, unknown elsewhere.
FrameResult run_frame(const Frame& frame,
                      const PipelineOptions& options,
                      const Classifier* classifier,
                      const FrameTruth* truth = nullptr,
                      Trace* trace = nullptr,
                      std::span<const KnownPlane> known = {});

// Sums of a frame's timings [ms].

/// From voxel grid to planes, as the paper's table IV adds it up: t_d + t_c + t_b + t_s.
inline double paper_ms(const FrameTimings& t) { return t.t_d_ms + t.t_c_ms + t.t_b_ms + t.t_s_ms; }

/// With reading and back-projection.
inline double total_ms(const FrameTimings& t) {
  return t.load_ms + t.cloud_ms + t.t_d_ms + t.t_c_ms + t.t_b_ms + t.t_s_ms;
}

/// Cloud points begin <= i < end, all of one plane.
struct PointRun {
  std::size_t begin = 0, end = 0;
};

/// By id - 1, the points of each plane in the cloud's order.
inline std::vector<std::vector<PointRun>> runs_of_planes(const FrameResult& result) {
  std::vector<std::vector<PointRun>> runs(result.segmentation.planes.size());
  for (std::size_t begin = 0, end = 0; begin < result.plane_of.size(); begin = end) {
    end = end_of_run(result.plane_of, begin);
    if (const std::int32_t id = result.plane_of[begin]; id > 0)
      runs[static_cast<std::size_t>(id) - 1].push_back({begin, end});
  }
  return runs;
}

/// Frames side by side and, if there are fewer frames than threads, several threads for each.
struct FrameThreads {
  int at_once = 1;
  PipelineOptions pipeline;  // of one frame
};

inline FrameThreads threads_for_frames(const PipelineOptions& options, int frames) {
  FrameThreads threads{std::clamp(options.threads, 1, std::max(1, frames)), options};
  threads.pipeline.threads = std::max(1, options.threads / threads.at_once);
  return threads;
}

// ---- Classifiers ----

/// Which weights a classifier has, and how they were trained.
struct WeightsRecord {
  std::string file;      // its name without folders
  std::string sha256;    // of the file
  std::string network;   // "compact, 27714 parameters"
  std::string training;  // a JSON object: how the weights were trained
};

struct ChosenClassifier {
  std::shared_ptr<const Classifier> classifier;  // null: truth
  std::optional<WeightsRecord> weights;          // where it is a network
};

/// Whether `name` is a weights file rather than the name of a classifier: something with a '.' or
/// '/' in it, or a file that is there.
bool names_weights_file(const std::string& name);

/// gcn | pca | truth | FILE. `shipped_weights`: those of gcn. Throws Error where weights cannot be
/// read; there is no fallback.
ChosenClassifier make_classifier(const PipelineOptions& options,
                                 const std::filesystem::path& shipped_weights);

}  // namespace planescope::planes
