// Code shared by the formats, and the formats that are lists of points: EVOPS, PLY, PCD,
// SemanticKITTI and voxels.

#include "core/labels/exchange/formats.hpp"

#include <cstring>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/model/text.hpp"
#include "core/planes/cloud/cloud.hpp"

namespace planescope::labels {

void check_count(std::uint64_t points, const std::string& where) {
  if (points > kMaxLabeledPoints)
    throw Error(where + ": " + std::to_string(points) + " points; expected at most " +
                std::to_string(kMaxLabeledPoints));
}

std::string printable(std::string_view text) {
  std::string result(text.substr(0, 60));
  for (char& c : result)
    if (c < ' ' || c > '~') c = '?';
  return result;
}

std::vector<std::int32_t> instances_of(std::span<const double> values, const std::string& where) {
  return whole_numbers<std::int32_t>(values, 0, kPlaneIgnore, where + ": plane id");
}

std::vector<std::uint8_t> classes_of(std::span<const double> values, const std::string& where) {
  auto classes = whole_numbers<std::uint8_t>(values, 0, kHvIgnore, where + ": class");
  for (std::size_t i = 0; i < classes.size(); ++i)
    if (classes[i] > 2 && classes[i] != kHvIgnore)
      throw Error(where + ": class " + std::to_string(classes[i]) + " at index " +
                  std::to_string(i) + "; expected 0 (unknown), 1 (h), 2 (v), or 255 (ignore)");
  return classes;
}

// EVOPS (https://github.com/MobileRoboticsSkoltech/EVOPS): a NumPy array with one plane id per
// point, 0 for none.

FileBytes evops_bytes(const LabeledPoints& points) {
  // Other readers would treat 65535 as another plane.
  std::vector<std::int32_t> ids = points.instance;
  for (std::int32_t& id : ids)
    if (id == kPlaneIgnore) id = 0;
  return npy_bytes("<i4", {ids.size()}, std::as_bytes(std::span(ids)));
}

LabeledPoints parse_evops(io::Bytes file, const std::string& where) {
  const NpyArray array = parse_npy(file, where);
  if (array.shape.size() != 1)
    throw Error(where + ": an array with " + counted(array.shape.size(), "dimension") +
                "; expected one plane id per point");
  check_count(array.size(), where);
  LabeledPoints points;
  points.instance = instances_of(array.values(), where);
  return points;
}

// PLY and PCD, with the fields of docs/labels.md.

namespace {

PointSet point_set_of(const LabeledPoints& points) {
  PointSet set;
  set.points = points.points;
  set.origin = points.origin;
  set.rgb = points.rgb;
  set.label = points.label;
  set.instance = points.instance;
  return set;
}

std::vector<io::IntField> pixel_fields_of(const LabeledPoints& points) {
  if (points.pixel.empty()) return {};
  io::IntField u{"u", {}}, v{"v", {}};
  for (const DepthPixel& pixel : points.pixel) {
    u.values.push_back(pixel.u);
    v.values.push_back(pixel.v);
  }
  return {std::move(u), std::move(v)};
}

}  // namespace

FileBytes labeled_ply_bytes(const LabeledPoints& points) {
  return io::ply_bytes(point_set_of(points), pixel_fields_of(points));
}

FileBytes labeled_pcd_bytes(const LabeledPoints& points) {
  return io::pcd_bytes(point_set_of(points), pixel_fields_of(points));
}

LabeledPoints read_labeled_cloud(const std::filesystem::path& path) {
  // label and instance exactly as in the file; PointSet clamps them.
  io::CloudExtras extras{{"label", "instance", "u", "v"}, {}};
  PointSet set = io::read_cloud_file(path, &extras);
  const std::string where = path.string();
  if (extras.values[1].empty() && !set.points.empty())
    throw Error(where + ": points have no \"instance\" field; expected a field with plane ids");
  LabeledPoints points;
  points.label = classes_of(extras.values[0], where);
  points.instance = instances_of(extras.values[1], where);
  const auto u = whole_numbers<std::uint16_t>(extras.values[2], 0, 65535, where + ": u");
  const auto v = whole_numbers<std::uint16_t>(extras.values[3], 0, 65535, where + ": v");
  if (!u.empty() && !v.empty())
    for (std::size_t i = 0; i < u.size(); ++i) points.pixel.push_back({u[i], v[i]});
  points.rgb = std::move(set.rgb);
  points.points = std::move(set.points);
  points.origin = set.origin;
  return points;
}

// SemanticKITTI (http://semantic-kitti.org/dataset.html): points as float32 x y z remission, and a
// uint32 per point: class in the lower and instance in the upper 16 bits.

namespace {

struct KittiPoint {
  float x, y, z, remission;
};
static_assert(sizeof(KittiPoint) == 16);

template <typename T>
FileBytes bytes_of(const std::vector<T>& values) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(values.data());
  return {bytes, bytes + values.size() * sizeof(T)};
}

void check_whole(io::Bytes file, std::size_t each, const std::string& what) {
  if (file.size() % each != 0)
    throw Error(what + ": " + std::to_string(file.size()) + " bytes; expected a multiple of " +
                std::to_string(each));
}

}  // namespace

