// Draws the labels of a frame (step_scene.hpp).

#include <algorithm>
#include <cassert>
#include <cmath>

#include "core/labels/edit/operations.hpp"
#include "core/labels/edit/selection.hpp"
#include "core/labels/model/pixel_sets.hpp"
#include "render/paint.hpp"
#include "render/scenes.hpp"
#include "render/step_scene.hpp"

namespace planescope::render {
namespace {

constexpr std::uint8_t kMuted = 165, kBright = 225, kHighlight = 205;  // alpha values of 255
constexpr Rgba kIgnored{24, 26, 30, 200};

struct Highlights {
  Rgba preview, takes, doubt, marked;
};
Highlights highlights_of(Theme theme) {
  const bool dark = theme == Theme::dark;
  return {.preview = {255, 236, 64, kHighlight},
          .takes = {240, 60, 50, kHighlight},
          .doubt = dark ? Rgba{255, 150, 40, 190} : Rgba{235, 120, 0, 190},
          .marked = dark ? Rgba{255, 64, 160, kHighlight} : Rgba{225, 0, 122, kHighlight}};
}

void blend(std::uint8_t* pixel, Rgba tint) {
  const std::uint8_t above[3] = {tint.r, tint.g, tint.b};
  for (int c = 0; c < 3; ++c)
    pixel[c] = static_cast<std::uint8_t>(pixel[c] + (above[c] - pixel[c]) * tint.a / 255);
}

/// Lit from the camera's upper left, to distinguish surfaces.
std::uint8_t shade_of(const labels::LabelGrid& grid, std::size_t pixel) {
  const Vec3f& normal = grid.normals[pixel];
  if (normal.isZero()) return 150;
  if (grid.is_cloud()) {  // from above, slightly to the side
    const Vec3f down = grid.gravity.direction.cast<float>(), aside = down.unitOrthogonal();
    const Vec3f from = (-down + 0.35f * aside + 0.25f * down.cross(aside)).normalized();
    return static_cast<std::uint8_t>(70 + 165 * std::abs(normal.dot(from)));
  }
  const Vec3f light = (-grid.points[pixel].normalized() + Vec3f(-0.25f, -0.35f, 0)).normalized();
  return static_cast<std::uint8_t>(70 + 165 * std::abs(normal.dot(light)));
}

/// For adjacent pixels: the plane whose outline passes between them, 0 if none. Unmeasured holes
/// are not edges of a plane.
int outline_between(const FrameLabels& labels,
                    const labels::LabelGrid& grid,
                    std::size_t pixel,
                    std::size_t next) {
  const std::uint16_t a = labels.plane.data[pixel], b = labels.plane.data[next];
  if (a == b || !grid.measured[pixel] || !grid.measured[next]) return 0;
  const auto id = [](std::uint16_t plane) { return plane == kPlaneIgnore ? 0 : int{plane}; };
  return std::max(id(a), id(b));
}

void paint_outlines(Image8& image, const labels::LabelGrid& grid, const LabelLook& look) {
  const FrameLabels& labels = *look.labels;
  std::vector<std::uint8_t> hidden(kPlaneIgnore + 1, 0);
  for (const LabelPlane& plane : labels.planes) hidden[plane.id] = plane.hidden;
  const Rgba active = look.theme == Theme::dark ? Rgba{255, 255, 255, 240} : Rgba{0, 0, 0, 240};
  const auto width = static_cast<std::size_t>(grid.width);
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * width + x;
      int id = y + 1 < grid.height ? outline_between(labels, grid, pixel, pixel + width) : 0;
      if (id == 0 && x + 1 < grid.width) id = outline_between(labels, grid, pixel, pixel + 1);
      if (id == 0 || hidden[id]) continue;
      Rgba color = id == look.plane ? active : plane_color(id);
      color.a = 230;
      blend(&image.at(x, y), color);
    }
}

/// The plane's own pixels are colored at any distance, because they may need trimming. Other pixels
/// beyond the scale's range show the image.
void tint_residuals(const labels::LabelGrid& grid,
                    const LabelLook& look,
                    double opacity,
                    std::vector<Rgba>& tints) {
  const Residual& residual = *look.residual;
  std::vector<std::uint8_t> own(tints.size(), 0);
  if (residual.plane == 0)
    for (const std::uint32_t pixel : look.preview) own[pixel] = 1;
  else if (look.labels)
    for (std::size_t i = 0; i < tints.size(); ++i)
      own[i] = look.labels->plane.data[i] == residual.plane;
  const auto alpha =
      static_cast<std::uint8_t>(std::lround(255 * std::clamp(opacity + 0.25, 0.0, 1.0)));
  for (std::size_t i = 0; i < tints.size(); ++i) {
    tints[i] = {0, 0, 0, 0};
    if (!grid.measured[i]) continue;
    const double share = residual.distance_m(grid.points[i]) / residual.most_m;
    if (std::abs(share) > 1 && !own[i]) continue;
    tints[i] = with_alpha(residual_color(share), alpha);
  }
}

}  // namespace

Image8 label_ground(const labels::LabelGrid& grid, Backdrop backdrop) {
  if (backdrop == Backdrop::color && !grid.color.empty()) return grid.color;
  Image8 ground(grid.width, grid.height, 3);
  for (int y = 0; y < grid.height; ++y)
    for (int x = 0; x < grid.width; ++x) {
      const std::size_t pixel = static_cast<std::size_t>(y) * grid.width + x;
      const int hatched = on_hatch(x, y, 8) ? 196 : 214;
      const auto grey =
          grid.measured[pixel] ? shade_of(grid, pixel) : static_cast<std::uint8_t>(hatched);
      std::fill_n(&ground.at(x, y), 3, grey);
    }
  return ground;
}

