// Renders draw lists with OpenGL, and finds the parts of a picture that changed.

#include "render/renderer.hpp"

#include <algorithm>
#include <cmath>
#include <ranges>
#include <utility>

#include "render/gl.hpp"

PLANESCOPE_ASSET_DECLARE(background_frag);
PLANESCOPE_ASSET_DECLARE(fullscreen_vert);
PLANESCOPE_ASSET_DECLARE(shade_frag);

namespace planescope::render {
namespace {

// Restores the caller's bindings, so that a window can continue drawing.
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

 private:
  GLint draw_ = 0, read_ = 0, viewport_[4] = {};
};

/// A drawing task: content and target rectangle, whose rows GL counts from the bottom.
struct Picture {
  const DrawList& list;
  const View& view;
  const ThemeColors& theme;
  const SceneTarget& target;
  Part part;

  int bottom() const { return view.height - part.y1; }
  /// Disables the scissor test, which otherwise restricts drawing to the part: whole rectangles are
  /// copied bit by bit, but clipped ones may be drawn, with rounded depths.
  void copy(GLuint from, GLuint to, GLbitfield what) const {
    const int top = view.height - part.y0;
    glBindFramebuffer(GL_READ_FRAMEBUFFER, from);
    glBindFramebuffer(GL_DRAW_FRAMEBUFFER, to);
    const bool in_part = glIsEnabled(GL_SCISSOR_TEST) == GL_TRUE;
    glDisable(GL_SCISSOR_TEST);
    glBlitFramebuffer(part.x0, bottom(), part.x1, top, part.x0, bottom(), part.x1, top, what,
                      GL_NEAREST);
    if (in_part) glEnable(GL_SCISSOR_TEST);
  }
};

template <typename T>
void flip_rows(Image<T>& image) {
  const std::ptrdiff_t row = std::ptrdiff_t{image.width} * image.channels;
  for (int y = 0; y < image.height / 2; ++y) {
    const auto from = image.data.begin() + row * y;
    std::swap_ranges(from, from + row, image.data.end() - row * (y + 1));
  }
}

// Farthest first, because they are translucent.
std::vector<const DrawPolygon*> back_to_front(const DrawList& list, const View& view) {
  std::vector<std::pair<float, const DrawPolygon*>> items;
  for (const DrawPolygon& polygon : list.polygons) {
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

bool is_solid(const DrawBox& box) { return box.style != BoxStyle::outline; }

/// A retained picture and a description of its content.
struct Sheet {
  explicit Sheet(int samples) : target(samples) {}

  SceneTarget target;
  std::uint64_t seen_from = 0;  // hash of the view and the theme
  Tiles tiles;                  // empty: unknown

  /// Parts that must be redrawn to show the list.
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
    constexpr std::size_t kMostParts = 4;  // each part runs all passes
    // Shading depends on neighboring points, so parts must be far enough apart.
    return apart(at_most(tiles.changes_since(before), kMostParts),
                 static_cast<int>(std::ceil(radius_px)) + 1);
  }
};

}  // namespace

struct Renderer::State {
  Sheet fine = Sheet(4);
  Sheet quick = Sheet(0);
  std::vector<Part> changes;
  SceneTarget picture = SceneTarget(0);  // lines and outlines are already antialiased
  IdTarget id_target;
  GlProgram background = make_program(
      "background", PLANESCOPE_ASSET(fullscreen_vert), PLANESCOPE_ASSET(background_frag));
  GlProgram shade =
      make_program("shade", PLANESCOPE_ASSET(fullscreen_vert), PLANESCOPE_ASSET(shade_frag));
  GlVertexArray nothing = GlVertexArray::make();  // for the full-screen triangle
  PointPass points;
  BoxPass boxes;
  SegmentPass segments;
  PolygonPass polygons;
  ShapePass shapes;
  TextPass texts;
  // The last drawn points: pictures of one frame often differ only in colors.
  SplatLayer layer;
  std::vector<DrawPoints> layer_points;
  View layer_view;

  void draw_points(const Picture& picture);
  void show_points(const Picture& picture);
  void draw_over_points(const Picture& picture);
  void draw_boxes(const Picture& picture);
  void draw_polygons(const Picture& picture);
  void draw_lines(const Picture& picture);
  void draw_overlay(const Overlay& overlay, const View& view);
};

// Draws points with GL on the theme's background, shaded by their neighbors.
void Renderer::State::draw_points(const Picture& p) {
  glBindFramebuffer(GL_FRAMEBUFFER, p.target.scene);
  glClear(GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
  glEnable(GL_MULTISAMPLE);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_BLEND);
  glUseProgram(background);
  set_uniform(background, "top", p.theme.background_top);
  set_uniform(background, "bottom", p.theme.background_bottom);
  set_uniform(background, "viewport", p.view.size_px());
  glBindVertexArray(nothing);
  glDrawArrays(GL_TRIANGLES, 0, 3);

  glEnable(GL_DEPTH_TEST);
  glEnable(GL_SAMPLE_ALPHA_TO_COVERAGE);  // order-independent soft edges
  points.draw(p.list.points, p.view, Output::color);
  glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);

