// Tests of the renderer: pixels, partial redraws and picking.

#include "render/renderer.hpp"

#include <algorithm>
#include <cmath>

#include "gl_fixture.hpp"
#include "render/scenes.hpp"
#include "support/image_octree.hpp"

namespace planescope::render {
namespace {

// ---- Pictures ----

constexpr Rgba kRed = {220, 20, 20};
constexpr Rgba kBlue = {20, 20, 220};

struct RendererTest : GlTest {
  // The background without points, boxes or overlay.
  Image8 empty(Theme theme = Theme::light) {
    return render(without_overlay(), front_camera(), theme);
  }
  static int differing(const Image8& a, const Image8& b) {
    int count = 0;
    for (std::size_t i = 0; i < a.data.size(); i += 3) {
      count += a.data[i] != b.data[i] || a.data[i + 1] != b.data[i + 1] ||
               a.data[i + 2] != b.data[i + 2];
    }
    return count;
  }
};

DrawPoints one_point(Vec3f at, Rgba color, float size_m = 0.1f) {
  DrawPoints points;
  points.positions = {at};
  points.colors = {color};
  points.size_m = size_m;
  return points;
}

DrawBox box(Vec3f middle, float edge, Rgba color, BoxStyle style, std::uint32_t id = 0) {
  const Vec3f half = Vec3f::Constant(edge / 2);
  return {box_corners(middle - half, middle + half), color, style, id};
}

// Allows for shading, which changes lightness slightly.
void expect_near(Rgba a, Rgba b) {
  EXPECT_NEAR(a.r, b.r, 12);
  EXPECT_NEAR(a.g, b.g, 12);
  EXPECT_NEAR(a.b, b.b, 12);
}
bool reddish(Rgba c) { return c.r > c.b + 60 && c.r > c.g + 60; }
bool bluish(Rgba c) { return c.b > c.r + 60 && c.b > c.g + 60; }

TEST_F(RendererTest, EmptyListGivesTheThemesBackground) {
  const Image8 light = empty(Theme::light);
  const Image8 dark = empty(Theme::dark);
  EXPECT_EQ(light.width, kWidth);
  EXPECT_EQ(light.height, kHeight);
  EXPECT_EQ(light.channels, 3);
  for (const int y : {0, kHeight - 1}) {
    EXPECT_GT(pixel(light, 5, y).g, 220);
    EXPECT_LT(pixel(dark, 5, y).g, 50);
  }
}

TEST_F(RendererTest, RowZeroIsTheTopAndLeftOfTheSensorIsLeft) {
  DrawList list = without_overlay();
  list.points = {one_point({0, 0.2f, 0.2f}, kRed)};  // +y is left of +x, z points up
  const Image8 image = render(list, front_camera());
  const double px_per_m = kHeight / (2 * std::tan(22.5 * M_PI / 180));
  const int offset = static_cast<int>(std::lround(0.2 * px_per_m));
  expect_near(pixel(image, kWidth / 2 - offset, kHeight / 2 - offset), kRed);
}

TEST_F(RendererTest, SizeOnScreenFollowsTheDistanceWithinItsBounds) {
  const auto width_px = [&](float distance_m, float max_px) {
    DrawList list = without_overlay();
    list.points = {one_point({distance_m - 1, 0, 0}, kRed, 0.1f)};
    list.points[0].max_px = max_px;
    const Image8 image = render(list, front_camera());
    int count = 0;
    for (int x = 0; x < kWidth; ++x) count += reddish(pixel(image, x, kHeight / 2));
    return count;
  };
  EXPECT_NEAR(width_px(1, 100), 14.5, 1.5);
  EXPECT_NEAR(width_px(2, 100), 7.2, 1.5);
  EXPECT_NEAR(width_px(1, 6), 6, 1.5);
  EXPECT_GE(width_px(100, 100), 1);
}

TEST_F(RendererTest, NearPointHidesTheFarOneInAnyOrder) {
  const DrawPoints near = one_point({-0.2f, 0, 0}, kRed);
  const DrawPoints far = one_point({0.2f, 0, 0}, kBlue, 0.3f);
  for (const bool near_first : {true, false}) {
    DrawList list = without_overlay();
    list.points = near_first ? std::vector{near, far} : std::vector{far, near};
    list.points[0].max_px = list.points[1].max_px = 100;
    const Image8 image = render(list, front_camera());
    EXPECT_TRUE(reddish(pixel(image, kWidth / 2, kHeight / 2)));
    EXPECT_TRUE(bluish(pixel(image, kWidth / 2 + 12, kHeight / 2)));
  }
}

TEST_F(RendererTest, StepInACloudIsDarkenedAtItsFoot) {
  // A wall with a nearer half: the far half is darkened next to the near one.
  DrawList list = without_overlay();
  list.points.resize(1);
  list.points[0].max_px = 40;
  for (int y = -20; y <= 20; ++y) {
    for (int z = -20; z <= 20; ++z) {
      const float x = y > 0 ? -0.1f : 0.1f;
      list.points[0].positions.emplace_back(x, 0.02f * static_cast<float>(y),
                                            0.02f * static_cast<float>(z));
      list.points[0].colors.push_back({200, 200, 200});
    }
  }
  list.points[0].size_m = 0.03f;
  const Image8 image = render(list, front_camera());
  int darkest = 255;
  for (int x = kWidth / 2 - 8; x < kWidth / 2 + 8; ++x) {
    darkest = std::min<int>(darkest, image.at(x, kHeight / 2));
  }
  EXPECT_LT(darkest, 150);
  EXPECT_GT(image.at(kWidth / 2 - 30, kHeight / 2), 165);
}

TEST_F(RendererTest, BoxStylesDiffer) {
  const auto draw = [&](BoxStyle style) {
    DrawList list = without_overlay();
    list.boxes = {box(Vec3f::Zero(), 0.5f, kRed, style)};
    return render(list, front_camera());
  };
  const Image8 background = empty();
  const Image8 outline = draw(BoxStyle::outline);
  const Image8 tinted = draw(BoxStyle::tinted);
  const Image8 hatched = draw(BoxStyle::hatched);
  // A field of 9 x 9 pixels away from the edges: unchanged, evenly tinted, or striped.
  const auto reds = [](const Image8& image) {
    std::vector<int> values;
    for (int y = 50; y < 59; ++y) {
      for (int x = 70; x < 79; ++x) values.push_back(pixel(image, x, y).r - pixel(image, x, y).g);
    }
    return values;
  };
  const auto spread = [](const std::vector<int>& values) {
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    return *high - *low;
  };
  EXPECT_EQ(pixel(outline, 74, 54), pixel(background, 74, 54));
  EXPECT_GT(differing(outline, background), 100);
  EXPECT_TRUE(pixel(tinted, 74, 54).r > pixel(tinted, 74, 54).g + 20);
  EXPECT_LE(spread(reds(tinted)), 6);
  EXPECT_GT(spread(reds(hatched)), 80);
}

TEST_F(RendererTest, SolidBoxHidesTheBoxBehindButNotThePointInIt) {
  DrawList list = without_overlay();
  list.boxes = {box({0, 0, 0}, 0.4f, kRed, BoxStyle::tinted)};
  const Image8 one = render(list, front_camera());
  list.boxes.push_back(box({0.5f, 0, 0}, 0.2f, kBlue, BoxStyle::tinted));
  EXPECT_EQ(render(list, front_camera()).data, one.data);
  list.points = {one_point(Vec3f::Zero(), kBlue)};
  EXPECT_TRUE(bluish(pixel(render(list, front_camera()), kWidth / 2, kHeight / 2)));
}

// Its near end is smaller; if its faces were inverted, the box inside would be visible.
TEST_F(RendererTest, AFrustumHidesTheBoxInItFromAllSides) {
  const planes::Octree octree = test::image_octree();
  DrawList list = without_overlay();
  list.boxes = {cell_box(octree, octree.nodes[0])};
  list.boxes[0].color = kRed;
  list.boxes[0].style = BoxStyle::tinted;
  const Vec3f inside = middle_of(list.boxes[0]);
  for (const Vec3d& from : {Vec3d(-1, 0, 0), Vec3d(1, 0, 0), Vec3d(0.1, 1, 0), Vec3d(0.1, -1, 0),
                            Vec3d(0.1, 0, 1), Vec3d(0.1, 0, -1)}) {
    Camera camera;
    camera.target = inside.cast<double>();
    camera.eye = camera.target + 9 * from;
    camera.up = std::abs(from.z()) < 1 ? Vec3d::UnitZ() : Vec3d::UnitX();
    list.boxes.resize(1);
    const Image8 alone = render(list, camera);
    EXPECT_GT(differing(alone, render(without_overlay(), camera)), kWidth * kHeight / 50);
    list.boxes.push_back(box(inside, 0.4f, kBlue, BoxStyle::tinted));
    EXPECT_EQ(render(list, camera).data, alone.data) << from.transpose();
  }
}

TEST_F(RendererTest, PolygonIsFilledTranslucentlyAndOutlined) {
  DrawList list = without_overlay();
  const std::vector<Vec3f> corners = {
      {0, -0.2f, -0.2f}, {0, 0.2f, -0.2f}, {0, 0.2f, 0.2f}, {0, -0.2f, 0.2f}};
  list.polygons = {{corners, {220, 20, 20, 100}, kBlue, 3, 0}};
  const Image8 image = render(list, front_camera());
  const Rgba middle = pixel(image, kWidth / 2, kHeight / 2);
  EXPECT_GT(middle.r, middle.g + 40);
  EXPECT_GT(middle.g, 100);
  const int edge = static_cast<int>(std::lround(0.2 * kHeight / (2 * std::tan(22.5 * M_PI / 180))));
  EXPECT_TRUE(bluish(pixel(image, kWidth / 2 - edge, kHeight / 2)));
  EXPECT_TRUE(bluish(pixel(image, kWidth / 2, kHeight / 2 + edge)));
}

TEST_F(RendererTest, LineHasItsWidthAtAnyDistance) {
  const Image8 background = empty();
  for (const float x : {-0.5f, 0.0f, 3.0f}) {
    DrawList list = without_overlay();
    list.lines = {{{{x, -9, 0}, {x, 9, 0}}, {kRed}, 6}};
    const Image8 image = render(list, front_camera());
    double ink = 0;  // sum over full pixels
    for (int y = 0; y < kHeight; ++y) {
      const double paper = background.at(40, y, 1);
      ink += (paper - image.at(40, y, 1)) / (paper - kRed.g);
    }
    EXPECT_NEAR(ink, 6, 0.5) << x;
  }
}

TEST_F(RendererTest, LineThatPassesTheEyeIsClippedAtTheNearPlane) {
  DrawList list = without_overlay();
  list.lines = {{{{-3, 0, -0.3f}, {3, 0, 0.1f}}, {kRed}, 4}};  // starts behind the camera
  const Image8 image = render(list, front_camera());
  EXPECT_GT(differing(image, empty()), 50);
}

TEST_F(RendererTest, ArrowIsWiderAtItsHead) {
  DrawList list = without_overlay();
  list.arrows = {{{0, 0.4f, 0}, {0, -0.4f, 0}, kRed, 3}};  // left to right on screen
  const Image8 image = render(list, front_camera());
  const auto height_px = [&](int x) {
    int count = 0;
    for (int y = 0; y < kHeight; ++y) count += reddish(pixel(image, x, y));
    return count;
  };
  int widest = 0;
  for (int x = kWidth / 2; x < kWidth; ++x) widest = std::max(widest, height_px(x));
  EXPECT_NEAR(height_px(40), 3, 1);
  EXPECT_GE(widest, 7);
}

TEST_F(RendererTest, LabelStaysOnTopOfPoints) {
  DrawList list = without_overlay();
  list.points = {one_point({-0.3f, 0, 0}, {100, 100, 100}, 1)};
  list.points[0].max_px = 60;
  list.labels = {{Vec3f::Zero(), "HHH", kRed, 20}};
  const Image8 image = render(list, front_camera());
  int ink = 0;
  for (int x = 50; x < 110; ++x) ink += reddish(pixel(image, x, kHeight / 2));
  EXPECT_GT(ink, 5);
}

TEST_F(RendererTest, SamePictureTwiceHasTheSamePixels) {
  DrawList list;
  list.title = "Planes";
  list.legend = {{LegendEntry::Symbol::hatched_box, kRed, "hatched"}};
  list.points = {one_point({0.1f, 0, 0}, kRed)};
  list.boxes = {box(Vec3f::Zero(), 0.4f, kBlue, BoxStyle::hatched)};
  list.labels = {{Vec3f::Zero(), "label", kRed, 14}};
  const Image8 first = render(list, front_camera());
  render(without_overlay(), front_camera(), Theme::dark);
  renderer().render(list, front_camera(), 99, 77, Theme::dark);
  EXPECT_EQ(render(list, front_camera()).data, first.data);
  Renderer another;
  EXPECT_EQ(another.render(list, front_camera(), kWidth, kHeight, Theme::light).data, first.data);
}

TEST_F(RendererTest, OrthographicCameraShowsEqualLengthsEqual) {
  Camera camera = front_camera();
  camera.orthographic = true;
  camera.ortho_height_m = 1;
  for (const float x : {-0.5f, 2.0f}) {
    DrawList list = without_overlay();
    list.points = {one_point({x, 0, 0.25f}, kRed)};
    expect_near(pixel(render(list, camera), kWidth / 2, kHeight / 4), kRed);
  }
}

TEST_F(RendererTest, DegenerateInputIsDrawnWithoutAnError) {
  DrawList list = without_overlay();
  const float nan = std::nanf("");
  list.points = {one_point({nan, 0, 0}, kRed), DrawPoints{}};
  list.lines = {{{{0, 0, 0}, {0, 0, 0}}, {kRed}, 2}, DrawLines{}};
  list.polygons = {{{}, kRed, kRed, 2, 0}, {{{0, 0, 0}, {0, 1, 0}}, kRed, kRed, 2, 0}};
  list.boxes = {box(Vec3f(-1, 0, 0), 0.5f, kRed, BoxStyle::tinted)};  // around the eye
  list.arrows = {{{0, 0, 0}, {0, 0, 0}, kRed, 3}};
  list.labels = {{{-2, 0, 0}, "behind", kRed, 14}, {Vec3f::Zero(), "", kRed, 14}};
  Camera camera = front_camera();
  camera.up = Vec3d::UnitX();  // parallel to the view
  EXPECT_NO_THROW(render(list, camera));
  camera.eye = camera.target;
  EXPECT_NO_THROW(render(list, camera));
}

TEST_F(RendererTest, ImpossibleSizeIsRejected) {
  EXPECT_THROW(renderer().render({}, front_camera(), 0, 100, Theme::light), Error);
  EXPECT_THROW(renderer().render({}, front_camera(), 100, 1 << 20, Theme::light), Error);
  EXPECT_THROW(renderer().render_ids({}, front_camera(), -1, 100), Error);
  EXPECT_NO_THROW(renderer().render({}, front_camera(), 1, 1, Theme::light));
}

// ---- What changes ----

/// Points, boxes, a plane and labels side by side; `change` selects one that differs.
DrawList row_of_things(int change) {
  DrawList list;
  for (int i = 0; i < 6; ++i) {
    const Vec3f at(0, 0.5f - 0.2f * static_cast<float>(i), 0.1f);
    const Rgba color = change == i ? kRed : kBlue;
    list.points.push_back(one_point(at, color));
    list.boxes.push_back(box(at, 0.12f, color, BoxStyle::tinted));
    list.labels.push_back({at + Vec3f(0, 0, 0.2f), change == i ? "b" : "a", color});
  }
  list.legend.push_back({LegendEntry::Symbol::dot, kRed, "number " + std::to_string(change)});
  return list;
}

TEST_F(RendererTest, DrawsNothingIfThePictureIsUnchanged) {
  draw(row_of_things(0), front_camera());
  EXPECT_FALSE(renderer().changes().empty());
  draw(row_of_things(0), front_camera());
  draw(row_of_things(0), front_camera());
  EXPECT_TRUE(renderer().changes().empty());
}

TEST_F(RendererTest, PartsDrawnAgainMakeThePictureDrawnAsAWhole) {
  int fewer = 0;  // number of partial redraws; adjacent parts are merged
  for (int i = 0; i < 6; ++i) {
    draw(row_of_things(5 - i), front_camera());
    draw(row_of_things(5 - i), front_camera());
    const Image8 in_parts = draw(row_of_things(i), front_camera());
    std::int64_t drawn = 0;
    for (const Part& part : renderer().changes()) drawn += part.pixels();
    EXPECT_GT(drawn, 0);
    fewer += drawn < std::int64_t{kWidth} * kHeight;
    draw({}, Camera{});  // a different view redraws everything
    EXPECT_EQ(draw(row_of_things(i), front_camera()).data, in_parts.data) << i;
  }
  EXPECT_EQ(fewer, 4);
}

TEST_F(RendererTest, PointsThatAppearAndDisappearLeaveNoShadows) {
  const auto scene =
      [](int step) {  // large points that move across the tiles, in front of a wall of points
        DrawList list = without_overlay();
        for (int y = -6; y <= 6; ++y)
          for (int z = -5; z <= 5; ++z)
            list.points.push_back(one_point(
                {0.1f, 0.08f * static_cast<float>(y), 0.08f * static_cast<float>(z)}, kBlue));
        for (int i = 0; i <= step; ++i) {
          const float at = 0.13f * static_cast<float>(i);
          list.points.push_back(one_point({-0.1f, at - 0.3f, at - 0.3f}, kRed));
          list.points.push_back(one_point({-0.1f, at - 0.3f, -0.3f}, kRed));
        }
        return list;
      };
  for (int step = 0; step < 5; ++step) {
    draw(scene(step), front_camera());
    const Image8 in_parts = draw(scene((step + 2) % 5), front_camera());
    draw({}, Camera{});
    EXPECT_EQ(draw(scene((step + 2) % 5), front_camera()).data, in_parts.data) << step;
  }
}

// ---- Picking ----

struct Picking : GlTest {
  std::uint32_t middle(const DrawList& list) {
    return renderer().render_ids(list, front_camera(), kWidth, kHeight).at(kWidth / 2, kHeight / 2);
  }
};

DrawPoints cloud(float x, std::vector<std::uint32_t> ids) {
  DrawPoints points = one_point({x, 0, 0}, {255, 0, 0});
  points.ids = std::move(ids);
  return points;
}

const std::vector<Vec3f> kTriangle = {
    {-0.5f, -0.2f, -0.2f}, {-0.5f, 0.2f, -0.2f}, {-0.5f, 0, 0.3f}};

TEST_F(Picking, AllThirtyTwoBitsOfAnIdAreReturned) {
  DrawList list;
  EXPECT_EQ(middle(list), 0u);
  list.points = {cloud(0, {0xFEDCBA98u})};
  EXPECT_EQ(middle(list), 0xFEDCBA98u);
}

TEST_F(Picking, NearestObjectIsPicked) {
  DrawList list;
  list.points = {cloud(0.3f, {1}), cloud(0, {2})};
  EXPECT_EQ(middle(list), 2u);
  list.boxes = {box(Vec3f::Zero(), 0.5f, kRed, BoxStyle::tinted, 3)};
  EXPECT_EQ(middle(list), 3u);
  list.polygons = {{kTriangle, {}, {}, 1, 4}};
  EXPECT_EQ(middle(list), 4u);
}

TEST_F(Picking, PointsWithoutIdsHideObjectsBehindThem) {
  DrawList list;
  list.points = {cloud(0.3f, {1}), cloud(0, {})};
  EXPECT_EQ(middle(list), 0u);
}

TEST_F(Picking, BoxesAndPolygonsWithoutAnIdAreIgnored) {
  DrawList list;
  list.points = {cloud(0, {7})};
  list.boxes = {box(Vec3f::Zero(), 0.5f, kRed, BoxStyle::tinted)};
  list.polygons = {{kTriangle, {}, {}, 1, 0}};
  EXPECT_EQ(middle(list), 7u);
}

TEST_F(Picking, OpenBoxIsPickedByItsEdgesOnly) {
  DrawList list;
  list.boxes = {box(Vec3f::Zero(), 0.5f, kRed, BoxStyle::outline, 9)};
  const auto ids = renderer().render_ids(list, front_camera(), kWidth, kHeight);
  EXPECT_EQ(ids.at(kWidth / 2, kHeight / 2), 0u);
  EXPECT_GT(std::count(ids.data.begin(), ids.data.end(), 9u), 500);
}

TEST_F(Picking, IdsMatchThePicture) {
  DrawList list = without_overlay();
  list.points = {cloud(0, {5})};
  list.points[0].positions[0] = {0, 0.2f, 0.3f};
  const Image8 image = render(list, front_camera());
  const auto ids = renderer().render_ids(list, front_camera(), kWidth, kHeight);
  int both = 0;
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const bool red = pixel(image, x, y).r > pixel(image, x, y).g + 170;
      both += red && ids.at(x, y) == 5;
      if (red) {
        EXPECT_EQ(ids.at(x, y), 5u) << x << " " << y;
      }
    }
  }
  EXPECT_GT(both, 100);
}

}  // namespace

}  // namespace planescope::render
