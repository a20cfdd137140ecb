// Looks up methods and classifiers by name, and runs one frame from cloud to planes.

#include "core/planes/pipeline/pipeline.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <chrono>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/classify/gcn.hpp"
#include "core/planes/classify/weights.hpp"
#include "core/planes/depth/segment_depth.hpp"
#include "core/planes/segment/segment.hpp"

namespace planescope::planes {

// ---- Methods ----

namespace {

struct NamedMethod {
  Method method;
  const char* name;
};
constexpr std::array kMethods = {NamedMethod{Method::ours, "ours"},
                                 NamedMethod{Method::ransac, "ransac"},
                                 NamedMethod{Method::region_growing, "region-growing"}};

/// CMake option that would add the method to this program; null if the method is available.
const char* missing_option(Method method) {
  if (method == Method::ransac) return has_ransac() ? nullptr : "PLANESCOPE_OPEN3D";
  return nullptr;
}

}  // namespace

const char* to_string(Method method) { return kMethods[static_cast<std::size_t>(method)].name; }

const std::vector<Method>& built_methods() {
  static const std::vector<Method> methods = [] {
    std::vector<Method> built;
    for (const NamedMethod& named : kMethods)
      if (!missing_option(named.method)) built.push_back(named.method);
    return built;
  }();
  return methods;
}

Method parse_method(const std::string& text) {
  std::string known;
  for (const auto& [method, name] : kMethods) {
    const char* missing = missing_option(method);
    if (text == name && missing)
      throw Error("method '" + text + "' is not part of this build; configure it with -D" +
                  missing + "=ON (see docs/method.md)");
    if (text == name) return method;
    if (!missing) known += fmt::format("{}'{}'", known.empty() ? "" : ", ", name);
  }
  throw Error("unknown method '" + text + "'; expected one of " + known);
}

// ---- Classifiers ----

namespace {

namespace fs = std::filesystem;

ChosenClassifier from_weights(const fs::path& file, const std::string& name) {
  const NetworkWeights weights = read_weights(file);
  const NetworkConfig& config = weights.config;
  WeightsRecord record;
  record.file = file.filename().string();
  record.sha256 = sha256_hex_of_file(file);
  record.network = fmt::format("{}, {} parameters", config.name, parameter_count(config));
  record.training = weights.training;
  return {make_gcn_classifier(weights, name), std::move(record)};
}

}  // namespace

bool names_weights_file(const std::string& name) {
  std::error_code ignored;
  return name.find_first_of("./") != std::string::npos || fs::exists(name, ignored);
}

ChosenClassifier make_classifier(const PipelineOptions& options, const fs::path& shipped_weights) {
  const std::string& name = options.classifier;
  if (name == "truth") return {};
  if (name == "pca") return {make_pca_classifier(options.pca), std::nullopt};
  if (name == "gcn") return from_weights(shipped_weights, name);
  return from_weights(name, name);
}

// ---- Frames ----

namespace {

std::vector<PlaneRegion> regions_of(const std::vector<PlaneFit>& planes,
                                    const PreparedFrame& prepared) {
  std::vector<PlaneRegion> regions;
  for (const PlaneFit& fit : planes) {
    PlaneRegion region;
    region.founded = static_cast<std::int32_t>(regions.size());
    region.id = region.founded + 1;
    if (prepared.gravity.known())
      region.label = label_of_normal(fit.normal);  // majority label of
                                                   // the plane
    region.fit = fit;
    region.fit.normal = outward_normal(fit, region.label, prepared.sensor());
    regions.push_back(region);
  }
  return regions;
}

/// Points without a plane of their own get the plane of their voxel.
void set_planes_of_points(const PreparedFrame& prepared, FoundRegions& found) {
  found.plane_of.assign(prepared.cloud.points.size(), 0);
  for (std::size_t i = 0; i < found.plane_of.size(); ++i)
    if (const std::uint32_t voxel = prepared.voxels.voxel_of[i]; voxel != kNoVoxel)
      found.plane_of[i] = found.segmentation.plane_of[voxel];
}

/// Label of each voxel's plane, unknown if none; used in place of a classification.
std::vector<Label> labels_of_planes(const Segmentation& segmentation) {
  std::vector<Label> labels;
  labels.reserve(segmentation.plane_of.size());
  for (const std::int32_t id : segmentation.plane_of)
    labels.push_back(id > 0 ? segmentation.planes[static_cast<std::size_t>(id) - 1].label
                            : Label::unknown);
  return labels;
}

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
    throw Error("classifier 'truth' requires ground truth labels, but this frame has none");
  Classification known;
  for (const std::uint8_t label : vote_labels(voxels, truth->label))
    // Voxels without truth still need a class. Use h, because most of a frame is ground.
    known.labels.push_back(label == 2 ? Label::v : Label::h);
  known.margins.assign(known.labels.size(), 1.0f);
  return known;
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
  prepared.gravity = resolve_gravity(frame, options.gravity, options.cloud.max_range_m);

