#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/cloud_files/cloud_formats.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/sha256.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

/// Takes another field for `instance`; below 1 is no plane, as in labels by others.
PointSet read_with_instances(const fs::path& path, const std::string& field) {
  CloudExtras extras{{field}, {}};
  PointSet set = read_cloud_file(path, &extras);
  const std::vector<double>& values = extras.values[0];
  if (values.size() != set.points.size())
    throw Error(
        fmt::format("{}: points have no field '{}' to take plane ids from", path.string(), field));
  set.instance.clear();
  for (const double value : values) {
    if (!(value == std::floor(value) && std::abs(value) <= 1e9))
      throw Error(fmt::format("{}: field '{}' has {}, expected plane ids: whole numbers",
                              path.string(), field, value));
    set.instance.push_back(std::max(0, static_cast<std::int32_t>(value)));
  }
  return set;
}

class CloudRecording : public Recording {
 public:
  CloudRecording(const fs::path& path, std::string instance_field)
      : instance_field_(std::move(instance_field)), sidecar_(read_sidecar(path)) {
    info_.path = path;
    info_.depth_unit_m = 1;
    info_.depth_unit_source = "metres, as clouds have it";
    info_.color_note = "in the cloud, where it has any";
    if (tells_times(sidecar_)) info_.times_source = sidecar_.path.filename().string();
    std::error_code ignored;
    const bool folder = fs::is_directory(path, ignored);
    files_ = folder ? cloud_files_under(path) : std::vector<fs::path>{path};
    info_.format = files_.size() == 1 ? "point cloud" : "folder of point clouds";
    for (const fs::path& file : files_) {
      if (is_ply(file)) check_ply(file);
      if (is_pcd(file)) check_pcd(file);
      const fs::path name = folder ? file.lexically_relative(path) : file.filename();
      names_.push_back((name.parent_path() / name.stem()).string());
    }
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(files_.size()); }

  Frame frame(int i) const override {
    Frame frame;
    frame.index = i;
    frame.name = names_.at(i);
    frame.depth_unit_m = info_.depth_unit_m;
    frame.cloud = instance_field_.empty() ? read_cloud_file(files_.at(i))
                                          : read_with_instances(files_.at(i), instance_field_);
    apply_sidecar(sidecar_, frame);
    return frame;
  }

  double timestamp_s(int i) const override {
    Frame facts;
    facts.name = names_.at(i);
    apply_sidecar(sidecar_, facts);
    return facts.timestamp_s;
  }

  std::string frame_hash(int i) const override {
    const PointSet set = read_cloud_file(files_.at(i));
    std::vector<std::byte> bytes(sizeof(double) * 3 + set.points.size() * sizeof(Vec3f));
    std::memcpy(bytes.data(), set.origin.data(), sizeof(double) * 3);
    if (!set.points.empty()) {
      std::memcpy(bytes.data() + sizeof(double) * 3, set.points.data()->data(),
                  set.points.size() * sizeof(Vec3f));
    }
    return sha256_hex(bytes);
  }

 private:
  RecordingInfo info_;
  std::string instance_field_;
  Sidecar sidecar_;
  std::vector<fs::path> files_;
  std::vector<std::string> names_;
};

}  // namespace

PointSet read_cloud_file(const fs::path& path, CloudExtras* extras) {
  for (const CloudFormat& format : added_cloud_formats()) {
    if (extension(path) != format.extension) continue;
    if (extras) extras->values.assign(extras->names.size(), {});
    return format.read(path);
  }
  return is_ply(path) ? read_ply(path, extras) : read_pcd(path, extras);
}

std::unique_ptr<Recording> open_clouds(const fs::path& path, const RecordingOptions& options) {
  return std::make_unique<CloudRecording>(path, options.instance_field);
}

}  // namespace planescope::io
