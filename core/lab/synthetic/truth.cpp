#include "core/lab/synthetic/truth.hpp"

#include <cmath>
#include <map>

#include "core/lab/synthetic/render_scene.hpp"
#include "core/labels/model/pixel_sets.hpp"

namespace planescope::lab {
namespace {

/// Nine digits are far below any error of measurement, and print the same on every machine.
double rounded(double x) { return std::round(x * 1e9) / 1e9; }
Vec3d rounded(const Vec3d& v) { return {rounded(v.x()), rounded(v.y()), rounded(v.z())}; }

/// In the sensor's frame, the normal towards the camera.
LabelPlane plane_in_view(const Surface& surface, const Pose& T_world_camera) {
  const double offset_in_world = surface.normal.dot(surface.corners[0]);
  LabelPlane plane;
  plane.id = surface.plane;
  plane.label = label_of_normal(surface.normal);
  plane.normal = rounded(Vec3d(T_world_camera.linear().transpose() * surface.normal));
  plane.offset_m = rounded(offset_in_world - surface.normal.dot(T_world_camera.translation()));
  return plane;
}

/// RMS distance of the measured pixels of each plane from it.
void set_rms(const Frame& frame, const Image16& ids, std::map<int, LabelPlane>& planes) {
  struct Sum {
    double squares = 0;
    double count = 0;
  };
  std::map<int, Sum> sums;
  const Intrinsics& k = frame.intrinsics;
  for (int y = 0; y < k.height; ++y) {
    for (int x = 0; x < k.width; ++x) {
      const int id = ids.at(x, y);
      const double z = frame.depth.at(x, y) * frame.depth_unit_m;
      if (id == 0 || z == 0) continue;
      const Vec3d point = z * Vec3d((x - k.cx) / k.fx, (y - k.cy) / k.fy, 1);
      const LabelPlane& plane = planes.at(id);
      const double distance = plane.normal.dot(point) - plane.offset_m;
      sums[id].squares += distance * distance;
      sums[id].count += 1;
    }
  }
  for (const auto& [id, sum] : sums)
    planes.at(id).rms_m = rounded(std::sqrt(sum.squares / sum.count));
}

}  // namespace

FrameLabels true_labels(const Scene& scene,
                        const Pose& T_world_camera,
                        std::span<const int> surfaces,
                        const Frame& frame) {
  FrameLabels labels;
  labels.depth_sha256 = depth_sha256(frame.depth);
  labels.intrinsics = frame.intrinsics;
  const Vec3d down = T_world_camera.linear().transpose() * Vec3d(0, 0, -1);
  labels.gravity = {rounded(down), GravitySource::sidecar, 1, "exact, from the synthetic scene"};
  labels.plane = Image16(frame.intrinsics.width, frame.intrinsics.height);
  labels.hv = Image8(frame.intrinsics.width, frame.intrinsics.height);
  std::map<int, LabelPlane> planes;
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    if (surfaces[i] < 0) continue;
    const Surface& surface = scene.surfaces[surfaces[i]];
    if (surface.plane == 0) continue;
    labels.plane.data[i] = static_cast<std::uint16_t>(surface.plane);
    labels.hv.data[i] = static_cast<std::uint8_t>(label_of_normal(surface.normal));
    planes.try_emplace(surface.plane, plane_in_view(surface, T_world_camera));
  }
  set_rms(frame, labels.plane, planes);
  const auto fragments = labels::count_fragments(labels.plane);
  for (auto& [id, plane] : planes) {
    plane.fragments = fragments[id];
    labels.planes.push_back(plane);
  }
  labels.annotator = "planescope synth";
  labels.review_state = "reviewed";
  return labels;
}

}  // namespace planescope::lab
