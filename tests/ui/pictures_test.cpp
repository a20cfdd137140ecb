// The whole window, drawn without a display.

#include <algorithm>
#include <array>
#include <cstdlib>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

#include "app/commands/view.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/window.hpp"
#include "cli/program.hpp"
#include "core/io/image/png.hpp"
#include "core/io/recording.hpp"
#include "core/model/error.hpp"
#include "desktop_fixture.hpp"
#include "render/palette.hpp"
#include "render/step_scene.hpp"
#include "support/apng.hpp"

namespace planescope::desktop {
namespace {

/// Share of pixels that differ between two pictures.
double difference(const Image8& a, const Image8& b) {
  if (a.width != b.width || a.height != b.height) return 1;
  std::size_t differing = 0;
  for (std::size_t i = 0; i < a.data.size(); i += 3)
    differing +=
        a.data[i] != b.data[i] || a.data[i + 1] != b.data[i + 1] || a.data[i + 2] != b.data[i + 2]
            ? 1
            : 0;
  return static_cast<double>(differing) * 3 / static_cast<double>(a.data.size());
}

/// A separate window, and its picture after some actions.
struct Window {
  explicit Window(State state) : offscreen(std::move(state), 1280, 800, 1) {
    settle(offscreen.shell(), offscreen, {});
  }
  explicit Window(render::Theme theme = render::Theme::dark) : Window(themed(theme)) {}
  static State themed(render::Theme theme) {
    State state = open_state();
    state.view.theme = theme;
    return state;
  }
  Window& after(const std::vector<Command>& commands) {
    for (const Command& command : commands) {
      offscreen.shell().perform(command, true);
      settle(offscreen.shell(), offscreen, {});
    }
    return *this;
  }
  void play(const std::string& actions) {
    play_actions(offscreen.shell(), offscreen, scratch_dir(), actions);
  }
  Image8 picture() { return offscreen.picture(); }
  Image8 panel(const std::string& name) {
    return part_of(picture(), offscreen.shell().widgets().at("panel." + name));
  }
  Offscreen offscreen;
};

constexpr double kSame = 0.0005;  // share of pixels that may differ

struct Pictures : testing::Test {};

TEST_F(Pictures, OfTheReadmesTourMatchItsCommands) {
  const std::filesystem::path docs = std::filesystem::path(PLANESCOPE_SOURCE_DIR) / "docs";
  int pictures = 0;
  for (const auto& entry : std::filesystem::directory_iterator(docs / "tour")) {
    const std::filesystem::path drawn =
        docs / "pictures" / ("tour_" + entry.path().stem().string() + ".png");
    const bool draws_labels = entry.path().stem().string().ends_with("_label");
    app::ViewArgs args;  // --frames 1 --profile paper
    args.input.inputs = {sample_path()};
    args.input.frames = app::parse_frame_slice("1");
    args.input.pipeline.segment = planes::profile_options(planes::Profile::paper);
    if (draws_labels) args.input.label_dir = scratch_dir() / "tour.labels";
    Offscreen offscreen(app::view_state(args), args.width, args.height, 1);
    settle(offscreen.shell(), offscreen, {});
    Script::read(entry.path()).play(offscreen.shell(), offscreen, {});
    settle(offscreen.shell(), offscreen, {});  // including the strip's pictures
    EXPECT_LE(difference(offscreen.picture(), io::read_png_rgb(drawn)), kSame)
        << drawn << " is old: scripts/tour draws it again";
    ++pictures;
  }
  EXPECT_EQ(pictures, 6);
}

TEST_F(Pictures, OfAStepDoNotDependOnThePathToIt) {
  Window straight, detour;
  straight.after({{"step.goto", "120"}, {"color.planes"}});
  detour.after({{"step.goto", "700"},
                {"color.labels"},
                {"select.node", "3"},
                {"step.goto", "121"},
                {"step.previous"},
                {"color.planes"}});
  // The lists below keep their own scroll position and unfolded rows.
  for (const char* panel : {"view3d", "image", "timeline", "inspector"})
    EXPECT_LE(difference(straight.panel(panel), detour.panel(panel)), kSame) << panel;
}

TEST_F(Pictures, OfAStepAreNotDrawnAsAWhole) {
  Window window;
  window.after({{"step.goto", "120"}});
  Screen& screen = window.offscreen.screen();
  for (int i = 0; i < 5; ++i) {
    window.offscreen.shell().perform({"step.next"}, true);
    window.offscreen.draw_frame();
    EXPECT_GT(screen.pixels_drawn(), 0);
    EXPECT_LT(screen.pixels_drawn(), 1280 * 800 / 2);
    settle(window.offscreen.shell(), window.offscreen, {});
    const Image8 in_parts = window.picture();
    window.offscreen.draw_frame();
    EXPECT_EQ(screen.pixels_drawn(), 0) << "nothing has changed";
    screen.forget();
    window.offscreen.draw_frame();
    EXPECT_EQ(screen.pixels_drawn(), 1280 * 800);
    EXPECT_EQ(difference(in_parts, window.picture()), 0);
  }
}

TEST_F(Pictures, ShowTheThemeAndTheStepInBothViews) {
  Window window;
  EXPECT_GT(difference(window.picture(), Window(render::Theme::light).picture()), 0.3);
  const Image8 scene = window.panel("view3d"), image = window.panel("image");
  window.after({{"step.goto", "3"}});
  EXPECT_GT(difference(scene, window.panel("view3d")), 0.05);
  EXPECT_GT(difference(image, window.panel("image")), 0.05);
}

TEST_F(Pictures, ShowTheMapWithAnySelection) {
  State state = open_walk(scratch_dir() / "walk", {.frames = 40});
  state.view.strip_stopped = true;
  Window window(std::move(state));
  window.after({{"map.make"}, {"frame.show", "4"}});
  const Image8 plain = window.panel("view3d");
  window.after({{"show.map"}});
  EXPECT_GT(difference(plain, window.panel("view3d")), 0.005);
}

TEST_F(Pictures, TheStripHasTheColorsOfTheReport) {
  const std::filesystem::path dir = scratch_dir(), walk = dir / "walk", out = dir / "report";
  State state = open_walk(walk, {.frames = 12});
  const testing_cli::Ran ran =
      testing_cli::run({"report", walk.string(), "--profile", "refined", "--classifier", "pca",
                        "--no-pictures", "-o", out.string()});
  ASSERT_EQ(ran.code, 0) << ran.err;
  Window window(std::move(state));
  const auto& strip = window.offscreen.shell().state().results.strip;
  const auto report = nlohmann::json::parse(testing_cli::read_text(out / "report.json"));
  const auto& frames = report.at("recordings").at(0).at("frames");
  ASSERT_EQ(frames.size(), strip.size());
  std::set<std::string> distinct;
  for (std::size_t i = 0; i < strip.size(); ++i) {
    std::vector<std::string> in_strip, in_report;
    for (const int color : strip[i].colors.planes->own_colors()) {
      const render::Rgba rgba = render::plane_color(color);
      in_strip.push_back(fmt::format("#{:02x}{:02x}{:02x}", rgba.r, rgba.g, rgba.b));
    }
    for (const auto& plane : frames[i].at("planes")) in_report.push_back(plane.at("color"));
    EXPECT_EQ(in_strip, in_report) << "frame " << i;
    distinct.insert(in_report.begin(), in_report.end());
  }
  EXPECT_GT(distinct.size(), 3u);
}

TEST_F(Pictures, ShowFootholdsStairsAndSteppablePlanes) {
  Window window;
  window.after(
      {{"option.set", "profile=refined"}, {"option.set", "foot_radius_m=0.08"}, {"color.planes"}});
  const Image8 plain = window.panel("view3d");
  for (const char* layer : {"show.foot", "show.stairs"}) {
    window.after({{layer, ""}});
    EXPECT_GT(difference(plain, window.panel("view3d")), 0.005) << layer;
    window.after({{layer, ""}});
    EXPECT_LT(difference(plain, window.panel("view3d")), 0.005) << layer;  // except for its button
  }
  const Image8 image = window.panel("image");
  window.after({{"color.steppable"}});
  EXPECT_GT(difference(plain, window.panel("view3d")), 0.1);
  EXPECT_GT(difference(image, window.panel("image")), 0.1);
}

/// Where points of the scene are drawn, as shares of the panel: pixels that differ without them.
struct Covered {
  double width = 0, height = 0;
};
Covered covered(Window& window) {
  window.after({{"color.planes"}});
  const Image8 with = window.panel("view3d");
  window.after({{"show.points"}, {"show.planes"}, {"show.names"}});
  const Image8 without = window.panel("view3d");
  int left = with.width, right = 0, top = with.height, bottom = 0;
  for (int y = 40; y < with.height; ++y)  // below the buttons
    for (int x = 0; x < with.width; ++x) {
      if (std::abs(with.at(x, y, 0) - without.at(x, y, 0)) < 25 &&
          std::abs(with.at(x, y, 1) - without.at(x, y, 1)) < 25)
        continue;
      left = std::min(left, x), right = std::max(right, x);
      top = std::min(top, y), bottom = std::max(bottom, y);
    }
  return {static_cast<double>(right - left) / with.width,
          static_cast<double>(bottom - top) / (with.height - 40)};
}

TEST_F(Pictures, ShowTheFrameAsLargeAsPossible) {
  for (const char* views : {"both", "scene"}) {
    Window window;
    window.after({{"views.show", views}});
    const Covered home = covered(window);
    EXPECT_GT(std::max(home.width, home.height), 0.85) << views;
    EXPECT_LT(std::max(home.width, home.height), 1) << views;
  }
}

TEST_F(Pictures, ShowOnlyAnIsolatedPlane) {
  Window window;
  window.after({{"color.planes"}, {"show.names"}, {"select.plane", "1"}});
  const Covered all = covered(window);
  window.after({{"show.points"}, {"isolate"}, {"show.points"}});
  const Image8 nothing = window.panel("view3d");
  window.after({{"show.points"}});
  const double alone = difference(nothing, window.panel("view3d"));
  window.after({{"isolate"}});
  EXPECT_GT(alone, 0.001);
  EXPECT_LT(alone, 0.7 * difference(nothing, window.panel("view3d")));
  EXPECT_GT(all.width, 0.3);
}

/// Whether the columns of two pictures are equal, below the buttons and badges.
bool same_columns(const Image8& a, const Image8& b, int from, int to) {
  std::size_t differing = 0;
  for (int y = 90; y < a.height - 4; ++y)
    for (int x = from; x < to; ++x)
      for (int c = 0; c < 3; ++c) differing += a.at(x, y, c) != b.at(x, y, c);
  return differing < 20;
}

TEST_F(Pictures, WipeFromAToB) {
  Window window;
  window.after({{"color.planes"}, {"run.pin"}, {"option.set", "profile=refined"}});
  for (const char* panel : {"view3d", "image"}) {
    const Image8 b = window.panel(panel);
    const Image8 a = window.after({{"run.flash"}}).panel(panel);
    ASSERT_GT(difference(a, b), 0.01);
    window.after({{"run.flash"}, {"run.wiper"}});
    const Image8 both = window.panel(panel);
    const int middle = both.width / 2;
    EXPECT_TRUE(same_columns(both, a, 8, middle - 12)) << panel;
    EXPECT_TRUE(same_columns(both, b, middle + 12, both.width - 8)) << panel;
    window.after({{"run.wiper"}});
  }
}

/// Color of the bar's pixel for a value.
std::array<int, 3> on_bar(const Image8& bar, const render::ValueRange& range, double value_m) {
  const double share = (value_m - range.low_m) / (range.high_m - range.low_m);
  const int x = std::clamp(static_cast<int>(share * bar.width), 0, bar.width - 1);
  return {bar.at(x, bar.height / 2, 0), bar.at(x, bar.height / 2, 1), bar.at(x, bar.height / 2, 2)};
}

TEST_F(Pictures, HaveTheColorsOfTheBarForTheValuesOfPoints) {
  for (const render::Theme theme : {render::Theme::dark, render::Theme::light}) {
    Window window(theme);
    window.after({{"color.depth"},
                  {"show.planes"},
                  {"show.names"},
                  {"views.show", "image"},
                  {"image.opacity", "1"}});
    const Shell& shell = window.offscreen.shell();
    const debug::Run& run = *shell.state().run();
    const Image8 bar = part_of(window.picture(), shell.widgets().at("scale.bar"));
    const Image8 image = part_of(window.picture(), shell.widgets().at("image"));
    const Image16& depth = run.subject->frame.depth;
    const render::ValueRange range = render::color_scale(run, look_of(shell.state())).range;
    // The nearest and farthest visible pixels, and some between.
    int compared = 0;
    for (int v = depth.height / 2; v < depth.height; v += 31)
      for (int u = 20; u < depth.width - 20; u += 37) {
        const std::uint32_t voxel =
            run.subject->voxel_of_source(static_cast<std::size_t>(v) * depth.width + u);
        if (voxel == planes::kNoVoxel) continue;
        const double measured_m = depth.at(u, v) * run.subject->frame.depth_unit_m;
        const auto expected = on_bar(bar, range, measured_m);
        const int x = (2 * u + 1) * image.width / (2 * depth.width);
        const int y = (2 * v + 1) * image.height / (2 * depth.height);
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(image.at(x, y, c), expected[static_cast<std::size_t>(c)], 24)
              << u << "," << v << ": " << measured_m << " m";
        ++compared;
      }
    EXPECT_GT(compared, 40);
    EXPECT_GT(on_bar(bar, range, range.low_m)[1], 200) << "near is bright";
    EXPECT_LT(on_bar(bar, range, range.high_m)[1], 60);
  }
}

TEST_F(Pictures, OfColorScalesHaveTheirBarInEveryView) {
  Window window;
  for (const char* views : {"both", "scene", "image"})
    for (const char* color : {"depth", "height", "rms", "distance"}) {
      window.after({{std::string("color.") + color, ""}, {"views.show", views}});
      EXPECT_TRUE(window.offscreen.shell().widgets().contains("scale.bar")) << color << views;
    }
  window.after({{"color.planes"}});
  EXPECT_FALSE(window.offscreen.shell().widgets().contains("scale.bar"));
  window.after({{"option.set", "gravity=none"}, {"color.height"}});
  EXPECT_FALSE(window.offscreen.shell().widgets().contains("scale.bar"));
  EXPECT_TRUE(window.offscreen.shell().widgets().contains("scale.absent"));
}

TEST_F(Pictures, OfTheWindowAreSavedAsDisplayed) {
  const std::filesystem::path dir = scratch_dir(), saved = dir / "a.png";
  Window window;
  window.offscreen.shell().show_message("", false);
  const Image8 shown = window.after({{"color.height"}, {"step.goto", "90"}}).picture();
  window.after({{"picture.save", saved.string()}});
  EXPECT_EQ(window.offscreen.shell().state().view.message, "picture written to " + saved.string());
  EXPECT_LE(difference(shown, io::read_png_rgb(saved)), kSame);
  EXPECT_THROW(window.after({{"picture.save", "a.jpg"}}), Error);
  window.after({{"picture.save", (dir / "none" / "a.png").string()}});
  EXPECT_TRUE(window.offscreen.shell().state().view.message_is_error);
  EXPECT_TRUE(has(window.offscreen.shell().state().view.message, "none"));
}

TEST_F(Pictures, OfSmallerPointsShowMoreBackground) {
  Window window;
  window.after({{"show.planes"}, {"show.names"}, {"show.points"}});
  const Image8 ground = window.panel("view3d");
  window.after({{"show.points"}});
  const double covered = difference(ground, window.panel("view3d"));
  double before = covered;
  for (int i = 0; i < 3; ++i) {
    const double less =
        difference(ground, window.after({{"points.smaller"}, {"points.smaller"}}).panel("view3d"));
    EXPECT_LT(less, before - 0.005);
    before = less;
  }
  for (int i = 0; i < 6; ++i) window.after({{"points.larger"}});
  EXPECT_NEAR(difference(ground, window.panel("view3d")), covered, 0.001);
  for (int i = 0; i < 40; ++i) window.after({{"points.larger"}});
  EXPECT_EQ(window.offscreen.shell().state().view.point_size, kMostPointSize);
}

TEST_F(Pictures, OfANewFrameHaveNoBoxesQueueOrHighlights) {
  for (const render::Theme theme : {render::Theme::dark, render::Theme::light}) {
    Window window(theme);
    const Image8 first = window.panel("view3d"), image = window.panel("image");
    window.after({{"show.settled"}});
    EXPECT_GT(difference(first, window.panel("view3d")), 0.02)
        << "boxes are seen where switched on";
    window.after({{"show.settled"}, {"step.goto", "100"}});
    EXPECT_GT(difference(first, window.panel("view3d")), 0.02) << "so is what a step is about";
    window.after({{"step.last"}, {"select.none"}});
    EXPECT_LE(difference(first, window.panel("view3d")), kSame);
    EXPECT_LE(difference(image, window.panel("image")), kSame);
  }
}

TEST_F(Pictures, OfStepsAreSavedAsAnAnimationThatStartsAtTheFirst) {
  const std::filesystem::path dir = scratch_dir(), single = dir / "a.png", steps = dir / "b c.png";
  Window window;
  window.offscreen.shell().show_message("", false);
  window.after({{"step.goto", "40"}, {"picture.save", single.string()}});
  window.after({{"steps.save", steps.string() + " 40-75 10 20"}});
  EXPECT_EQ(window.offscreen.shell().state().view.message, "5 steps written to " + steps.string());
  EXPECT_EQ(window.offscreen.shell().state().view.step, 75);
  const test::Apng apng = test::read_apng(steps);
  EXPECT_EQ(apng.frame_count, 5);  // 40, 50, 60, 70, 75
  EXPECT_EQ(apng.frames_per_second, 20);
  ASSERT_EQ(apng.frames.size(), 5U);
  EXPECT_EQ(difference(apng.frames[0], io::read_png_rgb(single)), 0);
  window.offscreen.shell().show_message("", false);
  window.after({{"step.goto", "70"}, {"picture.save", single.string()}});
  EXPECT_LE(difference(apng.frames[3], io::read_png_rgb(single)), kSame);
  EXPECT_GT(difference(apng.frames[0], apng.frames[3]), 0.005);
}

TEST_F(Pictures, OfCanceledStepsLeaveNoFile) {
  const std::filesystem::path dir = scratch_dir(), steps = dir / "steps.png";
  Window window;
  Shell& shell = window.offscreen.shell();
  shell.perform({"steps.save", steps.string() + " 0-300 1"}, true);
  for (int i = 0; i < 4; ++i) window.offscreen.draw_frame();
  ASSERT_TRUE(shell.state().view.saving);
  EXPECT_TRUE(shell.widgets().contains("status.message"));
  EXPECT_THROW(shell.perform({"steps.save", steps.string()}, true), Error) << "one at a time";
  for (const bool down : {true, false})
    shell.input().push({.type = InputEvent::Type::key, .down = down, .key = Key::escape});
  settle(shell, window.offscreen, {});
  EXPECT_FALSE(shell.state().view.saving);
  EXPECT_TRUE(std::filesystem::is_empty(dir));
  for (const std::string to : {"/nowhere/a.png", "a.gif", ""}) {
    shell.perform({"steps.save", to.empty() ? (dir / "").string() : to});
    settle(shell, window.offscreen, {});
    EXPECT_TRUE(shell.state().view.message_is_error) << to;
    EXPECT_FALSE(shell.state().view.saving);
  }
  EXPECT_TRUE(std::filesystem::is_empty(dir));
}

TEST_F(Pictures, OfAScriptCanShowASinglePanel) {
  Window window;
  const std::filesystem::path drawn = scratch_dir() / "a.png";
  window.play(fmt::format(R"({{"screenshot": "{}", "of": "panel.view3d"}})", drawn.string()));
  EXPECT_LE(difference(window.panel("view3d"), io::read_png_rgb(drawn)), kSame);
  EXPECT_THROW(window.play(R"({"screenshot": "b.png", "of": "panel.view3"})"), Error);
}

TEST_F(Pictures, AClickInTheSceneSelectsTheVisibleObject) {
  Window window;
  const Selection& selected = window.offscreen.shell().state().view.selected;
  window.play(R"({"click": "view3d", "at": [0.5, 0.6]})");
  EXPECT_GE(selected.voxel, 0);
  EXPECT_GE(selected.node, 0);
  window.play(R"({"click": "view3d", "at": [0.99, 0.02]})");
  EXPECT_EQ(selected.voxel, -1);
}

}  // namespace
}  // namespace planescope::desktop
