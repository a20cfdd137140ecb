// Pictures on the pixels of a depth frame: planes over the image, depth with its scale, and
// single steps.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "render/paint.hpp"
#include "render/scenes.hpp"
#include "render/step_scene.hpp"

namespace planescope::render {

namespace {

bool measured(std::uint16_t count) { return count != 0 && count != 65535; }

}  // namespace

bool has_aligned_color(const Frame& frame) {
  return frame.color_aligned && frame.color.channels == 3 && !frame.color.empty() &&
         frame.color.width == frame.depth.width && frame.color.height == frame.depth.height;
}

Image8 shaded_depth(const Frame& frame) {
  const int width = frame.depth.width, height = frame.depth.height;
  Image8 image(width, height, 3);
  const auto point = [&](int x, int y) {
    const double z = frame.depth.at(x, y) * frame.depth_unit_m;
    return Vec3d((x - frame.intrinsics.cx) / frame.intrinsics.fx * z,
                 (y - frame.intrinsics.cy) / frame.intrinsics.fy * z, z);
  };
  const auto is_there = [&](int x, int y) {
    return x >= 0 && y >= 0 && x < width && y < height && measured(frame.depth.at(x, y));
  };
  constexpr int kReach = 4;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      double grey = on_hatch(x, y, 8) ? 196 : 214;
      if (is_there(x, y)) {
        grey = 150;
        const int x0 = is_there(x - kReach, y) ? x - kReach : x;
        const int x1 = is_there(x + kReach, y) ? x + kReach : x;
        const int y0 = is_there(x, y - kReach) ? y - kReach : y;
        const int y1 = is_there(x, y + kReach) ? y + kReach : y;
        const Vec3d normal = (point(x1, y) - point(x0, y)).cross(point(x, y1) - point(x, y0));
        if (normal.norm() > 0) {
          const Vec3d light = (-point(x, y).normalized() + Vec3d(-0.25, -0.35, 0)).normalized();
          grey = 70 + 165 * std::abs(normal.normalized().dot(light));
        }
      }
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<std::uint8_t>(grey);
    }
  }
  return image;
}

namespace {

/// Distorts normalized coordinates like OpenCV (Brown-Conrady).
Vec2d distorted(const Intrinsics& camera, const Vec2d& p) {
  if (camera.distortion != Distortion::brown_conrady) return p;
  const auto& [k1, k2, p1, p2, k3] = camera.coefficients;
  const double x = p.x(), y = p.y(), r2 = x * x + y * y;
  const double radial = 1 + r2 * (k1 + r2 * (k2 + r2 * k3));
  return {x * radial + 2 * p1 * x * y + p2 * (r2 + 2 * x * x),
          y * radial + p1 * (r2 + 2 * y * y) + 2 * p2 * x * y};
}

}  // namespace

RegionImage regions_on_depth(const Frame& frame, const planes::FrameResult& result) {
  RegionImage regions(frame.depth.width, frame.depth.height);
  for (std::size_t i = 0; i < result.plane_of.size(); ++i)
    regions.data[result.cloud.source[i]] = result.plane_of[i];
  return regions;
}

RegionImage regions_on_color(const Frame& frame, const planes::FrameResult& result) {
  const Intrinsics& camera = frame.color_intrinsics;
  RegionImage regions(frame.color.width, frame.color.height);
  Image<float> nearest(frame.color.width, frame.color.height, 1,
                       std::numeric_limits<float>::infinity());
  const Pose T_depth_world = result.cloud.T_world_sensor.inverse();
  const Pose T_color_world = frame.T_color_depth * T_depth_world;
  // Color pixels per depth pixel along each axis.
  const double grow = std::max(1.0, camera.fx / std::max(1.0, frame.intrinsics.fx));
  for (std::size_t i = 0; i < result.plane_of.size(); ++i) {
    const Vec3d p = T_color_world * (result.cloud.origin + result.cloud.points[i].cast<double>());
    if (p.z() < 0.05) continue;
    const Vec2d n = distorted(camera, Vec2d(p.x() / p.z(), p.y() / p.z()));
    const double u = camera.fx * n.x() + camera.cx, v = camera.fy * n.y() + camera.cy;
    const double half = 0.5 * grow + 0.25;
    const auto depth = static_cast<float>(p.z());
    const int first_x = std::max(0, static_cast<int>(std::lround(u - half)));
    const int last_x = std::min(regions.width - 1, static_cast<int>(std::lround(u + half)));
    const int first_y = std::max(0, static_cast<int>(std::lround(v - half)));
    const int last_y = std::min(regions.height - 1, static_cast<int>(std::lround(v + half)));
    for (int y = first_y; y <= last_y; ++y) {
      for (int x = first_x; x <= last_x; ++x) {
        if (depth >= nearest.at(x, y)) continue;
        nearest.at(x, y) = depth;
        regions.at(x, y) = result.plane_of[i];
      }
    }
  }
  return regions;
}

