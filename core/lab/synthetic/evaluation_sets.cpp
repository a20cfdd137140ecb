// Evaluation sets: their names, and generation of each frame from a seed.

#include "core/lab/synthetic/evaluation_sets.hpp"

#include <cassert>
#include <cstdio>
#include <map>

#include "core/lab/synthetic/render_scene.hpp"
#include "core/lab/synthetic/repeatable.hpp"
#include "core/lab/synthetic/scenes.hpp"
#include "core/lab/synthetic/stairs.hpp"
#include "core/model/error.hpp"

namespace planescope::lab {

// ---- The sets ----

namespace {

constexpr DepthErrors kAllErrors[] = {DepthErrors::clean, DepthErrors::noise, DepthErrors::d435};

}  // namespace

const char* to_string(DepthErrors errors) {
  switch (errors) {
    case DepthErrors::clean:
      return "clean";
    case DepthErrors::noise:
      return "noise";
    case DepthErrors::d435:
      break;
  }
  return "d435";
}

DepthErrors parse_depth_errors(const std::string& text) {
  for (const DepthErrors errors : kAllErrors)
    if (text == to_string(errors)) return errors;
  throw Error("unknown depth errors \"" + text + "\"; expected one of clean, noise, d435");
}

const std::vector<EvaluationSet>& evaluation_sets() {
  static const std::vector<EvaluationSet> sets = {
      {"stairs", "the paper's: a riser and a tread per step", false, 100},
      {"side_walls", "stairs between one or two walls that risers and treads meet", false, 24},
      {"open_risers", "treads as slabs 3 to 5 cm thick, floating one above the other over ground",
       false, 24},
      {"equal_boxes",
       "boxes of one height, 5 to 30 cm apart: coplanar tops, each a separate true plane", false,
       24},
      {"ramps", "a ramp of 5 to 25 degrees with its sides and level ground around it", false, 24},
      {"kerbs", "a kerb of 2 to 15 cm between road and pavement, straight or around a corner",
       false, 24},
      {"spiral", "wedge-shaped steps around a curved pole, which is not a plane", false, 24},
      {"depth_stairs",
       "a camera's views of stairs of 2 to 6 steps, half of them in front of a wall", true, 12},
      {"depth_boxes", "a camera's views of 3 to 6 boxes of several sizes and headings", true, 12},
      {"depth_slopes",
       "a camera's views of ramps of 5 to 35 degrees: alone, up to a pavement, or beside one", true,
       12},
      {"depth_descent", "a camera's views of stairs of 2 to 6 steps from the landing at their top",
       true, 12}};
  return sets;
}

const EvaluationSet& find_evaluation_set(const std::string& name) {
  std::string known;
  for (const EvaluationSet& set : evaluation_sets()) {
    if (set.name == name) return set;
    known += (known.empty() ? "" : ", ") + set.name;
  }
  throw Error("unknown evaluation set \"" + name + "\"; expected one of " + known);
}

// ---- Their frames ----

namespace {

/// The seed of a frame depends on its set's name, so adding a set does not change others.
std::uint64_t seed_of(const EvaluationSet& set, int index, std::uint64_t seed) {
  std::uint64_t stream = 0;
  for (const char c : set.name) stream = mix_bits(stream ^ static_cast<unsigned char>(c));
  return random_bits(seed, stream, static_cast<std::uint64_t>(index));
}

Gravity exact_gravity(const Vec3d& down) {
  return {down, GravitySource::sidecar, 1, "exact, from the synthetic scene"};
}

/// Ground truth of a scene, in a frame's coordinates.
void set_truth(EvaluationFrame& out, const Scene& scene, const Pose& T_frame_world) {
  out.frame.gravity = exact_gravity(T_frame_world.linear() * -Vec3d::UnitZ());
  out.normals.resize(scene.planes);
  for (const Surface& surface : scene.surfaces) {
    TruePolygon polygon{{}, surface.plane};
    for (const Vec3d& corner : surface.corners) polygon.corners.push_back(T_frame_world * corner);
    out.polygons.push_back(std::move(polygon));
    if (surface.plane > 0) out.normals[surface.plane - 1] = T_frame_world.linear() * surface.normal;
  }
  out.stairs = scene.stairs;
  if (!out.stairs) return;
  for (TrueStep& step : out.stairs->steps)
    for (Vec3d* end : {&step.right, &step.left}) *end = T_frame_world * *end;
}

void fill_stairs(EvaluationFrame& out, int index, const EvaluationOptions& options) {
  StairsOptions stairs_options;
  stairs_options.seed = options.seed;
  stairs_options.points = options.points;
  stairs_options.noise_m = options.noise_m;
  Stairs stairs = make_stairs(index, stairs_options);
  out.polygons = true_polygons(stairs);
  out.normals = std::move(stairs.normals);
  out.frame.cloud = std::move(stairs.cloud);
  out.frame.gravity = exact_gravity(-Vec3d::UnitZ());
}

/// Faces as triangles, and the surface of each.
struct Triangles {
  std::vector<Rectangle> faces;
  std::vector<std::uint32_t> surface;
};
Triangles triangles_of(const Scene& scene) {
  Triangles triangles;
  for (std::size_t s = 0; s < scene.surfaces.size(); ++s) {
    const Surface& surface = scene.surfaces[s];
    const std::vector<Vec3d>& corners = surface.corners;
    for (std::size_t i = 2; i < corners.size(); ++i) {
      triangles.faces.push_back({corners[0], corners[i - 1] - corners[0], corners[i] - corners[0],
                                 surface.normal, /*halved=*/true});
      triangles.surface.push_back(static_cast<std::uint32_t>(s));
    }
  }
  return triangles;
}

/// Points sampled on a scene's surfaces, as for stairs.
PointSet sample_cloud(const Scene& scene, const EvaluationOptions& options, Random& random) {
  const Triangles triangles = triangles_of(scene);
  const SurfacePoints sampled = sample_surface(
      triangles.faces, static_cast<std::size_t>(options.points), Mat3d::Identity(), random);
  PointSet cloud;
  for (std::size_t i = 0; i < sampled.points.size(); ++i) {
    const Surface& surface = scene.surfaces[triangles.surface[sampled.rectangle[i]]];
    cloud.points.push_back(with_noise(sampled.points[i], options.noise_m, random));
    cloud.instance.push_back(surface.plane);
    cloud.label.push_back(static_cast<std::uint8_t>(label_of_normal(surface.normal)));
  }
  return cloud;
}

void fill_cloud(EvaluationFrame& out,
                BuildScene build,
                std::uint64_t seed,
                const EvaluationOptions& o) {
  Random random(seed);
  Scene scene;
  build(scene, random);
  turn(scene, Vec3d::Zero(), random.uniform(0, 360));
  set_truth(out, scene, Pose::Identity());
  out.frame.cloud = sample_cloud(scene, o, random);
}

/// Whether a quarter-resolution preview finds at least three planes nearby.
bool shows_enough(const Scene& scene, const D435Model& model) {
  constexpr double kNearM = 1.5;
  constexpr int kPlanes = 3, kPixels = 160, kShrink = 4;
  D435Model small = model;
  small.noise = false;
  small.intrinsics =
      d435_intrinsics(model.intrinsics.width / kShrink, model.intrinsics.height / kShrink);
  const SceneView view = view_scene(scene, scene.camera, small);
  std::map<int, int> pixels;
  for (std::size_t i = 0; i < view.surfaces.size(); ++i)
    if (view.surfaces[i] >= 0 && view.depth.depth_m[i] < kNearM)
      ++pixels[scene.surfaces[view.surfaces[i]].plane];
  int planes = 0;
  for (const auto& [plane, count] : pixels)
    if (plane > 0 && count * kShrink * kShrink >= kPixels) ++planes;
  return planes >= kPlanes;
}

Scene build_view(BuildScene build, std::uint64_t seed, const D435Model& model) {
  for (std::uint64_t attempt = 0;; ++attempt) {
    assert(attempt < 1000);
    Random random(random_bits(seed, 1, attempt));
    Scene scene;
    build(scene, random);
    if (shows_enough(scene, model)) return scene;
  }
}

void fill_depth(EvaluationFrame& out, BuildScene build, std::uint64_t seed, DepthErrors errors) {
  D435Model model;
  model.noise = errors == DepthErrors::d435;
  model.color = false;
  const Scene scene = build_view(build, seed, model);
  const Pose T_world_camera = pose_of(scene.camera);
  const SceneView view = view_scene(scene, scene.camera, model);
  const std::uint64_t noise_seed = random_bits(seed, 2, 0);
  Frame& frame = out.frame;
  frame.intrinsics = model.intrinsics;
  frame.depth_unit_m = model.depth_unit_m;
  frame.depth = errors == DepthErrors::noise
                    ? measure_with_pixel_noise(view.depth, model, noise_seed)
                    : measure_depth(view.depth, model, noise_seed);
  out.labels = true_labels(scene, T_world_camera, view.surfaces, frame);
  set_truth(out, scene, T_world_camera.inverse());
}

}  // namespace

EvaluationFrame make_evaluation_frame(const EvaluationSet& set,
                                      int index,
                                      const EvaluationOptions& options) {
  char number[16];
  std::snprintf(number, sizeof(number), "_%03d", index);
  EvaluationFrame out;
  out.name = set.name + number;
  out.frame.name = out.name;
  out.frame.index = index;
  if (set.name == "stairs")
    fill_stairs(out, index, options);
  else if (set.depth)
    fill_depth(out, build_of_set(set.name), seed_of(set, index, options.seed), options.errors);
  else
    fill_cloud(out, build_of_set(set.name), seed_of(set, index, options.seed), options);
  return out;
}

}  // namespace planescope::lab
