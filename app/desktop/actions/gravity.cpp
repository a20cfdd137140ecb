// Actions that derive gravity from clicked floors and walls.

#include "core/planes/cloud/gravity.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/desktop/actions/actions.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/labels/wand/wand.hpp"
#include "core/model/error.hpp"

namespace planescope::desktop {
namespace {

constexpr double kLeastArea_m2 = 0.01;   // minimum for a direction within a degree
constexpr double kMostRoughness = 0.04;  // likewise, maximum RMS as a fraction of the size
constexpr double kMostTilt_deg = 60;     // warn about floors with a larger tilt

/// A clicked surface; its unit normal faces the sensor, in sensor coordinates.
struct ClickedSurface {
  Vec3d normal;
  double area_m2 = 0;  // 0: unknown
  double rms_m = 0;
};

const debug::Subject& subject_of(const State& state) {
  return *state.results.current->run->subject;
}

/// The surface around a pixel found by the plane wand, which is robust at any distance.
ClickedSurface surface_at_pixel(const debug::Subject& subject, std::uint32_t pixel) {
  const labels::LabelGrid grid = labels::make_label_grid(subject.frame, subject.prepared.gravity);
  std::string why_not;
  const std::uint32_t seeds[] = {pixel};
  const auto found = labels::grow_plane(grid, nullptr, seeds, {}, &why_not);
  if (!found) throw Error(why_not);
  const labels::FittedPlane& plane = found->plane;
  if (plane.area_m2 < kLeastArea_m2 || plane.rms_m > kMostRoughness * std::sqrt(plane.area_m2))
    throw Error(
        fmt::format("the surface is too small or too rough to measure its direction "
                    "({:.0f} cm2, RMS {:.1f} mm)",
                    1e4 * plane.area_m2, 1000 * plane.rms_m));
  return {plane.normal, plane.area_m2, plane.rms_m};
}

ClickedSurface surface_of_plane(const State& state, std::int32_t plane) {
  const debug::Run& run = *state.run();
  const planes::PlaneChange* now = run.timeline.plane_at(plane, state.view.step);
  if (!now || !now->alive) throw Error("no plane there");
  const planes::PreparedFrame& prepared = run.subject->prepared;
  Vec3d normal = now->fit.normal;
  if (normal.dot(prepared.sensor() - now->fit.centroid) < 0) normal = -normal;
  return {prepared.cloud.T_world_sensor.linear().transpose() * normal, 0, now->fit.rms_m()};
}

ClickedSurface surface_at_voxel(const State& state, int voxel) {
  const debug::Subject& subject = *state.run()->subject;
  if (!subject.frame.is_cloud())
    return surface_at_pixel(subject, static_cast<std::uint32_t>(debug::source_of_voxel(
                                         subject, static_cast<std::uint32_t>(voxel))));
  const std::int32_t plane = state.run()->timeline.point_at(voxel, state.view.step).plane;
  if (plane < 0) throw Error("no plane there");
  return surface_of_plane(state, plane);
}

/// Throws Error with a phrase if there is no surface.
ClickedSurface clicked_surface(const State& state, const Clicked& clicked) {
  const std::int64_t at = expect_clicked(state, clicked);
  if (clicked.on == Clicked::On::voxel) return surface_at_voxel(state, clicked.index);
  if (clicked.on == Clicked::On::plane) return surface_of_plane(state, clicked.index);
  return surface_at_pixel(*state.run()->subject, static_cast<std::uint32_t>(at));
}

std::string surface_text(const ClickedSurface& surface) {
  if (surface.area_m2 <= 0) return fmt::format("RMS {:.1f} mm", 1000 * surface.rms_m);
  return fmt::format("{:.2f} m2, RMS {:.1f} mm", surface.area_m2, 1000 * surface.rms_m);
}

/// Throws Error if a click would have no effect: an unreadable file is not replaced, and gravity in
/// the recording takes precedence over picked gravity.
void expect_effect(const State& state) {
  if (const std::string& why = state.document.current()->picked_refused; !why.empty())
    throw Error(why + "; move the file away first");
  const std::optional<Gravity>& own = subject_of(state).frame.gravity;
  const GravitySource source = own ? own->source : GravitySource::none;
  if (source != GravitySource::imu && source != GravitySource::sidecar) return;
  const char* who = source == GravitySource::imu ? "IMU" : "sidecar";
  throw Error(
      fmt::format("the recording's {} specifies gravity and overrides clicks; --gravity "
                  "X,Y,Z and the option gravity override both",
                  who));
}

/// Previously picked gravity of this frame, or of the recording if clicks apply to all frames.
const io::PickedDirection* picked_before(const State& state) {
  const io::PickedGravity& picked = state.document.current()->picked;
  if (state.view.gravity_of_recording) return picked.recording ? &*picked.recording : nullptr;
  const auto own = picked.frames.find(state.document.frame);
  return own == picked.frames.end() ? nullptr : &own->second;
}

/// Adds an undo step with picked gravity and options.
void change_picked(State& state,
                   const io::PickedGravity& after,
                   const planes::PipelineOptions& options) {
  const OpenRecording& open = *state.document.current();
  OptionChange change{state.document.options, options, "", {}};
  change.gravity = GravityChange{open.path, open.picked, after};
  keep_picked(state, open.path, after);
  state.undo.push_back(std::move(change));
  state.redo.clear();
  state.document.options = options;
}

/// Sets the classes of labels drawn while gravity was unknown, as a separate undo step.
void set_labels_gravity(State& state, const Gravity& gravity) {
  const labels::LabelStore* store = state.document.current()->labels.get();
  const std::shared_ptr<const FrameLabels> labels = state.labels();
  if (state.view.mode != Mode::labels || !labels || !store->read_only().empty()) return;
  if (labels->planes.empty()) return;
  labels::LabelDraft draft(*labels);
  labels::set_gravity(draft, gravity);
  commit_labels(state, "Gravity", draft);
}

void keep_direction(State& state, io::PickedDirection picked, const std::string& said) {
  const OpenRecording& open = *state.document.current();
  const int frame = state.document.frame;
  picked.frame = frame;
  picked.frame_sha256 = open.recording->frame_hash(frame);
  io::PickedGravity after = open.picked;
  const bool all = state.view.gravity_of_recording;
  if (all) {
    after.recording = picked;
    after.frames.erase(frame);  // the recording's direction applies to this frame too
  } else {
    after.frames[frame] = picked;
  }
  planes::PipelineOptions options = state.document.options;
  options.gravity.mode =
      planes::GravityMode::automatic;  // a direction in the options would override it
  change_picked(state, after, options);
  state.view.click = Click::selects;
  const char* where = all ? "all frames"
                      : open.recording->frame_count() == 1
                          ? "this frame"
                          : "this frame and frames whose camera motion relative to it is known";
  std::string text = fmt::format("gravity for {} set {}", where, said);
  if (!subject_of(state).frame.is_cloud()) {
    const double tilt_deg =
        std::acos(std::clamp(picked.direction.y(), -1.0, 1.0)) * 180 / std::numbers::pi;
    text += fmt::format("; the camera is tilted by {:.0f}°", tilt_deg);
    if (tilt_deg > kMostTilt_deg) text += " (was that the right surface?)";
  }
  say(state, fmt::format("{}; stored in {}", text, (open.label_dir / "gravity.json").string()));
  try {
    set_labels_gravity(state, {picked.direction, GravitySource::picked, 1, picked.note});
  } catch (const Error& error) {  // the picked gravity remains
    say(state, error.what(), true);
  }
}

void pick_floor(State& state, const Clicked& clicked) {
  expect_effect(state);
  const ClickedSurface surface = clicked_surface(state, clicked);
  io::PickedDirection picked;
  picked.direction = planes::gravity_of_floor(surface.normal);
  picked.note = fmt::format("picked: a floor ({})", surface_text(surface));
  keep_direction(state, picked, fmt::format("from a floor ({})", surface_text(surface)));
}

void pick_wall(State& state, const Clicked& clicked) {
  expect_effect(state);
  const ClickedSurface surface = clicked_surface(state, clicked);
  io::PickedDirection picked;
  if (const io::PickedDirection* before = picked_before(state)) picked.walls = before->walls;
  picked.walls.push_back(surface.normal);
  // Known gravity, or the direction of the image's lower edge.
  const Vec3d before = subject_of(state).prepared.gravity.direction;
  std::string why_not;
  const auto direction = planes::gravity_of_walls(picked.walls, before, &why_not);
  if (!direction) throw Error(why_not);
  picked.direction = *direction;
  const std::size_t walls = picked.walls.size();
  const std::string what = walls == 1 ? "one wall" : fmt::format("{} walls", walls);
  picked.note = "picked: " + what;
  const char* open_angle =
      " (the angle along it is uncertain; click a floor, or a wall at an angle to it)";
  keep_direction(state, picked, "from " + what + (walls == 1 ? open_angle : ""));
}

/// A click that hits no surface changes nothing and says so.
template <void (*pick)(State&, const Clicked&)>
void try_pick(State& state, const Clicked& clicked) {
  try {
    pick(state, clicked);
  } catch (const Error& error) {
    say(state, fmt::format("gravity is unchanged: {}", error.what()), true);
  }
}

void forget(State& state) {
  const OpenRecording& open = *state.document.current();
  io::PickedGravity after = open.picked;
  const bool own = after.frames.erase(state.document.frame) > 0;
  if (!own) after.recording.reset();
  change_picked(state, after, state.document.options);
  say(state, own ? "removed the gravity picked for this frame"
                 : "removed the gravity picked for the recording");
}

bool has_pick(const State& state) {
  const OpenRecording* open = state.document.current();
  return open && open->picked.of(state.document.frame) != nullptr;
}

}  // namespace

void read_picked(State& state, OpenRecording& open) {
  try {
    open.picked = io::read_picked_gravity(open.label_dir, *open.recording);
  } catch (const Error& error) {
    open.picked = {};
    open.picked_refused = error.what();
    say(state, error.what(), true);
  }
}

void keep_picked(State& state,
                 const std::filesystem::path& recording,
                 const io::PickedGravity& picked) {
  auto& all = state.document.recordings;
  const auto open = std::ranges::find(all, recording, &OpenRecording::path);
  if (open == all.end()) return;
  state.document.check_output(open->label_dir);
  io::write_picked_gravity(open->label_dir, picked);
  open->picked = picked;
  forget_cameras(state);  // world coordinates rotate with gravity
}

void add_gravity_actions(std::vector<Action>& all) {
  const ActionGroup gravity{all, KeyMode::anywhere, "Gravity"};
  add_click(gravity, "gravity.click.floor", "Click a floor to set gravity", "Shift+G", Click::floor)
      .words("up down level horizontal");
  add_click(gravity, "gravity.click.wall", "Click a wall to set gravity", "Shift+W", Click::wall)
      .words("up down upright vertical");
  gravity.add("gravity.all_frames", "Apply clicks to all frames")
      .key("Ctrl+Shift+W")
      .flips(&ViewState::gravity_of_recording);
  gravity.add("gravity.forget", "Forget clicked gravity")
      .key("Ctrl+Shift+G")
      .when(has_pick)
      .run(forget);
  gravity.add("gravity.floor", "Set gravity from a floor")
      .when(has_run)
      .run(clicked(), try_pick<pick_floor>);
  gravity.add("gravity.wall", "Set gravity from a wall")
      .when(has_run)
      .run(clicked(), try_pick<pick_wall>);
}

}  // namespace planescope::desktop