RegionImage smooth_regions(const RegionImage& regions) {
  constexpr int kReach = 2;
  constexpr int kMajority = 13;  // of 25
  RegionImage smooth = regions;
  for (int y = kReach; y < regions.height - kReach; ++y) {
    for (int x = kReach; x < regions.width - kReach; ++x) {
      // Boyer-Moore majority vote: finds the only id that can cover more than half of the window.
      std::int32_t winner = 0;
      int lead = 0;
      const auto window = [&](auto&& each) {
        for (int dy = -kReach; dy <= kReach; ++dy)
          for (int dx = -kReach; dx <= kReach; ++dx) each(regions.at(x + dx, y + dy));
      };
      window([&](std::int32_t id) {
        if (lead == 0) winner = id;
        lead += id == winner ? 1 : -1;
      });
      int votes = 0;
      window([&](std::int32_t id) { votes += id == winner; });
      if (votes >= kMajority) smooth.at(x, y) = winner;
    }
  }
  return smooth;
}

std::vector<InteriorPoint> interior_points(const RegionImage& regions, std::size_t plane_count) {
  // Chamfer distance to the nearest pixel with another id; the picture's edge counts as another id.
  const int width = regions.width, height = regions.height;
  Image<float> distance(width, height, 1, 1e9F);
  const auto relax = [&](int x, int y, int dx, int dy, float step) {
    const int nx = x + dx, ny = y + dy;
    const bool same =
        nx >= 0 && ny >= 0 && nx < width && ny < height && regions.at(nx, ny) == regions.at(x, y);
    const float through = same ? distance.at(nx, ny) + step : step;
    distance.at(x, y) = std::min(distance.at(x, y), through);
  };
  constexpr float kDiagonal = 1.4142F;
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      relax(x, y, -1, 0, 1);
      relax(x, y, 0, -1, 1);
      relax(x, y, -1, -1, kDiagonal);
      relax(x, y, 1, -1, kDiagonal);
    }
  }
  std::vector<InteriorPoint> points(plane_count);
  for (int y = height - 1; y >= 0; --y) {
    for (int x = width - 1; x >= 0; --x) {
      relax(x, y, 1, 0, 1);
      relax(x, y, 0, 1, 1);
      relax(x, y, 1, 1, kDiagonal);
      relax(x, y, -1, 1, kDiagonal);
      const std::int32_t id = regions.at(x, y);
      if (id <= 0 || static_cast<std::size_t>(id) > plane_count) continue;
      InteriorPoint& best = points[id - 1];
      if (distance.at(x, y) > best.depth_px) best = {x, y, distance.at(x, y)};
    }
  }
  return points;
}

// ---- Planes over the camera's image ----

