// Recovery after a kill, of a damaged journal, and of a long one.

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "core/labels/store/journal.hpp"
#include "core/model/file_bytes.hpp"
#include "random_labels.hpp"
#include "support/refusal.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

constexpr int kFrames = 3;
constexpr int kSeed = 1000, kChoices = 19;  // the first choice is saving

/// A deterministic labeling session, with the expected labels after each step.
class Script {
 public:
  Script() {
    for (int frame = 0; frame < kFrames; ++frame) labels_[frame] = blank(frame);
  }

  /// Performs the next step, with or without a store.
  void step(LabelStore* store) {
    Random random(kSeed + steps_++);
    const int choice = random.integer(0, kChoices);
    const int frame = random.integer(0, kFrames - 1);
    if (choice == 0) {
      if (store) steps_ % 2 == 0 ? store->save(frame) : store->save_all();
    } else if (choice < 6 && !done_.empty()) {
      if (store) store->undo();
      apply_edit(labels_[done_.back().frame], reversed(done_.back()));
      undone_.push_back(done_.back());
      done_.pop_back();
    } else if (choice < 9 && !undone_.empty()) {
      if (store) store->redo();
      apply_edit(labels_[undone_.back().frame], undone_.back());
      done_.push_back(undone_.back());
      undone_.pop_back();
    } else {
      FrameLabels& labels = labels_[frame];
      const LabelEdit edit = make_edit(frame, "step", labels, after_random_gesture(labels, random));
      if (store) store->commit(edit);
      if (edit.empty()) return;
      apply_edit(labels, edit);
      done_.push_back(edit);
      undone_.clear();
    }
  }

  bool is_in(const LabelStore& store) const {
    if (store.undo_count() != done_.size() || store.redo_count() != undone_.size()) return false;
    for (int frame = 0; frame < kFrames; ++frame) {
      const auto found = store.labels(frame);
      const FrameLabels& expected = labels_.at(frame);
      if (!make_edit(frame, "", *found, expected).empty()) return false;
    }
    return true;
  }

  int steps() const { return steps_; }
  int steps_before_save() const {
    int steps = 0;
    while (Random(kSeed + steps_ + steps).integer(0, kChoices) != 0) ++steps;
    return steps;
  }

 private:
  int steps_ = 0;
  std::map<int, FrameLabels> labels_;
  std::vector<LabelEdit> done_, undone_;
};

void open_all(LabelStore& store) {
  for (int frame = 0; frame < kFrames; ++frame) store.open(frame, blank(frame));
}

/// Continues the script until it is killed, and acknowledges each step.
[[noreturn]] void work(const std::filesystem::path& dir, Script script, int acknowledge) {
  try {
    LabelStore store(dir, by("ann"));
    open_all(store);
    if (!store.read_only().empty()) ::_exit(1);
    while (true) {
      script.step(&store);
      if (::write(acknowledge, "x", 1) != 1) ::_exit(2);
    }
  } catch (const std::exception& error) {
    std::fprintf(stderr, "%s\n", error.what());
    ::_exit(3);
  }
}

/// Returns the number of steps acknowledged before the kill, which happens some time after the
/// first `steps`.
int work_and_be_killed(const std::filesystem::path& dir,
                       const Script& script,
                       int steps,
                       unsigned after_us) {
  int ends[2];
  if (::pipe(ends) != 0) std::abort();
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    work(dir, script, ends[1]);
  }
  ::close(ends[1]);
  int count = 0;
  char acknowledgement = 0;
  while (count < steps && ::read(ends[0], &acknowledgement, 1) == 1) ++count;
  ::usleep(after_us);
  ::kill(child, SIGKILL);
  while (::read(ends[0], &acknowledgement, 1) == 1) ++count;
  ::close(ends[0]);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status)) << "ended by itself with " << WEXITSTATUS(status);
  return count;
}

TEST(KilledSessions, KeepExactlyTheirAcknowledgedGesturesAfterAHundredKills) {
  const auto dir = fresh_dir("killed");
  Random random(41);
  Script script;
  int in_progress = 0;
  for (int round = 0; round < 100; ++round) {
    // Every other kill happens while saving, which takes longest.
    const bool saves = round % 2 == 1;
    const int steps = saves ? script.steps_before_save() : random.integer(0, 30);
    const auto after_us = static_cast<unsigned>(random.integer(0, saves ? 40000 : 1000));
    const int acknowledged = work_and_be_killed(dir, script, steps, after_us);
    for (int i = 0; i < acknowledged; ++i) script.step(nullptr);

    LabelStore store(dir, by("ann"));
    open_all(store);
    for (const std::string& notice : store.notices()) {
      EXPECT_NE(notice.find("damaged"), std::string::npos) << notice;
    }
    if (!script.is_in(store)) {
      script.step(nullptr);  // at most the step in progress, completed
      ++in_progress;
    }
    ASSERT_TRUE(script.is_in(store)) << "round " << round << ", step " << script.steps();
  }
  std::printf("%d steps, %d of them done but not yet acknowledged at a kill\n", script.steps(),
              in_progress);
  EXPECT_GT(script.steps(), 100);
}

