// Measuring by clicking in the views.

#include <fmt/format.h>

#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

/// The sample's stairs.
struct Measuring : RefinedDesktop {
  const std::vector<debug::MeasureEnd>& ends() const { return state().view.measured; }
  std::string fact(const char* name) const { return state_facts(state(), true).at(name); }
  /// A pixel of a level plane of the result, lowest first.
  std::string pixel_of_level(int which) const {
    const debug::Run& run = *state().run();
    std::vector<const planes::PlaneRegion*> level;
    for (const planes::PlaneRegion& plane : run.segmentation.planes)
      if (plane.label == Label::h) level.push_back(&plane);
    std::ranges::sort(level, {}, [](const auto* plane) { return plane->fit.centroid.z(); });
    const Image16& depth = run.subject->frame.depth;
    for (int v = 0; v < depth.height; v += 4)
      for (int u = 0; u < depth.width; u += 4) {
        const std::size_t pixel = static_cast<std::size_t>(v) * depth.width + u;
        const std::uint32_t point = run.subject->point_of_source[pixel];
        if (point == planes::kNoVoxel) continue;
        const Vec3d at = run.subject->prepared.cloud.points[point].cast<double>();
        const PlaneFit& fit = level.at(which)->fit;
        if (run.plane_of[point] == level.at(which)->id && (at - fit.centroid).norm() < 0.05)
          return fmt::format("{},{}", u, v);
      }
    ADD_FAILURE() << "no such pixel";
    return "0,0";
  }
  void click(const std::string& pixel) { play(click_on(pixel)); }
};

TEST_F(Measuring, TwoClicksOnPointsMeasureTheirDistance) {
  const std::string low = pixel_of_level(0), high = pixel_of_level(1);
  play(R"({"key": "U"}, {"expect": {"click": "point"}})");
  EXPECT_TRUE(shown("measure.line"));
  click(low);
  ASSERT_EQ(ends().size(), 1u);
  EXPECT_EQ(fact("measured"), "");
  click(high);
  ASSERT_EQ(ends().size(), 2u);
  EXPECT_EQ(state().view.message, fact("measured"));
  EXPECT_TRUE(has(fact("measured"), "up"));
  EXPECT_EQ(state().view.selected.source, -1) << "measuring selects nothing";
  click(low);
  EXPECT_EQ(ends().size(), 1u) << "a third begins anew";
  play(R"({"key": "Escape"}, {"expect": {"click": "", "measured": ""}})");
  EXPECT_TRUE(ends().empty());
  click(low);
  EXPECT_GE(state().view.selected.source, 0) << "clicks select again";
}

TEST_F(Measuring, TheDistanceOfTreadsIsTheRiseOfTheFlight) {
  play(R"({"key": "Shift+U"}, {"expect": {"click": "plane"}})");
  click(pixel_of_level(1));
  click(pixel_of_level(2));
  ASSERT_EQ(ends().size(), 2u) << state().view.message;
  const debug::Measurement measured = debug::measure(*state().run()->subject, ends()[0], ends()[1]);
  const planes::Flight& flight = state().planes()->found.stairs.flights.at(0);
  EXPECT_NEAR(measured.height_m.value(), flight.rise_m, 0.005) << measured.text;
  EXPECT_LT(measured.angle_deg.value(), 2);
  EXPECT_TRUE(has(measured.text, " above P"));
}

TEST_F(Measuring, MeasuresFromAPlaneByNumberToAPoint) {
  play(R"({"do": "measure.end", "with": "plane 1"}, {"do": "measure.end", "with": "voxel 5"})");
  ASSERT_EQ(ends().size(), 2u) << state().view.message;
  EXPECT_TRUE(has(fact("measured"), " P1: "));
  play(R"("select.none", {"expect": {"measured": ""}})");
}

TEST_F(Measuring, SurvivesOptionsAndEndsWithTheFrame) {
  play(R"({"do": "measure.end", "with": "voxel 5"}, {"do": "measure.end", "with": "voxel 900"})");
  const std::string before = fact("measured");
  play(
      R"({"do": "option.set", "with": "merge_cost=8"}, {"do": "option.set", "with": "profile=paper"})");
  EXPECT_EQ(fact("measured"), before);
  play(R"({"key": "U"}, "frame.next", {"expect": {"measured": "", "click": ""}})");
}

TEST_F(Measuring, InvalidPositionsAreReportedInOneLineAndChangeNothing) {
  play(R"({"do": "measure.end", "with": "voxel 5"})");
  for (const char* bad : {"nothing", "9999,3", "plane 999999", "voxel -1", "here"}) {
    play(fmt::format(R"({{"do": "measure.end", "with": "{}"}})", bad));
    EXPECT_TRUE(state().view.message.starts_with("nothing to measure: ")) << state().view.message;
    EXPECT_TRUE(state().view.message_is_error);
    EXPECT_EQ(ends().size(), 1u);
  }
}

TEST_F(Measuring, APlaneHasNoDistanceToItself) {
  const std::string pixel = pixel_of_level(0);
  play("\"measure.planes\"");
  click(pixel);
  click(pixel);
  EXPECT_TRUE(state().view.message.ends_with(" was already clicked")) << state().view.message;
  EXPECT_EQ(ends().size(), 1u);
}

TEST_F(Measuring, OtherClickModesReplaceIt) {
  play(
      R"({"key": "U"}, {"key": "M"}, {"expect": {"click": ""}}, {"key": "U"}, {"expect": {"click": "point"}})");
  EXPECT_FALSE(state().view.marking);
  play(
      R"({"key": "Shift+G"}, {"expect": {"click": "floor"}}, {"key": "U"}, "label.mode", {"expect": {"click": ""}})");
}

}  // namespace
}  // namespace planescope::desktop
