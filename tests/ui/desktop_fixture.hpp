#pragma once

// A desktop with the sample recording: only its state, or the whole shell without a window, in the
// debugger or in label mode with the test's own label folder.

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/script.hpp"
#include "app/desktop/shell.hpp"
#include "core/lab/synthetic/sample.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/model/label_files.hpp"
#include "support/has.hpp"

namespace planescope::desktop {

inline std::filesystem::path sample_path() {
  return std::filesystem::path(PLANESCOPE_SOURCE_DIR) / "assets" / "sample";
}

/// A copy of the sample's labels that tests may change, removed when the process ends.
inline std::filesystem::path sample_labels() {
  namespace fs = std::filesystem;
  struct Copy {
    const fs::path dir =
        fs::path(testing::TempDir()) / ("planescope_sample_labels." + std::to_string(::getpid()));
    Copy() {
      fs::remove_all(dir);  // left by a killed process
      fs::copy(labels::default_label_dir(sample_path()), dir);
    }
    ~Copy() {
      std::error_code gone;
      fs::remove_all(dir, gone);
    }
  };
  static const Copy copy;
  return copy.dir;
}

/// A state with the sample open, before any run.
inline State open_state(planes::Profile profile = planes::Profile::paper) {
  State state;
  state.document.options.segment = planes::profile_options(profile);
  state.document.options.classifier = "pca";  // faster than the network under a sanitizer
  state.document.recordings.push_back(
      {sample_path(), io::open_recording(sample_path(), {}), sample_labels()});
  state.document.recording = 0;
  return state;
}

/// A state with all results that jobs would deliver for the frame.
inline State run_state(planes::Profile profile = planes::Profile::paper) {
  State state = open_state(profile);
  const io::Recording& recording = *state.document.current()->recording;
  Frame frame = recording.frame(0);
  auto truth =
      labels::frame_truth(frame, state.document.current()->label_dir, recording.frame_hash(0));
  const auto classifier = planes::make_pca_classifier();
  auto view = std::make_shared<RunView>();
  view->run = debug::make_run(debug::make_subject(std::move(frame), std::move(truth),
                                                  state.document.options, classifier.get()),
                              state.document.options);
  view->score =
      debug::quick_score(view->run->segmentation.plane_of, view->run->subject->voxel_truth);
  state.results.current = view;
  state.view.step = 0;
  return state;
}

/// Writes a synthetic walk and opens it: small frames without color images.
inline State open_walk(const std::filesystem::path& to, lab::SequenceOptions options) {
  options.width = 160;
  options.height = 120;
  options.color = false;
  lab::write_sequence(to, options, 2);
  State state = open_state(planes::Profile::refined);
  state.document.recordings[0] = {to, io::open_recording(to, {}), to.string() + ".none"};
  return state;
}

/// A stage that draws nothing.
class NoStage : public Stage {
 public:
  NoStage(Shell& shell, int width = 1440, int height = 900)
      : shell_(shell), width_(width), height_(height) {}
  void draw_frame() override { shell_.frame(width_, height_, 1, 1.0 / 60); }
  Image8 picture() override { return Image8(1, 1, 3); }

 private:
  Shell& shell_;
  int width_, height_;
};

inline std::filesystem::path scratch_dir() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const std::filesystem::path dir = std::filesystem::path(testing::TempDir()) / "planescope_ui" /
                                    (std::string(test->test_suite_name()) + "." + test->name());
  std::filesystem::remove_all(dir);
  std::filesystem::create_directories(dir);
  return dir;
}

/// `actions`: elements of a script's list. `dir`: folder for the script.
inline void play_actions(Shell& shell,
                         Stage& stage,
                         const std::filesystem::path& dir,
                         const std::string& actions) {
  const std::filesystem::path path = dir / "script.json";
  std::ofstream(path) << R"({"actions": [)" << actions << "]}";
  Script::read(path).play(shell, stage, {});
}

/// A window that is not drawn.
struct Desk {
  Shell shell;
  NoStage stage{shell};

