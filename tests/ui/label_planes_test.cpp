// The planes of the label mode: actions, the panel, and labels that go on to the next frame.

#include "core/model/error.hpp"
#include "label_desktop.hpp"

namespace planescope::desktop {
namespace {

struct LabelPlanes : LabelDesktop {
  void SetUp() override { window.run("label.take"); }
  std::size_t pixels_of(int plane) const { return labels::pixels_of_plane(labels(), plane).size(); }
};

TEST_F(LabelPlanes, StartFromTheAlgorithmInOneUndoStep) {
  const planes::Segmentation& found = state().run()->segmentation;
  ASSERT_GE(found.planes.size(), 3u);
  EXPECT_EQ(labels().planes.size(), found.planes.size());
  for (const LabelPlane& plane : labels().planes) {
    EXPECT_EQ(plane.origin, LabelOrigin::algorithm);
    EXPECT_EQ(plane.label, found.planes[static_cast<std::size_t>(plane.id - 1)].label);
  }
  EXPECT_EQ(window.store().history(1).front().title, "Start from the algorithm (refined)");
  window.run("label.undo");
  EXPECT_TRUE(labels().planes.empty());
}

TEST_F(LabelPlanes, LockedAndHiddenOnesStayWhenTheAlgorithmIsAskedAgain) {
  window.run("label.class.v", "1");
  window.run("label.lock", "1");
  window.run("label.take");
  EXPECT_EQ(labels::find_plane(labels(), 1)->label, Label::v);
}

TEST_F(LabelPlanes, TakeTheirClassFromAKeyAndGiveItBackOnUndo) {
  const Label before = labels::find_plane(labels(), 1)->label;
  window.run("label.class.v", "1");
  EXPECT_EQ(labels::find_plane(labels(), 1)->label, Label::v);
  EXPECT_EQ(state().view.message, "Make P1 v");
  window.run("label.undo");
  EXPECT_EQ(labels::find_plane(labels(), 1)->label, before);
}

TEST_F(LabelPlanes, JoinAndSplitKeepEveryPixel) {
  const auto labelled = [&] {
    return std::ranges::count_if(labels().plane.data, [](std::uint16_t id) { return id > 0; });
  };
  const auto before = labelled();
  const std::size_t one = pixels_of(1), two = pixels_of(2);
  choose(1);
  window.run("label.join", "P2");
  EXPECT_EQ(pixels_of(1), one + two);
  EXPECT_EQ(labels::find_plane(labels(), 2), nullptr);
  EXPECT_EQ(window.store().history(1).front().title, "Join P2 into P1");
  window.run("label.split");
  EXPECT_EQ(labelled(), before);
}

TEST_F(LabelPlanes, JoinTheOneUnderTheMouse) {
  const labels::PixelSet pixels = labels::pixels_of_plane(labels(), 2);
  const auto width = static_cast<std::uint32_t>(labels().plane.width);
  const auto pixel = std::to_string(pixels[0] % width) + "," + std::to_string(pixels[0] / width);
  choose(1);
  window.shell.perform({"label.hover", pixel}, true);
  window.run("label.join");
  EXPECT_EQ(labels::find_plane(labels(), 2), nullptr);
  EXPECT_NE(window.refusal("label.join").find("under the mouse"), std::string::npos);
}

TEST_F(LabelPlanes, ThatAreLockedRefuseInOneLine) {
  window.run("label.lock", "2");
  const std::uint64_t version = window.store().version(0);
  EXPECT_NE(window.refusal("label.remove", "2").find("P2 is locked"), std::string::npos);
  EXPECT_EQ(window.store().version(0), version);
  EXPECT_NE(window.refusal("label.lock", "77").find("no plane P77"), std::string::npos);
}

TEST_F(LabelPlanes, ThatAreHiddenAreCountedUntilAllAreShown) {
  EXPECT_FALSE(window.shows("planes.hidden"));
  window.run("label.hide", "1");
  EXPECT_TRUE(window.shows("planes.hidden"));
  EXPECT_TRUE(labels::find_plane(labels(), 1)->hidden);
  EXPECT_GT(pixels_of(1), 0u);
  window.run("label.show_all");
  EXPECT_FALSE(window.shows("planes.hidden"));
}

TEST_F(LabelPlanes, AreChosenLockedAndLookedAtInTheList) {
  play(R"({"click": "planes.2"})");
  EXPECT_EQ(state().view.label.plane, 2);
  play(R"({"click": "planes.2.lock"}, {"click": "planes.3.hide"})");
  EXPECT_TRUE(labels::find_plane(labels(), 2)->locked);
  EXPECT_TRUE(labels::find_plane(labels(), 3)->hidden);
  ASSERT_FALSE(state().view.camera.has_value());
  play(R"({"click": "planes.1", "double": true})");
  EXPECT_EQ(state().view.label.plane, 1);
  EXPECT_TRUE(state().view.camera.has_value());
}

TEST_F(LabelPlanes, WithoutOneTheKeyIsForWhatIsPaintedNext) {
  choose(0);
  window.run("label.class.h");
  EXPECT_EQ(state().view.label.paints, Paints::h_only);
  window.run("label.class.h");
  EXPECT_EQ(state().view.label.paints, Paints::plane);
}

/// Frames of the sample show different scenes; here the camera stands still.
struct CarriedPlanes : testing::Test {
  const std::filesystem::path dir = scratch_dir();
  std::filesystem::path still() const {
    namespace fs = std::filesystem;
    fs::copy(sample_path(), dir / "still", fs::copy_options::recursive);
    for (const char* folder : {"depth", "color"})
      fs::copy(dir / "still" / folder / "000000.png", dir / "still" / folder / "000001.png",
               fs::copy_options::overwrite_existing);
    return dir / "still";
  }
  LabelWindow window{dir / "labels", still()};
  const State& state() const { return window.state(); }

  void SetUp() override { window.run("label.take"); }
};

TEST_F(CarriedPlanes, GoOnToTheNextFrameAsOneGesture) {
  const std::size_t planes = window.labels().planes.size();
  window.run("label.carry");
  EXPECT_EQ(state().document.frame, 1);
  EXPECT_EQ(window.labels().planes.size(), planes);
  for (const LabelPlane& plane : window.labels().planes) {
    EXPECT_EQ(plane.origin, LabelOrigin::carried);
    EXPECT_GT(plane.confidence, 0.5);
  }
  ASSERT_NE(state().results.label.carry.done, nullptr);
  EXPECT_TRUE(window.shows("planes.doubt"));
  window.run("label.cancel");
  EXPECT_EQ(state().results.label.carry.done, nullptr);
  window.run("label.undo");
  EXPECT_TRUE(window.labels().planes.empty());
}

TEST_F(CarriedPlanes, StayWhereTheyAreOnceItIsCancelled) {
  window.shell.perform({"label.carry", ""}, true);
  window.run("label.cancel");
  EXPECT_EQ(state().document.frame, 1);
  EXPECT_TRUE(window.labels().planes.empty());
}

TEST_F(CarriedPlanes, AreRefusedWhereTheNextFrameShowsSomethingElse) {
  window.run("label.carry");
  EXPECT_NE(window.refusal("label.carry").find("points have a partner"), std::string::npos);
  EXPECT_EQ(state().document.frame, 2);
  EXPECT_TRUE(window.labels().planes.empty());
  window.run("label.take");
  EXPECT_NE(window.refusal("label.carry").find("last"), std::string::npos);
}

}  // namespace
}  // namespace planescope::desktop