FileBytes kitti_points_bytes(const LabeledPoints& points) {
  std::vector<KittiPoint> written;
  written.reserve(points.size());
  for (const Vec3f& about : points.points) {
    const Vec3f p = (points.origin + about.cast<double>()).cast<float>();
    written.push_back({p.x(), p.y(), p.z(), 0});
  }
  return bytes_of(written);
}

FileBytes kitti_label_bytes(const LabeledPoints& points) {
  std::vector<std::uint32_t> written(points.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    const std::uint32_t label = points.label.empty() ? 0u : points.label[i];
    written[i] = static_cast<std::uint32_t>(points.instance[i]) << 16 | label;
  }
  return bytes_of(written);
}

LabeledPoints parse_kitti(io::Bytes bin, io::Bytes label, const std::string& where) {
  check_whole(label, sizeof(std::uint32_t), where + ".label");
  check_whole(bin, sizeof(KittiPoint), where + ".bin");
  const std::size_t count = label.size() / sizeof(std::uint32_t);
  check_count(count, where + ".label");
  if (!bin.empty() && bin.size() / sizeof(KittiPoint) != count)
    throw Error(where + ".label: labels for " + std::to_string(count) + " points, but " + where +
                ".bin has " + std::to_string(bin.size() / sizeof(KittiPoint)));
  LabeledPoints points;
  std::vector<double> classes(count), instances(count);
  for (std::size_t i = 0; i < count; ++i) {
    std::uint32_t value;
    std::memcpy(&value, label.data() + i * sizeof(value), sizeof(value));
    classes[i] = value & 0xffff;
    instances[i] = value >> 16;
  }
  points.label = classes_of(classes, where + ".label");
  points.instance = instances_of(instances, where + ".label");
  for (std::size_t i = 0; i < bin.size(); i += sizeof(KittiPoint)) {
    KittiPoint p;
    std::memcpy(&p, bin.data() + i, sizeof(p));
    points.points.emplace_back(p.x, p.y, p.z);
  }
  return points;
}

// Reference for segmenters that work on voxels: the same upright voxels as our segmenter's, with
// the majority of their points' labels (0 has no vote).

FileBytes voxel_bytes(const LabeledPoints& points, double voxel_size_m) {
  if (!(voxel_size_m > 0) || !std::isfinite(voxel_size_m))
    throw Error(fmt::format("voxel size is {:g} m; expected more than 0 m", voxel_size_m));
  planes::Cloud cloud;
  cloud.T_world_sensor = points.T_world_sensor;
  const Eigen::Isometry3f T_world_sensor = points.T_world_sensor.cast<float>();
  double extent_m = 0;
  std::vector<std::uint8_t> label;
  std::vector<std::int32_t> instance;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3f& point = points.points[i];
    if (!point.allFinite() || point.isZero(0)) continue;  // of a cloud: no measurement
    if (!points.label.empty()) label.push_back(points.label[i]);
    instance.push_back(points.instance[i]);
    cloud.points.push_back(T_world_sensor * point);
    extent_m = std::max(extent_m, static_cast<double>(cloud.points.back().cwiseAbs().maxCoeff()));
  }
  cloud.kept.assign(cloud.points.size(), 1);  // labels are not cropped by range
  // Centered on the sensor and doubled like the segmenter's cube, so that the grids agree.
  while (cloud.cube.edge_m <= 2 * extent_m) cloud.cube.edge_m *= 2;
  cloud.cube.min_corner = Vec3d::Constant(-cloud.cube.edge_m / 2);

  const planes::VoxelCloud voxels = planes::voxelize(cloud, voxel_size_m);
  PointSet set;
  set.origin = points.T_world_sensor * points.origin;
  set.points = voxels.points;
  if (!label.empty()) set.label = planes::vote_labels(voxels, label);
  set.instance = planes::vote_instances(voxels, instance);
  return io::ply_bytes(set);
}

}  // namespace planescope::labels
