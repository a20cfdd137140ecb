// Selects the pixels of a drawn shape, on the image or in a view of the point cloud.

#include "core/labels/edit/selection.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace planescope::labels {

// Rasterizes drawn shapes, row by row.

namespace {

/// Sets the pixels of a row with centers in [from, to].
void fill(Image8& mask, int row, float from, float to) {
  const float last = static_cast<float>(mask.width) - 0.5f;
  if (!(from <= last) || !(to >= 0.5f)) return;
  const int first_x = static_cast<int>(std::ceil(std::max(from, 0.5f) - 0.5f));
  const int last_x = static_cast<int>(std::floor(std::min(to, last) - 0.5f));
  for (int x = first_x; x <= last_x; ++x) mask.at(x, row) = 1;
}

/// Rows of the picture with centers in [from, to]: first and one past the last.
std::pair<int, int> rows_between(const Image8& mask, float from, float to) {
  const float height = static_cast<float>(mask.height);
  if (!(from < height) || !(to > 0)) return {0, 0};
  return {static_cast<int>(std::ceil(std::max(from, 0.5f) - 0.5f)),
          static_cast<int>(std::floor(std::min(to, height - 0.5f) - 0.5f)) + 1};
}

/// Fills everything within `radius` of the line from a to b. The capsule is convex, so each row has
/// one span: the hull of its parts in the two discs and the rectangle between them.
void fill_capsule(Image8& mask, const Vec2f& a, const Vec2f& b, float radius) {
  const auto [first, end] =
      rows_between(mask, std::min(a.y(), b.y()) - radius, std::max(a.y(), b.y()) + radius);
  const float length = (b - a).norm();
  const Vec2f side =
      length > 0 ? Vec2f(Vec2f(a.y() - b.y(), b.x() - a.x()) * (radius / length)) : Vec2f(0, 0);
  const std::array<Vec2f, 4> corners{Vec2f(a + side), Vec2f(b + side), Vec2f(b - side),
                                     Vec2f(a - side)};
  for (int row = first; row < end; ++row) {
    const float y = static_cast<float>(row) + 0.5f;
    float from = std::numeric_limits<float>::max(), to = -from;
    const auto include = [&](float x0, float x1) {
      from = std::min(from, x0);
      to = std::max(to, x1);
    };
    for (const Vec2f& center : {a, b}) {
      const float dy = y - center.y();
      if (std::abs(dy) > radius) continue;
      const float half = std::sqrt(radius * radius - dy * dy);
      include(center.x() - half, center.x() + half);
    }
    for (int k = 0; k < 4 && length > 0; ++k) {
      const Vec2f &p = corners[k], &q = corners[(k + 1) % 4];
      if ((p.y() <= y) == (q.y() <= y)) continue;
      const float x = p.x() + (y - p.y()) / (q.y() - p.y()) * (q.x() - p.x());
      include(x, x);
    }
    fill(mask, row, from, to);
  }
}

/// Even-odd rule; the path is closed.
void fill_area(Image8& mask, const std::vector<Vec2f>& path) {
  float top = std::numeric_limits<float>::max(), bottom = -top;
  for (const Vec2f& p : path) {
    top = std::min(top, p.y());
    bottom = std::max(bottom, p.y());
  }
  const auto [first, end] = rows_between(mask, top, bottom);
  std::vector<float> crossings;
  for (int row = first; row < end; ++row) {
    const float y = static_cast<float>(row) + 0.5f;
    crossings.clear();
    for (std::size_t k = 0; k < path.size(); ++k) {
      const Vec2f &p = path[k], &q = path[(k + 1) % path.size()];
      if ((p.y() <= y) == (q.y() <= y)) continue;
      crossings.push_back(p.x() + (y - p.y()) / (q.y() - p.y()) * (q.x() - p.x()));
    }
    std::ranges::sort(crossings);
    for (std::size_t k = 0; k + 1 < crossings.size(); k += 2)
      fill(mask, row, crossings[k], crossings[k + 1]);
  }
}

}  // namespace

