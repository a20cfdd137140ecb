// Maps ground truth to a frame's points, and scores results against it.

#include "core/planes/pipeline/truth.hpp"

#include <algorithm>
#include <cmath>

#include "core/model/error.hpp"
#include "core/planes/evaluate/metrics.hpp"

namespace planescope::planes {

SourceTruth truth_of_labels(const FrameLabels& labels) {
  SourceTruth truth;
  const std::size_t pixels = labels.plane.pixels();
  truth.values.label.resize(pixels);
  truth.values.instance.resize(pixels);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::uint8_t hv = labels.hv.empty() ? std::uint8_t{0} : labels.hv.data[i];
    truth.values.label[i] = hv <= 2 ? hv : std::uint8_t{0};
    const std::uint16_t id = labels.plane.data[i];
    truth.values.instance[i] = id == kPlaneIgnore ? -1 : id;
  }
  for (const LabelPlane& plane : labels.planes) {
    if (plane.id < 1) continue;
    if (truth.normals.size() < static_cast<std::size_t>(plane.id))
      truth.normals.resize(static_cast<std::size_t>(plane.id), Vec3d::Zero());
    truth.normals[static_cast<std::size_t>(plane.id) - 1] = plane.normal;
  }
  return truth;
}

std::optional<SourceTruth> truth_of_cloud(const PointSet& set) {
  if (set.label.empty() && set.instance.empty()) return std::nullopt;
  const std::size_t n = set.points.size();
  SourceTruth truth;
  truth.values.label = set.label;
  truth.values.label.resize(n, 0);
  for (std::uint8_t& label : truth.values.label)
    if (label > 2) label = 0;
  truth.values.instance = set.instance;
  truth.values.instance.resize(n, -1);  // h and v labels carry no information about planes
  return truth;
}

FrameTruth truth_on_points(const FrameTruth& truth, std::span<const std::uint32_t> source) {
  FrameTruth gathered;
  gathered.label.resize(source.size());
  gathered.instance.resize(source.size());
  for (std::size_t i = 0; i < source.size(); ++i) {
    gathered.label[i] = truth.label[source[i]];
    gathered.instance[i] = truth.instance[source[i]];
  }
  return gathered;
}

std::vector<std::uint32_t> measured_sources(const Frame& frame) {
  return make_cloud(frame, Gravity{}, CloudOptions{}).source;
}

LabeledCloud labeled_frame(const Frame& frame,
                           const PipelineOptions& options,
                           const SourceTruth& truth) {
  const Gravity gravity = resolve_gravity(frame, options.gravity, options.cloud.max_range_m);
  if (!gravity.known())
    throw Error("frame " + frame.name + ": h and v labels require gravity, but --gravity is none");
  const Cloud cloud = make_cloud(frame, gravity, options.cloud);
  const VoxelCloud voxels = voxelize(cloud, options.cloud.voxel_size_m);
  const FrameTruth on_points = truth_on_points(truth.values, cloud.source);
  const std::vector<std::uint8_t> votes = vote_labels(voxels, on_points.label);
  LabeledCloud labeled;
  labeled.kind = "recording";
  labeled.points = voxels.points;
  for (const std::uint8_t vote : votes) labeled.labels.push_back(static_cast<Label>(vote));
  return labeled;
}

// ---- Scores ----

namespace {

/// Truth on the points, with plane ids renumbered 1, 2, ... because label ids are arbitrary.
struct DenseTruth {
  FrameTruth on_points;
  std::vector<Vec3d> normals;  // by dense id - 1, sensor frame; zero where unknown
};

DenseTruth dense_truth(const Cloud& cloud, const SourceTruth& truth) {
  DenseTruth dense;
  dense.on_points = truth_on_points(truth.values, cloud.source);
  std::vector<std::int32_t> ids;
  for (const std::int32_t id : dense.on_points.instance)
    if (id > 0) ids.push_back(id);
  std::sort(ids.begin(), ids.end());
  ids.erase(std::unique(ids.begin(), ids.end()), ids.end());
  for (std::int32_t& id : dense.on_points.instance)
    if (id > 0)
      id =
          static_cast<std::int32_t>(std::lower_bound(ids.begin(), ids.end(), id) - ids.begin()) + 1;
  for (const std::int32_t id : ids) {
    const auto k = static_cast<std::size_t>(id) - 1;
    dense.normals.push_back(k < truth.normals.size() ? truth.normals[k] : Vec3d::Zero());
  }
  return dense;
}

/// Voxels of the result, or of the default size if planes were found on pixels.
VoxelCloud scored_voxels(const FrameResult& result) {
  return result.of_pixels ? voxelize(result.cloud, CloudOptions().voxel_size_m) : result.voxels;
}

/// Planes with fewer voxels become unscored points.
void ignore_small(DenseTruth& dense, const VoxelCloud& cloud, int least_voxels) {
  std::vector<int> voxels(dense.normals.size() + 1, 0);
  for (const std::int32_t plane : vote_instances(cloud, dense.on_points.instance))
    if (plane > 0) ++voxels[plane];
  for (std::int32_t& plane : dense.on_points.instance)
    if (plane > 0 && voxels[plane] < least_voxels) plane = -1;
}

/// Truth and result on the scored points, and plane normals in the world frame.
struct Scored {
  std::vector<Vec3f> points;
  std::vector<std::int32_t> true_planes, found_planes;
  std::vector<Label> true_labels, found_labels;
  std::vector<Vec3d> true_normals, found_normals;
  int min_truth_points = 1;

