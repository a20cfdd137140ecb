// Unknown gravity, and clicks on floors and walls that define its direction.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <functional>
#include <nlohmann/json.hpp>
#include <numbers>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/model/error.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

double angle_deg(const Vec3d& a, const Vec3d& b) {
  return std::acos(std::min(1.0, a.normalized().dot(b.normalized()))) * 180 / std::numbers::pi;
}

/// The sample with a rejected estimate, because no camera tilt is allowed.
State without_gravity(const std::filesystem::path& label_dir) {
  State state = open_state_with_labels(label_dir);
  state.document.options.gravity.max_tilt_deg = 0;
  state.view.tool_tab = "histograms";  // no sensitivity curves at sliders
  return state;
}

struct GravityClicks : OpenDesktop {
  const std::filesystem::path label_dir = dir / "labels", file = label_dir / "gravity.json";
  const Vec3d down =
      labels::read_frame_labels(labels::default_label_dir(sample_path()), 0, "")->gravity.direction;

  GravityClicks() : OpenDesktop(without_gravity(scratch_dir() / "labels")) {}
  void SetUp() override { rest(/*background=*/false); }
  const Gravity& gravity() const { return state().run()->subject->prepared.gravity; }
  void run(const std::string& action, const std::string& argument = {}) {
    shell.perform({action, argument}, true);
    rest(/*background=*/false);
  }
  FrameLabels truth() const {
    return *labels::read_frame_labels(labels::default_label_dir(sample_path()),
                                      state().document.frame, "");
  }
  /// A measured pixel well inside the largest true plane that satisfies a condition.
  std::string pixel_of(const std::function<bool(const LabelPlane&)>& asked) const {
    const FrameLabels labels = truth();
    const Image16& depth = state().run()->subject->frame.depth;
    std::vector<labels::PixelSet> planes;
    for (const LabelPlane& plane : labels.planes)
      if (asked(plane)) planes.push_back(labels::pixels_of_plane(labels, plane.id));
    std::ranges::sort(planes, std::greater{}, &labels::PixelSet::size);
    const int width = labels.plane.width;
    for (const labels::PixelSet& pixels : planes) {
      const auto is_deep = [&](std::uint32_t pixel) {
        for (const int du : {-8, 0, 8})
          for (const int dv : {-8, 0, 8}) {
            const auto near = static_cast<std::uint32_t>(static_cast<int>(pixel) + du + dv * width);
            if (!std::ranges::binary_search(pixels, near)) return false;
          }
        return depth.data[pixel] > 0;
      };
      const auto deep = std::ranges::find_if(pixels, is_deep);
      if (deep != pixels.end())
        return fmt::format("{},{}", *deep % static_cast<unsigned>(width),
                           *deep / static_cast<unsigned>(width));
    }
    ADD_FAILURE() << "no such plane";
    return "0,0";
  }
  std::string pixel_of(Label label) const {
    return pixel_of([label](const LabelPlane& plane) { return plane.label == label; });
  }
  /// Clicks that pixel with the mouse.
  void click(const std::string& pixel) { play(click_on(pixel)); }
  /// Clicks a pixel and expects an error with this reason.
  void expect_refused(const std::string& action, const std::string& pixel, const char* why) {
    run(action, pixel);
    EXPECT_TRUE(state().view.message_is_error) << pixel;
    EXPECT_TRUE(has(message(), why));
  }
};

TEST_F(GravityClicks, AFrameWithoutGravityShowsPlanesAndSuggestsClicks) {
  ASSERT_TRUE(state().run()) << state().results.refusal;
  EXPECT_EQ(state().results.refusal, "");
  EXPECT_FALSE(gravity().known());
  EXPECT_GE(state().run()->segmentation.planes.size(), 3u);
  EXPECT_TRUE(shown("image")) << "to be clicked";
  EXPECT_TRUE(shown("gravity.line"));
  EXPECT_TRUE(shown("button.gravity.click.floor"));
  rest();
  for (const Thumbnail& thumbnail : state().results.strip) {
    EXPECT_EQ(thumbnail.refusal, "");
    EXPECT_GT(thumbnail.planes, 0);
  }
  for (const char* by : {"color.labels", "color.margins", "color.cases"}) run(by);
}