namespace {

constexpr double kTint = 0.40;  // opacity of the plane's color over the image
constexpr Rgba kOutlineShade{20, 22, 26, 255};

/// The image below the planes, and plane ids on its pixels.
struct Ground {
  Image8 image;
  RegionImage regions;
};
Ground ground_of(const Frame& frame, const planes::FrameResult& result) {
  if (has_aligned_color(frame)) return {frame.color, regions_on_depth(frame, result)};
  if (!frame.color.empty() && !frame.color_aligned && frame.color_intrinsics.fx > 0)
    return {frame.color, regions_on_color(frame, result)};
  return {shaded_depth(frame), regions_on_depth(frame, result)};
}

/// Lines along the inside of each region, `width_px` wide.
void draw_outlines(Image8& image,
                   const RegionImage& regions,
                   int factor,
                   int width_px,
                   std::span<const int> color_of_plane) {
  // Whether another region is within `reach` of a position in the regions, enlarged by `scale`.
  const auto is_edge = [&](int x, int y, std::int32_t id, int scale, int reach) {
    const auto is_other = [&](int column, int row) {
      return regions.at(std::clamp(column, 0, scale * regions.width - 1) / scale,
                        std::clamp(row, 0, scale * regions.height - 1) / scale) != id;
    };
    for (int d = 1; d <= reach; ++d)
      if (is_other(x - d, y) || is_other(x + d, y) || is_other(x, y - d) || is_other(x, y + d))
        return true;
    return false;
  };
  const int reach = (width_px + factor - 1) / factor;  // in pixels of the regions
  for (int row = 0; row < regions.height; ++row) {
    for (int column = 0; column < regions.width; ++column) {
      const std::int32_t id = regions.at(column, row);
      if (id <= 0 || !is_edge(column, row, id, 1, reach)) continue;
      const Rgba color = mix(color_of(id, color_of_plane), kOutlineShade, 0.2);
      for (int y = row * factor; y < (row + 1) * factor; ++y)
        for (int x = column * factor; x < (column + 1) * factor; ++x)
          if (is_edge(x, y, id, factor, width_px)) blend_pixel(image, x, y, color);
    }
  }
}

void draw_ids(Image8& image,
              const RegionImage& regions,
              int factor,
              std::size_t plane_count,
              std::span<const int> color_of_plane) {
  constexpr double kLeastDepth = 9;  // smallest region with room for its id [px of the picture]
  const std::vector<InteriorPoint> points = interior_points(regions, plane_count);
  for (std::size_t k = 0; k < points.size(); ++k) {
    const double depth = points[k].depth_px * factor;
    if (depth < kLeastDepth) continue;
    const int id = static_cast<int>(k) + 1;
    const std::string text = std::to_string(id);
    const double size = std::clamp(0.8 * depth, 13.0, 26.0);
    const double x = (points[k].x + 0.5) * factor, y = (points[k].y + 0.5) * factor;
    const double radius = std::max(0.72 * size, 0.5 * text_width(text, size) + 0.28 * size);
    fill_disc(image, x, y, radius + 2, {255, 255, 255, 235});
    fill_disc(image, x, y, radius, mix(color_of(id, color_of_plane), kOutlineShade, 0.45));
    draw_text(image, x - text_width(text, size) / 2, y + 0.36 * size, text, size,
              {255, 255, 255, 255});
  }
}

}  // namespace

Image8 image_overlay(const Frame& frame,
                     const planes::FrameResult& result,
                     std::span<const int> color_of_plane) {
  const Ground below = ground_of(frame, result);
  const int factor = enlargement(below.image.width);
  Image8 tinted = below.image;
  for (int y = 0; y < tinted.height; ++y) {
    for (int x = 0; x < tinted.width; ++x) {
      const std::int32_t id = below.regions.at(x, y);
      if (id > 0) blend_pixel(tinted, x, y, color_of(id, color_of_plane), kTint);
    }
  }
  Image8 image = enlarge(tinted, factor);
  const RegionImage smooth = smooth_regions(below.regions);
  draw_outlines(image, smooth, factor, 2, color_of_plane);
  draw_ids(image, smooth, factor, result.segmentation.planes.size(), color_of_plane);
  return image;
}

// ---- Depth with its scale ----

