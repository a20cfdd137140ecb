// Renders synthetic scenes by ray casting: depth, color and exact labels.

#include "core/lab/synthetic/render_scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>

#include "core/lab/synthetic/repeatable.hpp"
#include "core/labels/model/pixel_sets.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::lab {

// ---- Ray casts ----

namespace {

/// A scene's polygons as half-spaces: exact ray casting, fast enough for a few dozen polygons.
struct CastScene {
  struct HalfSpace {
    Vec3d normal;  // inside: normal . x >= offset
    double offset = 0;
  };
  struct Polygon {
    HalfSpace plane;
    int first_edge = 0, edge_count = 0;
  };
  std::vector<Polygon> polygons;  // by index in Scene::surfaces
  std::vector<HalfSpace> edges;
};

struct Hit {
  int surface = -1;  // index in Scene::surfaces; -1: nothing
  double t = 0;      // origin + t * direction
};

// Despite rounding, rays at a seam of two polygons must hit one of them.
constexpr double kSeamM = 1e-9;

bool is_inside(const CastScene& scene, const CastScene::Polygon& polygon, const Vec3d& point) {
  for (int i = 0; i < polygon.edge_count; ++i) {
    const CastScene::HalfSpace& edge = scene.edges[polygon.first_edge + i];
    if (edge.normal.dot(point) < edge.offset - kSeamM) return false;
  }
  return true;
}

/// Parameter of the intersection with the polygon's plane; negative if there is none.
double crossing(const CastScene::HalfSpace& plane, const Vec3d& origin, const Vec3d& direction) {
  const double approach = plane.normal.dot(direction);
  if (approach == 0) return -1;
  return (plane.offset - plane.normal.dot(origin)) / approach;
}

CastScene make_cast_scene(const Scene& scene) {
  CastScene cast;
  for (const Surface& surface : scene.surfaces) {
    const auto& corners = surface.corners;
    CastScene::Polygon polygon;
    polygon.plane = {surface.normal, surface.normal.dot(corners[0])};
    polygon.first_edge = static_cast<int>(cast.edges.size());
    polygon.edge_count = static_cast<int>(corners.size());
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const Vec3d along = corners[(i + 1) % corners.size()] - corners[i];
      const Vec3d inward = surface.normal.cross(along).normalized();
      cast.edges.push_back({inward, inward.dot(corners[i])});
    }
    cast.polygons.push_back(polygon);
  }
  return cast;
}

/// The nearest surface with t > 0.
Hit first_hit(const CastScene& scene, const Vec3d& origin, const Vec3d& direction) {
  Hit hit;
  double nearest = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < scene.polygons.size(); ++i) {
    const double t = crossing(scene.polygons[i].plane, origin, direction);
    if (t <= 0 || t >= nearest) continue;
    if (!is_inside(scene, scene.polygons[i], origin + t * direction)) continue;
    nearest = t;
    hit = {static_cast<int>(i), t};
  }
  return hit;
}

/// Whether something is strictly between two points; `from` may be on a surface.
bool is_blocked(const CastScene& scene, const Vec3d& from, const Vec3d& to) {
  constexpr double kEnd = 1e-6;
  const Vec3d direction = to - from;
  for (const CastScene::Polygon& polygon : scene.polygons) {
    const double t = crossing(polygon.plane, from, direction);
    if (t > kEnd && t < 1 - kEnd && is_inside(scene, polygon, from + t * direction)) return true;
  }
  return false;
}

// ---- Textures ----

double lattice(std::int64_t x, std::int64_t y, std::uint64_t stream) {
  return 2 * random_uniform(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y), stream) -
         1;
}

/// Smooth noise in -1..1 with features of size 1.
double value_noise(double x, double y, std::uint64_t stream) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
  double tx = x - fx, ty = y - fy;
  tx *= tx * (3 - 2 * tx);
  ty *= ty * (3 - 2 * ty);
  const double low = (1 - tx) * lattice(ix, iy, stream) + tx * lattice(ix + 1, iy, stream);
  const double high = (1 - tx) * lattice(ix, iy + 1, stream) + tx * lattice(ix + 1, iy + 1, stream);
  return (1 - ty) * low + ty * high;
}

/// The cell of a pattern of rows (each shifted), and the distance to the cell's border [m].
struct Cell {
  std::int64_t row = 0, column = 0;
  double border_m = 0;
};
Cell cell_at(double u, double v, double length, double width, double shift_per_row) {
  Cell cell;
  cell.row = static_cast<std::int64_t>(std::floor(v / width));
  const double shifted = u / length + shift_per_row * static_cast<double>(cell.row);
  cell.column = static_cast<std::int64_t>(std::floor(shifted));
  const double du = (shifted - static_cast<double>(cell.column)) * length;
  const double dv = v - static_cast<double>(cell.row) * width;
  cell.border_m = std::min({du, length - du, dv, width - dv});
  return cell;
}

double planks(double u, double v, std::uint64_t stream) {
  const Cell board = cell_at(u, v, 1.1, 0.11, 0.37);
  if (board.border_m < 0.0018) return 0.35;
  const double tone = 0.16 * lattice(board.row, board.column, stream);
  const double offset = 17.0 * static_cast<double>(board.row);
  const double grain = value_noise(4 * u + offset, 90 * v, stream + 1);
  return 1 + tone + 0.12 * grain;
}