TEST_F(GravityClicks, OneClickOnAFloorDefinesIt) {
  run("camera.orbit", "20,5");
  play(R"({"click": "button.gravity.click.floor"}, {"expect": {"click": "floor"}})");
  click(pixel_of(Label::h));
  EXPECT_EQ(gravity().source, GravitySource::picked) << message();
  EXPECT_LT(angle_deg(gravity().direction, down), 1.5);
  EXPECT_EQ(state().view.click, Click::selects) << "one click";
  EXPECT_FALSE(shown("gravity.line"));
  EXPECT_FALSE(state().view.camera) << "it stood in another world";
  EXPECT_EQ(state().view.step, state().run()->steps());
  EXPECT_TRUE(std::filesystem::exists(file));
  EXPECT_TRUE(has(message(), "for this frame"));
  EXPECT_FALSE(state().view.message_is_error);
  run("frame.next");
  EXPECT_FALSE(gravity().known()) << "of that frame alone";
}

TEST_F(GravityClicks, ForAllFramesApplyToTheNextAndAfterARestart) {
  run("gravity.all_frames");
  run("gravity.floor", pixel_of(Label::h));
  const Vec3d picked = gravity().direction;
  run("frame.next");
  EXPECT_EQ(gravity().source, GravitySource::picked);
  EXPECT_EQ(gravity().direction, picked);
  const auto recording = io::open_recording(sample_path());
  EXPECT_EQ(io::read_picked_gravity(label_dir, *recording).recording->direction, picked);

  State state = without_gravity(label_dir);
  read_picked(state, state.document.recordings[0]);
  EXPECT_EQ(state.document.recordings[0].picked.recording->direction, picked);
}

TEST_F(GravityClicks, OnOneWallRotateItAndOnTheSameAgainAddNothing) {
  run("gravity.wall", pixel_of(Label::v));
  ASSERT_EQ(gravity().source, GravitySource::picked) << message();
  const Vec3d normal = state().document.current()->picked.frames.at(0).walls[0];
  EXPECT_NEAR(normal.dot(gravity().direction), 0, 1e-6);
  EXPECT_TRUE(has(message(), "one wall"));
  // The same wall again adds no information.
  const Vec3d before = gravity().direction;
  expect_refused("gravity.wall", pixel_of(Label::v), "parallel");
  EXPECT_EQ(gravity().direction, before);
}

TEST_F(GravityClicks, OnTwoWallsDefineItWithoutAFloor) {
  run("frame.show", "2");
  const Vec3d truly = truth().gravity.direction;
  run("gravity.wall", pixel_of(Label::v));
  const double with_one_deg = angle_deg(gravity().direction, truly);
  const Vec3d first = state().document.current()->picked.frames.at(2).walls.at(0);
  run("gravity.wall", pixel_of([&](const LabelPlane& plane) {
        return plane.label == Label::v && std::abs(plane.normal.dot(first)) < 0.7;
      }));
  EXPECT_FALSE(state().view.message_is_error) << message();
  EXPECT_EQ(state().document.current()->picked.frames.at(2).walls.size(), 2u);
  EXPECT_LT(angle_deg(gravity().direction, truly), 4);
  EXPECT_LT(angle_deg(gravity().direction, truly), with_one_deg);
  run("option.undo");
  EXPECT_EQ(state().document.current()->picked.frames.at(2).walls.size(), 1u);
}

