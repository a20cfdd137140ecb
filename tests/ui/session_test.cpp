// Tests of sessions and window settings: saving, restoring and damaged files.

#include "app/desktop/state/session.hpp"

#include <fstream>

#include "core/model/error.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& path, const std::string& text) { std::ofstream(path) << text; }
std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

std::string refusal(State state, const std::string& where) {
  const int step = state.view.step;
  const auto recordings = state.document.recordings.size();
  try {
    open_session(state, where);
  } catch (const Error& error) {
    EXPECT_EQ(state.view.step, step);
    EXPECT_EQ(state.document.recordings.size(), recordings);
    return error.what();
  }
  return "";
}

TEST(Session, RestoresTheViewOnAnotherMachine) {
  const fs::path dir = scratch_dir();
  fs::create_directories(dir / "here");
  fs::create_directories(dir / "there");
  fs::copy(sample_path(), dir / "here" / "sample", fs::copy_options::recursive);
  State state = run_state();
  state.document.recordings[0].path = dir / "here" / "sample";
  apply(state, {"option.set", "theta_n_out=7"});
  apply(state, {"filter.set", "case==III"});
  apply(state, {"filter.next"});
  apply(state, {"break.on", "merge && offset>0.02"});
  apply(state, {"camera.set", "1,2,3,0,0,0"});
  apply(state, {"bookmark.add", "lost tread"});
  apply(state, {"bookmark.note", "0 why here"});
  apply(state, {"color.depth"});
  apply(state, {"color.range", "0.5,1.25"});
  save_session(state, dir / "here" / "s.json");

  fs::rename(dir / "here" / "sample", dir / "there" / "sample");
  fs::rename(dir / "here" / "s.json", dir / "there" / "s.json");
  State other;
  open_session(other, (dir / "there" / "s.json").string());
  EXPECT_EQ(other.document.options.segment.theta_n_out, 7);
  EXPECT_EQ(other.document.options.segment.profile, planes::Profile::paper);
  EXPECT_EQ(other.document.breakpoints.at(0).filter, "merge && offset>0.02");
  EXPECT_EQ(other.document.bookmarks.at(0).note, "why here");
  EXPECT_EQ(other.view.search.text, "case==III");
  EXPECT_EQ(other.view.color_by, render::ColorBy::depth);
  EXPECT_EQ(other.view.range, (render::ValueRange{0.5, 1.25}));
  ASSERT_TRUE(other.view.arrival);
  EXPECT_EQ(other.view.arrival->step, state.view.step);
  EXPECT_EQ(other.view.camera->eye, Vec3d(1, 2, 3));

  State at_bookmark;
  open_session(at_bookmark, (dir / "there" / "s.json").string() + "#lost tread");
  EXPECT_EQ(at_bookmark.view.arrival->name, "lost tread");
  EXPECT_TRUE(has(refusal(run_state(), (dir / "there" / "s.json").string() + "#none"), "none"));
}

TEST(Session, FollowsItsFramesWhenOneIsRemovedFromTheRecording) {
  const fs::path dir = scratch_dir();
  fs::copy(sample_path(), dir / "sample", fs::copy_options::recursive);
  State state = run_state();
  state.document.recordings[0].path = dir / "sample";
  apply(state, {"frame.show", "0"});
  apply(state, {"bookmark.add", "gone"});
  apply(state, {"frame.show", "2"});
  apply(state, {"bookmark.add", "kept"});
  save_session(state, dir / "s.json");
  fs::remove(dir / "sample" / "depth" / "000000.png");

  State other;
  open_session(other, (dir / "s.json").string());
  EXPECT_EQ(other.document.frame, 1);
  EXPECT_EQ(other.document.bookmarks.at(1).frame, 1);
  EXPECT_TRUE(
      has(refusal(run_state(), (dir / "s.json").string() + "#gone"), "refers to a removed frame"));
}

