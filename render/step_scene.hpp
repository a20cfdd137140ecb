#pragma once

// What one step of a run and what labels look like, in space and on the camera's image: pure
// functions, no GL. Of a step only what it knows is drawn: its queue, what is settled, planes as
// they are at that moment.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/labels/edit/edit.hpp"
#include "core/labels/model/grid.hpp"
#include "render/scenes.hpp"

namespace planescope::render {

enum class ColorBy : std::uint8_t {
  cases,
  planes,
  labels,
  margins,
  truth,
  camera,
  steppable,
  depth,  // this one and the next along a scale, below
  height,
  rms,
  distance
};
inline constexpr int kColorBys = 11;

/// What is shown of a step, by choice: a window keeps it as it is.
struct StepChoices {
  ColorBy color_by = ColorBy::cases;
  bool show_queue = true;     // outlines of the nodes that wait
  bool show_settled = true;   // boxes of settled nodes, colored by case
  bool show_numerals = true;  // their cases in numerals
  bool show_planes = true;    // outlines of the planes at this moment
  bool show_normals = true;
  bool show_names = true;
  bool show_points = true;
  double point_size = 1;                 // of voxels, in edges of one
  std::optional<ValueRange> range = {};  // of the colors along a scale; nothing: the run's own
  bool show_foot = false;     // of the finished planes: where the center of a foot may go
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
/// The depth camera's image with the same colors over it, each pixel in that of its voxel; one
/// picture pixel per depth pixel. Color is the color image where it is aligned, shaded depth
/// otherwise. Empty for cloud recordings.
Image8 image_backdrop(const debug::Subject& subject, Backdrop backdrop);
void paint_step(Image8& image, const debug::Run& run, const StepLook& look, double opacity);
/// Both at once.
Image8 image_step(const debug::Run& run, const StepLook& look, Backdrop backdrop, double opacity);

/// The voxels that a node, or a plane as it is at the step, holds.
std::vector<Vec3f> node_points(const debug::Run& run, std::int32_t node);
std::vector<Vec3f> plane_points(const debug::Run& run, std::int32_t plane, std::int32_t step);

// ---- What is known of each voxel at a step, and its color ----

/// What is known at a step, read from the timeline once for a whole picture.
struct StepState {
  const debug::Run& run;
  const StepLook& look;
  static constexpr std::int32_t kOpen = -1;      // plane of a voxel: not known yet
  static constexpr std::int32_t kLeftover = -2;  // in none, on the list of leftovers or dropped
  std::vector<planes::Case> case_of = {};        // per voxel: of the node that settled it
  std::vector<std::int32_t> plane_of = {};       // per voxel: plane of the trace
  // What the event that led here was about; -1 none.
  std::int32_t node = -1;  // its own, or that of its point
  std::int32_t plane = -1;
  std::int32_t other = -1;  // the second plane
  std::int32_t voxel = -1;
};
StepState step_state(const debug::Run& run, const StepLook& look);

/// Colors of marks, not of data.
struct MarkColors {
  Rgba selected;
  Rgba current;  // what the step's event is about
  Rgba marked;
  Rgba waiting;  // voxels not settled yet
};
MarkColors mark_colors(Theme theme);

/// Per voxel: 1 where it belongs to the node or the planes that is selected or that the step is
/// about. Empty where there is none, and where it is all of them: nothing recedes then.
std::vector<std::uint8_t> concerned_voxels(const StepState& state);

/// Per voxel, as the look asks, with single ones and the marked region standing out.
std::vector<Rgba> voxel_colors(const StepState& state);

/// What the colors show: only our method has cases and margins, for others planes and labels take
/// their place.
ColorBy told_by(const debug::Run& run, ColorBy asked);

/// A settled node that was not divided: its points are done with.
bool is_settled_leaf(const debug::Run& run, std::int32_t node, std::int32_t step);

// ---- What is measured of the voxels, in meters: what colors show along a scale ----

/// depth: along the camera's axis, in clouds the distance from their origin. height: along gravity,
/// above the camera or the cloud's origin. rms: of the plane that a point is in, of its settled
/// node where it is in none. distance: to the selected plane, to each point's own where none is;
/// positive on the side that the plane shows, above or before it.
bool is_along_scale(ColorBy by);

/// Why nothing is known of the quantity at the step; empty where it is.
std::string why_no_values(const debug::Run& run, const StepLook& look);

/// Per voxel; NaN where nothing is known of it.
std::vector<float> voxel_values(const StepState& state);

/// Its range is the same at every step: that of the points as the run leaves them, or `look`'s own.
ColorScale color_scale(const debug::Run& run, const StepLook& look);

/// "depth 1.234 m", "3.2 mm before P3"; empty where nothing is known of the voxel.
std::string value_text(const debug::Run& run, const StepLook& look, std::int32_t voxel);

// ---- Labels of a frame, in space and on the camera's image ----

/// Distances to a plane, as colors from -most_m, behind it, to +most_m, before it.
struct Residual {
  int plane = 0;                  // of the labels; 0: of the preview
  Vec3d normal = Vec3d::UnitZ();  // towards the sensor, in its frame: normal . x = offset
  double offset_m = 0, most_m = 0.016;
  std::string name;

  double distance_m(const Vec3f& point) const {
    return normal.dot(point.cast<double>()) - offset_m;
  }
  bool operator==(const Residual&) const = default;
};

/// What is drawn and what stands out.
struct LabelLook {
  std::shared_ptr<const FrameLabels> labels;      // null: none yet
  int plane = 0;                                  // the active one, brighter than others; 0: none
  bool show_class = false;                        // colors of h and v instead of the planes' own
  std::shared_ptr<const labels::LabelEdit> edit;  // that a gesture would make; null: none
  std::span<const std::uint32_t> preview;         // pixels that the wand found
  bool preview_takes = false;                     // ... to take labels off
  std::optional<Residual> residual;               // colors by distance, in place of labels
  std::span<const std::uint8_t> doubt;            // per pixel; empty: none
  std::span<const std::uint32_t> marked;          // pixels that a question is about
  Theme theme = Theme::dark;
};

/// What labels are drawn over, RGB per depth pixel: the camera's color where it is aligned, the
/// shape of surfaces otherwise.
Image8 label_ground(const labels::LabelGrid& grid, Backdrop backdrop);

/// How labels cover the ground, per pixel: alpha is their share. `opacity`: of labels, 0..1; what
/// stands out is seen however faint they are.
std::vector<Rgba> label_tints(const labels::LabelGrid& grid, const LabelLook& look, double opacity);

/// Labels over a copy of the ground, each plane with its outline. Hidden planes are left out.
void paint_labels(Image8& image,
                  const labels::LabelGrid& grid,
                  const LabelLook& look,
                  double opacity);

/// The points that are shown, by pixel: `world` of each, its id is pixel + 1. Colors are missing.
DrawPoints label_points(const labels::LabelGrid& grid,
                        std::span<const Vec3f> world,
                        std::span<const std::uint8_t> shown);
void color_label_points(DrawPoints& points,
                        const Image8& ground,
                        const labels::LabelGrid& grid,
                        const LabelLook& look);
/// Where a plane's name stands: on its pixel farthest from other labels.
struct LabelPlace {
  int plane = 0;
  std::uint32_t pixel = 0;
};
/// Of the planes that are shown, by id.
std::vector<LabelPlace> label_places(const FrameLabels& labels, const labels::LabelGrid& grid);

}  // namespace planescope::render