  explicit Desk(State opened) : shell(std::move(opened), nullptr, [] {}) {}
  const State& state() const { return shell.state(); }
  const std::string& message() const { return state().view.message; }
  bool shown(const std::string& widget) const { return shell.widgets().contains(widget); }
  void rest(bool background = true) { settle(shell, stage, {}, background); }
  /// Performs an action like a key or a click: errors appear in the status bar.
  void perform(const std::string& action, const std::string& argument = {}) {
    shell.perform({action, argument});
    rest();
  }
  /// Performs an action like a script: errors are thrown.
  void run(const std::string& action, const std::string& argument = {}) {
    shell.perform({action, argument}, true);
    rest();
  }
};

/// Opens the sample, or another recording, and runs it.
struct OpenDesktop : testing::Test, Desk {
  const std::filesystem::path dir = scratch_dir();

  explicit OpenDesktop(State opened = open_state()) : Desk(std::move(opened)) {}
  void SetUp() override { rest(); }
  void play(const std::string& actions) { play_actions(shell, stage, dir, actions); }
};

/// The same, with the profile that finds all planes of the sample.
struct RefinedDesktop : OpenDesktop {
  RefinedDesktop() : OpenDesktop(opened()) {}
  static State opened() {
    State state = open_state(planes::Profile::refined);
    state.view.tool_tab = "histograms";  // has no sensitivity curves at sliders
    return state;
  }
};

/// A script step: a mouse click on pixel "U,V" of the sample's image.
inline std::string click_on(const std::string& pixel) {
  const auto comma = pixel.find(',');
  return fmt::format(R"({{"click": "image", "at": [{}, {}]}})",
                     (std::stod(pixel.substr(0, comma)) + 0.5) / 640,
                     (std::stod(pixel.substr(comma + 1)) + 0.5) / 480);
}

inline State open_state_with_labels(const std::filesystem::path& label_dir,
                                    const std::filesystem::path& recording = sample_path()) {
  State state = open_state(planes::Profile::refined);
  state.document.recordings[0] = {recording, io::open_recording(recording, {}), label_dir};
  return state;
}

/// A window in label mode.
struct LabelWindow : Desk {
  explicit LabelWindow(const std::filesystem::path& label_dir,
                       const std::filesystem::path& recording = sample_path())
      : Desk(open_state_with_labels(label_dir, recording)) {
    finish();
    run("label.mode");
  }
  const FrameLabels& labels() const { return *state().labels(); }
  const labels::LabelStore& store() const { return *state().document.current()->labels; }
  void run(const std::string& action, const std::string& argument = {}) {
    shell.perform({action, argument}, true);
    finish();
  }
  std::string refusal(const std::string& action, const std::string& argument = {}) {
    shell.perform({action, argument});
    finish();
    return state().view.message_is_error ? state().view.message : "";
  }
  /// Waits for all jobs except background jobs (thumbnails, curves at sliders).
  void finish() { rest(/*background=*/false); }
  bool shows(const std::string& widget) const { return shown(widget); }
};

struct LabelDesktop : testing::Test {
  const std::filesystem::path dir = scratch_dir();
  const std::filesystem::path label_dir = dir / "labels";
  LabelWindow window;

  /// `recording` receives the test's folder.
  explicit LabelDesktop(std::filesystem::path (*recording)(const std::filesystem::path&) =
                            [](const std::filesystem::path&) { return sample_path(); })
      : window(label_dir, recording(dir)) {}

  const State& state() const { return window.state(); }
  const LabelView& view() const { return state().view.label; }
  const FrameLabels& labels() const { return window.labels(); }
  const labels::LabelStore& store() const { return window.store(); }
  const LabelPlane* find(int plane) const { return labels::find_plane(labels(), plane); }
  std::size_t pixels_of(int plane) const { return labels::pixels_of_plane(labels(), plane).size(); }
  void play(const std::string& actions) { play_actions(window.shell, window.stage, dir, actions); }
  void choose(int plane) { window.run("label.plane", std::to_string(plane)); }
  /// A copy of the labels' current folder, for another window.
  std::filesystem::path copy_of_labels() const {
    std::filesystem::copy(label_dir, dir / "copy", std::filesystem::copy_options::recursive);
    return dir / "copy";
  }
};

}  // namespace planescope::desktop
