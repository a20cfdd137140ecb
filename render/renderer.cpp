#include "render/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>

#include "render/gl.hpp"
#include "render/passes.hpp"
#include "render/tiles.hpp"

PLANESCOPE_ASSET_DECLARE(background_frag);
PLANESCOPE_ASSET_DECLARE(fullscreen_vert);
PLANESCOPE_ASSET_DECLARE(shade_frag);

namespace planescope::render {
namespace {

// Restores what the caller had bound, so that a window can go on drawing around us.
class RestoredBindings {
 public:
  RestoredBindings() {
    glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_);
    glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_);
    glGetIntegerv(GL_VIEWPORT, viewport_);
    glDisable(GL_SCISSOR_TEST);
    glDisable(GL_STENCIL_TEST);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_LEQUAL);
  }
  ~RestoredBindings() {
    glDisable(GL_SCISSOR_TEST);
    glUseProgram(0);
    glBindVertexArray(0);
    glBindBuffer(GL_ARRAY_BUFFER, 0);
    glDisable(GL_DEPTH_TEST);
    glDisable(GL_BLEND);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, static_cast<GLuint>(draw_));
    glBindFramebuffer(GL_READ_FRAMEBUFFER, static_cast<GLuint>(read_));
    glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
  }
  RestoredBindings(const RestoredBindings&) = delete;
  RestoredBindings& operator=(const RestoredBindings&) = delete;

 private:
  GLint draw_ = 0;
  GLint read_ = 0;
  GLint viewport_[4] = {};
};

/// GL counts rows from the bottom.
int bottom_of(const Part& part, const View& view) { return view.height - part.y1; }

/// The scissor test, which keeps to the part elsewhere, is off for it: a whole rectangle is copied
/// bit by bit, but one that is cut off may be drawn, with depths that come out rounded.
void copy(GLuint from, GLuint to, const Part& part, const View& view, GLbitfield what) {
  const int bottom = bottom_of(part, view), top = view.height - part.y0;
  glBindFramebuffer(GL_READ_FRAMEBUFFER, from);
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
  const bool in_part = glIsEnabled(GL_SCISSOR_TEST) == GL_TRUE;
  glDisable(GL_SCISSOR_TEST);
  glBlitFramebuffer(part.x0, bottom, part.x1, top, part.x0, bottom, part.x1, top, what, GL_NEAREST);
  if (in_part) glEnable(GL_SCISSOR_TEST);
}

template <typename T>
void flip_rows(Image<T>& image) {
  const std::size_t row = static_cast<std::size_t>(image.width) * image.channels;
  for (int y = 0; y < image.height / 2; ++y) {
    std::swap_ranges(image.data.begin() + static_cast<std::ptrdiff_t>(row * y),
                     image.data.begin() + static_cast<std::ptrdiff_t>(row * (y + 1)),
                     image.data.end() - static_cast<std::ptrdiff_t>(row * (y + 1)));
  }
}

// The farthest first: they are seen through.
std::vector<const DrawPolygon*> back_to_front(const std::vector<DrawPolygon>& polygons,
                                              const View& view) {
  std::vector<std::pair<float, const DrawPolygon*>> items;
  for (const DrawPolygon& polygon : polygons) {
    if (polygon.corners.empty()) continue;
    Vec3f sum = Vec3f::Zero();
    for (const Vec3f& corner : polygon.corners) sum += corner;
    const Vec3f middle = sum / static_cast<float>(polygon.corners.size());
    items.emplace_back((view.view * middle.homogeneous()).z(), &polygon);
  }
  std::ranges::stable_sort(items, {}, [](const auto& item) { return item.first; });
  const auto sorted = std::views::values(items);
  return {sorted.begin(), sorted.end()};
}

bool same_view(const View& a, const View& b) {
  return a.view == b.view && a.proj == b.proj && a.width == b.width && a.height == b.height;
}

bool is_solid(const DrawBox& box) { return box.style != BoxStyle::outline; }

// Polygons lie over the splats of their own points, which stand out by half their size and noise.
float polygon_bias_m(const DrawList& list) {
  float largest_m = 0;
  for (const DrawPoints& cloud : list.points) largest_m = std::max(largest_m, cloud.size_m);
  return largest_m;
}

/// A picture that is kept, and what it shows.
struct Sheet {
  explicit Sheet(int samples) : target(samples) {}

  SceneTarget target;
  std::uint64_t seen_from = 0;  // of the view and the theme
  Tiles tiles;                  // none: unknown

