#include <cstring>

#include "core/labels/exchange/exchange_files.hpp"

// SemanticKITTI (http://semantic-kitti.org/dataset.html): points as float32 x y z remission, and
// for each a uint32, class in the lower and instance in the upper 16 bits.
namespace planescope::labels {
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
    throw Error(what + ": " + std::to_string(file.size()) + " bytes, expected a multiple of " +
                std::to_string(each));
}

}  // namespace

FileBytes kitti_points_bytes(const LabelledPoints& points) {
  std::vector<KittiPoint> written;
  written.reserve(points.size());
  for (const Vec3f& p : points.points) written.push_back({p.x(), p.y(), p.z(), 0});
  return bytes_of(written);
}

FileBytes kitti_label_bytes(const LabelledPoints& points) {
  std::vector<std::uint32_t> written(points.size());
  for (std::size_t i = 0; i < written.size(); ++i) {
    const std::uint32_t label = points.label.empty() ? 0u : points.label[i];
    written[i] = static_cast<std::uint32_t>(points.instance[i]) << 16 | label;
  }
  return bytes_of(written);
}

LabelledPoints parse_kitti(io::Bytes bin, io::Bytes label, const std::string& where) {
  check_whole(label, sizeof(std::uint32_t), where + ".label");
  check_whole(bin, sizeof(KittiPoint), where + ".bin");
  const std::size_t count = label.size() / sizeof(std::uint32_t);
  check_count(count, where + ".label");
  if (!bin.empty() && bin.size() / sizeof(KittiPoint) != count)
    throw Error(where + ".label: labels of " + std::to_string(count) + " points, " + where +
                ".bin has " + std::to_string(bin.size() / sizeof(KittiPoint)));
  LabelledPoints points;
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

}  // namespace planescope::labels