TEST(Session, KeepsProjectionAndCameras) {
  const fs::path dir = scratch_dir();
  State state = run_state();
  apply(state, {"camera.orthographic"});
  apply(state, {"camera.top"});
  apply(state, {"bookmark.add", "from above"});
  apply(state, {"camera.set", "1,2,3,0,0,0"});
  apply(state, {"camera.orthographic"});
  save_session(state, dir / "s.json");
  const auto opened = [&](const std::string& place) {
    State other;
    open_session(other, (dir / "s.json").string() + place);
    return other.view;
  };
  EXPECT_FALSE(opened("").orthographic);
  EXPECT_TRUE(opened("").camera);
  const ViewState above = opened("#from above");
  EXPECT_TRUE(above.orthographic);
  EXPECT_EQ(above.facing, Facing::top);
  EXPECT_FALSE(above.camera) << "it goes on to fill the view at every shape of it";
  apply(state, {"bookmark.go", "from above"});
  EXPECT_TRUE(state.view.orthographic);
  EXPECT_FALSE(state.view.camera);
}

TEST(Session, RestoresTheSelectedPlane) {
  const fs::path dir = scratch_dir();
  State state = run_state(planes::Profile::refined);
  const debug::Timeline& timeline = state.run()->timeline;
  std::int32_t place = 0;  // of a plane whose id does not follow from its position
  while (timeline.number_of_plane(place) == place + 1) ++place;
  const std::int32_t number = timeline.number_of_plane(place);
  apply(state, {"step.last"});
  apply(state, {"select.plane", fmt::format("P{}", number)});
  save_session(state, dir / "s.json");
  EXPECT_TRUE(has(text_of(dir / "s.json"), fmt::format("\"plane\": {},", number)));
  Desk desk(std::move(state));
  desk.shell.perform({"session.open", (dir / "s.json").string()}, true);
  desk.rest(/*background=*/false);
  const State& now = desk.state();
  ASSERT_TRUE(now.run());
  ASSERT_GE(now.view.selected.plane, 0);
  EXPECT_EQ(now.run()->timeline.number_of_plane(now.view.selected.plane), number);
}

TEST(Session, ThatIsDamagedIsRejectedInOneLineAndChangesNothing) {
  const fs::path dir = scratch_dir();
  const State state = run_state();
  save_session(state, dir / "good.json");
  const std::string good = text_of(dir / "good.json");
  const auto bad = [&](const std::string& text) {
    write(dir / "bad.json", text);
    const std::string message = refusal(state, (dir / "bad.json").string());
    EXPECT_TRUE(has(message, "bad.json"));
    EXPECT_FALSE(has(message, "\n"));
  };
  bad("");
  bad("{");
  bad("[1, 2]");
  bad(R"({"schema": "something else"})");
  bad(good.substr(0, good.size() / 2));
  std::string old = good;
  old.replace(old.find("session/2"), 9, "session/1");
  bad(old);
  EXPECT_EQ(refusal(state, (dir / "bad.json").string()),
            (dir / "bad.json").string() +
                ": planescope.session/1 is no longer supported; expected planescope.session/2");
  std::string no_cursor = good;
  no_cursor.replace(no_cursor.find("\"cursor\""), 8, "\"curser\"");
  bad(no_cursor);
  const std::size_t frame = good.find("\"frame\":");
  ASSERT_NE(frame, std::string::npos);
  const auto with_frame = [&](const std::string& value) {
    const std::size_t begin = frame + 8, end = good.find_first_of(",}\n", begin);
    return good.substr(0, begin) + value + good.substr(end);
  };
  bad(with_frame("4294967296"));  // 0 in the lowest 32 bits
  bad(with_frame("0.5"));
  bad(with_frame("99999999999999999999"));
  EXPECT_NE(refusal(state, (dir / "absent.json").string()), "");
}

