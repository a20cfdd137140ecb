#include "app/desktop/labeling/work.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/tracks/map_view.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

constexpr double kRoom = 2;  // what is around a region says where it is

void look_on_image(ViewState& view,
                   const labels::LabelGrid& grid,
                   std::span<const std::uint32_t> pixels) {
  int u0 = grid.width, u1 = 0, v0 = grid.height, v1 = 0;
  for (const std::uint32_t pixel : pixels) {
    const int u = static_cast<int>(pixel) % grid.width, v = static_cast<int>(pixel) / grid.width;
    u0 = std::min(u0, u);
    u1 = std::max(u1, u + 1);
    v0 = std::min(v0, v);
    v1 = std::max(v1, v + 1);
  }
  constexpr double kMaxZoom = 8;
  view.image_zoom = std::clamp(
      std::min(grid.width / (kRoom * (u1 - u0)), grid.height / (kRoom * (v1 - v0))), 1.0, kMaxZoom);
  view.image_center = Vec2d((u0 + u1) / 2.0 / grid.width, (v0 + v1) / 2.0 / grid.height);
}

/// Looks at the pixels from the direction in which the camera stands now.
render::Camera camera_at(render::Camera camera,
                         const LabelFrame& frame,
                         std::span<const std::uint32_t> pixels) {
  Eigen::AlignedBox3f box;
  for (const std::uint32_t pixel : pixels)
    if (frame.grid.measured[pixel]) box.extend(frame.world[pixel]);
  if (box.isEmpty()) return camera;
  const double radius_m = std::max(0.5 * box.diagonal().cast<double>().norm(), 0.03);
  const double distance_m = kRoom * radius_m / std::sin(camera.fov_y_deg * std::numbers::pi / 360);
  const Vec3d back = (camera.eye - camera.target).normalized();
  camera.target = box.center().cast<double>();
  camera.eye = camera.target + distance_m * back;
  camera.ortho_height_m = 2 * kRoom * radius_m;
  camera.near_m = std::max(0.005, 0.02 * distance_m);
  camera.far_m = std::max(camera.far_m, 20 * distance_m);
  return camera;
}

bool is_plane(const labels::Paint& paint) { return paint.plane > 0 && paint.plane != kPlaneIgnore; }

bool takes_off(const labels::Paint& paint, labels::PaintMode mode) {
  return mode == labels::PaintMode::subtract || (paint.plane == 0 && paint.label == Label::unknown);
}

}  // namespace

bool can_label(const State& state) { return state.view.mode == Mode::labels && state.labels(); }

const char* sample_name(const LabelFrame& frame) {
  return frame.grid.is_cloud() ? "point" : "pixel";
}

LabelWork label_work(const State& state) {
  if (!can_label(state)) throw Error("the frame is not ready yet");
  return {*state.label_frame(), state.labels()};
}

Takes<int> plane_number(std::string shown, int low) {
  return {std::move(shown),
          [low](const State&, const std::string& action, const std::string& typed) {
            return plane_number_argument(action, typed, low, kPlaneIgnore - 1);
          }};
}

int active_plane(const State& state, const std::optional<int>& chosen) {
  const FrameLabels& labels = *label_work(state).labels;
  const int plane = chosen.value_or(state.view.label.plane);
  if (plane == 0) throw Error("no plane is active: click one in the list, or press its number");
  if (!labels::find_plane(labels, plane)) throw Error(fmt::format("no plane P{}", plane));
  return plane;
}

void commit_and_say(State& state,
                    const std::string& title,
                    const FrameLabels& after,
                    const std::string& unchanged) {
  const std::shared_ptr<const FrameLabels> before = state.labels();
  commit_labels(state, title, after);
  if (state.labels() == before)
    say_nothing_done(state, unchanged);
  else
    say(state, title);
}

FrameMark frame_mark(const State& state, int frame) {
  const OpenRecording* open = state.document.current();
  const std::vector<FrameMark>& files = state.results.label.marks;
  if (const auto labels = open && open->labels ? open->labels->labels(frame) : nullptr)
    return {.labelled = !labels->planes.empty(), .reviewed = labels->review_state == "reviewed"};
  if (frame < static_cast<int>(files.size())) return files[static_cast<std::size_t>(frame)];
  return {};
}

LabelProgress progress_of(const State& state) {
  LabelProgress progress;
  const OpenRecording* open = state.document.current();
  progress.frames = open ? open->recording->frame_count() : 0;
  for (int i = 0; i < progress.frames; ++i) {
    const FrameMark mark = frame_mark(state, i);
    progress.labelled += mark.labelled;
    progress.reviewed += mark.reviewed;
  }
  return progress;
}

std::shared_ptr<const FrameLabels> labels_at(const OpenRecording& open, int frame) {
  labels::LabelStore& store = *open.labels;
  if (auto labels = store.labels(frame)) return labels;
  try {
    auto found =
        labels::read_frame_labels(open.label_dir, frame, open.recording->frame_hash(frame));
    if (!found) return nullptr;
    FrameLabels blank = std::move(*found);
    std::ranges::fill(blank.plane.data, std::uint16_t{0});
    std::ranges::fill(blank.hv.data, std::uint8_t{0});
    blank.planes.clear();
    blank.review.clear();
    return store.open(frame, blank);
  } catch (const Error&) {
    return nullptr;
  }
}