  /// Where it has to be drawn again to show the list.
  std::vector<Part> turn_to(const DrawList& list,
                            const Overlay& overlay,
                            const View& view,
                            Theme theme) {
    const std::uint64_t from = hashed(1, view.view, view.proj, int{view.orthographic}, view.width,
                                      view.height, static_cast<int>(theme));
    const Tiles before = std::exchange(tiles, {});
    // While the camera moves, nothing is compared.
    if (std::exchange(seen_from, from) != from) return {{0, 0, view.width, view.height}};
    const float radius_px = shade_radius_px(view);
    tiles = scene_tiles(list, overlay, view, radius_px);
    constexpr std::size_t kMostParts = 4;  // each goes through all passes
    // Points are darkened by what is beside them, which must not be about to change.
    return apart(at_most(tiles.changes_since(before), kMostParts),
                 static_cast<int>(std::ceil(radius_px)) + 1);
  }
};

}  // namespace

struct Renderer::State {
  Sheet fine = Sheet(4);
  Sheet quick = Sheet(0);
  std::vector<Part> changes;
  SceneTarget picture = SceneTarget(0);  // lines and outlines have soft edges of their own
  IdTarget id_target;
  GlProgram background = make_program(
      "background", PLANESCOPE_ASSET(fullscreen_vert), PLANESCOPE_ASSET(background_frag));
  GlProgram shade =
      make_program("shade", PLANESCOPE_ASSET(fullscreen_vert), PLANESCOPE_ASSET(shade_frag));
  GlVertexArray nothing = make_vertex_array();  // for the full-screen triangle
  PointPass points;
  BoxPass boxes;
  SegmentPass segments;
  PolygonPass polygons;
  ShapePass shapes;
  TextPass texts;
  // The points drawn last: pictures of one frame often differ in their colors alone.
  SplatLayer layer;
  std::vector<DrawPoints> layer_points;
  View layer_view;

  void draw_background(const View& view, const ThemeColors& theme);
  void draw_points(const DrawList& list, const View& view);
  void shade_points(const SceneTarget& target, const Part& part, const View& view);
  void show_points(const DrawList& list, const View& view, const ThemeColors& theme);
  void draw_over_points(const DrawList& list,
                        const SceneTarget& target,
                        const Part& part,
                        const View& view,
                        const ThemeColors& theme);
  void draw_boxes(const DrawList& list,
                  const SceneTarget& target,
                  const Part& part,
                  const View& view,
                  const ThemeColors& theme);
  void draw_polygons(const DrawList& list, const View& view, const ThemeColors& theme);
  void draw_lines(const DrawList& list, const View& view, const ThemeColors& theme);
  void draw_overlay(const Overlay& overlay, const View& view);
  void draw_scene(const DrawList& list,
                  const Overlay& overlay,
                  const SceneTarget& target,
                  const Part& part,
                  const View& view,
                  const ThemeColors& theme);
};

void Renderer::State::draw_background(const View& view, const ThemeColors& theme) {
  glUseProgram(background);
  set_uniform(background, "top", to_vector(theme.background_top));
  set_uniform(background, "bottom", to_vector(theme.background_bottom));
  set_uniform(background, "viewport", view.size_px());
  glBindVertexArray(nothing);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void Renderer::State::draw_points(const DrawList& list, const View& view) {
  glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);  // soft edges whatever the order
  points.draw(list.points, view, Output::color);
  glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
}

// Into `picture`, on the CPU.
void Renderer::State::show_points(const DrawList& list,
                                  const View& view,
                                  const ThemeColors& theme) {
  const bool is_there =
      layer.width > 0 && same_view(view, layer_view) && same_shapes(list.points, layer_points);
  if (!is_there) {
    layer = splat(list.points, view);
    layer_points = list.points;
    layer_view = view;
    glBindTexture(GL_TEXTURE_2D, picture.flat_depth);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, view.width, view.height, GL_DEPTH_COMPONENT,
                    GL_UNSIGNED_INT, depths(layer, view).data());
  }
  const Image8 image = paint(layer, list.points, theme);
  glBindTexture(GL_TEXTURE_2D, picture.flat_color);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, view.width, view.height, GL_RGBA, GL_UNSIGNED_BYTE,
                  image.data.data());
  glBindTexture(GL_TEXTURE_2D, 0);
  copy(picture.resolved, picture.scene, {0, 0, view.width, view.height}, view,
       GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

void Renderer::State::shade_points(const SceneTarget& target, const Part& part, const View& view) {
  copy(target.scene, target.resolved, part, view, GL_DEPTH_BUFFER_BIT);
  glBindFramebuffer(GL_FRAMEBUFFER, target.scene);
  glUseProgram(shade);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, target.flat_depth);
  set_uniform(shade, "depth", 0);
  set_uniform(shade, "proj", view.proj);
  set_uniform(shade, "orthographic", view.orthographic ? 1 : 0);
  set_uniform(shade, "radius_px", shade_radius_px(view));
  set_uniform(shade, "strength", 60.0f);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_DST_COLOR, GL_ZERO);
  glBindVertexArray(nothing);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindTexture(GL_TEXTURE_2D, 0);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glEnable(GL_DEPTH_TEST);
}

