#pragma once

// What one step of a run looks like, in space and on the camera's image: pure functions, no GL.
// Only what the step knows is drawn: its queue, what is settled, planes as they are at that moment.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/model/types.hpp"
#include "render/color_scale.hpp"
#include "render/draw_list.hpp"
#include "render/plane_scene.hpp"

namespace planescope::render {

enum class ColorBy : std::uint8_t {
  cases,
  planes,
  labels,
  margins,
  truth,
  camera,
  steppable,
  depth,  // this one and the next along a scale, step_values.hpp
  height,
  rms,
  distance
};
inline constexpr int kColorBys = 11;

/// What is shown of a step, by choice: a window keeps it as it is.
struct StepChoices {
  ColorBy color_by = ColorBy::cases;
  bool show_queue = true;     // outlines of the nodes that wait
  bool show_settled = true;   // boxes of settled nodes, coloured by case
  bool show_numerals = true;  // their cases in numerals
  bool show_planes = true;    // outlines of the planes at this moment
  bool show_normals = true;
  bool show_names = true;
  bool show_points = true;
  double point_size = 1;                 // of voxels, in edges of one
  std::optional<ValueRange> range = {};  // of the colours along a scale; nothing: the run's own
  bool show_foot = false;     // of the finished planes: where the centre of a foot may go
  bool show_stairs = false;   // between them: flights, kerbs and ramps
  bool isolated = false;      // what is selected or current alone, where there is such a thing
  Theme theme = Theme::dark;  // of marks, not of data

  bool operator==(const StepChoices&) const = default;
};

/// What is drawn and what stands out. -1: nothing.
struct StepLook : StepChoices {
  std::int32_t step = 0;
  bool show_current = true;  // what the step is about
  std::int32_t node = -1;    // selected
  std::int32_t plane = -1;   // of the trace
  std::int32_t voxel = -1;
  std::vector<std::uint32_t> marked = {};  // voxels of a region that the user marked
  // Of the run's planes as they are at its last step; null: not known yet. What has no outline, a
  // plane that still grows as well, is drawn as the convex hull of its voxels, fainter.
  std::shared_ptr<const PlaneScene> planes = {};
  std::vector<int> color_of_plane = {};  // color ids of the trace's planes; empty: their own
  std::vector<int> color_of_truth = {};  // the same of true planes, by id - 1
  // Planes of the world about it, in the scene; null: none.
  std::shared_ptr<const std::vector<DrawLines>> map = {};

  Rgba plane_color(std::int32_t of) const;  // a plane of the trace
  bool operator==(const StepLook&) const = default;
};

DrawList scene_step(const debug::Run& run, const StepLook& look);

/// What an id of Renderer::render_ids() stands for in a scene_step().
struct Picked {
  enum class Kind : std::uint8_t { nothing, voxel, node, plane };
  Kind kind = Kind::nothing;
  std::int32_t index = -1;
};
Picked picked(std::uint32_t id);

// Quick enough to be repainted at every step, except for the shading of depth, which depends on the
// frame alone: keep image_backdrop() and paint over copies of it.
enum class Backdrop : std::uint8_t { color, depth, edges };  // edges: of depth, over color
/// The depth camera's image with the same colours over it, each pixel in that of its voxel; one
/// picture pixel per depth pixel. Colour is the colour image where it is aligned, shaded depth
/// otherwise. Empty for cloud recordings.
Image8 image_backdrop(const debug::Subject& subject, Backdrop backdrop);
void paint_step(Image8& image, const debug::Run& run, const StepLook& look, double opacity);
/// Both at once.
Image8 image_step(const debug::Run& run, const StepLook& look, Backdrop backdrop, double opacity);

/// The voxels that a node, or a plane as it is at the step, holds.
std::vector<Vec3f> node_points(const debug::Run& run, std::int32_t node);
std::vector<Vec3f> plane_points(const debug::Run& run, std::int32_t plane, std::int32_t step);

}  // namespace planescope::render