Image8 mask_of(const DrawnShape& shape, int width, int height) {
  Image8 mask(width, height);
  std::vector<Vec2f> path = shape.path;
  std::erase_if(path, [](const Vec2f& p) { return !p.allFinite(); });
  if (path.empty()) return mask;
  if (shape.kind == DrawnShape::Kind::area) {
    fill_area(mask, path);
  } else {
    for (std::size_t k = 0; k < path.size(); ++k)
      fill_capsule(mask, path[k > 0 ? k - 1 : 0], path[k], std::max(shape.radius_px, 0.0f));
  }
  return mask;
}

namespace {

constexpr float kNoises = 4;  // a point this far behind the nearest surface still belongs to it ...
constexpr float kSplats = 1.5f;  // ... or this many splat diameters: surfaces seen at a slant
constexpr float kNothing = std::numeric_limits<float>::infinity();

/// A point as drawn in the view.
struct Splat {
  Vec2f place;        // [view px]
  float depth_m = 0;  // along the view
  float radius_px = 0;
  float radius_m = 0;
};

class Projection {
 public:
  explicit Projection(const SpaceView& view) : view_(view) {
    // Depth along the view in meters: w for perspective, the scaled z for orthographic.
    const int row = view.orthographic ? 2 : 3;
    const float scale = view.clip_from_sensor.block<1, 3>(row, 0).norm();
    depth_row_ = view.clip_from_sensor.row(row) / (scale > 0 ? scale : 1.0f);
  }

  /// False if it is outside the view.
  bool project(const Vec3f& point, Splat& splat) const {
    const Eigen::Vector4f clip = view_.clip_from_sensor * point.homogeneous();
    const float w = clip.w();
    if (!(w > 0) ||
        !(std::abs(clip.x()) <= w && std::abs(clip.y()) <= w && std::abs(clip.z()) <= w))
      return false;
    splat.place.x() = (0.5f + 0.5f * clip.x() / w) * static_cast<float>(view_.width);
    splat.place.y() = (0.5f - 0.5f * clip.y() / w) * static_cast<float>(view_.height);
    splat.depth_m = depth_row_.dot(point.homogeneous());
    const float px_per_m =
        view_.orthographic ? view_.px_per_m : view_.px_per_m / std::max(splat.depth_m, 1e-6f);
    splat.radius_px = 0.5f * std::clamp(view_.point_size_m * px_per_m, view_.min_px, view_.max_px);
    splat.radius_m = splat.radius_px / px_per_m;
    return true;
  }

 private:
  const SpaceView& view_;
  Eigen::RowVector4f depth_row_;
};

/// The nearest splat on each pixel.
class DepthBuffer {
 public:
  DepthBuffer(int width, int height)
      : width_(width),
        height_(height),
        depth_(static_cast<std::size_t>(width) * height, kNothing) {}

  void draw(const Splat& splat) {
    const float r = splat.radius_px, x = splat.place.x(), y = splat.place.y();
    const auto [top, bottom] = covered(y, r, height_);
    for (int row_index = top; row_index < bottom; ++row_index) {
      float half = r;
      if (r > kSquare_px) {
        const float dy = static_cast<float>(row_index) + 0.5f - y;
        half = std::sqrt(std::max(0.0f, r * r - dy * dy));
      }
      const auto [left, right] = covered(x, half, width_);
      float* row = depth_.data() + static_cast<std::size_t>(row_index) * width_;
      for (int i = left; i < right; ++i) row[i] = std::min(row[i], splat.depth_m);
    }
  }
  float nearest_at(const Vec2f& place) const {
    const int x = std::min(width_ - 1, static_cast<int>(place.x()));
    const int y = std::min(height_ - 1, static_cast<int>(place.y()));
    return depth_[static_cast<std::size_t>(y) * width_ + x];
  }

 private:
  static constexpr float kSquare_px = 1.5f;  // smaller splats are drawn as squares

  /// Pixels with centers within `reach` of a position: the first and one past the last.
  static std::pair<int, int> covered(float place, float reach, int size) {
    const float first = place - reach + 0.5f, end = place + reach + 0.5f;
    return {std::max(0, static_cast<int>(first)), std::min(size, static_cast<int>(end))};
  }

  int width_, height_;
  std::vector<float> depth_;
};

}  // namespace