std::vector<Rgba> label_tints(const labels::LabelGrid& grid,
                              const LabelLook& look,
                              double opacity) {
  std::vector<Rgba> tints(grid.pixels(), Rgba{0, 0, 0, 0});
  if (look.labels) {
    assert(look.labels->plane.pixels() == grid.pixels());
    const auto faded = [opacity](Rgba color, int share) {
      const double alpha = share * std::clamp(opacity, 0.0, 1.0);
      return with_alpha(color, static_cast<std::uint8_t>(std::lround(alpha)));
    };
    std::vector<Rgba> of_plane(kPlaneIgnore + 1, Rgba{0, 0, 0, 0});
    for (const LabelPlane& plane : look.labels->planes) {
      if (plane.hidden) continue;
      const Rgba color = look.show_class ? label_color(plane.label) : plane_color(plane.id);
      of_plane[plane.id] = faded(color, plane.id == look.plane ? kBright : kMuted);
    }
    const Rgba of_class[] = {faded(label_color(Label::h), kMuted / 2),
                             faded(label_color(Label::v), kMuted / 2)};
    const Rgba ignored = faded(kIgnored, kIgnored.a);
    for (std::size_t i = 0; i < tints.size(); ++i) {
      const std::uint16_t plane = look.labels->plane.data[i];
      const std::uint8_t hv = look.labels->hv.data[i];
      tints[i] = plane == 0 && (hv == 1 || hv == 2) ? of_class[hv - 1] : of_plane[plane];
      if (plane != kPlaneIgnore) continue;
      const auto x = static_cast<int>(i % grid.width), y = static_cast<int>(i / grid.width);
      tints[i] = on_hatch(x, y, 6) ? ignored : with_alpha(ignored, ignored.a / 2);
    }
  }
  if (look.residual) tint_residuals(grid, look, opacity, tints);
  const Highlights highlights = highlights_of(look.theme);
  for (std::size_t i = 0; i < look.doubt.size() && i < tints.size(); ++i)
    if (look.doubt[i]) tints[i] = highlights.doubt;
  const auto highlight = [&](std::span<const std::uint32_t> pixels, Rgba color) {
    for (const std::uint32_t pixel : pixels)
      if (pixel < tints.size()) tints[pixel] = color;
  };
  highlight(look.marked, highlights.marked);
  if (look.edit)
    for (const labels::LabelRun& run : look.edit->runs)
      std::fill_n(
          tints.begin() + run.first, run.count,
          run.plane_after == 0 && run.hv_after == 0 ? highlights.takes : highlights.preview);
  const bool shown_by_distance = look.residual && look.residual->plane == 0;
  if (!shown_by_distance)
    highlight(look.preview, look.preview_takes ? highlights.takes : highlights.preview);
  return tints;
}

void paint_labels(Image8& image,
                  const labels::LabelGrid& grid,
                  const LabelLook& look,
                  double opacity) {
  assert(image.pixels() == grid.pixels() && image.channels == 3);
  const std::vector<Rgba> tints = label_tints(grid, look, opacity);
  std::uint8_t* pixel = image.data.data();
  for (const Rgba tint : tints) {
    if (tint.a != 0) blend(pixel, tint);
    pixel += 3;
  }
  if (look.labels) paint_outlines(image, grid, look);
}

DrawPoints label_points(const labels::LabelGrid& grid,
                        std::span<const Vec3f> world,
                        std::span<const std::uint8_t> shown) {
  assert(world.size() == grid.pixels());
  DrawPoints points;
  points.positions.reserve(grid.measured_count);
  points.ids.reserve(grid.measured_count);
  for (std::size_t i = 0; i < world.size(); ++i) {
    if (!grid.measured[i] || (!shown.empty() && !shown[i])) continue;
    points.positions.push_back(world[i]);
    points.ids.push_back(static_cast<std::uint32_t>(i + 1));
  }
  const labels::SpaceView drawn = labels::view_of_points(grid);  // strokes select points as drawn
  points.size_m = drawn.point_size_m;
  points.min_px = drawn.min_px;
  points.max_px = drawn.max_px;
  return points;
}

void color_label_points(DrawPoints& points,
                        const Image8& ground,
                        const labels::LabelGrid& grid,
                        const LabelLook& look) {
  const std::vector<Rgba> tints = label_tints(grid, look, 1);
  points.colors.resize(points.ids.size());
  for (std::size_t k = 0; k < points.ids.size(); ++k) {
    const std::size_t pixel = points.ids[k] - 1;
    std::uint8_t color[3];
    std::copy_n(&ground.data[3 * pixel], 3, color);
    blend(color, tints[pixel]);
    points.colors[k] = {color[0], color[1], color[2]};
  }
}

std::vector<LabelPlace> label_places(const FrameLabels& labels, const labels::LabelGrid& grid) {
  std::vector<InteriorPoint> inside;  // for images, by id - 1
  if (!grid.is_cloud()) {
    RegionImage regions(labels.plane.width, labels.plane.height);
    std::ranges::copy(labels.plane.data, regions.data.begin());
    inside = interior_points(regions, labels.planes.empty() ? 0 : labels.planes.back().id);
  }
  std::vector<LabelPlace> places;
  for (const LabelPlane& plane : labels.planes) {
    if (plane.hidden) continue;
    if (grid.is_cloud()) {
      const labels::PixelSet pixels = labels::pixels_of_plane(labels, plane.id);
      if (!pixels.empty()) places.push_back({plane.id, labels::deepest_pixel(pixels, grid)});
    } else if (const InteriorPoint& at = inside[plane.id - 1]; at.depth_px > 0) {
      places.push_back({plane.id, static_cast<std::uint32_t>(at.y * labels.plane.width + at.x)});
    }
  }
  return places;
}

}  // namespace planescope::render
