// External changes to a store's labels: other instances, changed files, a read-only folder or a
// full disk.

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <fstream>

#include "core/labels/model/label_files.hpp"
#include "core/model/file_bytes.hpp"
#include "random_labels.hpp"
#include "support/refusal.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFiles[] = {"000000.plane.png", "000000.hv.png", "000000.json"};

/// Frame 0 after three gestures, saved after the second.
struct Outside : LabelStores {
  FrameLabels saved, latest, others;

  void SetUp() override {
    random = Random(21);
    LabelStore store(dir, by("ann"));
    store.open(0, blank(0));
    gesture(store, 0, random);
    gesture(store, 0, random);
    store.save(0);
    saved = *store.labels(0);
    latest = saved;
    latest.planes.push_back(LabelPlane{.id = 100});  // changes all three files
    latest.plane.data[40] = 100;
    latest.hv.data[40] = kHvIgnore;
    store.commit(make_edit(0, "Brush P100", saved, latest));
    others = latest;
    while (others.plane.data == latest.plane.data) others = after_random_gesture(others, random);
    others.annotator = "other tool";
  }
};

TEST_F(Outside, LabelsWrittenByOthersAreAdoptedOnceAndCanBeUndone) {
  write_frame_labels(dir, 0, others);
  {
    const OpenStore first(dir);
    expect_same(*first.labels(0), others);
    ASSERT_EQ(first.notices().size(), 1u);
    EXPECT_NE(first.notices()[0].find("changed outside planescope"), std::string::npos);
  }
  OpenStore store(dir);
  EXPECT_TRUE(store.notices().empty());
  EXPECT_EQ(store.undo_count(), 4u);
  expect_same(*store.labels(0), others);
  EXPECT_EQ(store.history(1)[0].title, "changed outside planescope");
  EXPECT_FALSE(store.unsaved(0));
  store.undo();
  expect_same(*store.labels(0), latest);
  EXPECT_TRUE(store.unsaved(0));
}

TEST_F(Outside, RecompressedFilesAreNotAChange) {
  LabelStore(dir, by("ann")).save_all();
  auto bytes = read_file_bytes(dir / kFiles[2]);
  bytes.push_back('\n');
  write_file_bytes(dir / kFiles[2], bytes);
  OpenStore store(dir);
  EXPECT_TRUE(store.notices().empty());
  EXPECT_EQ(store.undo_count(), 3u);
}

TEST_F(Outside, MissingFilesAreWrittenAgain) {
  for (const char* file : kFiles) fs::remove(dir / file);
  OpenStore store(dir);
  expect_same(*store.labels(0), latest);
  EXPECT_TRUE(store.notices().empty());
  store.undo();
  EXPECT_TRUE(store.unsaved(0));
  store.save(0);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->plane.data, saved.plane.data);
}

TEST_F(Outside, ASaveInterruptedByACrashIsNotAChangeByOthers) {
  std::array<std::vector<unsigned char>, 3> old_files;
  for (int i = 0; i < 3; ++i) old_files[i] = read_file_bytes(dir / kFiles[i]);
  LabelStore(dir, by("ann")).save_all();
  for (int replaced = 0; replaced < 3; ++replaced) {
    for (int i = replaced; i < 3; ++i) write_file_bytes(dir / kFiles[i], old_files[i]);
    OpenStore store(dir);
    expect_same(*store.labels(0), latest);
    EXPECT_TRUE(store.notices().empty()) << store.notices()[0];
    EXPECT_TRUE(store.unsaved(0));
    EXPECT_EQ(store.undo_count(), 3u);
    store.save(0);
    EXPECT_FALSE(store.unsaved(0));
  }
}

TEST_F(Outside, SavingOverChangesByOthersKeepsBothInTheHistory) {
  OpenStore store(dir);
  write_frame_labels(dir, 0, others);
  store.save(0);
  expect_same(*store.labels(0), latest);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->plane.data, latest.plane.data);
  EXPECT_EQ(store.notices().size(), 1u);
  store.undo();
  expect_same(*store.labels(0), others);
  store.undo();
  expect_same(*store.labels(0), latest);
}

TEST_F(Outside, SavingWithoutEditsAdoptsChangesByOthers) {
  OpenStore store(dir);
  store.save(0);
  write_frame_labels(dir, 0, others);
  store.save(0);
  expect_same(*store.labels(0), others);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->plane.data, others.plane.data);
}

TEST_F(Outside, DamagedFilesDoNotReplaceTheJournalsLabels) {
  write_file_bytes(dir / kFiles[0], std::vector<unsigned char>{1, 2, 3});
  OpenStore store(dir);
  expect_same(*store.labels(0), latest);
  ASSERT_EQ(store.notices().size(), 1u);
  EXPECT_NE(store.notices()[0].find(kFiles[0]), std::string::npos);
  store.save(0);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->plane.data, latest.plane.data);
  EXPECT_EQ(read_file_bytes(dir / (kFiles[0] + std::string(".outside-1"))).size(), 3u);
}

