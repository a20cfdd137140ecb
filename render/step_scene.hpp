#pragma once

// What one step of a run looks like, in space and on the camera's image: pure functions, no GL.
// Only what the step knows is drawn: its queue, what is settled, planes as they are at that moment.

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/debug/replay/run.hpp"
#include "core/model/types.hpp"
#include "render/draw_list.hpp"
#include "render/palette.hpp"
#include "render/scene_parts.hpp"

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
  static constexpr std::int32_t kOpen = -1;      // plane of a voxel: not known yet
  static constexpr std::int32_t kLeftover = -2;  // in none, on the list of leftovers or dropped
  std::vector<planes::Case> case_of;             // per voxel: of the node that settled it
  std::vector<std::int32_t> plane_of;            // per voxel: plane of the trace
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
std::vector<std::uint8_t> concerned_voxels(const debug::Run& run,
                                           const StepLook& look,
                                           const StepState& state);

/// Per voxel, as `look` asks, with single ones and the marked region standing out.
std::vector<Rgba> voxel_colors(const debug::Run& run, const StepLook& look, const StepState& state);

/// What the colors show: only our method has cases and margins, for others planes and labels take
/// their place.
ColorBy told_by(const debug::Run& run, ColorBy asked);

/// A settled node that was not divided: its points are done with.
bool is_settled_leaf(const debug::Run& run, std::int32_t node, std::int32_t step);

// ---- What is measured of the voxels, in meters: the quantities that colors show along a scale
// ----

/// depth: along the camera's axis, in clouds the distance from their origin. height: along gravity,
/// above the camera or the cloud's origin. rms: of the plane that a point is in, of its settled
/// node where it is in none. distance: to the selected plane, to each point's own where none is;
/// positive on the side that the plane shows, above or before it.
bool is_along_scale(ColorBy by);

/// Why nothing is known of the quantity at the step; empty where it is.
std::string why_no_values(const debug::Run& run, const StepLook& look);

/// Per voxel; NaN where nothing is known of it.
std::vector<float> voxel_values(const debug::Run& run,
                                const StepLook& look,
                                const StepState& state);

/// Its range is the same at every step: that of the points as the run leaves them, or `look`'s own.
ColorScale color_scale(const debug::Run& run, const StepLook& look);

/// "depth 1.234 m", "3.2 mm before P3"; empty where nothing is known of the voxel.
std::string value_text(const debug::Run& run, const StepLook& look, std::int32_t voxel);

}  // namespace planescope::render
