#include <map>

#include "app/desktop/canvas.hpp"
#include "render/image_texture.hpp"
#include "render/renderer.hpp"

namespace planescope::desktop {
namespace {

bool same_camera(const Camera& a, const Camera& b) {
  return a.eye == b.eye && a.target == b.target && a.up == b.up && a.fov_y_deg == b.fov_y_deg &&
         a.orthographic == b.orthographic && a.ortho_height_m == b.ortho_height_m;
}

/// What a look depends on, to compare with the next.
struct LookKey {
  std::weak_ptr<const Run> run;  // an address alone may be another run's by now
  StepLook look;
  std::vector<std::uint32_t> marked;

  bool same(const std::shared_ptr<const Run>& other_run, const StepLook& other) const {
    return run.lock() == other_run && look.step == other.step && look.color_by == other.color_by &&
           look.show_queue == other.show_queue && look.show_settled == other.show_settled &&
           look.show_planes == other.show_planes && look.node == other.node &&
           look.plane == other.plane && look.voxel == other.voxel && look.theme == other.theme &&
           std::equal(marked.begin(), marked.end(), other.marked.begin(), other.marked.end());
  }
  void set(const std::shared_ptr<const Run>& new_run, const StepLook& new_look) {
    run = new_run;
    look = new_look;
    marked.assign(new_look.marked.begin(), new_look.marked.end());
    look.marked = {};
  }
};

class GlCanvas : public Canvas {
 public:
  TextureId scene(const std::shared_ptr<const Run>& run,
                  const StepLook& look,
                  const Camera& camera,
                  int width,
                  int height) override {
    const bool same_list = scene_texture_ != 0 && scene_key_.same(run, look);
    const bool same =
        same_list && same_camera(camera, camera_) && width == width_ && height == height_;
    if (same && fine_) return scene_texture_;
    // What moves is drawn quickly; what has come to rest, once more with smooth edges.
    fine_ = same;
    if (!same) ids_ = {};
    if (!same_list) {
      list_ = scene_step(*run, look);
      scene_key_.set(run, look);
    }
    camera_ = camera;
    width_ = width;
    height_ = height;
    scene_texture_ = renderer_.draw(list_, camera, width, height, look.theme,
                                    fine_ ? Effort::fine : Effort::quick);
    return scene_texture_;
  }

  Picked pick(int x, int y) override {
    if (scene_texture_ == 0 || x < 0 || y < 0 || x >= width_ || y >= height_) return {};
    if (ids_.empty()) ids_ = renderer_.render_ids(list_, camera_, width_, height_);
    return picked(ids_.at(x, y));
  }

  TextureId image(const std::shared_ptr<const Run>& run,
                  const StepLook& look,
                  Backdrop backdrop,
                  double opacity) override {
    const bool same = image_.id() != 0 && image_key_.same(run, look) && backdrop == backdrop_ &&
                      opacity == opacity_;
    if (same) return image_.id();
    if (backdrop_subject_.lock() != run->subject || backdrop != backdrop_) {
      backdrop_image_ = image_backdrop(*run->subject, backdrop);
      backdrop_subject_ = run->subject;
    }
    Image8 picture = backdrop_image_;
    if (picture.empty()) return 0;
    paint_step(picture, *run, look, opacity);
    image_.upload(picture);
    image_key_.set(run, look);
    backdrop_ = backdrop;
    opacity_ = opacity;
    return image_.id();
  }

  TextureId picture(const std::string& key, const Image8& image, std::uint64_t version) override {
    if (image.empty()) return 0;
    Picture& picture = pictures_[key];
    if (picture.texture.id() == 0 || picture.version != version) picture.texture.upload(image);
    picture.version = version;
    return picture.texture.id();
  }

 private:
  struct Picture {
    ImageTexture texture;
    std::uint64_t version = 0;
  };
  Renderer renderer_;
  DrawList list_;
  LookKey scene_key_, image_key_;
  Camera camera_;
  int width_ = 0, height_ = 0;
  TextureId scene_texture_ = 0;
  bool fine_ = false;
  Image<std::uint32_t> ids_;  // of the scene drawn last; empty until someone asks
  ImageTexture image_;
  Backdrop backdrop_ = Backdrop::color;
  std::weak_ptr<const Subject> backdrop_subject_;
  Image8 backdrop_image_;
  double opacity_ = 0;
  std::map<std::string, Picture> pictures_;
};

}  // namespace

std::unique_ptr<Canvas> make_gl_canvas() { return std::make_unique<GlCanvas>(); }

}  // namespace planescope::desktop
