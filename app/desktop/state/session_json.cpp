#include "app/desktop/state/session_json.hpp"

#include <algorithm>
#include <nlohmann/json.hpp>

namespace planescope::desktop {
namespace {

using Json = nlohmann::ordered_json;

Json vector_json(const Vec3d& v) { return {v.x(), v.y(), v.z()}; }
Vec3d vector_of(const Json& json) {
  return {json.at(0).get<double>(), json.at(1).get<double>(), json.at(2).get<double>()};
}

Json camera_json(const render::Camera& camera) {
  return {{"eye", vector_json(camera.eye)},
          {"target", vector_json(camera.target)},
          {"up", vector_json(camera.up)}};
}
render::Camera camera_of(const Json& json) {
  render::Camera camera;
  camera.eye = vector_of(json.at("eye"));
  camera.target = vector_of(json.at("target"));
  camera.up = vector_of(json.at("up"));
  return camera;
}

template <typename Enum>
void enum_of(const Json& json, const char* key, int count, Enum& value) {
  if (json.contains(key))
    value = static_cast<Enum>(std::clamp(json.at(key).get<int>(), 0, count - 1));
}
template <typename T>
void value_of(const Json& json, const char* key, T& value) {
  if (json.contains(key)) value = json.at(key).get<T>();
}
void share_of(const Json& json, const char* key, double& value) {
  value_of(json, key, value);
  value = std::clamp(value, 0.0, 0.9);
}

}  // namespace

std::string json_problem(const std::exception& problem) {
  const std::string text = problem.what();
  const std::size_t at = text.starts_with("[json.exception") ? text.find("] ") : std::string::npos;
  return at == std::string::npos ? text : text.substr(at + 2);
}

Json bookmark_json(const Bookmark& b) {
  return {{"name", b.name},   {"note", b.note},     {"frame", b.frame},
          {"step", b.step},   {"node", b.node},     {"plane", b.plane},
          {"voxel", b.voxel}, {"filter", b.filter}, {"camera", camera_json(b.camera)}};
}

Bookmark bookmark_of(const Json& json) {
  Bookmark b;
  b.name = json.at("name");
  b.note = json.at("note");
  b.frame = json.at("frame");
  b.step = json.at("step");
  b.node = json.at("node");
  b.plane = json.at("plane");
  b.voxel = json.at("voxel");
  b.filter = json.at("filter");
  b.camera = camera_of(json.at("camera"));
  return b;
}

Json breakpoint_json(const Breakpoint& b) {
  return {{"kind", static_cast<int>(b.kind)},
          {"filter", b.filter},
          {"index", b.index},
          {"enabled", b.enabled}};
}

Breakpoint breakpoint_of(const Json& json) {
  Breakpoint b;
  enum_of(json, "kind", 3, b.kind);
  b.filter = json.at("filter");
  b.index = json.at("index");
  b.enabled = json.at("enabled");
  return b;
}

Json view_json(const ViewState& view) {
  const Layout& l = view.layout;
  return {{"color_by", static_cast<int>(view.color_by)},
          {"show_queue", view.show_queue},
          {"show_settled", view.show_settled},
          {"show_planes", view.show_planes},
          {"backdrop", static_cast<int>(view.backdrop)},
          {"overlay_opacity", view.overlay_opacity},
          {"theme", static_cast<int>(view.theme)},
          {"zoom", view.zoom},
          {"inspector_tab", view.inspector_tab},
          {"tool_tab", view.tool_tab},
          {"octree_search", view.octree_search},
          {"only_matches", view.only_matches},
          {"rate", view.playing.steps_per_s},
          {"brush_px", view.label.brush_px},
          {"wand_tolerance_m", view.label.wand_options.tolerance_m},
          {"through", view.label.through},
          {"truth_plane", view.truth_plane},
          {"layout",
           {{"left", l.left},
            {"right", l.right},
            {"bottom", l.bottom},
            {"image", l.image},
            {"octree", l.octree},
            {"tools", l.tools}}}};
}

void view_of(const Json& json, ViewState& view) {
  enum_of(json, "color_by", 6, view.color_by);
  value_of(json, "show_queue", view.show_queue);
  value_of(json, "show_settled", view.show_settled);
  value_of(json, "show_planes", view.show_planes);
  enum_of(json, "backdrop", 2, view.backdrop);
  value_of(json, "overlay_opacity", view.overlay_opacity);
  enum_of(json, "theme", 2, view.theme);
  value_of(json, "zoom", view.zoom);
  view.zoom = std::clamp(view.zoom, 0.6, 3.0);
  value_of(json, "inspector_tab", view.inspector_tab);
  value_of(json, "tool_tab", view.tool_tab);
  value_of(json, "octree_search", view.octree_search);
  value_of(json, "only_matches", view.only_matches);
  value_of(json, "rate", view.playing.steps_per_s);
  view.playing.steps_per_s = std::clamp(view.playing.steps_per_s, 1.0, 100000.0);
  value_of(json, "brush_px", view.label.brush_px);
  view.label.brush_px = std::clamp(view.label.brush_px, 1.0, 200.0);
  value_of(json, "wand_tolerance_m", view.label.wand_options.tolerance_m);
  view.label.wand_options.tolerance_m =
      std::clamp(view.label.wand_options.tolerance_m, 0.0005, 0.1);
  value_of(json, "through", view.label.through);
  value_of(json, "truth_plane", view.truth_plane);
  if (json.contains("layout")) {
    const Json& l = json.at("layout");
    share_of(l, "left", view.layout.left);
    share_of(l, "right", view.layout.right);
    share_of(l, "bottom", view.layout.bottom);
    share_of(l, "image", view.layout.image);
    share_of(l, "octree", view.layout.octree);
    share_of(l, "tools", view.layout.tools);
  }
}

}  // namespace planescope::desktop
