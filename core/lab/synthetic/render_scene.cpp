#include "core/lab/synthetic/render_scene.hpp"

#include <cmath>
#include <map>

#include "core/lab/synthetic/ray_cast.hpp"
#include "core/lab/synthetic/shading.hpp"
#include "core/labels/model/pixel_sets.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::lab {

// ---- Ground truth ----

namespace {

/// Nine digits: far below any measurement error, and printed alike on every machine.
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

// ---- The camera's view ----

namespace {

/// Direction of a pixel, in the world frame, of depth 1.
Vec3d ray(const Intrinsics& k, const Pose& T_world_camera, double x, double y) {
  return T_world_camera.linear() * Vec3d((x - k.cx) / k.fx, (y - k.cy) / k.fy, 1);
}

SceneView look(const Scene& scene,
               const CastScene& cast,
               const Pose& T_world_camera,
               const D435Model& model) {
  const Intrinsics& k = model.intrinsics;
  const std::size_t pixels = static_cast<std::size_t>(k.width) * k.height;
  SceneView view{{std::vector<double>(pixels, 0), std::vector<float>(pixels, 0),
                  std::vector<bool>(pixels, false)},
                 std::vector<int>(pixels, -1)};
  const Vec3d eye = T_world_camera.translation();
  const Vec3d right_eye = T_world_camera * Vec3d(model.baseline_m, 0, 0);
  for (std::size_t i = 0; i < pixels; ++i) {
    const std::size_t row = i / k.width, column = i % k.width;
    const Vec3d direction =
        ray(k, T_world_camera, static_cast<double>(column), static_cast<double>(row));
    const Hit hit = first_hit(cast, eye, direction);
    if (hit.surface < 0) continue;
    view.surfaces[i] = hit.surface;
    view.depth.depth_m[i] = hit.t;
    const Vec3d& normal = scene.surfaces[hit.surface].normal;
    view.depth.cos_incidence[i] =
        static_cast<float>(std::abs(normal.dot(direction)) / direction.norm());
    if (model.noise)
      view.depth.in_both_eyes[i] = !is_blocked(cast, eye + hit.t * direction, right_eye);
  }
  return view;
}

/// Linear light along a ray. `near` is a hit close by, whose openness serves for its surface.
Vec3d light_along(const Scene& scene,
                  const CastScene& cast,
                  const Vec3d& eye,
                  const Vec3d& direction,
                  const Hit& near,
                  double near_open) {
  const Hit hit = first_hit(cast, eye, direction);
  if (hit.surface < 0) return {0.55, 0.68, 0.82};  // sky
  const Vec3d point = eye + hit.t * direction;
  const double open =
      hit.surface == near.surface ? near_open : openness(scene, cast, hit.surface, point);
  return shade(scene, cast, hit.surface, point, open);
}

/// Each pixel is the mean of four rays: edges and fine patterns come out smooth.
Image8 paint(const Scene& scene,
             const CastScene& cast,
             const Pose& T_world_camera,
             const Intrinsics& k) {
  constexpr double kOffsets[4][2] = {
      {-0.125, -0.375}, {0.375, -0.125}, {0.125, 0.375}, {-0.375, 0.125}};
  Image8 image(k.width, k.height, 3);
  const Vec3d eye = T_world_camera.translation();
  for (int y = 0; y < k.height; ++y) {
    for (int x = 0; x < k.width; ++x) {
      const Vec3d center = ray(k, T_world_camera, x, y);
      const Hit hit = first_hit(cast, eye, center);
      const double open =
          hit.surface < 0 ? 1 : openness(scene, cast, hit.surface, eye + hit.t * center);
      Vec3d sum = Vec3d::Zero();
      for (const auto& offset : kOffsets) {
        const Vec3d direction = ray(k, T_world_camera, x + offset[0], y + offset[1]);
        sum += light_along(scene, cast, eye, direction, hit, open);
      }
      const auto rgb = to_display(sum / 4);
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = rgb[c];
    }
  }
  return image;
}

}  // namespace

SceneView view_scene(const Scene& scene, const CameraPose& camera, const D435Model& model) {
  return look(scene, make_cast_scene(scene), pose_of(camera), model);
}

Frame render_scene(const Scene& scene,
                   const CameraPose& camera,
                   const D435Model& model,
                   std::uint64_t seed,
                   FrameLabels* truth) {
  const Pose T_world_camera = pose_of(camera);
  const CastScene cast = make_cast_scene(scene);
  const SceneView view = look(scene, cast, T_world_camera, model);

  Frame frame;
  frame.name = scene.name;
  frame.intrinsics = model.intrinsics;
  frame.depth_unit_m = model.depth_unit_m;
  frame.depth = measure_depth(view.depth, model, seed);
  if (model.color) {
    frame.color = paint(scene, cast, T_world_camera, model.intrinsics);
    frame.color_intrinsics = model.intrinsics;
    frame.color_aligned = true;
  }
  if (truth) *truth = true_labels(scene, T_world_camera, view.surfaces, frame);
  return frame;
}

std::string depth_sha256(const Image16& depth) {
  std::vector<std::byte> bytes;
  bytes.reserve(2 * depth.data.size());
  for (const std::uint16_t count : depth.data) {
    bytes.push_back(static_cast<std::byte>(count & 0xff));
    bytes.push_back(static_cast<std::byte>(count >> 8));
  }
  return sha256_hex(bytes);
}

}  // namespace planescope::lab
