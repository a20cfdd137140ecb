#include <algorithm>

#include "core/base/error.hpp"
#include "core/base/sha256.hpp"
#include "core/recording/cloud_file.hpp"
#include "core/recording/cloud_formats.hpp"
#include "core/recording/readers.hpp"
#include "core/recording/sniff.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;

class CloudRecording : public Recording {
 public:
  explicit CloudRecording(const fs::path& path) : sidecar_(read_sidecar(path)) {
    info_.path = path;
    info_.depth_unit_m = 1;
    info_.depth_unit_source = "metres, as clouds have it";
    info_.color_note = "in the cloud, where it has any";
    std::error_code ignored;
    const bool folder = fs::is_directory(path, ignored);
    files_ = folder ? cloud_files_under(path) : std::vector<fs::path>{path};
    info_.format = files_.size() == 1 ? "point cloud" : "folder of point clouds";
    for (const fs::path& file : files_) {
      if (is_ply(file)) {
        check_ply(file);
      } else {
        check_pcd(file);
      }
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
    frame.cloud = read_cloud_file(files_.at(i));
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
      std::memcpy(bytes.data() + sizeof(double) * 3, set.points.data(),
                  set.points.size() * sizeof(Vec3f));
    }
    return sha256_hex(bytes);
  }

 private:
  RecordingInfo info_;
  Sidecar sidecar_;
  std::vector<fs::path> files_;
  std::vector<std::string> names_;
};

}  // namespace

PointSet read_cloud_file(const fs::path& path, CloudExtras* extras) {
  return is_ply(path) ? read_ply(path, extras) : read_pcd(path, extras);
}

std::unique_ptr<Recording> open_clouds(const fs::path& path) {
  return std::make_unique<CloudRecording>(path);
}

}  // namespace planescope
