#pragma once

// Draws single steps of a run, and labels, in space and on the camera's image: pure functions, no
// GL. A step shows only its own state: its queue, settled nodes, and planes at that time.

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
  depth,  // this and the following have a color scale
  height,
  rms,
  distance
};
inline constexpr int kColorBys = 11;

/// View settings of a step, stored by the window.
struct StepChoices {
  ColorBy color_by = ColorBy::cases;
  bool show_queue = true;     // outlines of queued nodes
  bool show_settled = true;   // boxes of settled nodes, colored by case
  bool show_numerals = true;  // cases as numerals
  bool show_planes = true;    // outlines of the planes at this step
  bool show_normals = true;
  bool show_names = true;
  bool show_points = true;
  double point_size = 1;                 // of voxels, relative to their edge
  std::optional<ValueRange> range = {};  // of the color scale; nullopt: the run's own
  bool show_foot = false;                // finished planes: area for the center of a foot
  bool show_stairs = false;              // finished planes: flights, kerbs and ramps
  bool isolated = false;                 // show only the selected or current object, if any
  Theme theme = Theme::dark;             // of highlights, not of data

  bool operator==(const StepChoices&) const = default;
};

/// Content and highlights of a step's picture. -1: none.
struct StepLook : StepChoices {
  std::int32_t step = 0;
  bool show_current = true;  // objects of the step's event
  std::int32_t node = -1;    // selected node
  std::int32_t plane = -1;   // plane of the trace
  std::int32_t voxel = -1;
  std::vector<std::uint32_t> marked = {};  // voxels of a region marked by the user
  // The run's planes at its last step; null: not known yet. Planes without an outline, including
  // those that still grow, are drawn as faint convex hulls of their voxels.
  std::shared_ptr<const PlaneScene> planes = {};
  std::vector<int> color_of_plane = {};  // color ids of the trace's planes; empty: their own ids
  std::vector<int> color_of_truth = {};  // same for true planes, by id - 1
  // Map planes around the scene; null: none.
  std::shared_ptr<const std::vector<DrawLines>> map = {};

  Rgba plane_color(std::int32_t of) const;  // for a plane of the trace
  bool operator==(const StepLook&) const = default;
};

DrawList scene_step(const debug::Run& run, const StepLook& look);

/// The object behind an id of Renderer::render_ids() in a scene_step().
struct Picked {
  enum class Kind : std::uint8_t { nothing, voxel, node, plane };
  Kind kind = Kind::nothing;
  std::int32_t index = -1;
};
Picked picked(std::uint32_t id);

// Fast enough to repaint at every step, except for shaded depth, which only depends on the frame:
// keep the result of image_backdrop() and paint on copies.
enum class Backdrop : std::uint8_t { color, depth, edges };  // edges: depth edges over color
/// The depth camera's image overlaid with the voxel colors, one picture pixel per depth pixel.
/// Backdrop::color uses the color image if aligned, otherwise shaded depth. Empty for clouds.
Image8 image_backdrop(const debug::Subject& subject, Backdrop backdrop);
void paint_step(Image8& image, const debug::Run& run, const StepLook& look, double opacity);
/// Combines both.
Image8 image_step(const debug::Run& run, const StepLook& look, Backdrop backdrop, double opacity);

/// The voxels of a node, or of a plane at the step.
std::vector<Vec3f> node_points(const debug::Run& run, std::int32_t node);
std::vector<Vec3f> plane_points(const debug::Run& run, std::int32_t plane, std::int32_t step);

// ---- State and color of voxels at a step ----

/// State at a step, read from the timeline once per picture.
struct StepState {
  const debug::Run& run;
  const StepLook& look;
  static constexpr std::int32_t kOpen = -1;      // plane of a voxel: not known yet
  static constexpr std::int32_t kLeftover = -2;  // unassigned: a leftover, or dropped
  std::vector<planes::Case> case_of = {};        // per voxel: case of the node that settled it
  std::vector<std::int32_t> plane_of = {};       // per voxel: plane of the trace
  // Objects of the event that led to this step; -1: none.
  std::int32_t node = -1;  // the event's node, or its point's node
  std::int32_t plane = -1;
  std::int32_t other = -1;  // the second plane
  std::int32_t voxel = -1;
};
StepState step_state(const debug::Run& run, const StepLook& look);

/// Colors of highlights, not of data.
struct HighlightColors {
  Rgba selected;
  Rgba current;  // objects of the step's event
  Rgba marked;
  Rgba waiting;  // voxels not settled yet
};
HighlightColors highlight_colors(Theme theme);

