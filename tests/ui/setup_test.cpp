// Missing camera data of a recording, assumptions about it, and keyboard use without a mouse.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/desktop/panels.hpp"
#include "core/io/folder/folder_files.hpp"
#include "core/model/error.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;

/// A scratch folder with the sample's first frame, without intrinsics.
struct Folder {
  fs::path dir = scratch_dir(), path = dir / "walk";
  fs::path beside = dir / "walk.planescope.json";
  Folder() {
    fs::create_directories(path / "depth");
    fs::copy(sample_path() / "depth/000000.png", path / "depth");
  }
};

State opened(const Folder& folder) {
  State state;
  state.document.options.classifier = "pca";
  apply(state, {"recording.open", folder.path.string()});
  return state;
}

struct UnknownCamera : testing::Test, Folder, Desk {
  UnknownCamera() : Desk(opened(*this)) {}
  void SetUp() override { rest(); }
  void play(const std::string& actions) { play_actions(shell, stage, dir, actions); }
  io::RecordingInfo info() const { return state().document.current()->recording->info(); }
};

TEST_F(UnknownCamera, IsRequestedAndTheFrameRunsOnceItIsKnown) {
  EXPECT_FALSE(state().run());
  EXPECT_TRUE(shown("setup.fx"));
  EXPECT_EQ(state().results.strip.at(0).refusal, "") << "the strip shows the picture";
  play(R"({"click": "setup.choice.0"}, {"frames": 2}, {"click": "setup.apply"})");
  ASSERT_TRUE(state().run()) << state().results.refusal << state().view.message;
  EXPECT_EQ(state().run()->subject->frame.intrinsics.fx, 384);
  EXPECT_FALSE(shown("setup.fx"));
  EXPECT_GT(state().run()->segmentation.planes.size(), 0u);
  EXPECT_FALSE(fs::exists(beside)) << "nobody asked to remember them";
}

TEST_F(UnknownCamera, IsRememberedBesideTheRecordingForEveryCommand) {
  play(R"({"click": "setup.choice.1"}, {"frames": 2}, {"click": "setup.remember"},
          {"click": "setup.apply"})");
  ASSERT_TRUE(state().run());
  EXPECT_EQ(std::distance(fs::directory_iterator(path), fs::directory_iterator()), 1)
      << "nothing is written into the recording";
  const auto again = io::open_recording(path);
  EXPECT_EQ(again->info().intrinsics.fx, 615);
  EXPECT_EQ(again->info().intrinsics_source, "walk.planescope.json");
}

TEST_F(UnknownCamera, ValidNumbersAreAcceptedAndInvalidOnesRejected) {
  play(R"({"click": "setup.fx"}, {"type": "400"}, {"click": "setup.fy"}, {"type": "four"})");
  EXPECT_FALSE(state().run());
  play(R"({"click": "setup.apply"})");
  EXPECT_FALSE(state().run()) << "the button waits for four numbers";
  EXPECT_TRUE(shown("setup.wrong"));
  EXPECT_THROW(shell.perform({"intrinsics.set", "400,400,3000,240"}, true), Error)
      << "far outside the image";
  EXPECT_THROW(shell.perform({"intrinsics.set", "400,400,320"}, true), Error);
  EXPECT_THROW(shell.perform({"intrinsics.set", "0,400,320,240"}, true), Error);
  run("intrinsics.set", "400,400,320,240 0.002");
  ASSERT_TRUE(state().run());
  EXPECT_EQ(info().depth_unit_m, 0.002);
}

TEST_F(UnknownCamera, ASelectedCameraSetsItsDepthUnitAndIsShownAsNominal) {
  const auto choices = io::camera_choices(info());
  const auto tum = std::ranges::find(choices, "TUM RGB-D", &io::CameraChoice::name);
  ASSERT_NE(tum, choices.end());
  play(fmt::format(R"({{"click": "setup.choice.{}"}}, {{"frames": 2}}, {{"click": "setup.apply"}})",
                   tum - choices.begin()));
  ASSERT_TRUE(state().run()) << state().view.message;
  EXPECT_EQ(info().depth_unit_m, 0.0002);
  const auto all = assumptions_of(state());
  EXPECT_TRUE(std::ranges::any_of(
      all, [](const Assumption& one) { return one.text.starts_with("Intrinsics nominal ("); }));
}

TEST_F(UnknownCamera, AWarningAboutTheRecordingIsInTheBanner) {
  run("intrinsics.set", "400,600,320,240");
  const auto all = assumptions_of(state());
  ASSERT_FALSE(all.empty());
  EXPECT_TRUE(all[0].text.starts_with("intrinsics from option --intrinsics: fx 400 and fy 600"));
  EXPECT_TRUE(has(all[0].why, "depth cameras have square pixels"));
  EXPECT_EQ(all[0].command.action, "intrinsics.edit");
}

TEST_F(UnknownCamera, MapsAreRejectedInOneLine) {
  EXPECT_THROW(shell.perform({"map.make", ""}, true), Error);
}

TEST(CameraFile, KeepsOtherFieldsAndIsNotReplacedIfDamaged) {
  const Folder folder;
  std::ofstream(folder.beside) << R"({"gravity": [0, 1, 0], "note": "mine"})";
  io::RecordingOptions options;
  options.intrinsics = {{400, 401, 320, 240}};
  const io::RecordingInfo info = io::open_recording(folder.path, options)->info();
  io::remember_camera(info);
  const auto again = io::open_recording(folder.path);
  EXPECT_EQ(again->info().intrinsics.fy, 401);
  EXPECT_TRUE(again->frame(0).gravity);
  const auto json = nlohmann::json::parse(std::ifstream(folder.beside));
  EXPECT_EQ(json.at("note"), "mine");
  std::ofstream(folder.beside) << "{";
  EXPECT_THROW(io::remember_camera(info), Error);
  EXPECT_EQ(fs::file_size(folder.beside), 1u);
}

