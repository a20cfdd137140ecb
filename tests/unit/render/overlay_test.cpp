// Tests of overlays, text, scale bars, framing and camera views.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <random>

#include "core/model/random.hpp"
#include "gl_fixture.hpp"
#include "render/draw_list.hpp"
#include "render/paint.hpp"

namespace planescope::render {
namespace {

View view_of(int width, int height) { return make_view(Camera{}, width, height); }

Overlay layout(const DrawList& list) {
  return layout_overlay(list, view_of(900, 720), theme_colors(Theme::light));
}

const OverlayText* find(const Overlay& overlay, const std::string& text) {
  const auto found = std::ranges::find(overlay.texts, text, &OverlayText::text);
  return found == overlay.texts.end() ? nullptr : &*found;
}

TEST(ScaleBar, LengthIsTheLongestRoundOneThatFits) {
  EXPECT_DOUBLE_EQ(round_length_m(100, 100), 1);
  EXPECT_DOUBLE_EQ(round_length_m(100, 99), 0.5);
  EXPECT_DOUBLE_EQ(round_length_m(100, 49), 0.2);
  EXPECT_DOUBLE_EQ(round_length_m(100, 19), 0.1);
  EXPECT_DOUBLE_EQ(round_length_m(0.1, 100), 1000);
}

TEST(ScaleBar, LengthIsPrintedInItsNaturalUnit) {
  EXPECT_EQ(length_text(0.005), "5 mm");
  EXPECT_EQ(length_text(0.01), "1 cm");
  EXPECT_EQ(length_text(0.2), "20 cm");
  EXPECT_EQ(length_text(1), "1 m");
  EXPECT_EQ(length_text(50), "50 m");
  EXPECT_EQ(length_text(2000), "2 km");
}

TEST(ScaleBar, HasTheLengthOfItsLabel) {
  DrawList list;
  list.show_axes = false;
  const View view = view_of(900, 720);
  const Overlay overlay = layout_overlay(list, view, theme_colors(Theme::light));
  ASSERT_EQ(overlay.segments.size(), 3u);
  ASSERT_EQ(overlay.texts.size(), 1u);
  const double length_px = (overlay.segments[0].b - overlay.segments[0].a).norm();
  const double length_m = length_px / view.px_per_m_at_target;
  EXPECT_NEAR(length_m, round_length_m(view.px_per_m_at_target, 150), 1e-3);
  EXPECT_EQ(overlay.texts[0].text, length_text(round_length_m(view.px_per_m_at_target, 150)));
}

TEST(Overlay, AxesPointAsTheCameraSeesThem) {
  DrawList list;
  list.show_scale_bar = false;
  const Overlay overlay = layout(list);
  ASSERT_EQ(overlay.segments.size(), 3u);
  ASSERT_NE(find(overlay, "z"), nullptr);
  const Rgba z_color = find(overlay, "z")->color;
  for (const Segment& axis : overlay.segments) {
    if (axis.color == z_color) {
      EXPECT_LT(axis.b.y(), axis.a.y() - 10);  // up on screen
    }
  }
}

TEST(Overlay, EmptyListHasNoOverlay) {
  DrawList list;
  list.show_axes = list.show_scale_bar = false;
  const Overlay overlay = layout(list);
  EXPECT_TRUE(overlay.shapes.empty() && overlay.segments.empty() && overlay.texts.empty());
}

TEST(Overlay, LongTitleIsShortenedToThePicture) {
  DrawList list;
  list.title = std::string(400, 'W') + "ä";
  const Overlay overlay = layout(list);
  const OverlayText& title = overlay.texts.front();
  EXPECT_EQ(title.text.substr(title.text.size() - 3), "…");
  EXPECT_LT(title.x + text_width(title.text, title.size_px), 900);
}

TEST(Overlay, LongLegendFlowsIntoColumnsInsideThePicture) {
  DrawList list;
  list.title = "Planes";
  for (int i = 1; i <= 60; ++i) list.explain({0, 0, 0}, "plane " + std::to_string(i));
  const Overlay overlay = layout(list);
  double leftmost = 900;
  double rightmost = 0;
  for (int i = 1; i <= 60; ++i) {
    const OverlayText* text = find(overlay, "plane " + std::to_string(i));
    ASSERT_NE(text, nullptr) << i;
    EXPECT_GT(text->baseline, find(overlay, "Planes")->baseline + 20);
    EXPECT_LT(text->baseline, 720);
    leftmost = std::min(leftmost, text->x);
    rightmost = std::max(rightmost, text->x);
  }
  EXPECT_GT(rightmost, leftmost + 50);
  EXPECT_LT(rightmost, 800);
}

TEST(Overlay, ALabelIsHiddenByAnOverlappingMoreImportantOne) {
  DrawList list;
  list.labels = {{{0, 0, 0}, "IV", {}, 14, kNumeralLabel},
                 {{0.01f, 0.01f, 0}, "P7", {}, 14, kPlaneLabel + 900},
                 {{0, 0, 0}, "P3", {}, 14, kPlaneLabel + 10},
                 {{0.3f, -0.3f, 0}, "II", {}, 14, kNumeralLabel}};
  const Overlay overlay = layout(list);
  std::vector<std::string> shown;
  for (const OverlayText& label : overlay.labels) shown.push_back(label.text);
  std::sort(shown.begin(), shown.end());
  EXPECT_EQ(shown, (std::vector<std::string>{"II", "P3"}));
}

TEST(Overlay, LabelsNeverOverlap) {
  std::mt19937 random(7);
  const auto number = [&](int n) { return static_cast<int>(random() % static_cast<unsigned>(n)); };
  for (int scene = 0; scene < 50; ++scene) {
    DrawList list;
    for (int i = 0; i < 60; ++i) {
      const auto place = [&] { return 0.02f * static_cast<float>(number(80)) - 0.8f; };
      list.labels.push_back({{place(), place(), place()},
                             "P" + std::to_string(number(300)),
                             {},
                             static_cast<float>(12 + number(8)),
                             number(3)});
    }
    const Overlay overlay = layout(list);
    EXPECT_GE(overlay.labels.size(), 10u);
    for (std::size_t a = 0; a < overlay.labels.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        const OverlayText &one = overlay.labels[a], &other = overlay.labels[b];
        const auto width = [](const OverlayText& text) {
          return text_width(text.text, text.size_px);
        };
        const bool beside = one.x >= other.x + width(other) || other.x >= one.x + width(one);
        const double high = 0.9 * std::max(one.size_px, other.size_px);
        EXPECT_TRUE(beside || std::abs(one.baseline - other.baseline) >= high)
            << one.text << " on " << other.text;
      }
  }
}

TEST(Overlay, LabelsDoNotOverlapThePanels) {
  DrawList list;
  list.title = "Planes";
  list.legend = {{LegendEntry::Symbol::dot, {0, 0, 0}, "plane 1"}};
  const View view = view_of(900, 720);
  const Overlay bare = layout_overlay(list, view, theme_colors(Theme::light));
  const Eigen::Matrix4f to_world = (view.proj * view.view).inverse();
  const auto shown_at = [&](double x, double y) {
    const Eigen::Vector4f clip(static_cast<float>(2 * x / 900 - 1),
                               static_cast<float>(1 - 2 * y / 720), 0.5f, 1);
    const Vec3f at = (to_world * clip).hnormalized();
    list.labels = {{at, "P7", {}, 14}};
    EXPECT_NEAR((project(view, at)->px - Vec2d(x, y)).norm(), 0, 1);
    return !layout_overlay(list, view, theme_colors(Theme::light)).labels.empty();
  };
  EXPECT_TRUE(shown_at(450, 360));
  for (const OverlayText& text : bare.texts)  // title, legend, names of axes, length
    EXPECT_FALSE(shown_at(text.x + 4, text.baseline - 4)) << text.text;
}

TEST(Overlay, HasTheSameSizeOnADenseScreen) {
  DrawList list;
  list.title = "Planes";
  const ThemeColors& colors = theme_colors(Theme::light);
  const Overlay ordinary = layout_overlay(list, make_view({}, 400, 500), colors);
  const Overlay dense = layout_overlay(list, make_view({}, 800, 1000, 2), colors);
  ASSERT_FALSE(ordinary.texts.empty());
  ASSERT_EQ(dense.texts.size(), ordinary.texts.size());
  for (std::size_t i = 0; i < dense.texts.size(); ++i)
    EXPECT_NEAR(dense.texts[i].size_px, 2 * ordinary.texts[i].size_px, 1e-9);
}

TEST(Overlay, LabelsBehindTheCameraAreSkipped) {
  DrawList list;
  list.labels = {{{-0.5f, -0.5f, 0.5f}, "near", {}, 14},
                 {{1, -0.5f, -1}, "far", {}, 14},
                 {{-3, -3, 3}, "behind", {}, 14}};
  const Overlay overlay = layout(list);
  ASSERT_EQ(overlay.labels.size(), 2u);
  EXPECT_EQ(overlay.labels[0].text, "near");
  EXPECT_EQ(overlay.labels[1].text, "far");
}

// ---- Text ----

TEST(Text, InkCoversTheReportedWidth) {
  Image8 image(400, 60, 3);
  const double advance = draw_text(image, 20, 40, "MnHoM", 24, {255, 255, 255});
  EXPECT_DOUBLE_EQ(advance, text_width("MnHoM", 24));
  int first = image.width, last = -1;  // first and last column with ink
  for (int x = 0; x < image.width; ++x)
    for (int y = 0; y < image.height; ++y)
      if (image.at(x, y) > 64) {
        first = std::min(first, x);
        last = x;
      }
  EXPECT_NEAR(first, 20, 4);
  EXPECT_NEAR(last, 20 + advance, 4);
}

TEST(Text, IsAlignedToItsBaseline) {
  Image8 image(60, 60, 3);
  draw_text(image, 5, 40, "H", 30, {255, 255, 255});
  EXPECT_GT(image.at(10, 38), 100);  // the left stem of the H
  EXPECT_GT(image.at(10, 21), 100);
  for (int x = 0; x < 60; ++x) EXPECT_EQ(image.at(x, 41), 0);
}

TEST(Text, HasEveryCharacterOfOurPictures) {
  for (const char32_t c : decode_utf8("θστα µμ ≤≥±°×²³·–—…√Δλ 0123456789 (h/v) äöüß"))
    EXPECT_TRUE(has_glyph(c)) << static_cast<unsigned>(c);
}

TEST(Text, BrokenUtf8IsReplaced) {
  EXPECT_EQ(decode_utf8("a\xC3\xA4z").size(), 3u);
  EXPECT_EQ(decode_utf8("a\xC3\xA4z")[1], U'ä');
  EXPECT_EQ(decode_utf8("\xF0\x9F\x98\x80")[0], char32_t{0x1F600});
  EXPECT_EQ(decode_utf8("\xFFz")[0], char32_t{0xFFFD});
  EXPECT_EQ(decode_utf8("z\xE2\x89").size(), 3u);  // truncated: one per byte
}

TEST(Text, IsClippedAtTheImagesEdges) {
  Image8 image(20, 10, 3);
  EXPECT_NO_THROW(draw_text(image, -30, 5, "planescope", 40, {255, 255, 255}));
  EXPECT_NO_THROW(draw_text(image, 15, -100, "planescope", 40, {255, 255, 255}));
  EXPECT_NO_THROW(draw_text(image, 15, 500, "planescope", 40, {255, 255, 255}));
}

TEST(Text, AlphaBlendsWithTheImage) {
  Image8 full(60, 60, 3);
  Image8 half(60, 60, 3);
  draw_text(full, 5, 50, "H", 50, {255, 255, 255});
  draw_text(half, 5, 50, "H", 50, {255, 255, 255, 128});
  EXPECT_EQ(*std::max_element(full.data.begin(), full.data.end()), 255);
  EXPECT_NEAR(*std::max_element(half.data.begin(), half.data.end()), 128, 1);
}

TEST(Text, HaloSurroundsTheGlyph) {
  const GlyphBitmap glyph = glyph_bitmap(U'l', 20, 0);
  const GlyphBitmap halo = grown(glyph, 2);
  EXPECT_GT(halo.width, glyph.width + 3);
  EXPECT_EQ(halo.left + halo.width - glyph.left - glyph.width, glyph.left - halo.left);
  for (int y = 0; y < glyph.height; ++y)
    for (int x = 0; x < glyph.width; ++x) {
      const int hx = x + glyph.left - halo.left, hy = y + glyph.top - halo.top;
      EXPECT_GE(halo.coverage[hy * halo.width + hx], glyph.coverage[y * glyph.width + x]);
    }
}

struct OverlayPicture : GlTest {};

TEST_F(OverlayPicture, ManySizesOfTextExceedTheAtlasAndAreAllDrawn) {
  DrawList list = without_overlay();
  for (int i = 0; i < 60; ++i) {
    const auto y = static_cast<float>(i % 10) * 0.08f - 0.4f;
    list.labels.push_back({{0, y, 0}, "ABCDEFGHIJ", {255, 0, 0}, 40 + static_cast<float>(i)});
  }
  const Image8 first = render(list, front_camera());
  EXPECT_EQ(render(list, front_camera()).data, first.data);
  int red = 0;
  for (int x = 0; x < kWidth; ++x) red += pixel(first, x, kHeight / 2).g < 60;
  EXPECT_GT(red, 20);
}

// ---- Cameras ----

std::vector<Vec3f> points_in_box(const Vec3f& min, const Vec3f& max, int count) {
  Random random(7);
  std::vector<Vec3f> points;
  for (int i = 0; i < count; ++i) {
    Vec3f at;
    for (int axis = 0; axis < 3; ++axis)
      at[axis] = min[axis] + static_cast<float>(random.uniform()) * (max[axis] - min[axis]);
    points.push_back(at);
  }
  return points;
}

/// How far the points extend from the center of the view toward its borders; 1: to the border.
Vec2d reach_in_view(const std::vector<Vec3f>& points, const Camera& camera, double aspect) {
  const int height = 1000, width = static_cast<int>(1000 * aspect);
  const View view = make_view(camera, width, height);
  Vec2d most = Vec2d::Zero();
  for (const Vec3f& point : points) {
    const auto seen = project(view, point);
    if (!seen) return Vec2d::Constant(1e9);
    most.x() = std::max(most.x(), std::abs(seen->px.x() / width - 0.5) * 2);
    most.y() = std::max(most.y(), std::abs(seen->px.y() / height - 0.5) * 2);
  }
  return most;
}

TEST(Framing, FillsViewsOfEveryAspectRatioWithoutClipping) {
  const std::vector<Vec3f> points = points_in_box({1, -2, 0}, {4, 2, 1.5}, 5000);
  const std::vector<Vec3f> reach = extent_of(points, 0);
  for (const double aspect : {0.4, 1.0, 4.0 / 3, 2.6})
    for (const Vec3d& forward : {Vec3d(1, 0, 0), Vec3d(0.8, 0.2, -0.5), Vec3d(0, 0, -1)}) {
      Lens lens{.forward = forward.normalized(), .aspect = aspect};
      if (forward.x() == 0) lens.up = Vec3d::UnitX();
      const Vec2d most = reach_in_view(points, camera_fitting(reach, lens), aspect);
      EXPECT_LT(most.maxCoeff(), 1) << aspect << " " << forward.transpose();
      EXPECT_GT(most.maxCoeff(), 0.85) << aspect << " " << forward.transpose();
    }
}

TEST(Framing, AnOrthographicViewIsFilledToo) {
  const std::vector<Vec3f> points = points_in_box({1, -2, 0}, {9, 2, 1.5}, 5000);
  for (const double aspect : {0.5, 2.0}) {
    Camera camera = camera_fitting(extent_of(points, 0), {.aspect = aspect, .orthographic = true});
    camera.orthographic = true;
    camera.ortho_height_m =
        2 * (camera.eye - camera.target).norm() * std::tan(camera.fov_y_deg * M_PI / 360);
    camera.eye = camera.target - Vec3d(50, 0, 0);
    const Vec2d most = reach_in_view(points, camera, aspect);
    EXPECT_LT(most.maxCoeff(), 1);
    EXPECT_GT(most.maxCoeff(), 0.85);
  }
}

TEST(Framing, FewDistantPointsAreIgnored) {
  std::vector<Vec3f> points = points_in_box({0, 0, 0}, {2, 2, 0.1F}, 5000);
  const std::vector<Vec3f> speck = points_in_box({9, 9, 3}, {9.3F, 9.3F, 3.1F}, 60);
  const std::vector<Vec3f> wall = points_in_box({5, 0, 0}, {5.1F, 2, 2}, 1000);
  points.insert(points.end(), speck.begin(), speck.end());
  points.insert(points.end(), wall.begin(), wall.end());
  const std::vector<Vec3f> bulk = bulk_of(points, 0.25);
  EXPECT_EQ(bulk.size(), points.size() - speck.size()) << "a wall apart from the floor stays";
  for (const Vec3f& point : bulk) EXPECT_LT(point.x(), 6);
}

TEST(Framing, WithoutPointsIsFinite) {
  EXPECT_TRUE(extent_of({}, 0.01).empty());
  EXPECT_TRUE(bulk_of({}, 0.1).empty());
  EXPECT_TRUE(camera_fitting({}, {}).eye.allFinite());
  const std::vector<Vec3f> one = {Vec3f(1, 2, 3)};
  EXPECT_GT((camera_fitting(one, {}).eye - camera_fitting(one, {}).target).norm(), 0.01);
}

TEST(View, TargetIsInTheMiddleAndUpIsUp) {
  Camera camera;
  camera.eye = Vec3d(3, -2, 1);
  camera.target = Vec3d(0.5, 0.5, 0.2);
  const View view = make_view(camera, 640, 480);
  const auto middle = project(view, camera.target.cast<float>());
  ASSERT_TRUE(middle);
  EXPECT_NEAR(middle->px.x(), 320, 1e-3);
  EXPECT_NEAR(middle->px.y(), 240, 1e-3);
  EXPECT_NEAR(middle->depth_m, (camera.eye - camera.target).norm(), 1e-5);
  const auto above = project(view, Vec3f(0.5f, 0.5f, 0.3f));
  ASSERT_TRUE(above);
  EXPECT_LT(above->px.y(), 239);
  EXPECT_NEAR(above->px.x(), 320, 1e-3);
}

TEST(View, PixelsPerMeterAtTheTargetAreCorrect) {
  for (const bool orthographic : {false, true}) {
    Camera camera;
    camera.eye = Vec3d(-2, 0, 0);
    camera.orthographic = orthographic;
    const View view = make_view(camera, 640, 480);
    const auto a = project(view, Vec3f(0, 0, 0));
    const auto b = project(view, Vec3f(0, 0.1f, 0));
    ASSERT_TRUE(a && b);
    EXPECT_NEAR((a->px - b->px).norm(), 0.1 * view.px_per_m_at_target, 1e-3);
  }
}

TEST(View, NothingBehindTheEyeIsProjected) {
  Camera camera;
  camera.eye = Vec3d(-1, 0, 0);
  const View view = make_view(camera, 640, 480);
  EXPECT_FALSE(project(view, Vec3f(-2, 0, 0)));
  EXPECT_FALSE(project(view, Vec3f(std::nanf(""), 0, 0)));
  EXPECT_TRUE(project(view, Vec3f(2, 0, 0)));
}

}  // namespace

}  // namespace planescope::render
