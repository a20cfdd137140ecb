// Tests of GL contexts, textures and splats.

#include "render/gl.hpp"

#include <cstdlib>

#include "gl_fixture.hpp"
#include "render/gl.hpp"

namespace planescope::render {
namespace {

// ---- Contexts ----

struct Context : GlTest {};

TEST_F(Context, DescriptionContainsDriverAndInterface) {
  EXPECT_NE(context().description().find("EGL"), std::string::npos) << context().description();
}

TEST_F(Context, TwoContextsCanCoexist) {
  const auto camera = front_camera();
  const Image8 before = render({}, camera);
  {
    const auto other = make_egl_context();  // current from now on
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

// ---- Textures ----

struct Texture : GlTest {};

// The points of a picture are drawn on the CPU, those of a window by GL.
TEST_F(Texture, OfADrawingMatchesThePicture) {
  DrawList list;
  list.boxes = {{box_corners(Vec3f::Constant(-0.2f), Vec3f::Constant(0.2f)),
                 {220, 20, 20},
                 BoxStyle::tinted,
                 1}};
  list.title = "Box";
  const auto compare = [&](Effort effort, int most, int differing_share) {
    const Image8 picture = render(list, front_camera(), Theme::dark);
    const auto id = renderer().draw(list, front_camera(), kWidth, kHeight, Theme::dark, effort);
    const Image8 texture = pixels_of(id, kWidth, kHeight);
    double sum = 0;
    int differing = 0;
    for (int y = 0; y < kHeight; ++y) {
      for (int x = 0; x < kWidth; ++x) {
        const int off = std::abs(texture.at(x, kHeight - 1 - y) - picture.at(x, y));
        sum += off;
        differing += off > most;
      }
    }
    EXPECT_LT(sum / (kWidth * kHeight), 1);
    EXPECT_LT(differing, kWidth * kHeight / differing_share);
  };
  compare(Effort::quick, 8, 50);
  list.points.resize(1);
  list.points[0].size_m = 0.05f;
  list.points[0].max_px = 30;
  for (int k = 0; k < 200; ++k) {
    const auto turn = static_cast<float>(k) / 10;
    list.points[0].positions.emplace_back(0.2f * std::sin(turn), 0.4f * std::cos(turn),
                                          0.004f * static_cast<float>(k) - 0.4f);
    list.points[0].colors.push_back({static_cast<std::uint8_t>(k), 120, 40});
  }
  compare(Effort::fine, 2, 20);
}

TEST_F(Texture, OfADrawingFollowsItsSize) {
  const auto camera = front_camera();
  EXPECT_GT(pixels_of(renderer().draw({}, camera, 64, 48, Theme::light), 64, 48).at(32, 24), 220);
  const Image8 small = renderer().render({}, camera, 64, 48, Theme::light);
  renderer().draw({}, camera, kWidth, kHeight, Theme::light);
  EXPECT_EQ(renderer().render({}, camera, 64, 48, Theme::light).data, small.data);
}

TEST_F(Texture, OfAnImageHasItsPixelsAndCanBeReplaced) {
  Image8 image(3, 2, 3);
  for (std::size_t i = 0; i < image.data.size(); ++i) image.data[i] = static_cast<std::uint8_t>(i);
  ImageTexture texture(image);
  EXPECT_EQ(texture.width(), 3);
  EXPECT_EQ(texture.height(), 2);
  Image8 held = pixels_of(texture.id(), 3, 2);
  EXPECT_EQ(held.at(2, 1, 1), image.at(2, 1, 1));
  EXPECT_EQ(held.at(0, 0, 3), 255);

  const std::uint32_t id = texture.id();
  ImageTexture moved = std::move(texture);
  moved.upload(Image8(5, 4, 4, 77));
  EXPECT_EQ(moved.id(), id);
  held = pixels_of(moved.id(), 5, 4);
  EXPECT_EQ(held.at(4, 3, 3), 77);
}

// ---- Points on the CPU ----

// Shapes are shared by the pictures of one frame.
TEST(Splats, OtherColorsDoNotChangeTheShapes) {
  DrawPoints points;
  points.positions.assign(10, Vec3f::Zero());
  points.colors.assign(10, {3, 90, 200, 255});
  std::vector<DrawPoints> other = {points};
  for (Rgba& color : other[0].colors) color = {1, 2, 3, 255};
  EXPECT_TRUE(same_shapes({points}, other));
  other[0].colors[3].a = 128;
  EXPECT_FALSE(same_shapes({points}, other));
  EXPECT_FALSE(same_shapes({points}, {points, points}));
  other = {points};
  other[0].positions[0].x() += 0.01f;
  EXPECT_FALSE(same_shapes({points}, other));
}

}  // namespace

}  // namespace planescope::render
