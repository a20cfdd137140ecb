// A new user's first hour as one script, without dead ends.

#include <fmt/format.h>

#include <fstream>

#include "app/desktop/window.hpp"
#include "cli/program.hpp"
#include "core/io/image/png.hpp"
#include "core/model/error.hpp"
#include "desktop_fixture.hpp"
#include "support/apng.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;

struct FirstHour : testing::Test {
  const fs::path dir = scratch_dir(), recording = dir / "sample";
  std::unique_ptr<Offscreen> window;

  void SetUp() override {
    fs::copy(sample_path(), recording, fs::copy_options::recursive);
    State state = open_state(planes::Profile::refined);
    state.document.recordings.clear();
    state.document.recording = -1;
    window = std::make_unique<Offscreen>(std::move(state), 1280, 800, 1);
  }
  const State& state() const { return window->shell().state(); }
  void rest() { settle(window->shell(), *window, {}, /*background=*/false); }
  void run(const std::string& action, const std::string& argument = {}) {
    window->shell().perform({action, argument});
    rest();
    EXPECT_FALSE(state().view.message_is_error)
        << action << " " << argument << ": " << state().view.message;
    EXPECT_FALSE(state().view.did_nothing) << action << ": " << state().view.message;
  }
  void play(const std::string& actions) {
    play_actions(window->shell(), *window, dir, actions);
    rest();
    EXPECT_FALSE(state().view.message_is_error) << actions << ": " << state().view.message;
  }
  testing_cli::Ran command(std::vector<std::string> args) {
    testing_cli::Ran ran = testing_cli::run(args);
    EXPECT_EQ(ran.code, 0) << args[0] << ": " << ran.err;
    return ran;
  }
};

TEST_F(FirstHour, GoesFromTheFirstFrameToAReportWithoutDeadEnds) {
  rest();
  run("recording.open", recording.string());
  ASSERT_TRUE(state().run());

  // Keys, palette, views.
  play(R"({"key": "?"}, {"key": "Escape"}, {"key": "Ctrl+P"}, {"type": "colour by depth"},
          {"key": "Enter"})");
  EXPECT_EQ(state().view.color_by, render::ColorBy::depth);
  for (const char* action : {"color.height", "color.rms", "color.distance", "color.planes",
                             "camera.top", "camera.orthographic", "camera.home", "views.next",
                             "views.next", "views.next", "theme.toggle"})
    run(action);

  // Step, search, stop.
  run("step.first");
  for (const char* action : {"step.next", "step.next", "step.next_case", "step.decision"})
    run(action);
  run("filter.set", "case==III");
  run("filter.next");
  run("break.filter");
  run("run.forward");
  run("isolate");
  run("isolate");
  run("steps.save", (dir / "steps.png").string() + " 10-20");
  EXPECT_EQ(test::read_apng(dir / "steps.png").frames.size(), 11U);
  run("step.last");

  // Why: a point, an empty spot, a plane.
  play(R"({"click": "view3d", "at": [0.5, 0.75]}, {"key": "P"})");
  EXPECT_EQ(state().view.inspector_tab, "point");
  run("why.pixel", "600,20");
  run("select.plane", "P1");
  run("camera.selected");
  run("tab.inspector", "planes");
  run("planes.copy");
  run("measure.planes");
  run("measure.end", "plane 1");
  run("measure.end", "plane 2");
  run("select.none");

  // Fixes; comparison of A and B.
  run("mark.pixels", "300,300,340,340");
  run("fix.marked");
  EXPECT_TRUE(state().results.fix.finished);
  run("run.pin");
  run("option.set", "profile=paper");
  for (const char* action : {"run.flash", "run.flash", "run.wiper", "compare.diverging"})
    run(action);
  run("run.restore");
  run("run.unpin");
  run("bookmark.add", "here");
  run("picture.save", (dir / "window.png").string());
  EXPECT_EQ(io::read_png_rgb(dir / "window.png").width, 1280);
  run("session.save", (dir / "session.json").string());

  // Label a frame with the wand, review it, leave.
  run("label.mode");
  run("label.annotator", "new");
  for (const char* pixel : {"160,407", "210,225", "152,101"}) {
    run("label.wand", pixel);
    run("label.accept");
  }
  EXPECT_EQ(state().labels()->planes.size(), 3U);
  run("label.plane", "1");
  run("label.grow");
  run("label.accept");
  run("label.undo");
  run("review.start");
  run("review.smallest", "20");
  while (state().results.label.review->undecided() > 0) {
    const std::size_t before = state().results.label.review->undecided();
    run("review.keep");
    ASSERT_LT(state().results.label.review->undecided(), before) << state().view.message;
  }
  run("review.done");
  run("label.save");
  run("frame.next");
  run("label.mode");
  run("session.open", (dir / "session.json").string() + "#here");
  EXPECT_EQ(state().document.frame, 0);
  window.reset();

  // Labels on the command line, and a report of everything.
  command({"labels", "check", recording.string()});
  command(
      {"labels", "export", recording.string(), "--format", "ply", "-o", (dir / "ply").string()});
  command({"report", recording.string(), "-o", (dir / "report").string(), "--classifier", "pca"});
  EXPECT_TRUE(fs::exists(dir / "report" / "index.html"));
}

}  // namespace
}  // namespace planescope::desktop