double bricks(double u, double v, std::uint64_t stream) {
  const Cell brick = cell_at(u, v, 0.22, 0.075, 0.5);
  if (brick.border_m < 0.005) return 1.45;
  return 1 + 0.22 * lattice(brick.row, brick.column, stream) +
         0.08 * value_noise(60 * u, 60 * v, stream + 1);
}

double pattern(Texture texture, double u, double v, std::uint64_t stream) {
  switch (texture) {
    case Texture::plain:
      return 1 + 0.03 * value_noise(5 * u, 5 * v, stream);
    case Texture::concrete:
      return 1 + 0.10 * value_noise(7 * u, 7 * v, stream) +
             0.06 * value_noise(31 * u, 31 * v, stream + 1) +
             0.05 * value_noise(120 * u, 120 * v, stream + 2);
    case Texture::asphalt:
      return 1 + 0.12 * value_noise(4 * u, 4 * v, stream) +
             0.45 * value_noise(140 * u, 140 * v, stream + 1);
    case Texture::planks:
      return planks(u, v, stream);
    case Texture::cardboard:
      return 1 + 0.05 * value_noise(9 * u, 9 * v, stream) +
             0.03 * value_noise(150 * u, 6 * v, stream + 1);
    case Texture::brick:
      return bricks(u, v, stream);
    case Texture::rubber:  // ribs across the slope
      return v - 0.05 * std::floor(v / 0.05) < 0.012 ? 0.55 : 1.0;
  }
  return 1;
}

/// Linear albedo at a point on a surface: its material's color with a procedural pattern.
Vec3d textured_albedo(const Surface& surface, int surface_index, const Vec3d& point) {
  // Patterns follow the first edge; on level surfaces they follow x, so that parts of one floor
  // join.
  const Vec3d u = (surface.corners[1] - surface.corners[0]).normalized();
  const Vec3d v = surface.normal.cross(u);
  const Vec3d local = point - surface.corners[0];
  const auto stream = 16 * static_cast<std::uint64_t>(surface_index);
  return pattern(surface.material.texture, u.dot(local), v.dot(local), stream) *
         surface.material.albedo;
}

// ---- Light ----

constexpr double kLampDistanceM = 20;
constexpr double kContactM = 0.35;  // distance at which a neighboring surface darkens

/// Ambient occlusion: the share of ambient light that reaches a point on a surface, 0..1, less
/// beside higher surfaces.
double openness(const Scene& scene, const CastScene& cast, int surface, const Vec3d& point) {
  // One short ray along each of a few directions.
  static const Vec3d kDirections[] = {{0.8, 0, 0.6},    {-0.8, 0, 0.6},   {0, 0.8, 0.6},
                                      {0, -0.8, 0.6},   {0.7, 0.7, 0.1},  {-0.7, 0.7, 0.1},
                                      {0.7, -0.7, 0.1}, {-0.7, -0.7, 0.1}};
  const Vec3d& normal = scene.surfaces[surface].normal;
  double open = 0, total = 0;
  for (const Vec3d& direction : kDirections) {
    const double weight = normal.dot(direction);
    if (weight <= 0.05) continue;
    total += weight;
    const Hit hit = first_hit(cast, point + 1e-5 * normal, direction);
    const double distance = hit.surface < 0 ? kContactM : std::min(hit.t, kContactM);
    open += weight * distance / kContactM;
  }
  return total > 0 ? open / total : 1;
}

/// Linear RGB of a point on a surface: its texture under a lamp that casts shadows, and under
/// ambient light from sky and ground, scaled by the openness of the point.
Vec3d shade(
    const Scene& scene, const CastScene& cast, int surface, const Vec3d& point, double open) {
  const Surface& s = scene.surfaces[surface];
  const double facing = s.normal.dot(scene.light);
  const bool lit = facing > 0 && !is_blocked(cast, point, point + kLampDistanceM * scene.light);
  const double sky = 0.5 + 0.5 * s.normal.z();
  const double ambient = (0.28 + 0.27 * sky) * (0.45 + 0.55 * open);
  const double lamp = lit ? 0.75 * facing : 0;
  const Vec3d light = ambient * Vec3d(0.94, 0.98, 1.06) + lamp * Vec3d(1.06, 1.0, 0.9);
  return textured_albedo(s, surface, point).cwiseProduct(light);
}

/// Linear light to 8-bit display values (gamma 2: exact square roots).
std::array<std::uint8_t, 3> to_display(const Vec3d& linear) {
  std::array<std::uint8_t, 3> rgb{};
  for (int c = 0; c < 3; ++c) {
    const double value = std::sqrt(std::clamp(linear[c], 0.0, 1.0));
    rgb[c] = static_cast<std::uint8_t>(std::lround(255 * value));
  }
  return rgb;
}

}  // namespace

// ---- Ground truth ----

namespace {

/// Nine digits: far below any measurement error, and printed identically on every machine.
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

/// RMS distance of each plane's measured pixels from it.
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

/// World direction of a pixel, scaled to depth 1.
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

/// Linear light along a ray. `near` is a nearby hit, whose openness is used for its surface.
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

/// Each pixel is the mean of four rays, which smooths edges and fine patterns.
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
