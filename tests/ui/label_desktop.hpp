#pragma once

// The label mode on the sample, with labels in a folder of the test's own.

#include "core/labels/edit/operations.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {

inline State open_state_with_labels(const std::filesystem::path& label_dir,
                                    const std::filesystem::path& recording = sample_path()) {
  State state = open_state(planes::Profile::refined);
  state.document.recordings[0] = {recording, io::open_recording(recording, {}), label_dir};
  return state;
}

/// A window that is labelling; drawn nowhere.
struct LabelWindow {
  Shell shell;
  NoStage stage{shell};

  explicit LabelWindow(const std::filesystem::path& label_dir,
                       const std::filesystem::path& recording = sample_path())
      : shell(open_state_with_labels(label_dir, recording), nullptr, [] {}) {
    finish();
    run("label.mode");
  }
  const State& state() const { return shell.state(); }
  const FrameLabels& labels() const { return *state().labels(); }
  const labels::LabelStore& store() const { return *state().document.current()->labels; }
  /// Throws as the action does.
  void run(const std::string& action, const std::string& argument = {}) {
    shell.perform({action, argument}, true);
    finish();
  }
  std::string refusal(const std::string& action, const std::string& argument = {}) {
    shell.perform({action, argument});
    finish();
    return state().view.message_is_error ? state().view.message : "";
  }
  /// What was begun, but for what goes on in the background: thumbnails, curves along sliders.
  void finish() { settle(shell, stage, {}, /*background=*/false); }
  bool shows(const std::string& widget) const { return shell.widgets().contains(widget); }
};

struct LabelDesktop : testing::Test {
  const std::filesystem::path dir = scratch_dir();
  const std::filesystem::path label_dir = dir / "labels";
  LabelWindow window{label_dir};

  const State& state() const { return window.state(); }
  const FrameLabels& labels() const { return window.labels(); }
  /// `actions`: the elements of a script's list.
  void play(const std::string& actions) {
    const std::filesystem::path path = dir / "script.json";
    std::ofstream(path) << R"({"actions": [)" << actions << "]}";
    Script::read(path).play(window.shell, window.stage, {});
  }
  void choose(int plane) { window.run("label.plane", std::to_string(plane)); }
};

}  // namespace planescope::desktop
