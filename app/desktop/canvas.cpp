// OpenGL canvas: renders scenes and images into textures and redraws only after changes.

#include <algorithm>
#include <array>
#include <map>

#include "app/desktop/look.hpp"
#include "app/desktop/state/label_state.hpp"
#include "core/labels/edit/selection.hpp"
#include "render/gl.hpp"
#include "render/renderer.hpp"

namespace planescope::desktop {
namespace {

/// Identifies the last drawn look of a step.
struct LookKey {
  std::weak_ptr<const debug::Run> run;  // weak: a new run may reuse the address
  render::StepLook look;

  bool same(const std::shared_ptr<const debug::Run>& other_run,
            const render::StepLook& other) const {
    return run.lock() == other_run && look == other;
  }
};

/// The same for labels. Label frames are immutable, so a change always has a new address.
struct LabelLookKey {
  std::weak_ptr<const LabelFrame> frame;
  render::LabelLook look;
  std::vector<std::uint32_t> preview, marked;
  std::vector<std::uint8_t> doubt;

  bool same(const std::shared_ptr<const LabelFrame>& other_frame,
            const render::LabelLook& other) const {
    return frame.lock() == other_frame && look.labels == other.labels &&
           look.plane == other.plane && look.show_class == other.show_class &&
           look.edit == other.edit && look.preview_takes == other.preview_takes &&
           look.theme == other.theme && look.residual == other.residual &&
           std::ranges::equal(preview, other.preview) && std::ranges::equal(marked, other.marked) &&
           std::ranges::equal(doubt, other.doubt);
  }
  void set(const std::shared_ptr<const LabelFrame>& new_frame, const render::LabelLook& new_look) {
    frame = new_frame;
    look = new_look;
    preview.assign(new_look.preview.begin(), new_look.preview.end());
    marked.assign(new_look.marked.begin(), new_look.marked.end());
    doubt.assign(new_look.doubt.begin(), new_look.doubt.end());
    look.preview = look.marked = {};
    look.doubt = {};
  }
};

/// A scene in its own texture, redrawn when the list, the camera or the size changes.
struct SceneView {
  enum class Shows : std::uint8_t { nothing, step, labels };

  render::Renderer renderer;
  render::DrawList list;
  Shows shows = Shows::nothing;  // contents of `list`
  LookKey key;                   // for a step
  render::Camera camera;
  int width = 0, height = 0;
  double screen_scale = 1;
  TextureId texture = 0;
  bool fine = false;
  Image<std::uint32_t> ids;  // from the last drawing; empty until requested

  /// Returns true if the scene was redrawn.
  bool draw(
      bool same_list, const render::Camera& from, int w, int h, render::Theme theme, double scale) {
    const bool same = same_list && same_camera(from, camera) && w == width && h == height &&
                      scale == screen_scale;
    if (same && fine) return false;
    // Draw quickly while moving, then once more with smooth edges at rest.
    fine = same;
    if (!same) ids = {};
    camera = from;
    width = w;
    height = h;
    screen_scale = scale;
    texture = renderer.draw(list, from, w, h, theme,
                            fine ? render::Effort::fine : render::Effort::quick, scale);
    return true;
  }
};

/// Image view of a step.
struct StepPicture {
  render::ImageTexture texture;
  LookKey key;
  render::Backdrop backdrop = render::Backdrop::color;
  double opacity = 0;
};

class GlCanvas : public Canvas {
 public:
  TextureId scene(const std::shared_ptr<const debug::Run>& run,
                  const render::StepLook& look,
                  const render::Camera& camera,
                  int width,
                  int height,
                  Side side) override {
    if (side == Side::beside && !beside_) beside_ = std::make_unique<SceneView>();
    SceneView& view = side == Side::beside ? *beside_ : scene_;
    const bool same_list = view.shows == SceneView::Shows::step && view.key.same(run, look);
    if (!same_list) {
      view.list = render::scene_step(*run, look);
      view.key = {run, look};
      view.shows = SceneView::Shows::step;
    }
    return drawn(view, same_list, camera, width, height, look.theme);
  }

  TextureId label_scene(const std::shared_ptr<const LabelFrame>& frame,
                        const render::LabelLook& look,
                        const render::Camera& camera,
                        int width,
                        int height) override {
    const bool same_list = scene_.shows == SceneView::Shows::labels && label_key_.same(frame, look);
    if (!same_list) {
      // Keep the points when only colors change.
      std::vector<std::uint8_t> shown;
      if (look.labels) shown = labels::shown_pixels(*look.labels);
      if (scene_.shows != SceneView::Shows::labels || label_key_.frame.lock() != frame ||
          shown != shown_) {
        scene_.list = {};
        scene_.list.points.push_back(render::label_points(frame->grid, frame->world, shown));
        point_ground_ = render::label_ground(frame->grid, render::Backdrop::color);
        shown_ = std::move(shown);
      }
      render::color_label_points(scene_.list.points.back(), point_ground_, frame->grid, look);
      label_key_.set(frame, look);
      scene_.shows = SceneView::Shows::labels;
    }
    return drawn(scene_, same_list, camera, width, height, look.theme);
  }