/// A journal of several gestures, the last of one pixel, with the labels and its length after each.
struct Session {
  fs::path dir;
  std::vector<FrameLabels> labels = {blank(0)};
  std::vector<std::uintmax_t> lengths = {0};

  Session(const std::string& name, int gestures) : dir(fresh_dir(name)) {
    Random random(11);
    OpenStore store(dir);
    for (int i = 0; i < gestures; ++i) {
      if (i + 1 < gestures) {
        gesture(store, 0, random);
      } else {
        FrameLabels next = labels.back();
        next.hv.data[7] ^= 1;
        store.commit(make_edit(0, "Last", labels.back(), next));
      }
      labels.push_back(*store.labels(0));
      lengths.push_back(fs::file_size(dir / "journal"));
    }
  }

  std::vector<unsigned char> bytes() const { return read_file_bytes(dir / "journal"); }

  /// Opens a folder with this journal. Expects the labels after `kept` gestures, a copy of the
  /// discarded part, and that new gestures can follow.
  void expect_kept(std::span<const unsigned char> journal, std::size_t kept) const {
    fs::remove(dir / "journal.damaged-1");
    write_file_bytes(dir / "journal", journal);
    {
      LabelStore store(dir, by("ann"));
      ASSERT_EQ(store.read_only(), "");
      ASSERT_EQ(store.notices().size(), 1u);
      EXPECT_NE(store.notices()[0].find("journal.damaged-1"), std::string::npos);
      ASSERT_EQ(store.undo_count(), kept);
      expect_same(*store.open(0, blank(0)), labels[kept]);
      FrameLabels next = labels[kept];
      next.hv.data[0] ^= 1;
      store.commit(make_edit(0, "Next", labels[kept], next));
    }
    const auto aside = read_file_bytes(dir / "journal.damaged-1");
    ASSERT_LT(aside.size(), journal.size() + 1);
    EXPECT_TRUE(std::equal(aside.begin(), aside.end(), journal.end() - aside.size()));
    LabelStore store(dir, by("ann"));
    EXPECT_TRUE(store.notices().empty());
    EXPECT_EQ(store.undo_count(), kept + 1);
  }
};

TEST(DamagedJournals, DamageInTheLastRecordKeepsAllRecordsBefore) {
  const Session session("last", 6);
  const auto whole = session.bytes();
  for (auto at = session.lengths[5]; at < session.lengths[6]; ++at) {
    auto bytes = whole;
    bytes[at] ^= static_cast<unsigned char>(1 + at % 255);
    ASSERT_NO_FATAL_FAILURE(session.expect_kept(bytes, 5)) << at;
    if (at == session.lengths[5]) continue;  // a truncation there damages nothing
    ASSERT_NO_FATAL_FAILURE(session.expect_kept(std::span(whole).first(at), 5)) << at;
  }
}

TEST(DamagedJournals, RecordsAfterDamageElsewhereAreSetAside) {
  const Session session("elsewhere", 6);
  const auto whole = session.bytes();
  auto bytes = whole;
  bytes[(session.lengths[2] + session.lengths[3]) / 2] ^= 0x10;
  session.expect_kept(bytes, 2);
  EXPECT_EQ(fs::file_size(session.dir / "journal.damaged-1"), bytes.size() - session.lengths[2]);
  bytes = whole;
  bytes.resize(bytes.size() + 4096);  // zeros
  session.expect_kept(bytes, 6);
  session.expect_kept(std::span(whole).first(5), 0);  // in its first line
}

TEST(DamagedJournals, EachIsSetAsideUnderADifferentName) {
  const Session session("names", 2);
  const auto bytes = session.bytes();
  for (int i = 1; i <= 3; ++i) {
    write_file_bytes(session.dir / "journal", std::span(bytes).first(bytes.size() - 1));
    LabelStore(session.dir, by("ann"));
    EXPECT_TRUE(fs::exists(session.dir / ("journal.damaged-" + std::to_string(i))));
  }
}

