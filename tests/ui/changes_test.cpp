// Changes while jobs run: results belong to the state at the start of the job, not to the current
// one.

#include <nlohmann/json.hpp>

#include "app/desktop/jobs/jobs.hpp"
#include "app/desktop/state/state.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct Changes : OpenDesktop {
  void SetUp() override {}
  const Results& results() const { return shell.state().results; }
  void perform(const std::string& action, const std::string& argument = {}) {
    shell.perform({action, argument});
    ASSERT_FALSE(state().view.message_is_error) << state().view.message;
  }
  /// Draws frames as fast as possible while jobs are running.
  void draw(int frames) {
    for (int i = 0; i < frames; ++i) {
      stage.draw_frame();
      if (const auto& view = results().current) {
        ASSERT_EQ(view->run->subject->frame.index, state().document.frame)
            << "a frame that was left";
      }
      ASSERT_LE(results().strip_done, static_cast<int>(results().strip.size()));
      if (!state().run()) continue;
      ASSERT_LE(state().view.step, state().run()->steps());
      ASSERT_LT(state().view.selected.node,
                static_cast<std::int32_t>(state().run()->octree().nodes.size()));
    }
  }
  void expect_whole_strip() const {
    const auto count = state().document.current()->recording->frame_count();
    ASSERT_EQ(results().strip.size(), static_cast<std::size_t>(count));
    EXPECT_EQ(results().strip_done, count);
    for (const Thumbnail& thumbnail : results().strip) EXPECT_TRUE(thumbnail.ready);
  }
  /// Opens a cloud of points beside the sample.
  void open_cloud() {
    PointSet set;
    for (int i = 0; i < 4000; ++i)
      set.points.push_back(
          Vec3f(1 + 0.01f * static_cast<float>(i % 80), 0.01f * static_cast<float>(i / 80), 0));
    const std::filesystem::path path = dir / "cloud.ply";
    io::write_ply(path, set);
    perform("recording.open", path.string());
  }
};

TEST_F(Changes, OfTheFrameNeverShowAnotherOne) {
  for (int i = 0; i < 12; ++i) {
    perform("frame.show", std::to_string(i % 3));
    draw(1 + i % 4);
  }
  rest();
  draw(1);
  EXPECT_EQ(results().current->run->subject->frame.index, 2);
  expect_whole_strip();
}

TEST_F(Changes, OfTheRecordingFillItsOwnStrip) {
  rest();
  perform("frame.show", "2");
  rest();
  perform("option.set", "theta_n_in=8");
  while (results().strip_done == 3) draw(1);  // wait until it is filled again
  open_cloud();
  draw(1);
  perform("recording.show", "0");
  draw(3);
  perform("recording.show", "1");
  draw(2);
  perform("recording.show", "0");
  rest();
  expect_whole_strip();
  perform("recording.show", "1");
  rest();
  expect_whole_strip();
}

TEST_F(Changes, OfAnOptionKeepTheComparisonWithItsRuns) {
  rest();
  perform("run.pin");
  for (const char* against : {"pinned", "truth", "pinned"}) {
    perform("compare.against", against);
    for (int i = 0; i < 10; ++i) {
      perform("option.drag", "theta_n_in=" + std::to_string(5 + 60 * (i % 3)));
      draw(3);
      if (i % 4 == 1) perform("run.flash");
    }
  }
  perform("option.drop");
  rest();
  EXPECT_EQ(results().compared_a, results().pinned);
  EXPECT_EQ(results().compared_b, results().current);
  EXPECT_EQ(state().undo.size(), 1u);
  expect_whole_strip();
}

TEST_F(Changes, OfBAppearInTheStripInTheColorsOfA) {
  rest();
  perform("option.set", "profile=refined");
  rest();
  perform("run.pin");
  perform("option.set", "max_range_m=2");  // without the largest planes
  rest();
  FrameTools tools;
  ColorBook book;
  const Wanted wanted = wanted_of(state().document, state().document.frame);
  const Image8 like_a =
      thumbnail_of(wanted, tools, book, results().pinned_colors.planes.get()).image;
  ColorBook empty;
  ASSERT_NE(thumbnail_of(wanted, tools, empty).image.data, like_a.data);
  const auto shown = [&] {
    return results().strip[static_cast<std::size_t>(state().document.frame)].image.data;
  };
  EXPECT_EQ(shown(), like_a.data);
  perform("run.unpin");
  rest();
  EXPECT_EQ(shown(), like_a.data) << "colors stay";
  expect_whole_strip();
}

