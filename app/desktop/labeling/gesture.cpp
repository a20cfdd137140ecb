#include "app/desktop/labeling/gesture.hpp"

#include <fmt/format.h>

#include <cmath>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/look.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "render/draw_list.hpp"

namespace planescope::desktop {
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
    throw Error(fmt::format("action {}: '{}' has {} positions; expected {} or more", action, text,
                            gesture.path.size(), least_places));
  return gesture;
}

constexpr float kReach_px = 4;    // of a click
constexpr float kGap_px = 20;     // to the points around a gap in a sparse surface
constexpr float kBefore = 0.97f;  // of the depth of what is seen through it

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

/// The frame's points in a view of that size, through the camera in force. Kept in the state until
/// the camera, the size, the frame or what is hidden changes. The frame and its labels are there.
const labels::SeenPoints& sight(State& state, int width, int height) {
  const std::shared_ptr<const LabelFrame>& frame = state.results.label.frame;
  const std::shared_ptr<const FrameLabels> labels = state.labels();
  const render::Camera camera = camera_in_force(state, width, height);
  const SpaceSight* now = state.view.label.sight.get();
  const bool same_view = now && now->frame == frame && now->points.width == width &&
                         now->points.height == height && same_camera(now->camera, camera);
  if (same_view && now->labels == labels) return now->points;
  auto made = std::make_shared<SpaceSight>();
  made->frame = frame;
  made->labels = labels;
  made->shown = labels::shown_pixels(*labels);
  made->camera = camera;
  if (same_view && made->shown == now->shown)
    made->points = now->points;
  else
    made->points = labels::see(frame->grid, space_view(*frame, camera, width, height), made->shown);
  state.view.label.sight = std::move(made);
  return state.view.label.sight->points;
}

/// The point of a cloud that is drawn over a place, before all others; -1 where none is.
std::int64_t point_drawn_at(const labels::SeenPoints& seen, const labels::Vec2f& place) {
  std::int64_t front = -1;
  for (std::size_t i = 0; i < seen.radius_px.size(); ++i) {
    if (!((seen.place[i] - place).norm() <= seen.radius_px[i])) continue;
    if (front < 0 || seen.depth_m[i] < seen.depth_m[static_cast<std::size_t>(front)])
      front = static_cast<std::int64_t>(i);
  }
  return front;
}

/// Where points before `drawn` lie all around the place, their surface is meant, through whose gaps
/// it is seen: the nearest of them to the place; else `drawn` itself.
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

/// The point that is seen at a place, as its pixel; -1 where there is none nearby.
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
    return pixel_seen_at(sight(state, where.width, where.height), at);
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
    return labels::points_in_space(sight(state, gesture.width, gesture.height), shape,
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
