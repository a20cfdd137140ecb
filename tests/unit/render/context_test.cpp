#include <cstdlib>

#include "gl_fixture.hpp"

namespace planescope::render {
namespace {

struct Context : GlTest {};

TEST_F(Context, DescriptionNamesTheDriverAndTheWayIn) {
  EXPECT_NE(context().description().find("EGL"), std::string::npos) << context().description();
}

TEST_F(Context, TwoContextsLiveSideBySide) {
  const auto camera = front_camera();
  const Image8 before = render({}, camera);
  {
    const auto other = make_egl_context();  // current from here on
    Renderer there;
    EXPECT_EQ(there.render({}, camera, kWidth, kHeight, Theme::light).data, before.data);
  }
  context().make_current();
  EXPECT_EQ(render({}, camera).data, before.data);
}

TEST(GlfwContext, DrawsTheSamePictureInAHiddenWindow) {
  if (std::getenv("DISPLAY") == nullptr) GTEST_SKIP() << "no display";
  std::unique_ptr<GlContext> window;
  try {
    window = make_glfw_context(64, 48, "planescope", false);
  } catch (const Error& error) {
    GTEST_SKIP() << error.what();
  }
  ASSERT_NE(window->window(), nullptr);
  Renderer renderer;
  const Image8 image = renderer.render({}, front_camera(), 64, 48, Theme::dark);
  EXPECT_LT(image.at(32, 24, 0), 60);
}

TEST(GlfwContext, WithoutADisplayTheErrorSaysSo) {
  if (std::getenv("DISPLAY") != nullptr || std::getenv("WAYLAND_DISPLAY") != nullptr) {
    GTEST_SKIP() << "there is a display";
  }
  try {
    make_glfw_context(64, 48, "planescope", false);
    FAIL() << "a window opened";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find("window"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace planescope::render