// Solid boxes hide one another, so that many of them stay readable, but not the points in them: of
// each pixel only the nearest face tints what lies behind. Outlines alone hide nothing.
void Renderer::State::draw_boxes(const DrawList& list,
                                 const SceneTarget& target,
                                 const Part& part,
                                 const View& view,
                                 const ThemeColors& theme) {
  std::vector<Segment> solid_edges;
  std::vector<Segment> open_edges;
  for (const DrawBox& box : list.boxes) {
    append_edges(box, view, is_solid(box) ? solid_edges : open_edges);
  }
  if (!solid_edges.empty()) {
    copy(target.scene, target.boxes, part, view, GL_DEPTH_BUFFER_BIT);
    glBindFramebuffer(GL_FRAMEBUFFER, target.boxes);
    const auto hatch_period_px = static_cast<float>(7 * overlay_scale(view));
    const float face_alpha = 0.30f;
    glDepthMask(GL_TRUE);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    boxes.draw(list.boxes, view, face_alpha, hatch_period_px, Output::color);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_FALSE);
    boxes.draw(list.boxes, view, face_alpha, hatch_period_px, Output::color);
    segments.draw(solid_edges, view, theme.halo, Output::color);
    glBindFramebuffer(GL_FRAMEBUFFER, target.scene);
  }
  segments.draw(open_edges, view, theme.halo, Output::color);
}

void Renderer::State::draw_polygons(const DrawList& list,
                                    const View& view,
                                    const ThemeColors& theme) {
  const float bias_m = polygon_bias_m(list);
  const std::vector<const DrawPolygon*> sorted = back_to_front(list.polygons, view);
  polygons.draw(sorted, view, bias_m, Output::color);
  std::vector<Segment> outlines;
  for (const DrawPolygon* polygon : sorted) append_outline(*polygon, bias_m, outlines);
  segments.draw(outlines, view, theme.halo, Output::color);
}

void Renderer::State::draw_lines(const DrawList& list, const View& view, const ThemeColors& theme) {
  const float bias_m = polygon_bias_m(list);
  std::vector<Segment> all, through;
  for (const DrawLines& lines : list.lines) {
    for (std::size_t i = 0; i < lines.colors.size() && 2 * i + 1 < lines.positions.size(); ++i) {
      all.push_back({lines.positions[2 * i], lines.positions[2 * i + 1], lines.colors[i],
                     lines.width_px, 0, lines.lifted ? bias_m : 0.001f, 0});
      if (!lines.shine_through) continue;
      through.push_back(all.back());
      through.back().color.a = static_cast<std::uint8_t>(lines.colors[i].a / 3);
    }
  }
  glDisable(GL_DEPTH_TEST);
  segments.draw(through, view, theme.halo, Output::color);
  glEnable(GL_DEPTH_TEST);
  for (const DrawArrow& arrow : list.arrows) {
    all.push_back({arrow.from, arrow.to, arrow.color, arrow.width_px, 1, bias_m, 0});
  }
  segments.draw(all, view, theme.halo, Output::color);
}

// What is seen through hides nothing.
void Renderer::State::draw_over_points(const DrawList& list,
                                       const SceneTarget& target,
                                       const Part& part,
                                       const View& view,
                                       const ThemeColors& theme) {
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  draw_boxes(list, target, part, view, theme);
  draw_polygons(list, view, theme);
  draw_lines(list, view, theme);
  glDepthMask(GL_TRUE);
}

void Renderer::State::draw_overlay(const Overlay& overlay, const View& view) {
  texts.draw(overlay.labels, view);
  shapes.draw(overlay.shapes, view);
  segments.draw_flat(overlay.segments, view.width, view.height);
  texts.draw(overlay.texts, view);
}

void Renderer::State::draw_scene(const DrawList& list,
                                 const Overlay& overlay,
                                 const SceneTarget& target,
                                 const Part& part,
                                 const View& view,
                                 const ThemeColors& theme) {
  glViewport(0, 0, view.width, view.height);
  glBindFramebuffer(GL_FRAMEBUFFER, target.scene);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_MULTISAMPLE);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  draw_background(view, theme);
  glEnable(GL_DEPTH_TEST);
  draw_points(list, view);
  shade_points(target, part, view);

  draw_over_points(list, target, part, view, theme);
  copy(target.scene, target.resolved, part, view, GL_COLOR_BUFFER_BIT);

  glBindFramebuffer(GL_FRAMEBUFFER, target.resolved);
  glDisable(GL_DEPTH_TEST);
  draw_overlay(overlay, view);
}

