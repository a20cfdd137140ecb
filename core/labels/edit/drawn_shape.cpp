// Drawn shapes onto pixels, row by row.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "core/labels/edit/selection.hpp"

namespace planescope::labels {
namespace {

/// Sets the pixels of a row whose centres lie in [from, to].
void fill(Image8& mask, int row, float from, float to) {
  const float last = static_cast<float>(mask.width) - 0.5f;
  if (!(from <= last) || !(to >= 0.5f)) return;
  const int first_x = static_cast<int>(std::ceil(std::max(from, 0.5f) - 0.5f));
  const int last_x = static_cast<int>(std::floor(std::min(to, last) - 0.5f));
  for (int x = first_x; x <= last_x; ++x) mask.at(x, row) = 1;
}

/// Rows of the picture whose centres lie in [from, to]: first and one past the last.
std::pair<int, int> rows_between(const Image8& mask, float from, float to) {
  const float height = static_cast<float>(mask.height);
  if (!(from < height) || !(to > 0)) return {0, 0};
  return {static_cast<int>(std::ceil(std::max(from, 0.5f) - 0.5f)),
          static_cast<int>(std::floor(std::min(to, height - 0.5f) - 0.5f)) + 1};
}

/// Everything within `radius` of the line from a to b. That is convex: one span per row, the hull
/// of what the two discs and the rectangle between them have of it.
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
    for (const Vec2f& centre : {a, b}) {
      const float dy = y - centre.y();
      if (std::abs(dy) > radius) continue;
      const float half = std::sqrt(radius * radius - dy * dy);
      include(centre.x() - half, centre.x() + half);
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

/// Even-odd, the path closed.
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

}  // namespace planescope::labels
