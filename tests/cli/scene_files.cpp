// Builds the floor-and-wall recording and cloud for command-line tests.

#include "cli/scene_files.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include "cli/program.hpp"
#include "core/io/image/png.hpp"

namespace planescope::testing_cli {
namespace fs = std::filesystem;
namespace {

constexpr int kWidth = 160, kHeight = 120;
constexpr double kFocal = 120, kCx = 80, kCy = 60;
constexpr double kCameraHeightM = 0.5, kWallM = 1.2;

double depth_m(int v) {
  const double below = (v - kCy) / kFocal;
  return below > 0 ? std::min(kWallM, kCameraHeightM / below) : kWallM;
}

}  // namespace

Image16 floor_and_wall() {
  Image16 depth(kWidth, kHeight);
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u)
      depth.at(u, v) = static_cast<std::uint16_t>(std::lround(depth_m(v) * 1000));
  return depth;
}

FrameLabels floor_and_wall_labels(const io::Recording& recording, int frame) {
  const Image16 depth = floor_and_wall();
  FrameLabels labels;
  labels.depth_sha256 = recording.frame_hash(frame);
  labels.intrinsics = recording.info().intrinsics;
  labels.plane = Image16(depth.width, depth.height);
  labels.hv = Image8(depth.width, depth.height);
  for (std::size_t i = 0; i < depth.data.size(); ++i) {
    const bool wall = depth.data[i] == 1200;
    labels.plane.data[i] = wall ? 2 : 1;
    labels.hv.data[i] = wall ? 2 : 1;
  }
  labels.planes.resize(2);
  labels.planes[0] = {1, Label::h, Vec3d(0, -1, 0), -0.5, 0, 0.01, 1};
  labels.planes[1] = {2, Label::v, Vec3d(0, 0, -1), -1.2, 0, 0.01, 1};
  labels.review_state = "reviewed";
  return labels;
}

void write_text(const fs::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

std::filesystem::path scratch_with_rec(int frames) {
  const std::filesystem::path dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), frames);
  return dir;
}

void write_true_labels(const std::filesystem::path& recording,
                       const std::filesystem::path& to,
                       int frame) {
  labels::write_frame_labels(to, frame,
                             floor_and_wall_labels(*io::open_recording(recording), frame));
}

void write_intrinsics(const fs::path& dir, int width, int height) {
  write_text(dir / "camera_intrinsic.json",
             "{\"width\": " + std::to_string(width) + ", \"height\": " + std::to_string(height) +
                 ", \"intrinsic_matrix\": [120, 0, 0, 0, 120, 0, 80, 60, 1]}\n");
}

void write_depth_folder(const fs::path& dir, const Image16& depth, int frames) {
  fs::create_directories(dir / "depth");
  for (int i = 0; i < frames; ++i) {
    std::string name = std::to_string(i);
    name.insert(0, 6 - name.size(), '0');
    io::write_png(dir / "depth" / (name + ".png"), depth);
  }
  write_intrinsics(dir, depth.width, depth.height);
}

PointSet floor_and_wall_cloud() {
  PointSet set;
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) {
      const double z = depth_m(v);
      const double right = (u - kCx) / kFocal * z, down = (v - kCy) / kFocal * z;
      set.points.emplace_back(static_cast<float>(z), static_cast<float>(-right),
                              static_cast<float>(-down));
      const bool wall = z >= kWallM;
      set.label.push_back(wall ? 2 : 1);
      set.instance.push_back(wall ? 2 : 1);
    }
  return set;
}

}  // namespace planescope::testing_cli
