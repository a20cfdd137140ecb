// Gravity that nobody knows, and clicks on floors and walls that say where things fall.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/base/error.hpp"
#include "core/recording/cloud_file.hpp"
#include "label_desktop.hpp"

namespace planescope::desktop {
namespace {

double angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::min(1.0, a.normalized().dot(b.normalized()))) * 180 / std::numbers::pi;
}

/// The sample, whose estimate is refused as no tilt of the camera is allowed.
State without_gravity(const std::filesystem::path& label_dir) {
  State state = open_state_with_labels(label_dir);
  state.document.options.gravity.max_tilt_deg = 0;
  return state;
}

struct GravityClicks : testing::Test {
  const std::filesystem::path dir = scratch_dir(), label_dir = dir / "labels";
  const std::filesystem::path file = label_dir / "gravity.json";
  Shell shell{without_gravity(label_dir), nullptr, [] {}};
  NoStage stage{shell};
  // What the sample's makers know.
  const Vec3d down = read_frame_labels(default_label_dir(sample_path()), 0, "")->gravity.direction;

  void SetUp() override { settle(shell, stage, {}); }
  const State& state() const { return shell.state(); }
  const Gravity& gravity() const { return state().run()->subject->prepared.gravity; }
  const std::string& message() const { return state().view.message; }
  void run(const std::string& action, const std::string& argument = {}) {
    shell.perform({action, argument}, true);
    settle(shell, stage, {});
  }
  void play(const std::string& actions) {
    const std::filesystem::path path = dir / "script.json";
    std::ofstream(path) << R"({"actions": [)" << actions << "]}";
    Script::read(path).play(shell, stage, {});
  }
  bool shows(const std::string& widget) const { return shell.widgets().contains(widget); }
  /// A pixel in the middle of the largest labelled plane of that class.
  std::string pixel_of(Label label, std::size_t nth = 0) const {
    const auto truth = read_frame_labels(default_label_dir(sample_path()), 0, "");
    std::vector<std::pair<std::size_t, int>> sizes;
    for (const LabelPlane& plane : truth->planes)
      if (plane.label == label)
        sizes.push_back({pixels_of_plane(*truth, plane.id).size(), plane.id});
    std::ranges::sort(sizes, std::greater{});
    const PixelSet pixels = pixels_of_plane(*truth, sizes.at(nth).second);
    const auto width = static_cast<std::uint32_t>(truth->plane.width);
    Vec2d middle = Vec2d::Zero();
    for (const std::uint32_t p : pixels) middle += Vec2d(p % width, p / width) / pixels.size();
    const auto nearest = std::ranges::min_element(pixels, {}, [&](std::uint32_t p) {
      return (Vec2d(p % width, p / width) - middle).squaredNorm();
    });
    return std::to_string(*nearest % width) + "," + std::to_string(*nearest / width);
  }
};

TEST_F(GravityClicks, AFrameWithoutGravityShowsItsPlanesAndWhatToClick) {
  ASSERT_TRUE(state().run()) << state().results.refusal;
  EXPECT_EQ(state().results.refusal, "");
  EXPECT_FALSE(gravity().known());
  EXPECT_GE(state().run()->segmentation.planes.size(), 3u);
  EXPECT_TRUE(shows("image")) << "to be clicked";
  EXPECT_TRUE(shows("gravity.line"));
  EXPECT_TRUE(shows("button.gravity.click.floor"));
  for (const Thumbnail& thumbnail : state().results.strip) {
    EXPECT_EQ(thumbnail.refusal, "");
    EXPECT_GT(thumbnail.planes, 0);
  }
  for (const char* by : {"color.labels", "color.margins", "color.cases"}) run(by);
}

TEST_F(GravityClicks, OneClickOnAFloorTellsIt) {
  run("camera.orbit", "20,5");
  play(R"({"click": "button.gravity.click.floor"}, {"expect": {"gravity_click": "floor"}})");
  // The street at the bottom of the image.
  const std::string floor = pixel_of(Label::h);
  const auto comma = floor.find(',');
  const double u = std::stod(floor.substr(0, comma)) / 640,
               v = std::stod(floor.substr(comma + 1)) / 480;
  play(fmt::format(R"({{"click": "image", "at": [{}, {}]}})", u, v));
  EXPECT_EQ(gravity().source, GravitySource::picked) << message();
  EXPECT_LT(angle_deg(gravity().direction, down), 1.5);
  EXPECT_EQ(state().view.gravity_click, GravityClick::none) << "one click";
  EXPECT_FALSE(shows("gravity.line"));
  EXPECT_FALSE(state().view.camera) << "it stood in another world";
  EXPECT_EQ(state().view.step, state().run()->steps());
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_NE(message().find("for this frame"), std::string::npos) << message();
  EXPECT_FALSE(state().view.message_is_error);
  run("frame.next");
  EXPECT_FALSE(gravity().known()) << "of that frame alone";
}

