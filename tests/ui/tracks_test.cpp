// Planes tracked over the frames of a walk: the timeline, targets of gaps, colors.

#include <set>

#include "app/desktop/look.hpp"
#include "app/desktop/tracks/map_view.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/world/files/map_files.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

/// A walk past a kerb and boxes, with the camera covered for a while.
std::filesystem::path walk() {
  static const std::filesystem::path dir = [] {
    const auto made = std::filesystem::path(testing::TempDir()) /
                      ("planescope_walk." + std::to_string(::getpid()));
    open_walk(made, {.frames = 60, .covered = true});
    return made;
  }();
  return dir;
}

struct Tracks : OpenDesktop {
  Tracks() : OpenDesktop(opened()) {}
  static State opened() {
    State state = open_state(planes::Profile::refined);
    state.document.recordings[0] = {walk(), io::open_recording(walk(), {}), walk() / "none"};
    state.view.strip_stopped = true;
    state.view.tool_tab = "histograms";
    return state;
  }
  void follow() { play(R"({"do": "map.make"})"); }
  const MapView& map() const { return *state().map(); }
  /// A track of the map that was missed in a frame.
  const world::Track& missed() const {
    const auto& all = map().tracker().tracks();
    const auto at = std::ranges::find_if(all, [](const world::Track& track) {
      return track.state != world::TrackState::merged && track.frames_seen > 1 &&
             std::ranges::any_of(track.gaps, [](const world::Gap& gap) {
               return gap.why == world::Absence::not_detected;
             });
    });
    EXPECT_NE(at, all.end());
    return *at;
  }
};

TEST_F(Tracks, AreStartedByAButtonAndShownInOneRowEach) {
  play(R"({"click": "tab.tracks"})");
  EXPECT_FALSE(state().map());
  play(R"({"click": "button.map.make"})");
  ASSERT_TRUE(state().map());
  EXPECT_TRUE(is_fresh(map(), state().document));
  EXPECT_GT(track_rows(state()).size(), 5u);
  EXPECT_TRUE(shown("tracks.1"));
  // The window's own run has the same planes as the map.
  EXPECT_EQ(map().tracks_at(0)->listed, std::ssize(state().run()->segmentation.planes));
}

TEST_F(Tracks, KeepTheirColorFromFrameToFrame) {
  follow();
  const auto color_of = [&](int track) {
    const auto& reported = map().tracks_at(state().document.frame)->track_of;
    const std::vector<int> colors = colors_of_planes(state(), *state().run_view());
    for (std::int32_t p = 0; p < state().run()->timeline.plane_count(); ++p)
      if (const auto id = state().run()->timeline.result_of_plane(p);
          id > 0 && reported[static_cast<std::size_t>(id) - 1] == track)
        return colors[static_cast<std::size_t>(p)];
    return -1;
  };
  const int before = color_of(1);
  play(R"({"do": "frame.show", "with": "7"})");
  EXPECT_EQ(before, 1);
  EXPECT_EQ(color_of(1), 1);
  // Other options give other planes, which the map's colors do not fit.
  play(R"({"do": "option.set", "with": "voxel_size_m=0.03"})");
  EXPECT_FALSE(is_fresh(map(), state().document));
  EXPECT_FALSE(state().run_view()->colors.of_tracks);
}

TEST_F(Tracks, WithoutAMapPlanesKeepTheirColorsInStripAndViews) {
  shell.perform({"frame.show", "5"});  // before the strip reaches it
  rest();
  const std::vector<Thumbnail> strip = state().results.strip;
  ASSERT_EQ(std::ranges::count_if(strip, &Thumbnail::ready), std::ssize(strip));
  double pixels = 0, kept = 0;
  for (std::size_t i = 1; i < strip.size(); ++i) {
    if (!strip[i - 1].colors.planes || !strip[i].colors.planes) continue;
    const render::ColoredPlanes &before = *strip[i - 1].colors.planes,
                                &now = *strip[i].colors.planes;
    const std::vector<int> colors = now.own_colors();
    const render::PlaneMatch match = render::match_planes(before.image, now.image);
    for (std::size_t n = 0; n < colors.size(); ++n) {
      const int b = match.before_of[n];
      if (b == 0) continue;
      const auto size = static_cast<double>(now.image.planes[n].size);
      pixels += size;
      if (before.colors[static_cast<std::size_t>(b) - 1] == colors[n]) kept += size;
    }
    perform("frame.show", std::to_string(i));
    EXPECT_EQ(colors_of_planes(state(), *state().run_view()),
              render::trace_colors(*state().run(), colors));
  }
  EXPECT_GT(kept, 0.98 * pixels);
}

TEST_F(Tracks, AGapOpensTheDecisionThatLostThePlane) {
  play(R"({"do": "option.set", "with": "filled=0.95"})");  // few cells are planar

  follow();
  const world::Track& track = missed();
  const int frame =
      std::ranges::find(track.gaps, world::Absence::not_detected, &world::Gap::why)->first;
  run("track.show", fmt::format("T{},{}", track.id, frame));
  EXPECT_EQ(state().document.frame, frame);
  EXPECT_EQ(state().view.tracks.track, track.id);
  EXPECT_TRUE(has(state().view.message,
                  fmt::format("T{} is not in frame {}: not detected", track.id, frame)));
  EXPECT_TRUE(has(state().view.message, "unassigned at step"));
  EXPECT_LT(state().view.step, state().run()->steps());
  EXPECT_FALSE(state().document.marked.empty()) << "its place";
  // The same position in the previous frame, where the plane was seen.
  play(R"({"key": "Alt+PageUp"})");
  const int seen = state().document.frame;
  EXPECT_LT(seen, frame);
  EXPECT_GE(state().view.selected.plane, 0);
  EXPECT_TRUE(has(track_text(state()), fmt::format("T{} is P", track.id)));
  play(R"({"key": "Shift+PageDown"})");
  EXPECT_EQ(state().document.frame, frame_missed(map(), track, seen, 1));
}

