// Recently opened recordings, and recordings dropped on the window.

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/desktop/state/session.hpp"
#include "core/model/error.hpp"
#include "desktop_fixture.hpp"

namespace planescope::desktop {
namespace {

namespace fs = std::filesystem;

fs::path copy_of_sample(const fs::path& to) {
  fs::create_directories(to.parent_path());
  fs::copy(sample_path(), to, fs::copy_options::recursive);
  return to;
}

std::vector<std::string> offered(const State& state, const std::string& typed) {
  std::vector<std::string> titles;
  for (const Offer& offer : palette_offers(state, typed))
    if (offer.action->name == "recording.open" && !offer.argument.empty())
      titles.push_back(offer.title);
  return titles;
}

TEST(Recent, RecordingsAreListedLatestFirstWithoutDuplicatesUpToTen) {
  Document document;
  for (int i = 0; i < 14; ++i) note_recent(document, fmt::format("/data/{}.bag", i));
  EXPECT_EQ(document.recent.size(), 10u);
  EXPECT_EQ(document.recent.front(), "/data/13.bag");
  EXPECT_EQ(document.recent.back(), "/data/4.bag");
  note_recent(document, "/data/here/../7.bag");  // in any spelling
  EXPECT_EQ(document.recent.size(), 10u);
  EXPECT_EQ(document.recent.front(), "/data/7.bag");
  note_recent(document, "/data/7.bag/");
  EXPECT_EQ(document.recent.size(), 10u);
}

TEST(Recent, RecordingsAreOfferedByNameInThePalette) {
  const fs::path dir = scratch_dir();
  State state = open_state();
  apply(state, {"recording.open", copy_of_sample(dir / "lost tread").string()});
  apply(state, {"recording.open", copy_of_sample(dir / "block").string()});
  EXPECT_EQ(offered(state, "recent"),
            (std::vector<std::string>{"Open recent: block", "Open recent: lost tread"}));
  EXPECT_EQ(offered(state, "tread"), (std::vector<std::string>{"Open recent: lost tread"}));
  const Offer first = palette_offers(state, "recent lost").front();
  EXPECT_EQ(first.argument, (dir / "lost tread").string());
}

TEST(Recent, MissingRecordingsAreRemovedWithAMessage) {
  const fs::path dir = scratch_dir();
  State state = open_state();
  note_recent(state.document, dir / "gone.bag");
  try {
    apply(state, {"recording.open", (dir / "gone.bag").string()});
    FAIL() << "it is not there";
  } catch (const Error& error) {
    const std::string message = error.what();
    EXPECT_TRUE(has(message, "gone.bag"));
    EXPECT_TRUE(has(message, "removed from the recent recordings"));
    EXPECT_FALSE(has(message, "\n"));
  }
  EXPECT_TRUE(state.document.recent.empty());
  EXPECT_EQ(state.document.recordings.size(), 1u);
}

TEST_F(OpenDesktop, TheOpenDialogListsRecentRecordingsAndAClickOpensOne) {
  const fs::path other = copy_of_sample(dir / "other");
  for (const char* name : {"other", "gone"})
    shell.perform({"recording.open", (dir / name).string()});
  shell.perform({"recording.show", "0"});
  play(R"({"key": "Ctrl+O"}, {"click": "palette.recent.0"})");
  EXPECT_FALSE(state().view.show_palette) << "it could take that";
  EXPECT_EQ(state().document.recording, 1);
  EXPECT_FALSE(shown("palette.recent.0"));
  play(R"({"key": "Ctrl+O"}, {"type": "/"})");
  EXPECT_FALSE(shown("palette.recent.0")) << "paths are completed now";
}

TEST_F(OpenDesktop, DroppedFilesAreOpened) {
  const fs::path other = copy_of_sample(dir / "other");
  play(fmt::format(R"({{"drop": "{0}"}}, {{"expect": {{"recording": "{0}"}}}})", other.string()));
  ASSERT_EQ(state().document.recordings.size(), 2u);
  EXPECT_EQ(state().document.recent.front(), other);
  shell.perform({"session.save", (dir / "s.json").string()}, true);
  shell.perform({"recording.show", "0"}, true);
  play(fmt::format(R"({{"drop": "{}"}})", (dir / "s.json").string()));
  EXPECT_EQ(state().document.current()->path.filename(), "other");
  shell.drop((dir / "nothing.bag").string());
  EXPECT_TRUE(state().view.message_is_error);
  EXPECT_TRUE(has(state().view.message, "nothing.bag"));
}

}  // namespace
}  // namespace planescope::desktop
