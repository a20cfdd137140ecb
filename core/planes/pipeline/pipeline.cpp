#include "core/planes/pipeline/pipeline.hpp"

#include <algorithm>
#include <chrono>

#include "core/model/error.hpp"
#include "core/planes/pipeline/rival.hpp"

namespace planescope::planes {
namespace {

class Stopwatch {
 public:
  double lap_ms() {
    const auto now = Clock::now();
    const double ms = std::chrono::duration<double, std::milli>(now - last_).count();
    last_ = now;
    return ms;
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point last_ = Clock::now();
};

Classification classify(const VoxelCloud& voxels,
                        const Classifier* classifier,
                        const FrameTruth* truth,
                        int threads) {
  if (classifier) return classifier->classify(voxels.points, threads);
  if (!truth || std::ranges::all_of(truth->label, [](std::uint8_t label) { return label == 0; }))
    throw Error("classifier 'truth' needs ground truth labels, but this frame has none");
  Classification known;
  for (const std::uint8_t label : vote_labels(voxels, truth->label))
    // A voxel without truth still needs a class: h, as most of a frame is ground.
    known.labels.push_back(label == 2 ? Label::v : Label::h);
  known.margins.assign(known.labels.size(), 1.0f);
  return known;
}

/// Cropped points, thinned out: the rays of neighbouring pixels carry the same information.
std::vector<Vec3f> points_beyond(const Cloud& cloud) {
  constexpr std::size_t kStride = 8;
  std::vector<Vec3f> beyond;
  for (std::size_t i = 0; i < cloud.points.size(); i += kStride)
    if (!cloud.kept[i]) beyond.push_back(cloud.points[i]);
  return beyond;
}

PixelGrid pixel_grid(const Cloud& cloud, const VoxelCloud& voxels) {
  PixelGrid grid{cloud.width, cloud.height, cloud.focal_px, {}, {}};
  const std::size_t pixels = static_cast<std::size_t>(cloud.width) * cloud.height;
  grid.measured.resize(pixels);
  grid.point.assign(pixels, PixelGrid::kNoPoint);
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (voxels.voxel_of[i] != kNoVoxel) {
      grid.measured[cloud.source[i]] = cloud.points[i];
      grid.point[cloud.source[i]] = voxels.voxel_of[i];
    }
  return grid;
}

Classification unclassified(const VoxelCloud& voxels) {
  const std::size_t n = voxels.points.size();
  return {std::vector<Label>(n, Label::unknown), std::vector<float>(n, 0.0f)};
}

}  // namespace

PreparedFrame prepare_frame(const Frame& frame,
                            const PipelineOptions& options,
                            const Classifier* classifier,
                            const FrameTruth* truth) {
  PreparedFrame prepared;
  prepared.from_cloud = frame.is_cloud();
  prepared.gravity = resolve_gravity(frame, options.gravity);

  Stopwatch watch;
  prepared.cloud = make_cloud(frame, prepared.gravity, options.cloud);
  prepared.timings.cloud_ms = watch.lap_ms();
  prepared.voxels = voxelize(prepared.cloud, options.cloud.voxel_size_m);
  prepared.timings.t_d_ms = watch.lap_ms();
  if (options.method == Method::ours && prepared.gravity.known())
    prepared.classification = classify(prepared.voxels, classifier, truth, options.threads);
  else
    prepared.classification = unclassified(prepared.voxels);
  prepared.timings.t_c_ms = watch.lap_ms();
  return prepared;
}

SegmentOptions segment_options(const PreparedFrame& prepared, const PipelineOptions& options) {
  SegmentOptions result = options.segment;
  if (prepared.from_cloud) result.noise.sigma_by_range = false;
  if (!prepared.gravity.known()) {
    result.use_labels = false;
    result.one_label = Label::unknown;
  }
  return result;
}

Measurements more_measurements(const PreparedFrame& prepared, const SegmentOptions& options) {
  Measurements more;
  more.rays = !prepared.from_cloud;
  if (options.r8_voxel_spread.on && prepared.voxels.size_m > 0)
    more.spreads = voxel_spreads(prepared.cloud, prepared.voxels);
  if (options.split_disconnected.rule == SplitRule::seen && more.rays)
    more.beyond = points_beyond(prepared.cloud);
  if (needs_pixels(options) && prepared.cloud.width > 0)
    more.pixels = pixel_grid(prepared.cloud, prepared.voxels);
  return more;
}

FoundRegions find_regions(const Frame& frame,
                          const PreparedFrame& prepared,
                          const PipelineOptions& options,
                          Trace* trace) {
  FoundRegions found;
  if (options.method == Method::ours) {
    Stopwatch watch;
    const Measurements more = more_measurements(prepared, options.segment);
    const double more_ms = watch.lap_ms();
    found.segmentation =
        segment(prepared.voxels.points, prepared.classification.labels, prepared.cloud.cube,
                prepared.sensor(), segment_options(prepared, options), trace, more);
    for (const std::uint32_t pixel : prepared.cloud.source)
      if (!found.segmentation.plane_of_pixel.empty())
        found.plane_of.push_back(found.segmentation.plane_of_pixel[pixel]);
    found.segmentation.timings.traverse_ms += more_ms;
  } else {
    found = find_rival_regions(frame, prepared, options);
  }
  if (!found.plane_of.empty()) return found;
  found.plane_of.assign(prepared.cloud.points.size(), 0);
  for (std::size_t i = 0; i < found.plane_of.size(); ++i)
    if (const std::uint32_t voxel = prepared.voxels.voxel_of[i]; voxel != kNoVoxel)
      found.plane_of[i] = found.segmentation.plane_of[voxel];
  return found;
}

FrameResult run_frame(const Frame& frame,
                      const PipelineOptions& options,
                      const Classifier* classifier,
                      const FrameTruth* truth,
                      Trace* trace) {
  FrameResult result{prepare_frame(frame, options, classifier, truth), {}, {}};
  FoundRegions found = find_regions(frame, result, options, trace);
  result.segmentation = std::move(found.segmentation);
  result.plane_of = std::move(found.plane_of);
  if (options.method != Method::ours)
    result.classification.labels = labels_of_planes(result.segmentation);
  result.timings.t_b_ms = result.segmentation.timings.build_ms;
  result.timings.t_s_ms = result.segmentation.timings.traverse_ms;
  return result;
}

}  // namespace planescope::planes