TEST_F(GravityClicks, ForAllFramesItHoldsOnTheNextAndAfterARestart) {
  run("gravity.all_frames");
  run("gravity.floor", pixel_of(Label::h));
  const Vec3d picked = gravity().direction;
  run("frame.next");
  EXPECT_EQ(gravity().source, GravitySource::picked);
  EXPECT_EQ(gravity().direction, picked);
  const auto recording = open_recording(sample_path());
  EXPECT_EQ(read_picked_gravity(label_dir, *recording).recording->direction, picked);

  Shell again{without_gravity(dir / "none"), nullptr, [] {}};
  NoStage there{again};
  settle(again, there, {});
  EXPECT_FALSE(again.state().run()->subject->prepared.gravity.known());
  State state = without_gravity(label_dir);
  read_picked(state, state.document.recordings[0]);
  EXPECT_EQ(state.document.recordings[0].picked.recording->direction, picked);
}

TEST_F(GravityClicks, OneWallTurnsItAndTwoTellIt) {
  run("gravity.wall", pixel_of(Label::v));
  ASSERT_EQ(gravity().source, GravitySource::picked) << message();
  const Vec3d normal = state().document.current()->picked.frames.at(0).walls[0];
  EXPECT_NEAR(normal.dot(gravity().direction), 0, 1e-6);
  EXPECT_NE(message().find("one wall"), std::string::npos) << message();
  // The same wall again says nothing more.
  const Vec3d before = gravity().direction;
  run("gravity.wall", pixel_of(Label::v));
  EXPECT_TRUE(state().view.message_is_error);
  EXPECT_NE(message().find("parallel"), std::string::npos) << message();
  EXPECT_EQ(gravity().direction, before);
}

TEST_F(GravityClicks, UndoAndRedoGoThroughThemAndForgettingIsAStepToo) {
  run("gravity.floor", pixel_of(Label::h));
  const Vec3d picked = gravity().direction;
  run("gravity.forget");
  EXPECT_FALSE(gravity().known());
  EXPECT_FALSE(std::filesystem::exists(file));
  run("option.undo");
  EXPECT_EQ(gravity().direction, picked);
  EXPECT_TRUE(std::filesystem::exists(file));
  run("option.undo");
  EXPECT_FALSE(gravity().known());
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_TRUE(state().undo.empty());
  run("option.redo");
  EXPECT_EQ(gravity().direction, picked);
  EXPECT_TRUE(std::filesystem::exists(file));
}

TEST_F(GravityClicks, BadOnesSaySoInOneLineAndChangeNothing) {
  run("gravity.click.floor");
  for (const char* argument : {"0,0", "9999,3", "-1,3", "a,b", "3", "", "voxel 99999999", "voxel x",
                               "plane 0", "plane 9999", "nothing"}) {
    run("gravity.floor", argument);
    EXPECT_TRUE(state().view.message_is_error) << argument;
    EXPECT_TRUE(message().starts_with("gravity is as it was: ")) << message();
    EXPECT_EQ(message().find('\n'), std::string::npos) << message();
    EXPECT_FALSE(gravity().known()) << argument;
  }
  EXPECT_TRUE(state().undo.empty());
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(state().view.gravity_click, GravityClick::floor) << "the next click may be better";
  run("select.none");
  EXPECT_EQ(state().view.gravity_click, GravityClick::none);
}

TEST_F(GravityClicks, AFloorIsNoWall) {
  run("gravity.floor", pixel_of(Label::h));
  run("gravity.wall", pixel_of(Label::h));
  EXPECT_TRUE(state().view.message_is_error);
  EXPECT_NE(message().find("is it a floor?"), std::string::npos) << message();
}

TEST_F(GravityClicks, WinOverTheOptionAndGiveItBackOnUndo) {
  run("option.set", "gravity=1,0,0");
  ASSERT_EQ(gravity().source, GravitySource::option);
  run("gravity.floor", pixel_of(Label::h));
  EXPECT_EQ(gravity().source, GravitySource::picked) << message();
  run("option.undo");
  EXPECT_EQ(gravity().source, GravitySource::option);
}

