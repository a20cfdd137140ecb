// One picture with everything in it, for both themes, left in the test's temporary folder to be
// looked at.

#include <cmath>
#include <random>

#include "core/io/image/png.hpp"
#include "gl_fixture.hpp"
#include "render/palette.hpp"

namespace planescope::render {
namespace {

struct Gallery : GlTest {};

// A flight of three steps before a wall: points with noise, a box per 20 cm of them, its planes.
struct Stairs {
  std::vector<Vec3f> points;
  std::vector<int> plane;  // of each point
  std::vector<DrawPolygon> planes;
};

void add_rectangle(Stairs& stairs, Vec3f corner, Vec3f u, Vec3f v, std::mt19937& random) {
  const int id = static_cast<int>(stairs.planes.size()) + 1;
  std::normal_distribution<float> noise(0.0f, 0.002f);
  const Vec3f normal = u.cross(v).normalized();
  const float step = 0.02f;
  for (float s = step / 2; s < u.norm(); s += step) {
    for (float t = step / 2; t < v.norm(); t += step) {
      stairs.points.push_back(corner + u.normalized() * s + v.normalized() * t +
                              normal * noise(random));
      stairs.plane.push_back(id);
    }
  }
  Rgba fill = plane_color(id);
  fill.a = 70;
  stairs.planes.push_back(
      {{corner, corner + u, corner + u + v, corner + v}, fill, plane_color(id), 2, 0});
}

Stairs make_stairs() {
  Stairs stairs;
  std::mt19937 random(7);
  add_rectangle(stairs, {0, -0.6f, 0}, {0.5f, 0, 0}, {0, 1.2f, 0}, random);
  for (int i = 0; i < 3; ++i) {
    const float x = 0.5f + 0.28f * static_cast<float>(i);
    const float z = 0.16f * static_cast<float>(i);
    add_rectangle(stairs, {x, -0.6f, z}, {0, 1.2f, 0}, {0, 0, 0.16f}, random);
    add_rectangle(stairs, {x, -0.6f, z + 0.16f}, {0.28f, 0, 0}, {0, 1.2f, 0}, random);
  }
  add_rectangle(stairs, {0, 0.6f, 0}, {1.34f, 0, 0}, {0, 0, 0.9f}, random);
  return stairs;
}

Camera stairs_camera() {
  Camera camera;
  camera.eye = Vec3d(-1.1, -1.5, 1.5);
  camera.target = Vec3d(0.65, 0, 0.2);
  return camera;
}

DrawList planes_scene(const Stairs& stairs) {
  DrawList list;
  DrawPoints cloud;
  cloud.positions = stairs.points;
  cloud.size_m = 0.026f;  // a little more than their spacing: no gaps
  for (const int id : stairs.plane) cloud.colors.push_back(plane_color(id));
  list.points.push_back(cloud);
  list.polygons = stairs.planes;
  for (std::size_t i = 0; i < stairs.planes.size(); ++i) {
    const std::vector<Vec3f>& c = stairs.planes[i].corners;
    const Vec3f middle = 0.25f * (c[0] + c[1] + c[2] + c[3]);
    Vec3f normal = (c[1] - c[0]).cross(c[2] - c[0]).normalized();
    if (normal.dot(Vec3f(-1, -1, 1)) < 0) normal = -normal;
    list.arrows.push_back({middle, middle + 0.16f * normal, stairs.planes[i].outline, 3});
    list.labels.push_back({middle, std::to_string(i + 1), stairs.planes[i].outline, 15, true});
    list.legend.push_back({LegendEntry::Mark::dot, stairs.planes[i].outline,
                           "plane " + std::to_string(i + 1) + (i % 2 == 1 ? "  v" : "  h")});
  }
  list.title = "Planes";
  list.subtitle = "frame 0 · 8 planes · σ 2.0 mm, α ≤ 0.1°, 2 × 10² µm² ± θ τ";
  return list;
}

DrawList cases_scene(const Stairs& stairs) {
  DrawList list;
  DrawPoints cloud;
  cloud.positions = stairs.points;
  cloud.size_m = 0.012f;
  cloud.colors.assign(stairs.points.size(), Rgba{120, 124, 130});
  list.points.push_back(cloud);
  const auto box = [](int x, int y, int z, float edge, planes::Case c, BoxStyle style) {
    const Vec3f at(static_cast<float>(x), static_cast<float>(y), static_cast<float>(z));
    return DrawBox{box_corners(edge * at, edge * (at + Vec3f::Ones())), case_color(c), style, 0};
  };
  for (int y = -3; y < 3; ++y) {
    for (int x = 0; x < 2; ++x)
      list.boxes.push_back(box(x, y, 0, 0.2f, planes::Case::IV, BoxStyle::tinted));
    for (int k = 0; k < 4; ++k) {
      list.boxes.push_back(box(8, 4 * y + k, 2, 0.05f, planes::Case::II, BoxStyle::tinted));
      list.boxes.push_back(box(10, 4 * y + k, 3, 0.05f, planes::Case::I, BoxStyle::hatched));
      list.boxes.push_back(box(15, 4 * y + k, 3, 0.05f, planes::Case::III, BoxStyle::hatched));
    }
    list.boxes.push_back(box(5, y, 2, 0.2f, planes::Case::IV, BoxStyle::tinted));
    list.boxes.push_back(box(3, y, 1, 0.2f, planes::Case::III, BoxStyle::tinted));
  }
  list.boxes.push_back(
      {box_corners({0, -0.8f, -0.1f}, {1.6f, 0.8f, 1.5f}), {128, 132, 140}, BoxStyle::outline, 0});
  list.arrows.push_back({{0.2f, -0.9f, 0.9f}, {0.2f, -0.9f, 0.5f}, {60, 60, 60}, 4});
  list.labels.push_back({{0.2f, -0.9f, 0.95f}, "gravity", {90, 90, 90}, 14, true});
  list.title = "Octree nodes by case";
  list.subtitle = "124 nodes";
  list.legend = {
      {LegendEntry::Mark::box, case_color(planes::Case::I), "I  both labels: divided"},
      {LegendEntry::Mark::box, case_color(planes::Case::II), "II  too few inliers: leftovers"},
      {LegendEntry::Mark::box, case_color(planes::Case::III), "III  not flat: divided"},
      {LegendEntry::Mark::box, case_color(planes::Case::IV), "IV  plane candidate"},
      {LegendEntry::Mark::hatched_box, case_color(planes::Case::III), "undecided at maximum depth"},
      {LegendEntry::Mark::line, {128, 132, 140}, "cube"},
      {LegendEntry::Mark::arrow, {60, 60, 60}, "gravity"}};
  return list;
}

void save(const Image8& image, const char* name) {
  const std::string path = testing::TempDir() + name;
  io::write_png(path, image);
  const Image8 back = io::read_png_rgb(path);
  EXPECT_EQ(back.data, image.data) << path;
}

TEST_F(Gallery, EverySceneIsDrawnInBothThemes) {
  const Stairs stairs = make_stairs();
  const Camera camera = stairs_camera();
  const auto draw = [&](const DrawList& list, Theme theme) {
    return renderer().render(list, camera, 1200, 900, theme);
  };
  save(draw(planes_scene(stairs), Theme::light), "planescope_planes_light.png");
  save(draw(planes_scene(stairs), Theme::dark), "planescope_planes_dark.png");
  save(draw(cases_scene(stairs), Theme::light), "planescope_cases_light.png");
  save(draw(cases_scene(stairs), Theme::dark), "planescope_cases_dark.png");
}

}  // namespace
}  // namespace planescope::render
