#include "app/desktop/script.hpp"

#include <fstream>

#include "core/model/error.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

struct Scripts : testing::Test {
  Shell shell{open_state(), nullptr, [] {}};
  NoStage stage{shell};

  void play(const std::string& actions) {
    const auto path = std::filesystem::path(scratch_dir()) / "script.json";
    std::ofstream(path) << actions;
    Script::read(path).play(shell, stage, {});
  }
  std::string refusal(const std::string& actions) {
    try {
      play(actions);
    } catch (const Error& error) {
      return error.what();
    }
    return "";
  }
};

TEST_F(Scripts, DoActionsAndExpectFacts) {
  settle(shell, stage, {});
  play(R"({"actions": ["step.first", {"do": "step.next"}, {"expect": {"step": 1}}]})");
  EXPECT_THROW(play(R"({"actions": [{"expect": {"step": 7}}]})"), ExpectationFailed);
}

TEST_F(Scripts, PressKeysAndTypeText) {
  settle(shell, stage, {});
  play(R"({"actions": [{"key": "Home"}, {"key": "Right"}, {"key": "Right"},
                       {"expect": {"step": 2}}, {"key": "Ctrl+P"}, {"type": "to the end"},
                       {"key": "Enter"}]})");
  EXPECT_EQ(shell.state().view.step, shell.state().run()->steps());
  EXPECT_FALSE(shell.state().view.show_palette);
}

TEST_F(Scripts, AKeyWhoseActionNeedsAnArgumentAsksForIt) {
  settle(shell, stage, {});
  play(
      R"({"actions": [{"key": "G"}, {"type": "17"}, {"key": "Enter"}, {"expect": {"step": 17}}]})");
  EXPECT_FALSE(shell.state().view.show_palette);
  EXPECT_NE(refusal(R"({"actions": ["step.goto"]})"), "") << "a script has nobody to ask";
}

TEST_F(Scripts, ThatAreWrongNameTheActionAndWhatIsNear) {
  settle(shell, stage, {});
  EXPECT_NE(refusal(R"({"actions": ["step.nxt"]})").find("step.next"), std::string::npos);
  EXPECT_NE(
      refusal(R"({"actions": ["step.next", {"click": "tab.histogram"}]})").find("tab.histograms"),
      std::string::npos);
  EXPECT_NE(refusal(R"({"actions": ["step.next", {"click": "x"}]})").find("action 2"),
            std::string::npos);
  EXPECT_NE(refusal(R"({"actions": [{"expect": {"stop": 7}}]})"), "");
  EXPECT_NE(refusal(R"({"actions": [{"dance": 1}]})"), "");
  EXPECT_NE(refusal(R"({"actions": [{"key": "Hyper"}]})"), "");
  EXPECT_NE(refusal(R"({"actions": {}})"), "");
  EXPECT_NE(refusal("{"), "");
}

}  // namespace
}  // namespace planescope::desktop
