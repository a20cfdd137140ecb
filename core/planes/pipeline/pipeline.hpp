#pragma once

// Recording -> Frame -> Cloud -> voxel grid -> labels -> Octree -> traverse -> merge -> assign,
// every intermediate kept, so that the desktop and the report can show any stage.

#include <memory>
#include <optional>
#include <span>
#include <string>

#include "core/model/frame.hpp"
#include "core/planes/classify/classifier.hpp"
#include "core/planes/cloud/cloud.hpp"
#include "core/planes/cloud/gravity.hpp"
#include "core/planes/depth/known.hpp"
#include "core/planes/foot/options.hpp"
#include "core/planes/pipeline/method.hpp"
#include "core/planes/segment/segment.hpp"
#include "core/planes/stairs/stairs_options.hpp"

namespace planescope::planes {

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

/// `classifier`: of these options (classifiers.hpp), null to take the labels of `truth`. Rivals,
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

}  // namespace planescope::planes
