// One step over the depth camera's image.

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "render/frame_image.hpp"
#include "render/step_scene.hpp"

namespace planescope::render {
namespace {

constexpr std::int32_t kUnmeasured = -3;  // beside StepState::kOpen, kLeftover

/// Blends in integers: a step's picture has hundreds of thousands of pixels.
void blend(std::uint8_t* pixel, Rgba color, int share_256) {
  const auto mixed = [share_256](int below, int above) {
    return static_cast<std::uint8_t>(below + (above - below) * share_256 / 256);
  };
  pixel[0] = mixed(pixel[0], color.r);
  pixel[1] = mixed(pixel[1], color.g);
  pixel[2] = mixed(pixel[2], color.b);
}

/// One row of the picture as voxels, and the planes they are in.
struct Row {
  std::vector<std::uint32_t> voxels;
  std::vector<std::int32_t> planes;

  void read(const debug::Subject& subject, const StepState& state, int y, int width) {
    voxels.resize(static_cast<std::size_t>(width));
    planes.resize(static_cast<std::size_t>(width));
    for (std::size_t x = 0; x < voxels.size(); ++x) {
      voxels[x] = subject.voxel_of_source(static_cast<std::size_t>(y) * voxels.size() + x);
      planes[x] = voxels[x] == planes::kNoVoxel ? kUnmeasured : state.plane_of[voxels[x]];
    }
  }
};

/// The plane whose contour runs between two pixels, -1 if none does. Holes in the measurement are
/// no edges of a plane.
std::int32_t contour_between(std::int32_t a, std::int32_t b) {
  if (a == b || a == kUnmeasured || b == kUnmeasured) return -1;
  return std::max(a, b);
}

/// Marks the nearer pixel where depth jumps by more than a tenth, the edges that color shows too.
void paint_depth_edges(const Image16& depth, Image8& image) {
  constexpr double kJump = 0.1;  // of the smaller depth
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
  const bool aligned = frame.color_aligned && frame.color.channels == 3 &&
                       frame.color.width == frame.depth.width &&
                       frame.color.height == frame.depth.height;
  if (backdrop == Backdrop::depth || !aligned) return shaded_depth(frame);
  Image8 image = frame.color;
  if (backdrop == Backdrop::edges) paint_depth_edges(frame.depth, image);
  return image;
}

void paint_step(Image8& image, const debug::Run& run, const StepLook& look, double opacity) {
  if (image.empty()) return;
  const debug::Subject& subject = *run.subject;
  const StepState state = step_state(run, look);
  const std::vector<Rgba> colors = voxel_colors(run, look, state);
  const Rgba selected = mark_colors(look.theme).selected;
  // The camera's own picture is not painted over with itself.
  const int share = look.color_by == ColorBy::camera
                        ? 0
                        : static_cast<int>(std::lround(256 * std::clamp(opacity, 0.0, 1.0)));
  // What is pointed at is seen however faint the rest is, which recedes.
  constexpr int kLeastShare = 140;
  std::vector<std::uint8_t> pointed = concerned_voxels(run, look, state);
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

  Row row, below;
  row.read(subject, state, 0, image.width);
  for (int y = 0; y < image.height; ++y) {
    const bool last = y + 1 == image.height;
    if (!last) below.read(subject, state, y + 1, image.width);
    std::uint8_t* pixel = &image.at(0, y);
    for (int x = 0; x < image.width; ++x, pixel += 3) {
      const std::uint32_t voxel = row.voxels[x];
      if (alone && (voxel == planes::kNoVoxel || !pointed[voxel])) {
        blend(pixel, ground, 200);
        continue;
      }
      if (voxel != planes::kNoVoxel)
        blend(pixel, colors[voxel], pointed[voxel] ? std::max(share, kLeastShare) : rest);
      if (!look.show_planes) continue;
      const std::int32_t plane = row.planes[x];
      std::int32_t contour = last ? -1 : contour_between(plane, below.planes[x]);
      if (contour < 0 && x + 1 < image.width) contour = contour_between(plane, row.planes[x + 1]);
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
