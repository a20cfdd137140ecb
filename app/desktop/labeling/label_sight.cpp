#include "app/desktop/labeling/label_sight.hpp"

#include <cmath>

#include "app/desktop/camera.hpp"
#include "render/view.hpp"

namespace planescope::desktop {
namespace {

constexpr float kReach_px = 4;  // of a click

render::Camera camera_in_force(const State& state, int width, int height) {
  return fitted(camera_of(state), static_cast<double>(width) / height);
}

labels::SpaceView space_view(const LabelFrame& frame,
                             const render::Camera& camera,
                             int width,
                             int height) {
  const render::View view = render::make_view(camera, width, height);
  labels::SpaceView space;
  space.clip_from_sensor = view.proj * view.view * frame.T_world_sensor.cast<float>().matrix();
  space.width = width;
  space.height = height;
  space.px_per_m = view.px_per_m;
  space.orthographic = view.orthographic;
  return space;
}

}  // namespace

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

std::int64_t pixel_seen_at(const labels::SeenPoints& seen, const labels::Vec2f& place) {
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