namespace {

constexpr Rgba kInk{52, 58, 66, 255};
constexpr Rgba kNotMeasured{232, 234, 237, 255};
constexpr Rgba kHatch{196, 200, 206, 255};
constexpr Rgba kBeyond{150, 154, 160, 255};
constexpr int kBarRoom = 120;  // [px] right of the image
constexpr int kNoteRoom = 44;  // [px] below the image
constexpr int kHatchSpacing = 12;

/// Contains all but the outermost half percent of the depths within range, rounded outward to
/// 10 cm.
ColorScale ramp_of(const Frame& frame, double max_range_m) {
  ColorScale ramp{.what = "depth", .range = {0, max_range_m}, .map = ColorScale::Map::falling};
  std::vector<double> depths;
  for (const std::uint16_t count : frame.depth.data)
    if (measured(count) && count * frame.depth_unit_m <= max_range_m)
      depths.push_back(count * frame.depth_unit_m);
  if (depths.empty()) return ramp;
  auto& [low_m, high_m] = ramp.range;
  low_m = std::floor(10 * quantile(depths, 0.005)) / 10;
  high_m = std::ceil(10 * quantile(depths, 0.995)) / 10;
  if (high_m - low_m < 0.15) high_m = low_m + 0.2;
  return ramp;
}

/// Color for each possible depth count; unmeasured ones are hatched.
std::vector<Rgba> colors_of_counts(const Frame& frame, const ColorScale& ramp, double max_range_m) {
  std::vector<Rgba> colors;
  for (int count = 0; count < 65536; ++count) {
    const double depth_m = count * frame.depth_unit_m;
    colors.push_back(!measured(static_cast<std::uint16_t>(count)) ? kNotMeasured
                     : depth_m > max_range_m                      ? kBeyond
                                                                  : ramp.color(depth_m));
  }
  return colors;
}

void draw_bar(Image8& image, int left, int top, int height, const ColorScale& ramp) {
  constexpr int kWidth = 22;
  const auto [low_m, high_m] = ramp.range;
  const double span_m = high_m - low_m;
  for (int y = 0; y < height; ++y)  // near at the top
    fill_rect(image, left, top + y, kWidth, 1, ramp.color(low_m + span_m * (y + 0.5) / height));
  const double step = round_step(span_m / 8);  // 4 to 8 ticks
  const auto first = static_cast<int>(std::ceil(low_m / step - 1e-6));
  const auto last = static_cast<int>(std::floor(high_m / step + 1e-6));
  for (int k = first; k <= last; ++k) {
    const int y = top + static_cast<int>(std::lround((k * step - low_m) / span_m * height));
    fill_rect(image, left + kWidth, std::min(y, top + height - 1), 6, 1, kInk);
    const std::string text =
        fmt::format("{:.{}f}{}", k * step, step < 0.095 ? 2 : 1, k == first ? " m" : "");
    draw_text(image, left + kWidth + 11, y + 6, text, 17, kInk);
  }
}

void draw_notes(Image8& image, int bottom, double max_range_m) {
  const int top = bottom - kNoteRoom + 15;
  double x = 4;
  const auto swatch = [&](bool hatched, Rgba color, const std::string& text) {
    const int left = static_cast<int>(x);
    for (int dy = 0; dy < 18; ++dy)
      for (int dx = 0; dx < 26; ++dx)
        blend_pixel(image, left + dx, top + dy,
                    hatched && on_hatch(left + dx, top + dy, kHatchSpacing) ? kHatch : color);
    x += 34;
    x += draw_text(image, x, top + 15, text, 17, kInk) + 28;
  };
  swatch(true, kNotMeasured, "no measurement");
  swatch(false, kBeyond, fmt::format("beyond {:.4g} m", max_range_m));
}

}  // namespace

Image8 image_depth(const Frame& frame, double max_range_m) {
  const int factor = enlargement(frame.depth.width);
  const int width = frame.depth.width * factor, height = frame.depth.height * factor;
  const ColorScale ramp = ramp_of(frame, max_range_m);
  Image8 image(width + kBarRoom, height + kNoteRoom, 3, 255);
  const std::vector<Rgba> colors = colors_of_counts(frame, ramp, max_range_m);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const std::uint16_t count = frame.depth.at(x / factor, y / factor);
      const bool hatch = !measured(count) && on_hatch(x, y, kHatchSpacing);
      const Rgba color = hatch ? kHatch : colors[count];
      std::uint8_t* pixel = &image.at(x, y);
      pixel[0] = color.r;
      pixel[1] = color.g;
      pixel[2] = color.b;
    }
  }
  draw_bar(image, width + 18, 16, height - 32, ramp);
  draw_notes(image, image.height, max_range_m);
  return image;
}