TEST_F(GravityClicks, DoNotGoBeforeTheRecordingsOwn) {
  const std::filesystem::path copy = dir / "sample";
  std::filesystem::copy(sample_path(), copy, std::filesystem::copy_options::recursive);
  std::ofstream(copy / "gravity.json") << R"({"gravity": [0, 1, 0]})";
  std::filesystem::remove(copy / "planescope.json");
  run("recording.open", copy.string());
  ASSERT_EQ(gravity().source, GravitySource::sidecar);
  run("gravity.floor", pixel_of(Label::h));
  EXPECT_EQ(gravity().source, GravitySource::sidecar);
  EXPECT_TRUE(state().view.message_is_error);
  EXPECT_NE(message().find("sidecar"), std::string::npos) << message();
  EXPECT_FALSE(std::filesystem::exists(default_label_dir(copy) / "gravity.json"));
}

TEST_F(GravityClicks, OfAFolderThatCannotBeWrittenChangeNothing) {
  std::ofstream(label_dir) << "a file where the folder should be";
  run("gravity.floor", pixel_of(Label::h));
  EXPECT_TRUE(state().view.message_is_error);
  EXPECT_FALSE(gravity().known());
  EXPECT_TRUE(state().undo.empty());
}

TEST_F(GravityClicks, ThatCannotBeReadAreToldOfAndTheRecordingOpens) {
  std::filesystem::create_directories(label_dir);
  std::ofstream(file) << "{}";
  State state = without_gravity(label_dir);
  read_picked(state, state.document.recordings[0]);
  EXPECT_TRUE(state.document.recordings[0].picked.empty());
  EXPECT_TRUE(state.view.message_is_error);
  EXPECT_NE(state.view.message.find("gravity.json"), std::string::npos);
}

TEST_F(GravityClicks, InThePanelSayWhereItIsFrom) {
  run("option.show", "gravity");
  for (const char* widget : {"gravity.source", "gravity.this_frame", "gravity.all_frames"})
    EXPECT_TRUE(shows(widget)) << widget;
  play(R"({"click": "gravity.all_frames"})");
  EXPECT_TRUE(state().view.gravity_of_recording);
  play(R"({"click": "gravity.this_frame"})");
  EXPECT_FALSE(state().view.gravity_of_recording);
}

TEST_F(GravityClicks, OnACloudTakeThePlaneOfThePoint) {
  PointSet set;
  for (int i = 0; i < 8000; ++i)  // the floor lies in x = 0, seen from +x
    set.points.push_back(Vec3f(-1, 0.01f * static_cast<float>(i % 80) + 0.1f,
                               0.01f * static_cast<float>(i / 80) + 0.1f));
  write_ply(dir / "cloud.ply", set);
  run("recording.open", (dir / "cloud.ply").string());
  run("option.set", "gravity=none");
  ASSERT_FALSE(gravity().known());
  EXPECT_TRUE(shows("gravity.line")) << "a cloud has no image to say it above";
  run("gravity.floor", "5,5");
  EXPECT_TRUE(state().view.message_is_error) << "no pixels";
  run("gravity.floor", "voxel 100");
  EXPECT_EQ(gravity().source, GravitySource::picked) << message();
  EXPECT_LT(angle_deg(gravity().direction, -Vec3d::UnitX()), 0.1);
  EXPECT_EQ(state().run()->segmentation.planes.at(0).label, Label::h);
}

TEST_F(GravityClicks, InTheLabelModeGiveLabelsTheirClasses) {
  run("label.mode");
  run("label.wand", pixel_of(Label::h));
  run("label.accept");
  ASSERT_EQ(state().labels()->planes.size(), 1u) << message();
  EXPECT_EQ(state().labels()->planes[0].label, Label::unknown);
  play(R"({"key": "Shift+G"})");
  EXPECT_EQ(state().view.gravity_click, GravityClick::floor);
  EXPECT_TRUE(shows("gravity.line"));
  const std::string floor = pixel_of(Label::h);
  const auto comma = floor.find(',');
  play(fmt::format(R"({{"click": "image", "at": [{}, {}]}})",
                   std::stod(floor.substr(0, comma)) / 640,
                   std::stod(floor.substr(comma + 1)) / 480));
  EXPECT_EQ(gravity().source, GravitySource::picked) << message();
  EXPECT_EQ(state().labels()->planes[0].label, Label::h);
  EXPECT_EQ(state().labels()->gravity.source, GravitySource::picked);
  run("label.undo");
  EXPECT_EQ(state().labels()->planes[0].label, Label::unknown);
  run("frame.next");
  run("gravity.all_frames");
  run("gravity.floor", pixel_of(Label::h));
  EXPECT_EQ(state().labels()->gravity.source, GravitySource::picked)
      << "nobody drew on this frame yet";
  play(R"({"key": "Shift+W"}, {"key": "Escape"})");
  EXPECT_EQ(state().view.gravity_click, GravityClick::none);
}

}  // namespace
}  // namespace planescope::desktop
