// Helpers shared by label actions: the active frame and plane, commits, progress and the camera.

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
#include "render/draw_list.hpp"

namespace planescope::desktop {

namespace {

constexpr double kRoom = 2;  // shows the surroundings of a region

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

/// Moves the camera to the pixels, keeping its direction.
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

}  // namespace

bool can_label(const State& state) { return state.view.mode == Mode::labels && state.labels(); }

const char* sample_name(const LabelFrame& frame) {
  return frame.grid.is_cloud() ? "point" : "pixel";
}

LabelWork label_work(const State& state) {
  if (!can_label(state)) throw Error("the frame is not ready yet");
  return {*state.label_frame(), state.labels()};
}

labels::LabelDraft draft_of(const State& state) {
  return labels::LabelDraft(*label_work(state).labels);
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
  if (plane == 0) throw Error("no plane is active; click one in the list, or press its number");
  if (!labels::find_plane(labels, plane)) throw Error(fmt::format("no plane P{}", plane));
  return plane;
}

void commit_and_say(State& state,
                    const std::string& title,
                    labels::LabelDraft& draft,
                    const std::string& unchanged) {
  if (commit_labels(state, title, draft).empty())
    say_nothing_done(state, unchanged);
  else
    say(state, title);
}

FrameMark frame_mark(const State& state, int frame) {
  const OpenRecording* open = state.document.current();
  const std::vector<FrameMark>& files = state.results.label.marks;
  if (const auto labels = open && open->labels ? open->labels->labels(frame) : nullptr)
    return {.labeled = !labels->planes.empty(), .reviewed = labels->review_state == "reviewed"};
  if (frame < static_cast<int>(files.size())) return files[static_cast<std::size_t>(frame)];
  return {};
}

LabelProgress progress_of(const State& state) {
  LabelProgress progress;
  const OpenRecording* open = state.document.current();
  progress.frames = open ? open->recording->frame_count() : 0;
  for (int i = 0; i < progress.frames; ++i) {
    const FrameMark mark = frame_mark(state, i);
    progress.labeled += mark.labeled;
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
    throw Error(
        "labels for clouds cannot be carried, because motion is estimated from depth images");
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
  if (!state.map())
    throw Error("poses are unknown; press Ctrl+Shift+M to track planes and estimate poses");
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
  if (!state.map()->track(track)) throw Error("no track is selected; click one in the Tracks tab");
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

void paint_pixels(State& state,
                  const std::string& tool,
                  std::span<const std::uint32_t> pixels,
                  const labels::Paint& paint,
                  labels::PaintMode mode) {
  labels::LabelDraft draft(*state.labels());
  const LabelPlane* plane = labels::find_plane(draft.labels, paint.plane);
  if (plane && plane->locked) throw Error(fmt::format("P{} is locked", plane->id));
  if (is_plane(paint) && !plane && mode == labels::PaintMode::subtract)
    throw Error(
        fmt::format("P{} has no {}s to remove", paint.plane, sample_name(*state.label_frame())));
  const std::string title = fmt::format(
      "{} {}{}", tool, mode == labels::PaintMode::subtract ? "off " : "", name_of_paint(paint));
  labels::paint(draft, state.label_frame()->grid, pixels, paint, mode);
  const labels::LabelEdit edit = commit_labels(state, title, draft);
  if (edit.empty()) return say_nothing_done(state, "nothing to change here");
  if (is_plane(paint)) state.view.label.plane = paint.plane;
  say(state, fmt::format("{}: {}", title,
                         counted(edit.changed_pixels(), sample_name(*state.label_frame()))));
}

// ---- Gestures --------------------------------------------------------------------------------

namespace {

constexpr int kLargestView_px = 8192;
constexpr double kFarthest_px = 1e5;

bool is_place(const std::string& part) { return part.find(',') != std::string::npos; }

labels::Vec2f place_argument(const std::string& action, const std::string& text) {
  const std::vector<double> xy = numbers_argument(action, text, 2);
  for (const double value : xy)
    if (!(std::abs(value) <= kFarthest_px))
      throw Error(fmt::format("action {}: {} is not a position in a picture", action, text));
  return {static_cast<float>(xy[0]), static_cast<float>(xy[1])};
}

void read_view(const std::string& action, const std::string& text, LabelGesture& gesture) {
  if (text == "image") return;
  const std::vector<std::string> size =
      text.starts_with("space:") ? split(text.substr(6), 'x') : std::vector<std::string>{};
  if (size.size() != 2)
    throw Error(
        fmt::format("action {}: '{}' is not a view; expected image or space:WxH", action, text));
  gesture.where = DrawnIn::space;
  gesture.width = whole_argument(action, size[0], 1, kLargestView_px);
  gesture.height = whole_argument(action, size[1], 1, kLargestView_px);
}

LabelGesture read_gesture(const std::string& action,
                          const std::string& text,
                          std::size_t least_places) {
  std::vector<std::string> parts = split(text, ' ');
  std::erase(parts, "");
  if (parts.empty()) throw Error(fmt::format("action {}: a view is missing", action));
  LabelGesture gesture;
  read_view(action, parts[0], gesture);
  std::size_t next = 1;
  if (next < parts.size() && std::isalpha(static_cast<unsigned char>(parts[next][0])))
    gesture.mode = static_cast<labels::PaintMode>(
        choice_argument(action, parts[next++], {"over", "add", "subtract"}));
  if (next < parts.size() && !is_place(parts[next])) {
    const double radius = number_argument(action, parts[next++]);
    if (!(radius > 0 && radius <= kLargestView_px))
      throw Error(fmt::format("action {}: brush radius {} px is out of range", action, radius));
    gesture.radius_px = static_cast<float>(radius);
  }
  for (; next < parts.size(); ++next) gesture.path.push_back(place_argument(action, parts[next]));
  if (gesture.path.size() < least_places)
    throw Error(fmt::format("action {}: '{}' has {}; expected at least {}", action, text,
                            counted(gesture.path.size(), "position"), least_places));
  return gesture;
}

constexpr float kReach_px = 4;    // around a click
constexpr float kGap_px = 20;     // to the points around a gap in a sparse surface
constexpr float kBefore = 0.97f;  // fraction of the depth of a point seen through it

render::Camera camera_in_force(const State& state, int width, int height) {
  return scene_camera(state, static_cast<double>(width) / height);
}

labels::SpaceView space_view(const LabelFrame& frame,
                             const render::Camera& camera,
                             int width,
                             int height) {
  const render::View view = render::make_view(camera, width, height);
  labels::SpaceView space = labels::view_of_points(frame.grid);
  space.clip_from_sensor = view.proj * view.view * frame.T_world_sensor.cast<float>().matrix();
  space.width = width;
  space.height = height;
  space.px_per_m = view.px_per_m;
  space.orthographic = view.orthographic;
  return space;
}

/// The frame's points in a view of this size from the current camera. Cached in the state until the
/// camera, size, frame or hidden planes change. Requires a frame and its labels.
const labels::SeenPoints& visible(State& state, int width, int height) {
  const std::shared_ptr<const LabelFrame>& frame = state.results.label.frame;
  const std::shared_ptr<const FrameLabels> labels = state.labels();
  const render::Camera camera = camera_in_force(state, width, height);
  const VisiblePoints* now = state.view.label.visible.get();
  const bool same_view = now && now->frame == frame && now->points.width == width &&
                         now->points.height == height && same_camera(now->camera, camera);
  if (same_view && now->labels == labels) return now->points;
  auto made = std::make_shared<VisiblePoints>();
  made->frame = frame;
  made->labels = labels;
  made->shown = labels::shown_pixels(*labels);
  made->camera = camera;
  if (same_view && made->shown == now->shown)
    made->points = now->points;
  else
    made->points = labels::see(frame->grid, space_view(*frame, camera, width, height), made->shown);
  state.view.label.visible = std::move(made);
  return state.view.label.visible->points;
}

/// The frontmost cloud point drawn over a position; -1: none.
std::int64_t point_drawn_at(const labels::SeenPoints& seen, const labels::Vec2f& place) {
  std::int64_t front = -1;
  for (std::size_t i = 0; i < seen.radius_px.size(); ++i) {
    if (!((seen.place[i] - place).norm() <= seen.radius_px[i])) continue;
    if (front < 0 || seen.depth_m[i] < seen.depth_m[static_cast<std::size_t>(front)])
      front = static_cast<std::int64_t>(i);
  }
  return front;
}

/// A point seen through a gap in a nearer surface: if points in front of `drawn` surround the
/// position, returns the nearest of them to the position, otherwise `drawn`.
std::int64_t point_meant_at(const labels::SeenPoints& seen,
                            const labels::Vec2f& place,
                            std::int64_t drawn) {
  const float before_m = kBefore * seen.depth_m[static_cast<std::size_t>(drawn)];
  std::int64_t best = drawn;
  float least = kGap_px * kGap_px;
  unsigned sides = 0;
  for (std::size_t i = 0; i < seen.depth_m.size(); ++i) {
    const labels::Vec2f away = seen.place[i] - place;
    const float distance = away.squaredNorm();
    if (!(distance < kGap_px * kGap_px && seen.depth_m[i] < before_m)) continue;
    sides |= 1u << ((away.x() < 0 ? 1 : 0) + (away.y() < 0 ? 2 : 0));
    if (distance >= least) continue;
    least = distance;
    best = static_cast<std::int64_t>(i);
  }
  return sides == 0xF ? best : drawn;
}

/// The pixel of the point visible at a position; -1 if there is none nearby.
std::int64_t pixel_seen_at(const labels::SeenPoints& seen, const labels::Vec2f& place) {
  if (const std::int64_t front = point_drawn_at(seen, place); front >= 0)
    return point_meant_at(seen, place, front);
  std::int64_t best = -1;
  float least = kReach_px * kReach_px;
  for (std::size_t i = 0; i < seen.place.size(); ++i) {
    if (!seen.visible[i]) continue;
    const float distance = (seen.place[i] - place).squaredNorm();
    if (!(distance < least)) continue;
    least = distance;
    best = static_cast<std::int64_t>(i);
  }
  return best;
}

}  // namespace

void expect_image(const State& state) {
  if (state.label_frame()->grid.is_cloud()) throw Error("a cloud has no image; expected space:WxH");
}

bool labels_at_hand(const State& state) { return state.labels() != nullptr; }

Takes<LabelGesture> gesture(std::string shown, std::size_t least_places) {
  return {std::move(shown),
          [least_places](const State&, const std::string& action, const std::string& typed) {
            return read_gesture(action, typed, least_places);
          }};
}

Takes<LabelGesture> place_in_view(std::string shown) {
  return {std::move(shown), [](const State&, const std::string& action, const std::string& typed) {
            const bool on_image = typed.find(' ') == std::string::npos;
            return read_gesture(action, on_image ? "image " + typed : typed, 1);
          }};
}

std::int64_t pixel_of_gesture(State& state, const std::string& action, const LabelGesture& where) {
  const labels::Vec2f& at = where.path.front();
  if (where.where == DrawnIn::space)
    return pixel_seen_at(visible(state, where.width, where.height), at);
  expect_image(state);
  const labels::LabelGrid& grid = state.label_frame()->grid;
  const int u = static_cast<int>(std::floor(at.x())), v = static_cast<int>(std::floor(at.y()));
  if (u < 0 || v < 0 || u >= grid.width || v >= grid.height)
    throw Error(fmt::format("action {}: {},{} is outside the {} x {} image", action, u, v,
                            grid.width, grid.height));
  return static_cast<std::int64_t>(v) * grid.width + u;
}

labels::SpaceSelection selected_by(State& state, const LabelGesture& gesture) {
  labels::DrawnShape shape;
  shape.kind =
      gesture.radius_px ? labels::DrawnShape::Kind::stroke : labels::DrawnShape::Kind::area;
  shape.path = gesture.path;
  if (gesture.radius_px) shape.radius_px = *gesture.radius_px;
  if (gesture.where == DrawnIn::space)
    return labels::points_in_space(visible(state, gesture.width, gesture.height), shape,
                                   state.view.label.through);
  expect_image(state);
  const std::vector<std::uint8_t> shown = labels::shown_pixels(*state.labels());
  return {labels::pixels_on_image(state.label_frame()->grid, shape, shown), 0};
}

std::vector<float> sides_in_space(
    const State& state, int width, int height, const labels::Vec2f& from, const labels::Vec2f& to) {
  const LabelFrame& frame = *state.label_frame();
  const render::View view = render::make_view(camera_in_force(state, width, height), width, height);
  const Vec2d begin = from.cast<double>(), along = (to - from).cast<double>();
  std::vector<float> sides(frame.world.size(), 0);
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (!frame.grid.measured[i]) continue;
    const std::optional<render::ScreenPoint> point = render::project(view, frame.world[i]);
    if (!point) continue;
    const Vec2d there = point->px - begin;
    sides[i] = static_cast<float>(along.x() * there.y() - along.y() * there.x());
  }
  return sides;
}

}  // namespace planescope::desktop