/// Per voxel: 1 if it belongs to the node or planes that are selected or of the step's event. Empty
/// if there are none, or if it would be all voxels; then nothing is faded.
std::vector<std::uint8_t> concerned_voxels(const StepState& state);

/// Color per voxel, including highlights of single voxels and of the marked region.
std::vector<Rgba> voxel_colors(const StepState& state);

/// The quantity that is actually shown: only our method has cases and margins; for others, planes
/// and labels replace them.
ColorBy effective_color_by(const debug::Run& run, ColorBy asked);

/// Whether the node is settled and was not divided, so that its points are final.
bool is_settled_leaf(const debug::Run& run, std::int32_t node, std::int32_t step);

// ---- Measured quantities of voxels in meters, for color scales ----

/// depth: along the camera's axis; for clouds, distance from the origin. height: against gravity,
/// above the camera or the cloud's origin. rms: of the point's plane or, if unassigned, of its
/// settled node. distance: to the selected plane or, without one, to each point's own plane;
/// positive on the plane's visible side (above or in front).
bool is_along_scale(ColorBy by);

/// Reason why the quantity is unavailable at the step; empty if available.
std::string why_no_values(const debug::Run& run, const StepLook& look);

/// Value per voxel; NaN if unknown.
std::vector<float> voxel_values(const StepState& state);

/// The range is the same for all steps: the range of the final points, or the range in `look`.
ColorScale color_scale(const debug::Run& run, const StepLook& look);

/// "depth 1.234 m", "3.2 mm in front of P3"; empty if the value is unknown.
std::string value_text(const debug::Run& run, const StepLook& look, std::int32_t voxel);

// ---- Labels of a frame, in space and on the camera's image ----

/// Distances to a plane, colored from -most_m (behind it) to +most_m (in front of it).
struct Residual {
  int plane = 0;                  // plane of the labels; 0: of the preview
  Vec3d normal = Vec3d::UnitZ();  // toward the sensor, in its frame: normal . x = offset
  double offset_m = 0, most_m = 0.016;
  std::string name;

  double distance_m(const Vec3f& point) const {
    return normal.dot(point.cast<double>()) - offset_m;
  }
  bool operator==(const Residual&) const = default;
};

/// Content and highlights of a label picture.
struct LabelLook {
  std::shared_ptr<const FrameLabels> labels;      // null: none yet
  int plane = 0;                                  // the active plane, brighter than others; 0: none
  bool show_class = false;                        // h and v colors instead of plane colors
  std::shared_ptr<const labels::LabelEdit> edit;  // edit that a gesture would make; null: none
  std::span<const std::uint32_t> preview;         // pixels that the wand would label
  bool preview_takes = false;                     // ... or whose labels it would remove
  std::optional<Residual> residual;               // color by distance instead of label
  std::span<const std::uint8_t> doubt;            // uncertain pixels (per pixel); empty: none
  std::span<const std::uint32_t> marked;          // pixels of a question to the user
  Theme theme = Theme::dark;
};

/// Background of labels, RGB per depth pixel: the camera's color if aligned, otherwise
/// shaded surfaces.
Image8 label_ground(const labels::LabelGrid& grid, Backdrop backdrop);

/// Color of labels per pixel; alpha is the share over the background. `opacity`: of labels, 0..1;
/// highlights stay visible at any opacity.
std::vector<Rgba> label_tints(const labels::LabelGrid& grid, const LabelLook& look, double opacity);

/// Draws labels over a copy of the background, each plane with its outline. Hidden planes
/// are skipped.
void paint_labels(Image8& image,
                  const labels::LabelGrid& grid,
                  const LabelLook& look,
                  double opacity);

/// The visible points at positions `world` (per pixel); the id of a point is pixel + 1. Colors
/// are empty.
DrawPoints label_points(const labels::LabelGrid& grid,
                        std::span<const Vec3f> world,
                        std::span<const std::uint8_t> shown);
void color_label_points(DrawPoints& points,
                        const Image8& ground,
                        const labels::LabelGrid& grid,
                        const LabelLook& look);
/// Position of a plane's name: the pixel farthest from other labels.
struct LabelPlace {
  int plane = 0;
  std::uint32_t pixel = 0;
};
/// For visible planes, by id.
std::vector<LabelPlace> label_places(const FrameLabels& labels, const labels::LabelGrid& grid);

}  // namespace planescope::render