Renderer::Renderer() : state_(std::make_unique<State>()) { check_gl("setting up the renderer"); }
Renderer::~Renderer() = default;

std::uint32_t Renderer::draw(const DrawList& list,
                             const Camera& camera,
                             int width,
                             int height,
                             Theme theme,
                             Effort effort,
                             double screen_scale) {
  const ThemeColors& colors = theme_colors(theme);
  Sheet& sheet = effort == Effort::fine ? state_->fine : state_->quick;
  const RestoredBindings restored;
  if (sheet.target.width != width || sheet.target.height != height) sheet.seen_from = 0;
  sheet.target.resize(width, height);
  const View view = make_view(camera, width, height, screen_scale);
  const Overlay overlay = layout_overlay(list, view, colors);
  state_->changes = sheet.turn_to(list, overlay, view, theme);
  glEnable(GL_SCISSOR_TEST);
  for (const Part& part : state_->changes) {
    glScissor(part.x0, bottom_of(part, view), part.x1 - part.x0, part.y1 - part.y0);
    state_->draw_scene(list, overlay, sheet.target, part, view, colors);
  }
  glDisable(GL_SCISSOR_TEST);
  check_gl("drawing a picture");
  return sheet.target.flat_color;
}

std::span<const Part> Renderer::changes() const { return state_->changes; }

Image8 Renderer::render(
    const DrawList& list, const Camera& camera, int width, int height, Theme theme, Image8* bare) {
  const ThemeColors& colors = theme_colors(theme);
  SceneTarget& target = state_->picture;
  const RestoredBindings restored;
  target.resize(width, height);
  const View view = make_view(camera, width, height);

  glViewport(0, 0, width, height);
  state_->show_points(list, view, colors);
  glBindFramebuffer(GL_FRAMEBUFFER, target.scene);
  state_->draw_over_points(list, target, {0, 0, width, height}, view, colors);
  glDisable(GL_DEPTH_TEST);
  const auto draw_part = [&](OverlayPart part) {
    state_->draw_overlay(layout_overlay(list, view, colors, part), view);
  };
  if (bare) {
    draw_part(OverlayPart::scene);
    *bare = read_picture(width, height);
  }
  draw_part(bare ? OverlayPart::panels : OverlayPart::all);
  check_gl("drawing a picture");
  Image8 image = read_picture(width, height);
  check_gl("reading a picture back");
  return image;
}

Image8 read_picture(int width, int height) {
  Image8 image(width, height, 3);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_RGB, GL_UNSIGNED_BYTE, image.data.data());
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  flip_rows(image);
  return image;
}

Image<std::uint32_t> Renderer::render_ids(const DrawList& list,
                                          const Camera& camera,
                                          int width,
                                          int height) {
  IdTarget& target = state_->id_target;
  const RestoredBindings restored;
  target.resize(width, height);
  const View view = make_view(camera, width, height);

  glViewport(0, 0, width, height);
  glBindFramebuffer(GL_FRAMEBUFFER, target.framebuffer);
  const GLuint none[4] = {};
  const GLfloat farthest = 1;
  glClearBufferuiv(GL_COLOR, 0, none);
  glClearBufferfv(GL_DEPTH, 0, &farthest);
  glDisable(GL_BLEND);
  glEnable(GL_DEPTH_TEST);
  const auto draw_points = [&] { state_->points.draw(list.points, view, Output::id); };
  if (!list.pick_points_first) draw_points();
  state_->boxes.draw(list.boxes, view, 0, 1, Output::id);
  // From here on what is nearest counts: faces of boxes only tint what is seen through them.
  if (list.pick_points_first) {
    glClearBufferfv(GL_DEPTH, 0, &farthest);
    draw_points();
  }
  std::vector<const DrawPolygon*> solid = back_to_front(list.polygons, view);
  std::erase_if(solid, [](const DrawPolygon* polygon) { return polygon->id == 0; });
  const float bias_m = (list.pick_points_first ? -1.0F : 1.0F) * polygon_bias_m(list);
  state_->polygons.draw(solid, view, bias_m, Output::id);
  std::vector<Segment> edges;  // of open boxes, wide enough to hit
  for (const DrawBox& box : list.boxes) {
    if (!is_solid(box) && box.id != 0) append_edges(box, view, edges);
  }
  for (Segment& edge : edges) edge.width_px = 5;
  state_->segments.draw(edges, view, {}, Output::id);

  Image<std::uint32_t> ids(width, height);
  glReadPixels(0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, ids.data.data());
  flip_rows(ids);
  check_gl("drawing ids");
  return ids;
}

}  // namespace planescope::render
