// The whole window, drawn without a display.

#include <fstream>
#include <nlohmann/json.hpp>

#include "app/desktop/offscreen.hpp"
#include "core/base/error.hpp"
#include "core/image/png.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

/// Share of the pixels in which two pictures differ.
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

struct Pictures : testing::Test {
  Image8 picture_of(Theme theme, const std::vector<Command>& commands) {
    State state = open_state();
    state.view.theme = theme;
    Offscreen offscreen(std::move(state), 1280, 800, 1);
    settle(offscreen.shell(), offscreen, {});
    for (const Command& command : commands) {
      offscreen.shell().perform(command, true);
      settle(offscreen.shell(), offscreen, {});
    }
    return offscreen.picture();
  }
};

TEST_F(Pictures, OfTheSameScriptAreTheSame) {
  const std::vector<Command> there = {{"step.goto", "120"}, {"color.planes", ""}};
  const std::vector<Command> by_a_detour = {{"step.goto", "700"},  {"color.labels", ""},
                                            {"select.node", "3"},  {"step.goto", "121"},
                                            {"step.previous", ""}, {"color.planes", ""}};
  const Image8 a = picture_of(Theme::dark, there);
  EXPECT_LE(difference(a, picture_of(Theme::dark, there)), 0.0005);
  EXPECT_LE(difference(a, picture_of(Theme::dark, by_a_detour)), 0.0005);
  EXPECT_GT(difference(a, picture_of(Theme::light, there)), 0.3);
}

TEST_F(Pictures, ShowTheStepInBothViews) {
  State state = open_state();
  Offscreen offscreen(std::move(state), 1280, 800, 1);
  settle(offscreen.shell(), offscreen, {});
  const auto part = [&](const char* panel) {
    const WidgetRect rect = offscreen.shell().widgets().at(std::string("panel.") + panel);
    const Image8 whole = offscreen.picture();
    Image8 cut(static_cast<int>(rect.max.x - rect.min.x), static_cast<int>(rect.max.y - rect.min.y),
               3);
    for (int y = 0; y < cut.height; ++y)
      for (int x = 0; x < cut.width; ++x)
        for (int c = 0; c < 3; ++c)
          cut.at(x, y, c) =
              whole.at(x + static_cast<int>(rect.min.x), y + static_cast<int>(rect.min.y), c);
    return cut;
  };
  const Image8 scene = part("view3d"), image = part("image");
  offscreen.shell().perform({"step.goto", "3"}, true);
  settle(offscreen.shell(), offscreen, {});
  EXPECT_GT(difference(scene, part("view3d")), 0.05);
  EXPECT_GT(difference(image, part("image")), 0.05);
}

TEST_F(Pictures, AClickInTheSceneSelectsWhatIsThere) {
  State state = open_state();
  Offscreen offscreen(std::move(state), 1280, 800, 1);
  settle(offscreen.shell(), offscreen, {});
  const std::filesystem::path path = scratch_dir() / "script.json";
  std::ofstream(path) << R"({"actions": [{"click": "view3d", "at": [0.5, 0.6]}]})";
  Script::read(path).play(offscreen.shell(), offscreen, {});
  const Selection selected = offscreen.shell().state().view.selected;
  EXPECT_GE(selected.voxel, 0);
  EXPECT_GE(selected.node, 0);
  std::ofstream(path) << R"({"actions": [{"click": "view3d", "at": [0.99, 0.02]}]})";
  Script::read(path).play(offscreen.shell(), offscreen, {});
  EXPECT_EQ(offscreen.shell().state().view.selected.voxel, -1);
}

}  // namespace
}  // namespace planescope::desktop