TEST_F(Changes, OfTheFrameWhileAIsFlashedDiscardIt) {
  rest();
  perform("run.pin");
  perform("option.set", "voxel_size_m=0.05");  // a smaller tree
  rest();
  perform("run.flash");
  const auto nodes = state().run()->octree().nodes.size();
  ASSERT_GT(nodes, results().current->run->octree().nodes.size());
  perform("select.node", std::to_string(nodes - 1));
  perform("frame.next");
  draw(2);
  rest();
  EXPECT_FALSE(state().view.flash);
}

TEST_F(Changes, OfTheTargetSearchForTheLastOne) {
  rest();
  for (const char* plane : {"1", "2", "3"}) {
    perform("fix.plane", plane);
    draw(2);
  }
  rest();
  EXPECT_EQ(results().fix.target.name, "true plane 3");
  EXPECT_TRUE(results().fix.finished);
  perform("fix.plane", "1");
  draw(1);
  perform("fix.cancel");
  perform("fix.plane", "2");
  rest();
  EXPECT_TRUE(results().fix.finished);
  EXPECT_EQ(results().fix.target.name, "true plane 2");
}

TEST_F(Changes, SensitivitiesReturnAfterASearch) {
  perform("tab.tool", "criteria");
  rest();
  const std::size_t all = results().sensitivity.size();
  ASSERT_GT(all, 5u);
  perform("option.set", "theta_n_in=6");
  while (results().sensitivity.empty() || results().sensitivity.size() == all) draw(1);
  perform("fix.plane", "1");
  rest();
  perform("tab.tool", "criteria");
  rest();
  EXPECT_EQ(results().sensitivity.size(), all);
}

TEST_F(Changes, OfTheFrameCancelAJumpToABookmark) {
  rest();
  perform("step.goto", "10");
  perform("bookmark.add", "here");
  perform("frame.show", "1");
  rest();
  perform("bookmark.go", "here");
  perform("frame.show", "2");
  rest();
  EXPECT_EQ(state().document.frame, 2);
  EXPECT_EQ(results().current->run->subject->frame.index, 2);
  perform("bookmark.go", "here");
  rest();
  EXPECT_EQ(state().document.frame, 0);
  EXPECT_EQ(state().view.step, 10);
}

TEST_F(Changes, KeepABookmarkOfALongerRecording) {
  perform("frame.show", "2");
  rest();
  perform("bookmark.add", "there");
  open_cloud();
  rest();
  shell.perform({"bookmark.go", "there"});
  EXPECT_TRUE(has(state().view.message, "frame 2"));
  rest();
  EXPECT_FALSE(state().view.arrival);
}

TEST_F(Changes, PlayingContinuesAtAnySpeed) {
  rest();
  perform("step.first");
  perform("step.rate", "20");
  perform("step.play");
  draw(20);  // a third of a second
  EXPECT_EQ(state().view.step, 6);
  perform("step.play_back");
  draw(30);
  EXPECT_EQ(state().view.step, 0);
  EXPECT_EQ(state().view.playing.direction, 0);
}

TEST_F(Changes, FileSystemErrorsAreReported) {
  shell.perform({"recording.open", std::string(5000, 'x')});
  EXPECT_TRUE(state().view.message_is_error);
  shell.perform({"session.open", std::string(5000, 'x')});
  EXPECT_TRUE(state().view.message_is_error);
  rest();
  shell.perform({"bookmark.add", "\xff is no UTF-8"});
  shell.perform({"recording.open", "\xff"});
  EXPECT_NE(state_text(state(), true), "");
  const std::filesystem::path session = dir / "s.json";
  perform("session.save", session.string());
  perform("session.open", session.string());
}

}  // namespace
}  // namespace planescope::desktop