// ---- One step over the camera's image ----
namespace {

constexpr std::int32_t kUnmeasured = -3;  // in addition to StepState::kOpen and kLeftover

/// Integer blending for speed: a step's picture has hundreds of thousands of pixels.
void blend(std::uint8_t* pixel, Rgba color, int share_256) {
  const auto mixed = [share_256](int below, int above) {
    return static_cast<std::uint8_t>(below + (above - below) * share_256 / 256);
  };
  pixel[0] = mixed(pixel[0], color.r);
  pixel[1] = mixed(pixel[1], color.g);
  pixel[2] = mixed(pixel[2], color.b);
}

/// For each pixel of a row: its voxel, and the plane of the voxel.
using Row = std::vector<std::pair<std::uint32_t, std::int32_t>>;
Row row_of(const StepState& state, int y, int width) {
  Row row(width);
  for (std::size_t x = 0; x < row.size(); ++x) {
    const std::uint32_t voxel = state.run.subject->voxel_of_source(y * row.size() + x);
    row[x] = {voxel, voxel == planes::kNoVoxel ? kUnmeasured : state.plane_of[voxel]};
  }
  return row;
}

/// The plane whose contour passes between two pixels; -1 if none. Unmeasured holes are not edges of
/// a plane.
std::int32_t contour_between(std::int32_t a, std::int32_t b) {
  if (a == b || a == kUnmeasured || b == kUnmeasured) return -1;
  return std::max(a, b);
}

/// Marks the nearer pixel where depth jumps by more than a tenth; the same edges are visible in
/// color images.
void paint_depth_edges(const Image16& depth, Image8& image) {
  constexpr double kJump = 0.1;  // share of the smaller depth
  const auto jumps = [&](int x, int y, int to_x, int to_y) {
    const int here = depth.at(x, y), there = depth.at(to_x, to_y);
    return here > 0 && there > here * (1 + kJump);
  };
  for (int y = 1; y + 1 < depth.height; ++y)
    for (int x = 1; x + 1 < depth.width; ++x)
      if (jumps(x, y, x + 1, y) || jumps(x, y, x - 1, y) || jumps(x, y, x, y + 1) ||
          jumps(x, y, x, y - 1)) {
        std::uint8_t* pixel = &image.at(x, y);
        pixel[0] = 255;
        pixel[1] = 220;
        pixel[2] = 0;
      }
}

}  // namespace

Image8 image_backdrop(const debug::Subject& subject, Backdrop backdrop) {
  const Frame& frame = subject.frame;
  if (frame.is_cloud()) return {};
  if (backdrop == Backdrop::depth || !has_aligned_color(frame)) return shaded_depth(frame);
  Image8 image = frame.color;
  if (backdrop == Backdrop::edges) paint_depth_edges(frame.depth, image);
  return image;
}

void paint_step(Image8& image, const debug::Run& run, const StepLook& look, double opacity) {
  if (image.empty()) return;
  const StepState state = step_state(run, look);
  const std::vector<Rgba> colors = voxel_colors(state);
  const Rgba selected = highlight_colors(look.theme).selected;
  // The camera's picture is not blended with itself.
  const int share = look.color_by == ColorBy::camera
                        ? 0
                        : static_cast<int>(std::lround(256 * std::clamp(opacity, 0.0, 1.0)));
  // Highlighted voxels stay visible at any opacity; the others are faded.
  constexpr int kLeastShare = 140;
  std::vector<std::uint8_t> pointed = concerned_voxels(state);
  const int rest = pointed.empty() ? share : share / 2;
  const bool alone = look.isolated && !pointed.empty();
  const Rgba ground = theme_colors(look.theme).background_bottom;
  const auto stands_out = [&](std::int32_t plane) {
    return plane == look.plane || plane == state.plane || plane == state.other;
  };
  pointed.resize(colors.size(), 0);
  const auto point_at = [&](std::size_t voxel) {
    if (voxel < pointed.size()) pointed[voxel] = 1;
  };
  for (const std::uint32_t voxel : look.marked) point_at(voxel);
  for (const std::int32_t voxel : {look.voxel, state.voxel})
    if (voxel >= 0) point_at(static_cast<std::size_t>(voxel));

  Row row = row_of(state, 0, image.width), below;
  for (int y = 0; y < image.height; ++y) {
    const bool last = y + 1 == image.height;
    if (!last) below = row_of(state, y + 1, image.width);
    std::uint8_t* pixel = &image.at(0, y);
    for (int x = 0; x < image.width; ++x, pixel += 3) {
      const auto [voxel, plane] = row[x];
      if (alone && (voxel == planes::kNoVoxel || !pointed[voxel])) {
        blend(pixel, ground, 200);
        continue;
      }
      if (voxel != planes::kNoVoxel)
        blend(pixel, colors[voxel], pointed[voxel] ? std::max(share, kLeastShare) : rest);
      if (!look.show_planes) continue;
      std::int32_t contour = last ? -1 : contour_between(plane, below[x].second);
      if (contour < 0 && x + 1 < image.width) contour = contour_between(plane, row[x + 1].second);
      if (contour >= 0 && (!alone || stands_out(contour)))
        blend(pixel, contour == look.plane ? selected : look.plane_color(contour), 230);
    }
    std::swap(row, below);
  }
}

Image8 image_step(const debug::Run& run, const StepLook& look, Backdrop backdrop, double opacity) {
  Image8 image = image_backdrop(*run.subject, backdrop);
  paint_step(image, run, look, opacity);
  return image;
}

}  // namespace planescope::render