  void add(const Vec3f& point, const FrameTruth& truth, std::size_t i, int plane, Label label) {
    points.push_back(point);
    true_planes.push_back(truth.instance[i]);
    true_labels.push_back(static_cast<Label>(truth.label[i]));
    found_planes.push_back(plane);
    found_labels.push_back(label);
  }
  Metrics metrics() const {
    return evaluate({.points = points,
                     .truth = true_planes,
                     .found = found_planes,
                     .found_normals = found_normals,
                     .truth_normals = true_normals,
                     .truth_labels = true_labels,
                     .found_labels = found_labels,
                     .min_truth_points = min_truth_points});
  }
};

std::vector<Vec3d> turned(const std::vector<Vec3d>& normals, const Pose& T_world_sensor) {
  std::vector<Vec3d> world;
  for (const Vec3d& normal : normals) world.push_back(T_world_sensor.linear() * normal);
  return world;
}

void add_normals(Scored& scored, const FrameResult& result, const DenseTruth& truth) {
  for (const PlaneRegion& plane : result.segmentation.planes)
    scored.found_normals.push_back(plane.fit.normal);
  scored.true_normals = turned(truth.normals, result.cloud.T_world_sensor);
}

/// Omits label accuracy if points have no labels: without gravity, or for `refined` on pixels.
Metrics without_open_labels(Metrics metrics, const FrameResult& result) {
  if (!result.gravity.known() || result.of_pixels)
    metrics.label_accuracy_edge = metrics.label_accuracy_inner = std::nan("");
  return metrics;
}

Verdict verdict_of(std::int32_t truth, std::int32_t found, std::span<const int> found_of) {
  if (truth < 0) return Verdict::unscored;
  if (truth == 0) return found > 0 ? Verdict::invented : Verdict::right;
  if (found <= 0) return Verdict::missed;
  return found_of[static_cast<std::size_t>(truth) - 1] == found ? Verdict::right
                                                                : Verdict::wrong_plane;
}

}  // namespace

Metrics score_frame(const FrameResult& result,
                    const SourceTruth& truth,
                    const LeastTruePlane& least) {
  const Cloud& cloud = result.cloud;
  DenseTruth dense = dense_truth(cloud, truth);
  if (least.voxels > 0) ignore_small(dense, scored_voxels(result), least.voxels);
  Scored scored;
  scored.min_truth_points = least.points;
  for (std::size_t i = 0; i < cloud.points.size(); ++i) {
    const std::uint32_t voxel = result.voxels.voxel_of[i];
    if (voxel == kNoVoxel) continue;
    scored.add(cloud.points[i], dense.on_points, i, result.plane_of[i],
               result.classification.labels[voxel]);
  }
  add_normals(scored, result, dense);
  return without_open_labels(scored.metrics(), result);
}

Metrics score_voxels(const FrameResult& result, const SourceTruth& truth, int min_truth_voxels) {
  const DenseTruth dense = dense_truth(result.cloud, truth);
  const VoxelCloud voxels = scored_voxels(result);
  const FrameTruth of_voxels{vote_labels(voxels, dense.on_points.label),
                             vote_instances(voxels, dense.on_points.instance)};
  const std::vector<std::int32_t> planes =
      result.of_pixels ? vote_instances(voxels, result.plane_of) : result.segmentation.plane_of;
  Scored scored;
  for (std::size_t v = 0; v < voxels.points.size(); ++v)
    scored.add(voxels.points[v], of_voxels, v, planes[v],
               result.of_pixels ? Label::unknown : result.classification.labels[v]);
  add_normals(scored, result, dense);
  scored.min_truth_points = min_truth_voxels;
  return without_open_labels(scored.metrics(), result);
}

Metrics score_labels(const Frame& frame,
                     const FrameLabels& found,
                     const FrameLabels& truth,
                     const CloudOptions& options) {
  const Cloud cloud = make_cloud(frame, truth.gravity, options);
  const DenseTruth dense = dense_truth(cloud, truth_of_labels(truth));
  const DenseTruth other = dense_truth(cloud, truth_of_labels(found));
  Scored scored;
  for (std::size_t i = 0; i < cloud.points.size(); ++i)
    if (cloud.kept[i])
      scored.add(cloud.points[i], dense.on_points, i, std::max(0, other.on_points.instance[i]),
                 static_cast<Label>(other.on_points.label[i]));
  scored.found_normals = turned(other.normals, cloud.T_world_sensor);
  scored.true_normals = turned(dense.normals, cloud.T_world_sensor);
  return scored.metrics();
}

EvaluatedFrame evaluate_frame(const FrameResult& result, const SourceTruth& truth) {
  EvaluatedFrame evaluated;
  const DenseTruth dense = dense_truth(result.cloud, truth);
  evaluated.true_plane = dense.on_points.instance;
  std::vector<std::int32_t> scored = evaluated.true_plane;
  for (std::size_t i = 0; i < scored.size(); ++i)
    if (result.voxels.voxel_of[i] == kNoVoxel) scored[i] = -1;
  evaluated.found_of = found_of_truth(count_truth_overlap(scored, result.plane_of));
  evaluated.found_of.resize(dense.normals.size(), 0);  // cropped planes have no partner
  for (std::size_t i = 0; i < scored.size(); ++i) {
    const std::int32_t found = result.plane_of[i];
    Verdict verdict = verdict_of(scored[i], found, evaluated.found_of);
    if (verdict == Verdict::right && found > 0) {
      const auto label = static_cast<Label>(dense.on_points.label[i]);
      const Label taken_for = result.segmentation.planes[static_cast<std::size_t>(found) - 1].label;
      if (label != Label::unknown && taken_for != Label::unknown && label != taken_for)
        verdict = Verdict::wrong_class;
    }
    evaluated.verdict.push_back(verdict);
  }
  return evaluated;
}

}  // namespace planescope::planes