TEST(DamagedJournals, SavedFilesAreAdoptedIfTheJournalLostTheirGestures) {
  const fs::path dir = fresh_dir("lost_saving");
  Random random(12);
  FrameLabels saved;
  std::uintmax_t length = 0;
  {
    OpenStore store(dir);
    gesture(store, 0, random);
    length = fs::file_size(dir / "journal");
    gesture(store, 0, random);
    gesture(store, 0, random);
    store.save(0);
    saved = *store.labels(0);
  }
  fs::resize_file(dir / "journal", length + 9);
  LabelStore store(dir, by("ann"));
  EXPECT_EQ(store.open(0, blank(0))->plane.data, saved.plane.data);
  EXPECT_EQ(store.undo_count(), 2u);
  EXPECT_FALSE(store.unsaved(0));
}

TEST(DamagedJournals, AnUnknownFormatIsRejectedAndNotChanged) {
  const auto expect_left = [](const Session& session, const std::string& message) {
    const auto bytes = session.bytes();
    expect_refused([&] { OpenStore(session.dir); }, message);
    EXPECT_EQ(session.bytes(), bytes);
  };
  const auto append = [](const Session& session, const JournalBytes& record) {
    Journal journal(session.dir / "journal", Journal::Access::write,
                    [](const auto&, const auto&) { return true; });
    journal.append(std::vector<JournalBytes>{record});
  };
  const Session version("version", 1);
  auto bytes = version.bytes();
  bytes[std::string("planescope.journal/").size()] = '2';
  write_file_bytes(version.dir / "journal", bytes);
  expect_left(version, "version 2");

  const Session kind("kind", 1);
  append(kind, {99, 0, 0, 0});
  expect_left(kind, (kind.dir / "journal").string());

  const Session other_labels("other_labels", 1);
  FrameLabels other = blank(0);
  std::ranges::fill(other.plane.data, std::uint16_t{7});
  append(other_labels,
         edit_record({RecordKind::edit, 0, 5, "ann"}, make_edit(0, "erase", other, blank(0))));
  expect_left(other_labels, "the edit at byte");
}

TEST(DamagedJournals, NoRecordIsReadBeyondItsEnd) {
  FrameLabels labels = blank(0);
  Random random(13);
  for (int i = 0; i < 20; ++i) labels = after_random_gesture(labels, random);
  const auto base = base_record({RecordKind::base, 0, 5, "ann"}, labels);
  const auto edit =
      edit_record({RecordKind::edit, 0, 5, "ann"}, make_edit(0, "all", blank(0), labels));
  for (int i = 0; i < 20000; ++i) {
    auto bytes = i % 2 == 0 ? base : edit;
    for (int k = random.integer(1, 4); k > 0; --k) {
      bytes[random.integer(0, static_cast<int>(bytes.size()) - 1)] =
          static_cast<unsigned char>(random.bits());
    }
    bytes.resize(bytes.size() - random.integer(0, 3));
    try {
      if (i % 2 == 0) {
        read_base(bytes);
      } else {
        FrameLabels to = blank(0);
        for (const LabelRun& run : read_edit(bytes, to.plane.data.size()).runs) {
          ASSERT_LE(run.first + run.count, to.plane.data.size());
        }
      }
    } catch (const Error&) {
    }
  }
}

TEST(DamagedJournals, ATextBeyondItsRecordIsRejected) {
  auto record = plain_record({RecordKind::written, 0, 5, ""});
  record.back() = 1;  // length of the annotator's name, which is missing
  expect_refused([&] { read_head(record); }, "has missing or extra fields");
}

TEST_F(LabelStores, AJournalOfManyMegabytesIsReplayedExactly) {
  constexpr int kGestures = 1000;
  FrameLabels labels = blank_labels(320, 240);
  std::vector<JournalBytes> records = {base_record({RecordKind::base, 0, 0, "ann"}, labels)};
  for (int i = 0; i < kGestures; ++i) {
    LabelDraft draft(labels);
    for (int k = 0; k < 1000; ++k)
      draft.set(static_cast<std::uint32_t>(random.integer(0, 320 * 240 - 1)), i % 30, 0);
    records.push_back(edit_record({RecordKind::edit, 0, i, "ann"}, draft.edit(0, "Brush")));
    labels = draft.labels;
  }
  fs::create_directories(dir);
  Journal(dir / "journal", Journal::Access::write, nullptr).append(records);
  EXPECT_GT(fs::file_size(dir / "journal"), 4u << 20);
  LabelStore store(dir, by("ann"));
  EXPECT_EQ(store.open(0, blank_labels(320, 240))->plane.data, labels.plane.data);
  EXPECT_EQ(store.undo_count(), std::size_t{kGestures});
}

}  // namespace
}  // namespace planescope::labels
