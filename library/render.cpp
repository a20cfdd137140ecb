// Renderer of the public library: pictures of results and of trace steps.

#include "planescope/render.hpp"

#include <fmt/format.h>

#include "core/io/image/png.hpp"
#include "library/data.hpp"
#include "render/plane_colors.hpp"
#include "render/renderer.hpp"
#include "render/scenes.hpp"
#include "render/step_scene.hpp"

namespace planescope::v0 {
namespace {

constexpr int kMaxSide = 16384;

Image image_of(Image8&& image) { return {image.width, image.height, std::move(image.data)}; }

render::Theme theme_of(Theme theme) {
  return theme == Theme::dark ? render::Theme::dark : render::Theme::light;
}

void expect_size(int width, int height) {
  if (width < 1 || height < 1 || width > kMaxSide || height > kMaxSide)
    throw Error(fmt::format("picture: {}x{} pixels; expected 1 to {} in each direction", width,
                            height, kMaxSide));
}

render::DrawList scene_of(const ::planescope::Frame& frame,
                          const planes::FrameResult& result,
                          Picture picture) {
  const std::vector<int> colors = render::first_colors(result);
  switch (picture) {
    case Picture::labels:
      return render::scene_labels(result);
    case Picture::cases:
      return render::scene_cases(result);
    case Picture::leftovers:
      return render::scene_leftovers(result, colors);
    case Picture::overlay:
      return render::scene_overlay(frame, result, colors);
    case Picture::depth:
      return render::scene_heights(result);
    case Picture::planes:
      break;
  }
  return render::scene_planes(frame, result, colors);
}

}  // namespace

struct Renderer::State {
  std::unique_ptr<render::GlContext> context = render::make_egl_context();
  render::Renderer renderer;
};

Renderer::Renderer() {
  detail::guarded([&] { state_ = std::make_unique<State>(); });
}
Renderer::~Renderer() {
  if (!state_) return;
  try {
    state_->context->make_current();
  } catch (const std::exception&) {
    // Created on another thread. Its OpenGL objects cannot be freed here, so leak them.
    static_cast<void>(state_.release());
  }
}

Image Renderer::draw(const Result& result, Picture picture, int width, int height, Theme theme) {
  return detail::guarded([&] {
    expect_size(width, height);
    const detail::ResultData& data = detail::Access::result(result);
    const ::planescope::Frame& frame = detail::Access::frame(data.frame);
    if (!frame.is_cloud() && picture == Picture::overlay)
      return image_of(render::image_overlay(frame, data.result, render::first_colors(data.result)));
    if (!frame.is_cloud() && picture == Picture::depth)
      return image_of(render::image_depth(frame, data.options.cloud.max_range_m));
    state_->context->make_current();
    const render::Camera camera =
        render::frame_camera(data.result, static_cast<double>(width) / height);
    return image_of(state_->renderer.render(scene_of(frame, data.result, picture), camera, width,
                                            height, theme_of(theme)));
  });
}

Image Renderer::draw(const Trace& trace, int step, int width, int height, Theme theme) {
  return detail::guarded([&] {
    expect_size(width, height);
    if (step < 0 || step > trace.steps())
      throw Error(fmt::format("step {} is out of range; expected 0 to {}", step, trace.steps()));
    const debug::Run& run = *detail::Access::trace(trace).run;
    render::StepLook look;
    look.step = step;
    look.theme = theme_of(theme);
    look.color_of_plane =
        render::trace_colors(run, render::settle_colors(render::plane_image(run), {}));
    state_->context->make_current();
    const render::Camera camera = render::frame_camera(run.subject->prepared, run.segmentation,
                                                       static_cast<double>(width) / height);
    return image_of(
        state_->renderer.render(render::scene_step(run, look), camera, width, height, look.theme));
  });
}

std::string Renderer::description() const { return state_->context->description(); }

void write_png(const std::string& path, const Image& image) {
  detail::guarded([&] {
    if (image.width < 1 || image.height < 1 ||
        image.rgb.size() != static_cast<std::size_t>(image.width) * image.height * 3)
      throw Error(fmt::format("{}: {}x{} pixels with {} values; expected three per pixel", path,
                              image.width, image.height, image.rgb.size()));
    Image8 picture;
    picture.width = image.width;
    picture.height = image.height;
    picture.channels = 3;
    picture.data = image.rgb;
    io::write_png(path, picture);
  });
}

}  // namespace planescope::v0
