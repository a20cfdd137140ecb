#pragma once

// Pixel tests need a GL context, but no display server. All tests share one context and one
// renderer, so that state left behind by a picture would be visible in the next.

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "core/model/error.hpp"
#include "render/gl.hpp"
#include "render/renderer.hpp"

namespace planescope::render {

class GlTest : public testing::Test {
 protected:
  static void SetUpTestSuite() {
    try {
      context_ = make_egl_context();
      renderer_ = std::make_unique<Renderer>();
    } catch (const Error& error) {
      no_context_ = error.what();
    }
  }
  static void TearDownTestSuite() {
    renderer_.reset();
    context_.reset();
  }
  void SetUp() override {
    if (context_ == nullptr) GTEST_SKIP() << no_context_;
    ASSERT_NE(renderer_, nullptr) << no_context_;
  }
  Image8 render(const DrawList& list, const Camera& camera, Theme theme = Theme::light) {
    return renderer_->render(list, camera, kWidth, kHeight, theme);
  }
  /// The drawing for a window: RGBA, row 0 at the bottom.
  Image8 draw(const DrawList& list, const Camera& camera) {
    return pixels_of(renderer_->draw(list, camera, kWidth, kHeight, Theme::light), kWidth, kHeight);
  }
  /// RGBA as stored by GL, row 0 first.
  static Image8 pixels_of(std::uint32_t texture, int width, int height) {
    Image8 image(width, height, 4);
    glBindTexture(GL_TEXTURE_2D, texture);
    glGetTexImage(GL_TEXTURE_2D, 0, GL_RGBA, GL_UNSIGNED_BYTE, image.data.data());
    glBindTexture(GL_TEXTURE_2D, 0);
    return image;
  }
  Renderer& renderer() { return *renderer_; }
  GlContext& context() { return *context_; }

  static constexpr int kWidth = 160;
  static constexpr int kHeight = 120;

 private:
  static inline std::unique_ptr<GlContext> context_;
  static inline std::unique_ptr<Renderer> renderer_;
  static inline std::string no_context_;
};

/// Looks along +x from 1 m in front of the origin, z up: y points left and z up on screen.
inline Camera front_camera() { return {.eye = Vec3d(-1, 0, 0)}; }

inline DrawList without_overlay() {
  DrawList list;
  list.show_axes = false;
  list.show_scale_bar = false;
  return list;
}

inline Rgba pixel(const Image8& image, int x, int y) {
  return {image.at(x, y, 0), image.at(x, y, 1), image.at(x, y, 2)};
}

}  // namespace planescope::render
