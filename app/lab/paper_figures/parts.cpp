#include "app/lab/paper_figures/parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/io/image/photo.hpp"
#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "core/report/page/pictures.hpp"
#include "render/scenes.hpp"

namespace planescope::app::figures {
namespace {

constexpr render::Rgba kInNone{40, 40, 44, 255};
constexpr int kCopyQuality = 86;

}  // namespace

void Work::begin(const std::string& what) const {
  if (args.stop.stop_requested()) throw Cancelled();
  if (args.progress) args.progress(what);
}

planes::PipelineOptions options_of(const lab::CellKey& key, const Work& work) {
  planes::PipelineOptions options = lab::cell_options(key);
  options.threads = work.args.threads;
  return options;
}

void add_picture(lab::PaperFigure& figure,
                 const std::string& row,
                 const std::string& column,
                 const std::string& caption,
                 const Image8& image,
                 int copy_width) {
  lab::PaperPicture picture;
  picture.row = row;
  picture.column = column;
  picture.caption = caption;
  picture.png = fmt::format("{}_{:02}.png", figure.id, figure.pictures.size());
  picture.bytes = io::encode_png(image);
  picture.copy = io::encode_webp(report::shrink(image, copy_width), kCopyQuality);
  picture.width = image.width;
  picture.height = image.height;
  figure.pictures.push_back(std::move(picture));
}

std::string planes_text(const planes::FrameResult& result) {
  const std::size_t planes = result.segmentation.planes.size();
  std::size_t kept = 0, in_none = 0;
  for (std::size_t i = 0; i < result.plane_of.size(); ++i) {
    if (!result.cloud.kept[i]) continue;
    ++kept;
    in_none += result.plane_of[i] <= 0;
  }
  const double share =
      kept == 0 ? 0 : 100.0 * static_cast<double>(in_none) / static_cast<double>(kept);
  return fmt::format("{} plane{}, {:.1f} % in none", planes, planes == 1 ? "" : "s", share);
}

std::vector<int> colors_by_truth(const planes::JudgedFrame& judged, std::size_t planes) {
  std::vector<int> colors(planes, 0);
  for (std::size_t t = 0; t < judged.found_of.size(); ++t)
    if (judged.found_of[t] > 0)
      colors[static_cast<std::size_t>(judged.found_of[t]) - 1] = static_cast<int>(t) + 1;
  int next = static_cast<int>(judged.found_of.size());
  for (int& color : colors)
    if (color == 0) color = ++next;
  return colors;
}

render::DrawList bare_planes(std::span<const Vec3f> points,
                             std::span<const std::int32_t> plane_of,
                             std::span<const int> color_of_plane) {
  render::DrawPoints splats;
  splats.size_m = 0.02F;
  splats.min_px = 2;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const std::int32_t id = plane_of[i];
    splats.positions.push_back(points[i]);
    splats.colors.push_back(id <= 0 ? kInNone : render::color_of(id, color_of_plane));
  }
  render::DrawList list;
  list.points.push_back(std::move(splats));
  return bare(std::move(list));
}

render::DrawList bare(render::DrawList list) {
  list.title.clear();
  list.subtitle.clear();
  list.legend.clear();
  list.arrows.clear();
  list.labels.clear();
  list.show_axes = false;
  list.show_scale_bar = false;
  return list;
}

render::Camera close_camera(std::span<const Vec3f> points, const Vec3d& forward, double aspect) {
  constexpr double kRoom = 1.05;
  const Vec3d ahead = forward.normalized();
  const Vec3d right = ahead.cross(Vec3d::UnitZ()).normalized();
  const Vec3d up = right.cross(ahead);
  Bounds bounds;  // right, up, ahead
  for (const Vec3f& point : points) {
    const Vec3d p = point.cast<double>();
    bounds.add({p.dot(right), p.dot(up), p.dot(ahead)});
  }
  const Vec3d middle = (bounds.min + bounds.max) / 2;
  render::Camera camera;
  camera.target = middle.x() * right + middle.y() * up + middle.z() * ahead;
  const double slope = std::tan(camera.fov_y_deg * std::numbers::pi / 360);
  double distance = 0.05;
  for (const Vec3f& point : points) {
    const Vec3d p = point.cast<double>() - camera.target;
    const double across = std::max(std::abs(p.dot(up)), std::abs(p.dot(right)) / aspect);
    distance = std::max(distance, kRoom * across / slope - p.dot(ahead));
  }
  camera.eye = camera.target - distance * ahead;
  return camera;
}

}  // namespace planescope::app::figures