TEST(Session, WithMissingTargetsKeepsTheCurrentPosition) {
  const fs::path dir = scratch_dir();
  State state = run_state();
  apply(state, {"bookmark.add", "far"});
  Bookmark& far = state.document.bookmarks[0];
  far.frame = 77;
  far.node = -5;
  state.view.truth_plane = 1 << 30;
  state.view.inspector_tab = "nonsense";
  state.document.marked = {0xfffffff0u};
  state.document.breakpoints = {{Breakpoint::Kind::node, "", -9},
                                {Breakpoint::Kind::point, "", 1 << 30}};
  state.view.step = 1 << 30;
  state.view.selected = {.node = 1 << 30, .plane = -7, .voxel = 1 << 30};
  save_session(state, dir / "s.json");
  EXPECT_TRUE(has(refusal(run_state(), (dir / "s.json").string() + "#far"), "77"));
  State flashing = run_state();
  apply(flashing, {"run.pin"});
  apply(flashing, {"run.flash"});
  Desk desk(std::move(flashing));
  desk.run("session.open", (dir / "s.json").string());
  ASSERT_TRUE(desk.state().run()) << desk.state().results.refusal;
  EXPECT_FALSE(desk.state().view.flash);
  EXPECT_EQ(desk.state().view.step, desk.state().run()->steps());
  EXPECT_EQ(desk.state().view.selected.node, -1);
  EXPECT_TRUE(desk.state().document.marked.empty());
  desk.shell.perform({"fix.search"}, true);
  EXPECT_FALSE(desk.state().results.fix.running);
  desk.shell.perform({"run.back"}, true);
}

TEST(Session, OfAnotherRecordingIsRejected) {
  const fs::path dir = scratch_dir();
  const State state = run_state();
  save_session(state, dir / "s.json");
  std::string text = text_of(dir / "s.json");
  const std::size_t at = text.find("frame_sha256\": \"") + 16;
  text[at] = text[at] == '0' ? '1' : '0';
  write(dir / "s.json", text);
  EXPECT_TRUE(has(refusal(state, (dir / "s.json").string()), "is not the session's recording"));
  const std::size_t path = text.find("\"path\": \"") + 9;
  text.replace(path, text.find('"', path) - path, "nowhere/at/all");
  write(dir / "s.json", text);
  EXPECT_TRUE(has(refusal(state, (dir / "s.json").string()), "nowhere/at/all"));
}

TEST(Session, ThatCannotBeWrittenLosesNothing) {
  const fs::path dir = scratch_dir();
  const State state = run_state();
  EXPECT_THROW(save_session(state, dir / "no" / "such" / "folder.json"), Error);
  save_session(state, dir / "s.json");
  const std::string before = text_of(dir / "s.json");
  fs::create_directory(dir / "s.json.part");  // the name of its temporary file is taken
  EXPECT_THROW(save_session(state, dir / "s.json"), Error);
  EXPECT_EQ(text_of(dir / "s.json"), before);
}

TEST(Settings, SurviveDamageAndAreRestored) {
  const fs::path dir = scratch_dir();
  setenv("XDG_STATE_HOME", dir.c_str(), 1);
  EXPECT_EQ(load_settings().width, Settings{}.width);
  Settings settings;
  settings.width = 1111;
  settings.last_recording = sample_path();
  settings.view.theme = render::Theme::light;
  settings.view.layout.left = 0.2;
  settings.view.color_by = render::ColorBy::distance;
  settings.view.step_unit = debug::StepUnit::node;
  settings.recent = {"/some/where", "/else/where"};
  save_settings(settings);
  const Settings back = load_settings();
  EXPECT_EQ(back.width, 1111);
  EXPECT_EQ(back.last_recording, sample_path());
  EXPECT_EQ(back.view.theme, render::Theme::light);
  EXPECT_EQ(back.view.layout.left, 0.2);
  EXPECT_EQ(back.view.color_by, render::ColorBy::distance);
  EXPECT_EQ(back.view.step_unit, debug::StepUnit::node);
  EXPECT_EQ(back.recent, settings.recent);
  write(settings_path(), "{\"schema\": 12");
  EXPECT_EQ(load_settings().width, Settings{}.width);
  unsetenv("XDG_STATE_HOME");
}

}  // namespace
}  // namespace planescope::desktop