TEST(CameraFile, BesideAFolderOverridesTheOneInside) {
  const Folder folder;
  std::ofstream(folder.path / "planescope.json")
      << R"({"intrinsics": {"fx": 300, "fy": 300, "cx": 320, "cy": 240}, "gravity": [0, 1, 0]})";
  std::ofstream(folder.beside) << R"({"intrinsics": {"fx": 500, "fy": 500, "cx": 320, "cy": 240}})";
  const auto recording = io::open_recording(folder.path);
  EXPECT_EQ(recording->info().intrinsics.fx, 500);
  EXPECT_EQ(recording->info().intrinsics_source, "walk.planescope.json");
  EXPECT_TRUE(recording->frame(0).gravity) << "from the one inside";
}

TEST(CameraChoices, AreNearbyFilesThenCamerasOfItsSize) {
  const Folder folder;
  fs::create_directories(folder.dir / "calibration");
  fs::create_directories(folder.dir / "other_walk");
  std::ofstream(folder.dir / "calibration/depth.txt") << "411 412 320 240\n";
  std::ofstream(folder.dir / "other_walk/intrinsics.txt") << "511 512 320 240\n";
  io::RecordingOptions options;
  options.intrinsics_may_lack = true;
  const auto choices = io::camera_choices(io::open_recording(folder.path, options)->info());
  ASSERT_GE(choices.size(), 2u);
  EXPECT_TRUE(choices[0].from_file);
  EXPECT_EQ(choices[0].name, "calibration/depth.txt");
  EXPECT_EQ(choices[0].intrinsics.fx, 411);
  for (const io::CameraChoice& choice : choices) {
    EXPECT_NE(choice.intrinsics.fx, 511) << "another recording's";
    EXPECT_EQ(choice.intrinsics.width, 640);
  }
}

// ---- Assumptions -------------------------------------------------------------------------------

struct Assumptions : OpenDesktop {
  const Assumption* with_action(const std::string& action) {
    all_ = assumptions_of(state());
    for (const Assumption& one : all_)
      if (one.command.action == action) return &one;
    return nullptr;
  }
  std::vector<Assumption> all_;
};

TEST_F(Assumptions, AShortRangeIsReportedAndOneClickExtendsIt) {
  play(R"("option.set max_range_m=0.7")");
  const Assumption* range = with_action("option.set");
  ASSERT_TRUE(range);
  EXPECT_TRUE(has(range->text, "beyond 0.7 m"));
  ASSERT_TRUE(shown("assumption.0"));
  play(R"({"click": "assumption.0"})");
  EXPECT_EQ(state().document.options.cloud.max_range_m, 4);
  EXPECT_FALSE(with_action("option.set")) << "nothing is beyond 4 m";
}

TEST_F(Assumptions, VoxelsLargerThanTheSceneAreNamedAndOneClickMakesThemSmall) {
  play(R"("option.set voxel_size_m=10")");
  const auto all = assumptions_of(state());
  const auto voxels = std::ranges::find(all, "use 20 mm", &Assumption::button);
  ASSERT_NE(voxels, all.end());
  EXPECT_TRUE(voxels->text.starts_with("10 m voxels are larger than the scene"));
  shell.perform(voxels->command, true);
  EXPECT_EQ(state().document.options.cloud.voxel_size_m, 0.02);
}

TEST_F(Assumptions, TheyDoNotReturnOnceDismissed) {
  play(R"("option.set max_range_m=0.7", {"click": "assumption.hide"}, {"frames": 2})");
  EXPECT_TRUE(assumptions_of(state()).empty());
  EXPECT_FALSE(shown("panel.assumptions"));
}

// ---- Keyboard ----------------------------------------------------------------------------------

TEST_F(OpenDesktop, TabFocusesPanelsAndEscapeReturnsToStepping) {
  play(R"("step.first", {"key": "Tab"}, {"frames": 2})");
  EXPECT_EQ(state().view.keyboard, "frames");
  play(R"({"key": "Right"}, {"key": "Right"})");
  EXPECT_EQ(state().view.step, 0) << "arrows move among widgets";
  play(R"({"key": "Shift+Tab"}, {"key": "Shift+Tab"})");
  EXPECT_EQ(state().view.keyboard, "tools");
  play(R"({"key": "Escape"}, {"key": "Right"})");
  EXPECT_EQ(state().view.keyboard, "");
  EXPECT_EQ(state().view.step, 1);
}

TEST_F(OpenDesktop, AButtonCanBePressedWithTheKeyboard) {
  play(R"("step.first", {"key": "Tab"}, {"key": "Tab"}, {"key": "Tab"}, {"key": "Tab"},
          {"frames": 3})");
  ASSERT_EQ(state().view.keyboard, "timeline");
  // The first key shows the keyboard focus; the buttons are first, previous, play, next, last.
  play(
      R"({"key": "Right"}, {"frames": 2}, {"key": "Right"}, {"frames": 2}, {"key": "Right"}, {"frames": 2}, {"key": "Right"},
          {"frames": 2}, {"key": "Space"}, {"frames": 2})");
  EXPECT_EQ(state().view.step, 1);
}

TEST_F(OpenDesktop, F10OpensTheMenu) {
  play(R"({"key": "F10"}, {"frames": 3})");
  EXPECT_TRUE(shown("menu.recording.open"));
}

}  // namespace
}  // namespace planescope::desktop