  render::Picked pick(int x, int y, int reach_px) override {
    SceneView& view = scene_;
    if (view.texture == 0 || x < 0 || y < 0 || x >= view.width || y >= view.height) return {};
    if (view.ids.empty())
      view.ids = view.renderer.render_ids(view.list, view.camera, view.width, view.height);
    std::uint32_t id = view.ids.at(x, y);
    int nearest = id != 0 ? 0 : reach_px * reach_px + 1;
    for (int v = std::max(0, y - reach_px); v <= std::min(view.height - 1, y + reach_px); ++v)
      for (int u = std::max(0, x - reach_px); u <= std::min(view.width - 1, x + reach_px); ++u) {
        const int distance = (u - x) * (u - x) + (v - y) * (v - y);
        if (distance >= nearest || view.ids.at(u, v) == 0) continue;
        nearest = distance;
        id = view.ids.at(u, v);
      }
    return render::picked(id);
  }

  TextureId image(const std::shared_ptr<const debug::Run>& run,
                  const render::StepLook& look,
                  render::Backdrop backdrop,
                  double opacity,
                  Side side) override {
    StepPicture& shown = images_[static_cast<std::size_t>(side)];
    const bool same = shown.texture.id() != 0 && shown.key.same(run, look) &&
                      backdrop == shown.backdrop && opacity == shown.opacity;
    if (same) return shown.texture.id();
    if (backdrop_subject_.lock() != run->subject || backdrop != backdrop_) {
      backdrop_image_ = render::image_backdrop(*run->subject, backdrop);
      backdrop_subject_ = run->subject;
      backdrop_ = backdrop;
    }
    Image8 picture = backdrop_image_;
    if (picture.empty()) return 0;
    render::paint_step(picture, *run, look, opacity);
    upload(shown.texture, picture);
    shown.key = {run, look};
    shown.backdrop = backdrop;
    shown.opacity = opacity;
    return shown.texture.id();
  }

  TextureId label_image(const std::shared_ptr<const LabelFrame>& frame,
                        const render::LabelLook& look,
                        render::Backdrop backdrop,
                        double opacity) override {
    const bool same_ground = label_image_.id() != 0 && label_image_key_.frame.lock() == frame &&
                             backdrop == label_backdrop_;
    if (same_ground && label_image_key_.same(frame, look) && opacity == label_opacity_)
      return label_image_.id();
    if (!same_ground) image_ground_ = render::label_ground(frame->grid, backdrop);
    Image8 picture = image_ground_;
    render::paint_labels(picture, frame->grid, look, opacity);
    upload(label_image_, picture);
    label_image_key_.set(frame, look);
    label_backdrop_ = backdrop;
    label_opacity_ = opacity;
    return label_image_.id();
  }

  TextureId picture(const std::string& key, const Image8& image, std::uint64_t version) override {
    if (image.empty()) return 0;
    Picture& picture = pictures_[key];
    if (picture.texture.id() == 0 || picture.version != version) upload(picture.texture, image);
    picture.version = version;
    return picture.texture.id();
  }

  std::uint64_t version(TextureId texture) const override {
    const auto found = versions_.find(texture);
    return found == versions_.end() ? 0 : found->second;
  }

 private:
  TextureId drawn(SceneView& view,
                  bool same_list,
                  const render::Camera& camera,
                  int width,
                  int height,
                  render::Theme theme) {
    if (view.draw(same_list, camera, width, height, theme, screen_scale))
      versions_[view.texture] = ++changes_;
    return view.texture;
  }

  void upload(render::ImageTexture& texture, const Image8& image) {
    texture.upload(image);
    versions_[texture.id()] = ++changes_;
  }

  struct Picture {
    render::ImageTexture texture;
    std::uint64_t version = 0;
  };
  SceneView scene_;
  std::unique_ptr<SceneView> beside_;  // created when two runs are first shown
  LabelLookKey label_key_, label_image_key_;
  std::vector<std::uint8_t> shown_;  // visible pixels of the labels in scene_
  Image8 point_ground_, image_ground_;
  std::array<StepPicture, 2> images_;  // by Side
  render::ImageTexture label_image_;
  render::Backdrop backdrop_ = render::Backdrop::color;
  std::weak_ptr<const debug::Subject> backdrop_subject_;
  Image8 backdrop_image_;
  render::Backdrop label_backdrop_ = render::Backdrop::color;
  double label_opacity_ = 0;
  std::map<std::string, Picture> pictures_;
  std::map<TextureId, std::uint64_t> versions_;
  std::uint64_t changes_ = 0;
};

}  // namespace

std::unique_ptr<Canvas> make_gl_canvas() { return std::make_unique<GlCanvas>(); }

}  // namespace planescope::desktop
