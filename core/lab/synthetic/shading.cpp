#include "core/lab/synthetic/shading.hpp"

#include <algorithm>
#include <cmath>

#include "core/lab/synthetic/repeatable.hpp"

namespace planescope::lab {

// ---- Textures ----

namespace {

double lattice(std::int64_t x, std::int64_t y, std::uint64_t stream) {
  return 2 * random_uniform(static_cast<std::uint64_t>(x), static_cast<std::uint64_t>(y), stream) -
         1;
}

/// Smooth noise in -1..1 with features of size 1.
double value_noise(double x, double y, std::uint64_t stream) {
  const double fx = std::floor(x), fy = std::floor(y);
  const auto ix = static_cast<std::int64_t>(fx), iy = static_cast<std::int64_t>(fy);
  double tx = x - fx, ty = y - fy;
  tx *= tx * (3 - 2 * tx);
  ty *= ty * (3 - 2 * ty);
  const double low = (1 - tx) * lattice(ix, iy, stream) + tx * lattice(ix + 1, iy, stream);
  const double high = (1 - tx) * lattice(ix, iy + 1, stream) + tx * lattice(ix + 1, iy + 1, stream);
  return (1 - ty) * low + ty * high;
}

/// The cell of a pattern of rows (each shifted), and the distance to the cell's border [m].
struct Cell {
  std::int64_t row = 0, column = 0;
  double border_m = 0;
};
Cell cell_at(double u, double v, double length, double width, double shift_per_row) {
  Cell cell;
  cell.row = static_cast<std::int64_t>(std::floor(v / width));
  const double shifted = u / length + shift_per_row * static_cast<double>(cell.row);
  cell.column = static_cast<std::int64_t>(std::floor(shifted));
  const double du = (shifted - static_cast<double>(cell.column)) * length;
  const double dv = v - static_cast<double>(cell.row) * width;
  cell.border_m = std::min({du, length - du, dv, width - dv});
  return cell;
}

double planks(double u, double v, std::uint64_t stream) {
  const Cell board = cell_at(u, v, 1.1, 0.11, 0.37);
  if (board.border_m < 0.0018) return 0.35;
  const double tone = 0.16 * lattice(board.row, board.column, stream);
  const double offset = 17.0 * static_cast<double>(board.row);
  const double grain = value_noise(4 * u + offset, 90 * v, stream + 1);
  return 1 + tone + 0.12 * grain;
}

double bricks(double u, double v, std::uint64_t stream) {
  const Cell brick = cell_at(u, v, 0.22, 0.075, 0.5);
  if (brick.border_m < 0.005) return 1.45;
  return 1 + 0.22 * lattice(brick.row, brick.column, stream) +
         0.08 * value_noise(60 * u, 60 * v, stream + 1);
}

double pattern(Texture texture, double u, double v, std::uint64_t stream) {
  switch (texture) {
    case Texture::plain:
      return 1 + 0.03 * value_noise(5 * u, 5 * v, stream);
    case Texture::concrete:
      return 1 + 0.10 * value_noise(7 * u, 7 * v, stream) +
             0.06 * value_noise(31 * u, 31 * v, stream + 1) +
             0.05 * value_noise(120 * u, 120 * v, stream + 2);
    case Texture::asphalt:
      return 1 + 0.12 * value_noise(4 * u, 4 * v, stream) +
             0.45 * value_noise(140 * u, 140 * v, stream + 1);
    case Texture::planks:
      return planks(u, v, stream);
    case Texture::cardboard:
      return 1 + 0.05 * value_noise(9 * u, 9 * v, stream) +
             0.03 * value_noise(150 * u, 6 * v, stream + 1);
    case Texture::brick:
      return bricks(u, v, stream);
    case Texture::rubber:  // ribs across the way up
      return v - 0.05 * std::floor(v / 0.05) < 0.012 ? 0.55 : 1.0;
  }
  return 1;
}

/// Linear albedo of a surface at a point on it: its material's colour with a procedural pattern.
Vec3d textured_albedo(const Surface& surface, int surface_index, const Vec3d& point) {
  // Patterns follow the first edge; levels all follow x, so that parts of one floor join.
  const Vec3d u = (surface.corners[1] - surface.corners[0]).normalized();
  const Vec3d v = surface.normal.cross(u);
  const Vec3d local = point - surface.corners[0];
  const auto stream = 16 * static_cast<std::uint64_t>(surface_index);
  return pattern(surface.material.texture, u.dot(local), v.dot(local), stream) *
         surface.material.albedo;
}

// ---- Light ----

constexpr double kLampDistanceM = 20;
constexpr double kContactM = 0.35;  // how far a neighbouring surface darkens

}  // namespace

double openness(const Scene& scene, const CastScene& cast, int surface, const Vec3d& point) {
  // One short ray along each of a few directions.
  static const Vec3d kDirections[] = {{0.8, 0, 0.6},    {-0.8, 0, 0.6},   {0, 0.8, 0.6},
                                      {0, -0.8, 0.6},   {0.7, 0.7, 0.1},  {-0.7, 0.7, 0.1},
                                      {0.7, -0.7, 0.1}, {-0.7, -0.7, 0.1}};
  const Vec3d& normal = scene.surfaces[surface].normal;
  double open = 0, total = 0;
  for (const Vec3d& direction : kDirections) {
    const double weight = normal.dot(direction);
    if (weight <= 0.05) continue;
    total += weight;
    const Hit hit = first_hit(cast, point + 1e-5 * normal, direction);
    const double distance = hit.surface < 0 ? kContactM : std::min(hit.t, kContactM);
    open += weight * distance / kContactM;
  }
  return total > 0 ? open / total : 1;
}

Vec3d shade(
    const Scene& scene, const CastScene& cast, int surface, const Vec3d& point, double open) {
  const Surface& s = scene.surfaces[surface];
  const double facing = s.normal.dot(scene.light);
  const bool lit = facing > 0 && !is_blocked(cast, point, point + kLampDistanceM * scene.light);
  const double sky = 0.5 + 0.5 * s.normal.z();
  const double ambient = (0.28 + 0.27 * sky) * (0.45 + 0.55 * open);
  const double lamp = lit ? 0.75 * facing : 0;
  const Vec3d light = ambient * Vec3d(0.94, 0.98, 1.06) + lamp * Vec3d(1.06, 1.0, 0.9);
  return textured_albedo(s, surface, point).cwiseProduct(light);
}

std::array<std::uint8_t, 3> to_display(const Vec3d& linear) {
  std::array<std::uint8_t, 3> rgb{};
  for (int c = 0; c < 3; ++c) {
    const double value = std::sqrt(std::clamp(linear[c], 0.0, 1.0));
    rgb[c] = static_cast<std::uint8_t>(std::lround(255 * value));
  }
  return rgb;
}

}  // namespace planescope::lab