PixelSet pixels_on_image(const LabelGrid& grid,
                         const DrawnShape& shape,
                         std::span<const std::uint8_t> shown) {
  assert(shown.empty() || shown.size() == grid.pixels());
  const Image8 mask = mask_of(shape, grid.width, grid.height);
  PixelSet pixels;
  for (std::size_t i = 0; i < mask.data.size(); ++i)
    if (mask.data[i] && grid.measured[i] && (shown.empty() || shown[i]))
      pixels.push_back(static_cast<std::uint32_t>(i));
  return pixels;
}

SpaceView view_of_points(const LabelGrid& grid) {
  constexpr float kMostOfCloud_px = 48, kCovers = 1.5f;
  SpaceView view;
  if (grid.is_cloud()) {
    view.point_size_m = kCovers * static_cast<float>(grid.spacing_m);
    view.max_px = kMostOfCloud_px;
  }
  return view;
}

SeenPoints see(const LabelGrid& grid, const SpaceView& view, std::span<const std::uint8_t> shown) {
  assert(shown.empty() || shown.size() == grid.pixels());
  SeenPoints seen;
  seen.width = view.width;
  seen.height = view.height;
  seen.place.resize(grid.pixels(), Vec2f::Constant(std::numeric_limits<float>::quiet_NaN()));
  seen.visible.resize(grid.pixels(), 0);
  if (view.width <= 0 || view.height <= 0) return seen;
  if (grid.is_cloud()) {
    seen.radius_px.resize(grid.pixels(), 0);
    seen.depth_m.resize(grid.pixels(), 0);
  }
  const Projection projection(view);
  DepthBuffer nearest(view.width, view.height);
  std::vector<std::uint32_t> inside;
  std::vector<Splat> splats;
  inside.reserve(grid.measured_count);
  splats.reserve(grid.measured_count);
  Splat splat;
  for (std::size_t i = 0; i < grid.pixels(); ++i) {
    if (!grid.measured[i] || (!shown.empty() && !shown[i])) continue;
    if (!projection.project(grid.points[i], splat)) continue;
    nearest.draw(splat);
    seen.place[i] = splat.place;
    if (grid.is_cloud()) {
      seen.radius_px[i] = splat.radius_px;
      seen.depth_m[i] = splat.depth_m;
    }
    inside.push_back(static_cast<std::uint32_t>(i));
    splats.push_back(splat);
  }
  for (std::size_t k = 0; k < inside.size(); ++k) {
    const float sigma_m = grid.sigma_m[inside[k]];
    const float tolerance_m = kNoises * sigma_m + kSplats * 2 * splats[k].radius_m;
    seen.visible[inside[k]] =
        splats[k].depth_m <= nearest.nearest_at(splats[k].place) + tolerance_m;
  }
  return seen;
}

SpaceSelection points_in_space(const SeenPoints& seen, const DrawnShape& shape, bool through) {
  SpaceSelection selection;
  if (seen.width <= 0 || seen.height <= 0) return selection;
  const Image8 mask = mask_of(shape, seen.width, seen.height);
  for (std::size_t i = 0; i < seen.place.size(); ++i) {
    const Vec2f& place = seen.place[i];
    if (std::isnan(place.x())) continue;
    const int x = std::min(seen.width - 1, static_cast<int>(place.x()));
    const int y = std::min(seen.height - 1, static_cast<int>(place.y()));
    if (!mask.at(x, y)) continue;
    if (!seen.visible[i]) ++selection.hidden;
    if (seen.visible[i] || through) selection.pixels.push_back(static_cast<std::uint32_t>(i));
  }
  return selection;
}

std::vector<std::uint8_t> shown_pixels(const FrameLabels& labels) {
  std::vector<std::uint8_t> shown_plane(kPlaneIgnore + 1, 1);
  for (const LabelPlane& plane : labels.planes) shown_plane[plane.id] = !plane.hidden;
  std::vector<std::uint8_t> shown;
  shown.reserve(labels.plane.data.size());
  for (const std::uint16_t id : labels.plane.data) shown.push_back(shown_plane[id]);
  return shown;
}

}  // namespace planescope::labels