TEST_F(Outside, LabelsOfAnotherDepthImageAreRejectedAndNotChanged) {
  const auto journal = read_file_bytes(dir / "journal");
  LabelStore store(dir, by("ann"));
  expect_refused([&] { store.open(0, blank(1)); }, "bbbbbbbbbbbb");
  expect_refused([&] { store.open(0, blank_labels(17, 23)); }, "23x17");
  EXPECT_FALSE(store.labels(0));
  FrameLabels another = others;
  another.depth_sha256 = std::string(64, 'f');
  write_frame_labels(dir, 0, another);
  expect_refused([&] { store.open(0, blank(0)); }, "ffffffffffff");
  EXPECT_EQ(read_file_bytes(dir / "journal"), journal);
}

TEST_F(LabelStores, LabelFilesWithoutAJournalStartTheHistory) {
  FrameLabels files = blank(0);
  for (int i = 0; i < 5; ++i) files = after_random_gesture(files, random);
  std::reverse(files.planes.begin(), files.planes.end());
  write_frame_labels(dir, 0, files);
  {
    LabelStore store(dir, by("ann"));
    EXPECT_EQ(store.open(0, blank(0))->plane.data, files.plane.data);
    EXPECT_FALSE(store.any_unsaved());
    gesture(store, 0, random);
    EXPECT_TRUE(store.unsaved(0));
  }
  OpenStore store(dir);
  EXPECT_TRUE(store.notices().empty());
  EXPECT_TRUE(store.unsaved(0));
  store.undo();
  EXPECT_EQ(store.labels(0)->plane.data, files.plane.data);
  EXPECT_FALSE(store.unsaved(0));
  EXPECT_EQ(store.undo_count(), 0u);
}

TEST_F(LabelStores, FilesRecompressedBeforeTheFirstJournalDoNoHarm) {
  write_frame_labels(dir, 0, blank(0));
  {
    OpenStore store(dir);
    auto bytes = read_file_bytes(dir / kFiles[2]);
    bytes.push_back('\n');
    write_file_bytes(dir / kFiles[2], bytes);
    store.save(0);
    gesture(store, 0, random);
  }
  LabelStore store(dir, by("ann"));
  EXPECT_TRUE(store.notices().empty());
  EXPECT_EQ(store.undo_count(), 1u);
}

TEST_F(LabelStores, FilesOfAnotherSizeAreRejected) {
  write_frame_labels(dir, 0, blank_labels(8, 6, 'a'));
  LabelStore store(dir, by("ann"));
  expect_refused([&] { store.open(0, blank(0)); }, "8x6");
}

TEST_F(Outside, AFrameThatCannotBeSavedDoesNotBlockOthers) {
  OpenStore store(dir);
  store.open(1, blank(1));
  gesture(store, 1, random);
  others.depth_sha256[0] = 'f';
  write_frame_labels(dir, 0, others);
  expect_refused([&] { store.save_all(); }, "000000.json");
  EXPECT_TRUE(store.unsaved(0));
  EXPECT_FALSE(store.unsaved(1));
}