  p.copy(p.target.scene, p.target.resolved, GL_DEPTH_BUFFER_BIT);
  glBindFramebuffer(GL_FRAMEBUFFER, p.target.scene);
  glUseProgram(shade);
  glActiveTexture(GL_TEXTURE0);
  glBindTexture(GL_TEXTURE_2D, p.target.flat_depth);
  set_uniform(shade, "depth", 0);
  set_uniform(shade, "proj", p.view.proj);
  set_uniform(shade, "orthographic", p.view.orthographic);
  set_uniform(shade, "radius_px", shade_radius_px(p.view));
  set_uniform(shade, "strength", 60.0f);
  glDisable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_DST_COLOR, GL_ZERO);
  glBindVertexArray(nothing);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  glBindTexture(GL_TEXTURE_2D, 0);
}

// Draws points on the CPU.
void Renderer::State::show_points(const Picture& p) {
  const View& view = p.view;
  const bool is_there = layer.width == view.width && layer.height == view.height &&
                        view.view == layer_view.view && view.proj == layer_view.proj &&
                        same_shapes(p.list.points, layer_points);
  if (!is_there) {
    layer = splat(p.list.points, view);
    layer_points = p.list.points;
    layer_view = view;
    glBindTexture(GL_TEXTURE_2D, p.target.flat_depth);
    glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, view.width, view.height, GL_DEPTH_COMPONENT,
                    GL_UNSIGNED_INT, depths(layer, view).data());
  }
  const Image8 image = paint(layer, p.list.points, p.theme);
  glBindTexture(GL_TEXTURE_2D, p.target.flat_color);
  glTexSubImage2D(GL_TEXTURE_2D, 0, 0, 0, view.width, view.height, GL_RGBA, GL_UNSIGNED_BYTE,
                  image.data.data());
  glBindTexture(GL_TEXTURE_2D, 0);
  p.copy(p.target.resolved, p.target.scene, GL_COLOR_BUFFER_BIT | GL_DEPTH_BUFFER_BIT);
}

// Translucent objects do not write depth.
void Renderer::State::draw_over_points(const Picture& p) {
  glBindFramebuffer(GL_FRAMEBUFFER, p.target.scene);
  glEnable(GL_DEPTH_TEST);
  glEnable(GL_BLEND);
  glBlendFunc(GL_SRC_ALPHA, GL_ONE_MINUS_SRC_ALPHA);
  glDepthMask(GL_FALSE);
  draw_boxes(p);
  draw_polygons(p);
  draw_lines(p);
  glDepthMask(GL_TRUE);
  glDisable(GL_DEPTH_TEST);
}

// Solid boxes occlude each other to stay readable, but not the points in them: only the nearest
// face tints objects behind it. Boxes without faces occlude nothing.
void Renderer::State::draw_boxes(const Picture& p) {
  std::vector<Segment> solid_edges, open_edges;
  for (const DrawBox& box : p.list.boxes)
    append_edges(box, p.view, is_solid(box) ? solid_edges : open_edges);
  if (!solid_edges.empty()) {
    p.copy(p.target.scene, p.target.boxes, GL_DEPTH_BUFFER_BIT);
    glBindFramebuffer(GL_FRAMEBUFFER, p.target.boxes);
    const auto draw_faces = [&] {
      const auto hatch_period_px = static_cast<float>(7 * overlay_scale(p.view));
      boxes.draw(p.list.boxes, p.view, 0.30f, hatch_period_px, Output::color);
    };
    glDepthMask(GL_TRUE);
    glColorMask(GL_FALSE, GL_FALSE, GL_FALSE, GL_FALSE);
    draw_faces();
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    glDepthMask(GL_FALSE);
    draw_faces();
    segments.draw(solid_edges, p.view, p.theme.halo, Output::color);
    glBindFramebuffer(GL_FRAMEBUFFER, p.target.scene);
  }
  segments.draw(open_edges, p.view, p.theme.halo, Output::color);
}