TEST_F(GravityClicks, CanBeUndoneRedoneAndForgotten) {
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

TEST_F(GravityClicks, BadOnesAreReportedInOneLineAndChangeNothing) {
  run("gravity.click.floor");
  for (const char* argument : {"0,0", "9999,3", "-1,3", "a,b", "3", "", "voxel 99999999", "voxel x",
                               "plane 0", "plane 9999", "nothing"}) {
    run("gravity.floor", argument);
    EXPECT_TRUE(state().view.message_is_error) << argument;
    EXPECT_TRUE(message().starts_with("gravity is unchanged: ")) << message();
    EXPECT_FALSE(has(message(), "\n"));
    EXPECT_FALSE(gravity().known()) << argument;
  }
  EXPECT_TRUE(state().undo.empty());
  EXPECT_FALSE(std::filesystem::exists(file));
  EXPECT_EQ(state().view.click, Click::floor) << "the next click may be better";
  run("select.none");
  EXPECT_EQ(state().view.click, Click::selects);
}

TEST_F(GravityClicks, AFloorIsNotAWall) {
  run("gravity.floor", pixel_of(Label::h));
  expect_refused("gravity.wall", pixel_of(Label::h), "expected a wall, not a floor");
}

TEST_F(GravityClicks, OverrideTheOptionAndRestoreItOnUndo) {
  run("option.set", "gravity=1,0,0");
  ASSERT_EQ(gravity().source, GravitySource::option);
  run("gravity.floor", pixel_of(Label::h));
  EXPECT_EQ(gravity().source, GravitySource::picked) << message();
  run("option.undo");
  EXPECT_EQ(gravity().source, GravitySource::option);
  run("option.redo");
  run("option.set", "gravity=1,0,0");
  run("gravity.forget");
  EXPECT_EQ(gravity().source, GravitySource::option) << "forgetting changes no option";
}

TEST_F(GravityClicks, DoNotOverrideTheRecording) {
  const std::filesystem::path copy = dir / "sample";
  std::filesystem::copy(sample_path(), copy, std::filesystem::copy_options::recursive);
  auto sidecar = nlohmann::json::parse(std::ifstream(copy / "planescope.json"));
  sidecar["gravity"] = {0, 1, 0};
  std::ofstream(copy / "planescope.json") << sidecar;
  run("recording.open", copy.string());
  ASSERT_EQ(gravity().source, GravitySource::sidecar);
  expect_refused("gravity.floor", pixel_of(Label::h), "sidecar");
  EXPECT_EQ(gravity().source, GravitySource::sidecar);
  EXPECT_FALSE(std::filesystem::exists(labels::default_label_dir(copy) / "gravity.json"));
}

TEST_F(GravityClicks, InAReadOnlyFolderChangeNothing) {
  std::ofstream(label_dir) << "a file where the folder should be";
  run("gravity.floor", pixel_of(Label::h));
  EXPECT_TRUE(state().view.message_is_error);
  EXPECT_FALSE(gravity().known());
  EXPECT_TRUE(state().undo.empty());
}

TEST_F(GravityClicks, ThatCannotBeReadAreReportedAndTheRecordingOpens) {
  std::filesystem::create_directories(label_dir);
  std::ofstream(file) << "{}";
  State state = without_gravity(label_dir);
  read_picked(state, state.document.recordings[0]);
  EXPECT_TRUE(state.document.recordings[0].picked.empty());
  EXPECT_TRUE(state.view.message_is_error);
  EXPECT_TRUE(has(state.view.message, "gravity.json"));
}

TEST_F(GravityClicks, DoNotReplaceARejectedFile) {
  const std::filesystem::path copy = dir / "sample", kept = dir / "sample.labels/gravity.json";
  std::filesystem::copy(sample_path(), copy, std::filesystem::copy_options::recursive);
  std::filesystem::create_directories(kept.parent_path());
  std::ofstream(kept) << "{\"schema\": \"planescope.gravity/2\"}";
  ASSERT_EQ(labels::default_label_dir(copy), kept.parent_path());
  run("recording.open", copy.string());
  expect_refused("gravity.floor", pixel_of(Label::h), "move the file away");
  EXPECT_EQ(nlohmann::json::parse(std::ifstream(kept)).at("schema"), "planescope.gravity/2");
}

TEST_F(GravityClicks, ShowTheirSourceInThePanel) {
  run("tab.tool", "criteria");
  run("option.show", "gravity");
  for (const char* widget : {"gravity.source", "gravity.this_frame", "gravity.all_frames"})
    EXPECT_TRUE(shown(widget)) << widget;
  play(R"({"click": "gravity.all_frames"})");
  EXPECT_TRUE(state().view.gravity_of_recording);
  play(R"({"click": "gravity.this_frame"})");
  EXPECT_FALSE(state().view.gravity_of_recording);
}

TEST_F(GravityClicks, OnACloudUseThePlaneOfThePoint) {
  PointSet set;
  for (int i = 0; i < 8000; ++i)  // the floor is the plane x = 0, seen from +x
    set.points.push_back(Vec3f(-1, 0.01f * static_cast<float>(i % 80) + 0.1f,
                               0.01f * static_cast<float>(i / 80) + 0.1f));
  io::write_ply(dir / "cloud.ply", set);
  run("recording.open", (dir / "cloud.ply").string());
  run("option.set", "gravity=none");
  ASSERT_FALSE(gravity().known());
  EXPECT_TRUE(shown("gravity.line")) << "a cloud has no image to say it above";
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
  EXPECT_EQ(state().view.click, Click::floor);
  EXPECT_TRUE(shown("gravity.line"));
  click(pixel_of(Label::h));
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
  EXPECT_EQ(state().view.click, Click::selects);
}

}  // namespace
}  // namespace planescope::desktop
