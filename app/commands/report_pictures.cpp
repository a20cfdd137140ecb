// Draws the pictures of one report frame, with their legends and captions.

#include <fmt/format.h>

#include <algorithm>

#include "app/commands/report.hpp"
#include "core/io/image/photo.hpp"
#include "core/io/image/png.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"
#include "core/report/page/pictures.hpp"
#include "render/scenes.hpp"

namespace planescope::app {
namespace {

constexpr int kWidth = 1280, kHeight = 960;  // of 3D pictures [px]
constexpr int kThumbnailWidth = 200;
constexpr float kCopyQuality = 72;

/// `shown` is the version on the page.
report::ReportPicture keep(const Image8& image,
                           const Image8& shown,
                           const std::string& name,
                           const std::string& title,
                           const std::string& alt,
                           const PictureJob& job) {
  report::ReportPicture picture;
  picture.name = name;
  picture.title = title;
  picture.alt = alt;
  picture.file = (job.relative / "pictures" / (name + ".png")).generic_string();
  picture.width = image.width;
  picture.height = image.height;
  picture.pixels_sha256 = sha256_hex(std::as_bytes(std::span(image.data)));
  io::write_png(job.dir / "pictures" / (name + ".png"), image);
  const auto copy = [&](const char* ending, int width) {
    const Image8 small = shown.width > width ? report::shrink(shown, width) : Image8();
    write_file_bytes(job.dir / "report" / (name + ending),
                     io::encode_webp(small.empty() ? shown : small, kCopyQuality));
  };
  copy(".webp", job.copy_width);
  copy(".small.webp", kThumbnailWidth);
  return picture;
}

Image8 render(render::Renderer& renderer,
              const render::DrawList& list,
              const render::Camera& camera,
              int width,
              int height,
              Image8* bare = nullptr) {
  try {
    return renderer.render(list, camera, width, height, render::Theme::light, bare);
  } catch (const Error& error) {
    throw DrawingFailed(error.what());
  }
}

/// Ground truth and result, drawn on the depth image or, for a cloud, in 3D.
std::optional<Image8> draw_truth(const LoadedFrame& loaded,
                                 const planes::EvaluatedFrame& evaluated,
                                 const std::vector<int>& color_of_plane,
                                 render::Renderer* renderer) {
  if (!loaded.frame.is_cloud())
    return render::image_truth(loaded.frame, loaded.result, evaluated, color_of_plane);
  if (!renderer) return std::nullopt;
  constexpr int kPanelWidth = 800, kPanelHeight = 720;
  const render::Camera camera =
      render::frame_camera(loaded.result, static_cast<double>(kPanelWidth) / kPanelHeight);
  std::vector<Image8> panels;
  for (const render::DrawList& list :
       render::scenes_truth(loaded.result, evaluated, color_of_plane))
    panels.push_back(render(*renderer, list, camera, kPanelWidth, kPanelHeight));
  return render::side_by_side(panels);
}

std::vector<report::LegendMark> marks_of(const std::vector<render::LegendEntry>& legend) {
  const char* const shapes[] = {"dot", "box", "hatched_box", "line", "arrow"};  // by Mark
  std::vector<report::LegendMark> marks;
  for (const render::LegendEntry& entry : legend)
    marks.push_back({shapes[static_cast<int>(entry.symbol)], css_color(entry.color), entry.text});
  return marks;
}

std::string in_planes(const planes::FrameResult& result) {
  return counted(result.segmentation.planes.size(), "plane");
}

}  // namespace

std::string css_color(render::Rgba color) {
  return fmt::format("#{:02x}{:02x}{:02x}", color.r, color.g, color.b);
}

std::vector<report::ReportPicture> draw_pictures(const LoadedFrame& loaded,
                                                 const std::vector<int>& color_of_plane,
                                                 render::Renderer* renderer,
                                                 const PictureJob& job) {
  const Frame& frame = loaded.frame;
  const planes::FrameResult& result = loaded.result;
  const planes::SegmentCounts& counts = result.segmentation.counts;
  std::vector<report::ReportPicture> pictures;
  const render::Camera camera = render::frame_camera(result, static_cast<double>(kWidth) / kHeight);
  const auto draw = [&](const render::DrawList& list, const std::string& name,
                        const std::string& title, const std::string& alt) {
    Image8 bare;
    const Image8 image = render(*renderer, list, camera, kWidth, kHeight, &bare);
    pictures.push_back(keep(image, bare, name, title, alt, job));
    pictures.back().legend = marks_of(list.legend);
  };
  const auto keep_image = [&](const Image8& image, const std::string& name,
                              const std::string& title, const std::string& alt) {
    pictures.push_back(keep(image, image, name, title, alt, job));
  };

  if (!frame.is_cloud()) {
    const std::string backdrop = frame.color.empty() ? "shaded depth image" : "color image";
    keep_image(
        render::image_overlay(frame, result, color_of_plane), "overlay",
        "Planes over the camera image",
        fmt::format("The {} with {} tinted, outlined, and numbered.", backdrop, in_planes(result)));
    keep_image(
        render::image_depth(frame, job.max_range_m), "depth", "Depth",
        fmt::format(
            "The depth image on a color ramp up to {:.6g} m; {} of {} pixels were not measured.",
            job.max_range_m, result.cloud.counts.no_measurement, result.cloud.counts.pixels));
  } else if (renderer) {
    draw(render::scene_overlay(frame, result, color_of_plane), "overlay", "Planes over the cloud",
         fmt::format("The cloud's points with {} colored and numbered.", in_planes(result)));
    draw(render::scene_heights(result), "heights", "Points by height",
         fmt::format("{} points colored by height.", result.cloud.counts.kept));
  }
  if (loaded.truth) {
    const planes::EvaluatedFrame evaluated = planes::evaluate_frame(result, *loaded.truth);
    if (const auto image = draw_truth(loaded, evaluated, color_of_plane, renderer))
      keep_image(*image, "truth", "Labels, found planes, and errors",
                 fmt::format("Labeled planes, found planes in the same colors, and the points "
                             "where they differ: {}.",
                             render::errors_text(evaluated)));
  }
  if (!renderer) return pictures;

  if (job.method == planes::Method::ours && result.gravity.known()) {
    draw(render::scene_labels(result), "labels", "Voxels by h and v",
         fmt::format("{} voxels colored by class: h (horizontal) or v (vertical).",
                     result.voxels.points.size()));
    draw(render::scene_margins(result), "margins", "Confidence of the classifier",
         "The same voxels, dark on the boundary between h and v and in the color of their class "
         "where the classifier is confident.");
  }
  draw(render::scene_planes(frame, result, color_of_plane), "planes", "Final planes",
       fmt::format("{} with outlines, normals, and numbers.", in_planes(result)));
  draw(render::scene_leftovers(result, color_of_plane), "leftovers", "Unassigned points",
       fmt::format("{} voxels in no plane; the others are faded.", counts.unassigned));
  // Drawn last because its node markers are extra points; the other pictures share their points.
  if (job.method == planes::Method::ours) {
    draw(render::scene_cases(result), "cases", "Octree nodes by case",
         fmt::format(
             "The octree's nodes as boxes: {} of case I, {} of case II, {} of case III, {} of "
             "case IV.",
             counts.nodes_per_case[1], counts.nodes_per_case[2], counts.nodes_per_case[3],
             counts.nodes_per_case[4]));
    std::rotate(pictures.end() - 3, pictures.end() - 1, pictures.end());
  }
  return pictures;
}

}  // namespace planescope::app