void Renderer::State::draw_polygons(const Picture& p) {
  const std::vector<const DrawPolygon*> sorted = back_to_front(p.list, p.view);
  polygons.draw(sorted, p.view, p.list.lift_m(), Output::color);
  std::vector<Segment> outlines;
  for (const DrawPolygon* polygon : sorted) append_outline(*polygon, p.list.lift_m(), outlines);
  segments.draw(outlines, p.view, p.theme.halo, Output::color);
}

void Renderer::State::draw_lines(const Picture& p) {
  const float lift_m = p.list.lift_m();
  std::vector<Segment> all, through;
  for (const DrawLines& lines : p.list.lines) {
    for (std::size_t i = 0; i < lines.colors.size() && 2 * i + 1 < lines.positions.size(); ++i) {
      all.push_back({lines.positions[2 * i], lines.positions[2 * i + 1], lines.colors[i],
                     lines.width_px, 0, lines.lifted ? lift_m : 0.001f, 0});
      if (!lines.shine_through) continue;
      through.push_back(all.back());
      through.back().color.a = static_cast<std::uint8_t>(lines.colors[i].a / 3);
    }
  }
  glDisable(GL_DEPTH_TEST);
  segments.draw(through, p.view, p.theme.halo, Output::color);
  glEnable(GL_DEPTH_TEST);
  for (const DrawArrow& arrow : p.list.arrows)
    all.push_back({arrow.from, arrow.to, arrow.color, arrow.width_px, 1, lift_m, 0});
  segments.draw(all, p.view, p.theme.halo, Output::color);
}

void Renderer::State::draw_overlay(const Overlay& overlay, const View& view) {
  texts.draw(overlay.labels, view);
  shapes.draw(overlay.shapes, view);
  segments.draw_flat(overlay.segments, view.width, view.height);
  texts.draw(overlay.texts, view);
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
  Sheet& sheet = effort == Effort::fine ? state_->fine : state_->quick;
  const RestoredBindings restored;
  if (sheet.target.width != width || sheet.target.height != height) sheet.seen_from = 0;
  sheet.target.resize(width, height);
  const View view = make_view(camera, width, height, screen_scale);
  Picture picture{list, view, theme_colors(theme), sheet.target, {}};
  const Overlay overlay = layout_overlay(list, view, picture.theme);
  state_->changes = sheet.turn_to(list, overlay, view, theme);
  glViewport(0, 0, width, height);
  glEnable(GL_SCISSOR_TEST);
  for (const Part& part : state_->changes) {
    picture.part = part;
    glScissor(part.x0, picture.bottom(), part.x1 - part.x0, part.y1 - part.y0);
    state_->draw_points(picture);
    state_->draw_over_points(picture);
    picture.copy(sheet.target.scene, sheet.target.resolved, GL_COLOR_BUFFER_BIT);
    glBindFramebuffer(GL_FRAMEBUFFER, sheet.target.resolved);
    state_->draw_overlay(overlay, view);
  }
  glDisable(GL_SCISSOR_TEST);
  check_gl("drawing a picture");
  return sheet.target.flat_color;
}

std::span<const Part> Renderer::changes() const { return state_->changes; }

Image8 Renderer::render(
    const DrawList& list, const Camera& camera, int width, int height, Theme theme, Image8* bare) {
  const RestoredBindings restored;
  state_->picture.resize(width, height);
  const View view = make_view(camera, width, height);
  const Picture picture{list, view, theme_colors(theme), state_->picture, {0, 0, width, height}};

  glViewport(0, 0, width, height);
  state_->show_points(picture);
  state_->draw_over_points(picture);
  const auto draw_part = [&](OverlayPart part) {
    state_->draw_overlay(layout_overlay(list, view, picture.theme, part), view);
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
  // From here on the nearest object wins: faces of boxes only tint the objects behind them.
  if (list.pick_points_first) {
    glClearBufferfv(GL_DEPTH, 0, &farthest);
    draw_points();
  }
  const float bias_m = (list.pick_points_first ? -1.0F : 1.0F) * list.lift_m();
  state_->polygons.draw(back_to_front(list, view), view, bias_m, Output::id);
  std::vector<Segment> edges;  // for open boxes, wide enough to hit
  for (const DrawBox& box : list.boxes)
    if (!is_solid(box) && box.id != 0) append_edges(box, view, edges);
  for (Segment& edge : edges) edge.width_px = 5;
  state_->segments.draw(edges, view, {}, Output::id);

  Image<std::uint32_t> ids(width, height);
  glReadPixels(0, 0, width, height, GL_RED_INTEGER, GL_UNSIGNED_INT, ids.data.data());
  flip_rows(ids);
  check_gl("drawing ids");
  return ids;
}

}  // namespace planescope::render