void look_at_pixels(State& state, std::span<const std::uint32_t> pixels) {
  const LabelFrame* frame = state.label_frame();
  if (!frame || pixels.empty()) return;
  if (!frame->grid.is_cloud()) look_on_image(state.view, frame->grid, pixels);
  move_camera(state, camera_at(camera_of(state), *frame, pixels));
}

void begin_carry(State& state, const CarryJob& plan) {
  const LabelWork work = label_work(state);
  const int frame = state.document.frame;
  const OpenRecording& open = *state.document.current();
  if (work.frame.grid.is_cloud())
    throw Error("labels of clouds cannot be carried: motion is estimated from depth images");
  if (work.labels->planes.empty())
    throw Error(fmt::format("frame {} has no planes to carry", frame));
  if (frame + 1 >= open.recording->frame_count())
    throw Error(fmt::format("frame {} is the last frame", frame));
  if (!open.labels->read_only().empty()) throw Error(open.labels->read_only());
  CarryJob job = plan;
  job.running = true;
  job.begun = false;
  job.from = frame;
  job.from_frame = state.results.label.frame;
  job.from_labels = work.labels;
  show_frame(state, frame + 1);
  state.results.label.carry = std::move(job);
}

namespace {

SpreadWork& begin_proposing(State& state, int frames) {
  const OpenRecording& open = *state.document.current();
  if (!open.labels->read_only().empty()) throw Error(open.labels->read_only());
  SpreadWork& spread = state.results.label.spread;
  spread = {};
  spread.running = true;
  spread.from = state.document.frame;
  spread.total = frames;
  return spread;
}

void expect_map(const State& state) {
  if (!state.map()) throw Error("poses are unknown: Ctrl+Shift+M tracks planes and estimates them");
}

}  // namespace

void begin_spread(State& state) {
  const LabelWork work = label_work(state);
  const OpenRecording& open = *state.document.current();
  const int frame = state.document.frame;
  expect_map(state);
  if (!state.map()->pose(frame)) throw Error(fmt::format("frame {} has no pose", frame));
  if (work.labels->planes.empty())
    throw Error(fmt::format("frame {} has no planes to propose", frame));
  begin_proposing(state, open.recording->frame_count() - 1);
}

void begin_spread_of_track(State& state) {
  label_work(state);
  expect_map(state);
  const int track = state.view.tracks.track;
  if (!state.map()->track(track)) throw Error("no track is selected: click one in the Tracks tab");
  begin_proposing(state, state.document.current()->recording->frame_count()).track = track;
}

labels::OtherLabels labels_of_run(const debug::Run& run, const labels::LabelGrid& grid) {
  labels::OtherLabels labels;
  labels.plane.assign(grid.pixels(), -1);
  for (std::size_t i = 0; i < grid.pixels(); ++i) {
    const std::uint32_t voxel = run.subject->voxel_of_source(i);
    if (voxel != planes::kNoVoxel) labels.plane[i] = run.segmentation.plane_of[voxel];
  }
  for (const planes::PlaneRegion& plane : run.segmentation.planes)
    labels.label.push_back(plane.label);
  return labels;
}

std::string name_of_paint(const labels::Paint& paint) {
  if (paint.plane == kPlaneIgnore) return "ignore";
  if (paint.plane > 0) return fmt::format("P{}", paint.plane);
  return to_string(paint.label, "nothing");
}

labels::Paint paint_in_hand(const State& state) {
  const LabelView& view = state.view.label;
  switch (view.paints) {
    case Paints::plane:
      return {.plane = view.plane > 0 ? view.plane : labels::free_plane_id(*state.labels())};
    case Paints::ignore:
      return {.plane = kPlaneIgnore};
    case Paints::erase:
      return {};
    case Paints::h_only:
      return {.label = Label::h};
    case Paints::v_only:
      return {.label = Label::v};
  }
  return {};
}

StrokePreview preview_of(const State& state, labels::SpaceSelection taken, labels::PaintMode mode) {
  const labels::Paint paint = paint_in_hand(state);
  return {.pixels = labels::changed_by_painting(*state.labels(), state.label_frame()->grid,
                                                taken.pixels, paint, mode),
          .hidden = taken.hidden,
          .takes = takes_off(paint, mode)};
}

void paint_pixels(State& state,
                  const std::string& tool,
                  std::span<const std::uint32_t> pixels,
                  const labels::Paint& paint,
                  labels::PaintMode mode) {
  const FrameLabels& labels = *state.labels();
  const labels::LabelGrid& grid = state.label_frame()->grid;
  const LabelPlane* plane = is_plane(paint) ? labels::find_plane(labels, paint.plane) : nullptr;
  if (plane && plane->locked) throw Error(fmt::format("P{} is locked", plane->id));
  if (is_plane(paint) && !plane && mode == labels::PaintMode::subtract)
    throw Error(
        fmt::format("P{} has no {}s to remove", paint.plane, sample_name(*state.label_frame())));
  const std::size_t changed = labels::changed_by_painting(labels, grid, pixels, paint, mode).size();
  if (changed == 0) return say_nothing_done(state, "nothing to change here");
  const std::string title = fmt::format(
      "{} {}{}", tool, mode == labels::PaintMode::subtract ? "off " : "", name_of_paint(paint));
  commit_labels(state, title, labels::painted(labels, grid, pixels, paint, mode));
  if (is_plane(paint)) state.view.label.plane = paint.plane;
  say(state, fmt::format("{}: {}", title, counted(changed, sample_name(*state.label_frame()))));
}

}  // namespace planescope::desktop