TEST_F(Tracks, AClickOnTheTimelineGoesToTheFrame) {
  follow();
  play(R"({"click": "tracks.1", "at": [0.26, 0.5]})");
  EXPECT_EQ(state().document.frame, 15);
  EXPECT_EQ(state().view.tracks.track, 1);
}

TEST_F(Tracks, TheSceneKeepsItsViewpointInTheWorld) {
  follow();
  play(
      R"({"do": "camera.top"}, {"do": "camera.zoom", "with": "2"}, {"do": "track.show", "with": "1"})");
  const auto eye = [&] { return *T_map_scene(map(), *state().run()) * state().view.camera->eye; };
  const Vec3d before = eye();
  play(R"({"do": "track.show", "with": "1,6"})");
  EXPECT_TRUE(eye().isApprox(before, 1e-6));
}

TEST_F(Tracks, TheMapGrowsWithTheFrames) {
  follow();
  play(R"({"do": "show.map"})");
  const std::size_t at_first = look_of(state()).map->size();
  play(R"({"do": "frame.show", "with": "59"})");
  EXPECT_GT(look_of(state()).map->size(), at_first);
}

TEST_F(Tracks, CanBeFiltered) {
  follow();
  const std::size_t all = track_rows(state()).size();
  play(R"({"do": "track.filter", "with": "gap && length>3"})");
  const auto rows = track_rows(state());
  EXPECT_LT(rows.size(), all);
  EXPECT_FALSE(rows.empty());
  for (const world::Track* track : rows) EXPECT_GT(track->frames_seen, 3);
  play(R"({"do": "track.filter", "with": "lenght<5"})");
  EXPECT_TRUE(has(state().view.tracks.filter_problem, "'lenght'"));
  EXPECT_EQ(track_rows(state()).size(), all) << "a filter that is none hides nothing";
}

TEST_F(Tracks, TrackingCanBeStoppedAndCloudsAreRejected) {
  shell.perform({"map.make", ""}, true);
  stage.draw_frame();
  run("map.stop");
  EXPECT_FALSE(state().map());
  EXPECT_FALSE(state().results.map.running);
}

struct LabelOnce : testing::Test {
  const std::filesystem::path dir = scratch_dir();
  LabelWindow window{dir / "labels", walk()};
  const State& state() const { return window.state(); }
  std::size_t labeled() const {
    std::size_t count = 0;
    for (int i = 0; i < 60; ++i) {
      const auto labels = window.store().labels(i);
      count += labels && !labels->planes.empty();
    }
    return count;
  }
};

TEST_F(LabelOnce, TheFloorOfOneFrameIsTheFloorOfOthers) {
  window.run("label.wand", "80,100");
  window.run("label.accept");
  ASSERT_EQ(labeled(), 1u);
  EXPECT_TRUE(has(window.refusal("label.spread"), "poses are unknown"));
  window.run("map.make");
  ASSERT_TRUE(state().map());
  window.run("label.spread");
  const std::size_t proposed = labeled();
  EXPECT_GT(proposed, 8u) << state().view.message;
  EXPECT_TRUE(has(state().view.message, fmt::format("proposed in {} frames", proposed - 1)));
  // Its confidence is stored with it.
  const auto next = window.store().labels(1);
  ASSERT_TRUE(next);
  ASSERT_FALSE(next->planes.empty());
  EXPECT_EQ(next->planes[0].origin, LabelOrigin::carried);
  EXPECT_GT(next->planes[0].confidence, 0.8);
  // Frames are visited in order of doubt.
  window.run("label.spread.next");
  EXPECT_EQ(state().document.frame, state().results.label.spread.doubtful.front().first);
  // One step of undo reverts all of it, from any frame.
  window.run("label.undo");
  EXPECT_EQ(labeled(), 1u) << state().view.message;
  window.run("label.redo");
  EXPECT_EQ(labeled(), proposed);
}

TEST_F(LabelOnce, ATrackOfTheMapLabelsAllFramesThatSeeIt) {
  window.run("label.wand", "80,100");
  window.run("label.accept");
  const auto by_hand = window.store().labels(0);
  window.run("map.make");
  ASSERT_TRUE(state().map());
  EXPECT_TRUE(has(window.refusal("label.spread.track"), "no track is selected"));
  const world::Tracker& tracker = state().map()->tracker();
  const world::Track& track = *world::planes_of_map(tracker).front();
  window.run("track.show", std::to_string(track.id));
  window.run("label.spread.track");
  std::size_t frames = 0;
  for (int i = 0; i < 60; ++i) {
    const auto labels = window.store().labels(i);
    if (!labels || labels->planes.empty() || labels->planes.back().origin != LabelOrigin::algorithm)
      continue;
    ++frames;
    EXPECT_EQ(labels->planes.back().id, 2) << "frame " << i;
    EXPECT_EQ(labels->planes.back().label, track.label);
  }
  EXPECT_GT(frames, 8u) << state().view.message;
  // Hand-drawn labels are unchanged.
  EXPECT_EQ(labels::pixels_of_plane(*window.store().labels(0), 1),
            labels::pixels_of_plane(*by_hand, 1));
  window.run("label.undo");
  EXPECT_EQ(labeled(), 1u) << state().view.message;
}

}  // namespace
}  // namespace planescope::desktop
