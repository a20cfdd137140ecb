#include <algorithm>

#include "gl_fixture.hpp"

namespace planescope::render {
namespace {

struct Picking : GlTest {
  std::uint32_t middle(const DrawList& list) {
    return renderer().render_ids(list, front_camera(), kWidth, kHeight).at(kWidth / 2, kHeight / 2);
  }
};

DrawPoints cloud(float x, std::vector<std::uint32_t> ids) {
  DrawPoints points;
  points.positions = {{x, 0, 0}};
  points.colors = {{255, 0, 0}};
  points.ids = std::move(ids);
  points.size_m = 0.1f;
  return points;
}

DrawBox box(float x, float edge, std::uint32_t id, BoxStyle style = BoxStyle::tinted) {
  const Vec3f half = Vec3f::Constant(edge / 2);
  return {Vec3f(x, 0, 0) - half, Vec3f(x, 0, 0) + half, {255, 0, 0}, style, id};
}

TEST_F(Picking, NothingIsZero) { EXPECT_EQ(middle({}), 0u); }

TEST_F(Picking, AllThirtyTwoBitsOfAnIdComeBack) {
  DrawList list;
  list.points = {cloud(0, {0xFEDCBA98u})};
  EXPECT_EQ(middle(list), 0xFEDCBA98u);
}

TEST_F(Picking, NearestThingIsPicked) {
  DrawList list;
  list.points = {cloud(0.3f, {1}), cloud(0, {2})};
  EXPECT_EQ(middle(list), 2u);
  list.boxes = {box(0, 0.5f, 3)};
  EXPECT_EQ(middle(list), 3u);
  list.polygons = {{{{-0.5f, -0.2f, -0.2f}, {-0.5f, 0.2f, -0.2f}, {-0.5f, 0, 0.3f}}, {}, {}, 1, 4}};
  EXPECT_EQ(middle(list), 4u);
}

TEST_F(Picking, PointsWithoutIdsHideWhatLiesBehindThem) {
  DrawList list;
  list.points = {cloud(0.3f, {1}), cloud(0, {})};
  EXPECT_EQ(middle(list), 0u);
}

TEST_F(Picking, BoxesAndPolygonsWithoutAnIdAreLookedThrough) {
  DrawList list;
  list.points = {cloud(0, {7})};
  list.boxes = {box(0, 0.5f, 0)};
  list.polygons = {{{{-0.5f, -0.2f, -0.2f}, {-0.5f, 0.2f, -0.2f}, {-0.5f, 0, 0.3f}}, {}, {}, 1, 0}};
  EXPECT_EQ(middle(list), 7u);
}

TEST_F(Picking, OpenBoxIsPickedByItsEdgesOnly) {
  DrawList list;
  list.boxes = {box(0, 0.5f, 9, BoxStyle::outline)};
  const auto ids = renderer().render_ids(list, front_camera(), kWidth, kHeight);
  EXPECT_EQ(ids.at(kWidth / 2, kHeight / 2), 0u);
  EXPECT_GT(std::count(ids.data.begin(), ids.data.end(), 9u), 500);
}

TEST_F(Picking, IdsLieWhereThePictureShowsTheThing) {
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