  Stopwatch watch;
  prepared.cloud = make_cloud(frame, prepared.gravity, options.cloud);
  prepared.timings.cloud_ms = watch.lap_ms();
  const bool on_pixels = prepared.of_pixels = is_found_on_pixels(frame, options);
  prepared.voxels = voxelize(prepared.cloud, on_pixels ? 0 : options.cloud.voxel_size_m);
  prepared.timings.t_d_ms = watch.lap_ms();
  if (options.method == Method::ours && prepared.gravity.known() && !on_pixels)
    prepared.classification = classify(prepared.voxels, classifier, truth, options.threads);
  else
    prepared.classification = unclassified(prepared.voxels);
  prepared.timings.t_c_ms = watch.lap_ms();
  return prepared;
}

bool finds_on_pixels(const PipelineOptions& options) {
  return options.method == Method::ours && options.segment.by_objective();
}

bool is_found_on_pixels(const Frame& frame, const PipelineOptions& options) {
  return finds_on_pixels(options) && !frame.is_cloud();
}

SegmentOptions segment_options(const PreparedFrame& prepared, const PipelineOptions& options) {
  SegmentOptions result = options.segment;
  if (!prepared.gravity.known()) {
    result.use_labels = false;
    result.one_label = Label::unknown;
  }
  return result;
}

namespace {

/// Throws Error if the planes do not match this depth image.
void check_given(const GivenPlanes& given, const DepthInput& input) {
  if (given.plane_of.width != input.image.width || given.plane_of.height != input.image.height)
    throw Error(fmt::format("stored planes are {}x{}; expected {}x{}", given.plane_of.width,
                            given.plane_of.height, input.image.width, input.image.height));
  for (std::size_t i = 0; i < given.plane_of.data.size(); ++i) {
    if (given.plane_of.data[i] > given.margins.size())
      throw Error(fmt::format("stored planes contain plane {}; expected at most {}",
                              given.plane_of.data[i], given.margins.size()));
    if (given.plane_of.data[i] > 0 && !(input.image.rho[i] > 0))
      throw Error(
          "stored planes do not match the depth; were frames added or removed since the map "
          "was created?");
  }
}

DepthInput depth_input(const Frame& frame,
                       const PreparedFrame& prepared,
                       std::span<const KnownPlane> known) {
  const Cloud& cloud = prepared.cloud;
  DepthInput input{.image = {.width = cloud.width,
                             .height = cloud.height,
                             .unit_m = frame.depth_unit_m,
                             .rho = std::vector<float>(frame.depth.pixels(), 0.0f)},
                   .points = prepared.voxels.points,
                   .pixel = {},
                   .space = {.fx = frame.intrinsics.fx,
                             .fy = frame.intrinsics.fy,
                             .cx = frame.intrinsics.cx,
                             .cy = frame.intrinsics.cy},
                   .sensor = prepared.sensor(),
                   .gravity_known = prepared.gravity.known(),
                   .known = known,
                   .given = frame.given.get()};
  input.space.T_local_camera.linear() = cloud.T_world_sensor.linear();
  input.space.T_local_camera.translation() = prepared.sensor();
  input.pixel.reserve(prepared.voxels.points.size());
  std::uint16_t farthest = 1;
  for (std::size_t i = 0; i < cloud.source.size(); ++i) {
    if (!cloud.kept[i]) continue;
    const std::uint32_t pixel = cloud.source[i];
    const std::uint16_t counts = frame.depth.data[pixel];
    farthest = std::max(farthest, counts);
    input.image.rho[pixel] = static_cast<float>(1 / (counts * frame.depth_unit_m));
    input.pixel.push_back(pixel);
  }
  input.space.farthest_m = farthest * frame.depth_unit_m;
  if (input.given) check_given(*input.given, input);
  return input;
}

}  // namespace

PixelPoints pixel_points(const Frame& frame, const PreparedFrame& prepared) {
  const Cloud& cloud = prepared.cloud;
  return {.points = cloud.points,
          .pixel = cloud.source,
          .kept = cloud.kept,
          .sensor = prepared.sensor().cast<float>(),
          .view = cloud.T_world_sensor.linear().col(2).cast<float>(),
          .width = frame.depth.width,
          .height = frame.depth.height};
}

FoundRegions regions_of_rival(const PreparedFrame& prepared, FoundPlanes planes, bool on_pixels) {
  FoundRegions found;
  Segmentation& segmentation = found.segmentation;
  segmentation.plane_of = std::move(planes.plane_of);
  if (on_pixels) {  // each voxel gets the plane of most of its points
    found.plane_of = std::move(segmentation.plane_of);
    segmentation.plane_of = vote_instances(prepared.voxels, found.plane_of);
  }
  segmentation.planes = regions_of(planes.planes, prepared);
  for (const std::int32_t id : segmentation.plane_of) {
    if (id > 0)
      ++segmentation.planes[static_cast<std::size_t>(id) - 1].points;
    else
      ++segmentation.counts.unassigned;
  }
  if (!on_pixels) set_planes_of_points(prepared, found);
  return found;
}

FoundRegions find_regions(const Frame& frame,
                          const PreparedFrame& prepared,
                          const PipelineOptions& options,
                          Trace* trace,
                          std::span<const KnownPlane> known) {
  FoundRegions found;
  if (is_found_on_pixels(frame, options) != prepared.of_pixels)
    throw Error("the frame was prepared for a different profile than the options specify");
  if (prepared.of_pixels) {
    Stopwatch watch;
    const DepthInput input = depth_input(frame, prepared, known);
    const double input_ms = watch.lap_ms();
    found.segmentation = segment_depth(input, segment_options(prepared, options), trace);
    found.segmentation.timings.build_ms += input_ms;
  } else if (options.method == Method::ours) {
    found.segmentation =
        segment(prepared.voxels.points, prepared.classification.labels, prepared.cloud.cube,
                prepared.sensor(), segment_options(prepared, options), trace);
  } else {
    Stopwatch watch;
    const RivalOptions& rivals = options.rivals;
    const bool on_pixels = options.method == Method::region_growing && !frame.is_cloud();
    const std::vector<Vec3f>& points = prepared.voxels.points;
    found = regions_of_rival(
        prepared,
        on_pixels ? grow_regions(pixel_points(frame, prepared), rivals.region_growing)
        : options.method == Method::ransac ? find_planes_ransac(points, rivals.ransac)
                                           : grow_regions(points, rivals.region_growing),
        on_pixels);
    found.segmentation.timings.traverse_ms = watch.lap_ms();
    return found;
  }
  set_planes_of_points(prepared, found);
  return found;
}

FrameResult run_frame(const Frame& frame,
                      const PipelineOptions& options,
                      const Classifier* classifier,
                      const FrameTruth* truth,
                      Trace* trace,
                      std::span<const KnownPlane> known) {
  FrameResult result{prepare_frame(frame, options, classifier, truth), {}, {}};
  FoundRegions found = find_regions(frame, result, options, trace, known);
  result.segmentation = std::move(found.segmentation);
  result.plane_of = std::move(found.plane_of);
  if (options.method != Method::ours || is_found_on_pixels(frame, options))
    result.classification.labels = labels_of_planes(result.segmentation);
  result.timings.t_b_ms = result.segmentation.timings.build_ms;
  result.timings.t_s_ms = result.segmentation.timings.traverse_ms;
  return result;
}

}  // namespace planescope::planes
