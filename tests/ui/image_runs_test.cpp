// The debugger on a depth image whose planes are found on pixels: every tab, at every kind of
// event.

#include "app/desktop/panels.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct ImageRuns : OpenDesktop {
  ImageRuns() : OpenDesktop(opened()) {}
  static State opened() {
    State state = RefinedDesktop::opened();
    // so that some planes are not listed
    state.document.options.segment.objective.worth_px = 14000;
    return state;
  }
};

TEST_F(ImageRuns, EveryTabShowsEveryKindOfEvent) {
  ASSERT_TRUE(state().run());
  ASSERT_TRUE(state().run()->is_on_image());
  for (const char* filter : {"visit", "case==I", "case==II", "case==IV", "found", "stage==join",
                             "stage==grow", "stage==list"}) {
    play(fmt::format(R"("step.first", "filter.set {}", "filter.next")", filter));
    ASSERT_GT(state().view.step, 0) << filter;
    for (const Tab& tab : kInspectorTabs) play(fmt::format(R"("tab.inspector {}")", tab.name));
    play(R"("tab.inspector inspector", "tab.tool compare", "tab.tool histograms")");
  }
}

TEST_F(ImageRuns, APixelShowsItsHistoryAtEveryStep) {
  for (const char* step : {"0", "100", "1000", "2000"})
    play(fmt::format(R"("step.goto {}", {}, "tab.inspector point", "point.life")", step,
                     click_on("320,400")));
  EXPECT_GE(state().view.selected.voxel, 0);
}

TEST_F(ImageRuns, AJoinShowsItsCostAndTheOptionOfItsThreshold) {
  play(R"("filter.set stage==join", "step.first", "filter.next", "tab.inspector inspector")");
  const planes::TraceEvent& event = *state().event();
  const std::string into = debug::plane_name(*state().run(), event.other);
  EXPECT_TRUE(shown("inspector.partner." + into));
}

}  // namespace
}  // namespace planescope::desktop