/// Runs `action` in another process, like another instance; returns its result.
bool in_another_process(const std::function<bool()>& action) {
  const pid_t child = ::fork();
  if (child == 0) {
    bool good = false;
    try {
      good = action();
    } catch (...) {
    }
    ::_exit(good ? 0 : 1);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

/// For its lifetime, files of this process cannot grow beyond `bytes`, as on a full disk.
class FullDisk {
 public:
  explicit FullDisk(std::uintmax_t bytes) {
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit = {bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FullDisk() {
    ::setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }

 private:
  rlimit before_ = {};
  void (*handler_)(int) = SIG_DFL;
};

TEST_F(LabelStores, ASecondInstanceIsReadOnlyAndReportsTheFirst) {
  random = Random(31);
  auto store = std::make_unique<LabelStore>(dir, by("ann"));
  store->open(0, blank(0));
  gesture(*store, 0, random);
  const FrameLabels labels = *store->labels(0);
  const std::string holder = "held by ann, process " + std::to_string(::getpid()) + " on ";
  EXPECT_TRUE(in_another_process([&] {
    LabelStore second(dir, by("bob"));
    const bool sees = second.open(0, blank(0))->plane.data == labels.plane.data;
    const auto edit = make_edit(0, "x", labels, after_random_gesture(labels, random));
    const std::string refused = message_of([&] { second.commit(edit); });
    return sees && second.read_only().find("read-only: " + holder) == 0 &&
           refused.find(holder) != std::string::npos && second.notices().empty() &&
           !message_of([&] { second.save(0); }).empty() &&
           !message_of([&] { second.undo(); }).empty() &&
           second.labels(0)->plane.data == labels.plane.data;
  }));
  gesture(*store, 0, random);
  store.reset();
  EXPECT_TRUE(in_another_process([&] { return LabelStore(dir, by("bob")).read_only().empty(); }));
}

TEST_F(LabelStores, TwoStoresOpenedBeforeTheFolderExistedDoNotMixGestures) {
  auto first = std::make_unique<LabelStore>(dir, by("ann"));
  LabelStore second(dir, by("bob"));
  first->open(0, blank(0));
  second.open(0, blank(0));
  gesture(*first, 0, random);
  expect_refused([&] { gesture(second, 0, random); }, "held by ann");
  expect_same(*second.labels(0), blank(0));
  first.reset();
  LabelStore third(dir, by("carol"));
  EXPECT_EQ(third.undo_count(), 1u);
}

TEST_F(LabelStores, GesturesOfAClosedInstanceAreNotOverwritten) {
  OpenStore late(dir, "bob");
  {
    OpenStore first(dir);
    gesture(first, 0, random);
  }
  expect_refused([&] { gesture(late, 0, random); }, "open the recording again");
  EXPECT_EQ(LabelStore(dir, by("carol")).undo_count(), 1u);
}

TEST_F(LabelStores, AFileInPlaceOfTheFolderIsReported) {
  std::ofstream(dir) << "a file";
  expect_refused([&] { LabelStore(dir, by("ann")); }, dir.string());
}

TEST_F(LabelStores, AFolderThatCannotBeCreatedIsReportedAtTheFirstGesture) {
  const fs::path blocked = dir;
  LabelStore store(blocked / "labels", by("ann"));
  store.open(0, blank(0));
  std::ofstream(blocked) << "a file";
  expect_refused([&] { gesture(store, 0, random); }, "the edit is not saved");
  expect_same(*store.labels(0), blank(0));
  fs::remove(blocked);
  gesture(store, 0, random);
  EXPECT_EQ(store.undo_count(), 1u);
}

TEST_F(LabelStores, AReadOnlyFolderIsReadAndReportedAsSuch) {
  FrameLabels labels;
  {
    OpenStore store(dir);
    gesture(store, 0, random);
    labels = *store.labels(0);
  }
  const auto journal = read_file_bytes(dir / "journal");
  fs::remove(dir / "lock");
  ::chmod(dir.c_str(), 0555);
  EXPECT_TRUE(in_another_process([&] {
    constexpr uid_t kNobody = 65534;  // root writes everywhere
    if (::geteuid() == 0 && ::setresuid(kNobody, kNobody, kNobody) != 0) return false;
    LabelStore store(dir, by("ann"));
    const LabelStore none(dir / "sub", by("ann"));
    return store.read_only().find("Permission denied") != std::string::npos &&
           none.read_only().find("Permission denied") != std::string::npos &&
           store.open(0, blank(0))->plane.data == labels.plane.data &&
           message_of([&] { gesture(store, 0, random); }).find("read-only") != std::string::npos;
  }));
  ::chmod(dir.c_str(), 0755);
  EXPECT_EQ(read_file_bytes(dir / "journal"), journal);
}

TEST_F(LabelStores, OnAFullDiskAGestureIsRejectedAndNothingIsLost) {
  random = Random(36);
  OpenStore store(dir);
  gesture(store, 0, random);
  const FrameLabels before = *store.labels(0);
  const auto journal = read_file_bytes(dir / "journal");
  for (const int room : {0, 1, 7, 15}) {
    const FullDisk full(journal.size() + room);
    expect_refused([&] { gesture(store, 0, random); }, "File too large); the edit is not saved");
    expect_refused([&] { store.undo(); }, "File too large); the edit is not saved");
    expect_same(*store.labels(0), before);
    EXPECT_EQ(store.undo_count(), 1u);
    EXPECT_EQ(read_file_bytes(dir / "journal"), journal);
  }
  gesture(store, 0, random);
  EXPECT_EQ(store.undo_count(), 2u);
}

TEST_F(LabelStores, OnAFullDiskSavingFailsAndKeepsTheOldFiles) {
  random = Random(37);
  FrameLabels latest;
  {
    OpenStore store(dir);
    gesture(store, 0, random);
    store.save(0);
    const FrameLabels saved = *store.labels(0);
    gesture(store, 0, random);
    latest = *store.labels(0);
    for (const std::uintmax_t room : {0, 20, 100}) {
      const FullDisk full(room);
      EXPECT_NE(message_of([&] { store.save(0); }), "");
      EXPECT_TRUE(store.unsaved(0));
      EXPECT_EQ(read_frame_labels(dir, 0, "")->plane.data, saved.plane.data);
    }
  }
  LabelStore store(dir, by("ann"));
  EXPECT_TRUE(store.any_unsaved());
  expect_same(*store.open(0, blank(0)), latest);
  EXPECT_TRUE(store.notices().empty());
  store.save(0);
  EXPECT_EQ(read_frame_labels(dir, 0, "")->plane.data, latest.plane.data);
}

}  // namespace
}  // namespace planescope::labels
