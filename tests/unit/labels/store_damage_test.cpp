#include <gtest/gtest.h>

#include "core/labels/store/journal_records.hpp"
#include "core/model/file_bytes.hpp"
#include "store_fixture.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

/// A journal of a few gestures, the last of one pixel, and the labels and length after each.
struct Session {
  fs::path dir;
  std::vector<FrameLabels> labels = {blank(0)};
  std::vector<std::uintmax_t> lengths = {0};

  Session(const std::string& name, int gestures) : dir(fresh_dir(name)) {
    Random random(11);
    LabelStore store(dir, by("ann"));
    store.open(0, blank(0));
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

  /// Opens the folder with this journal; it must hold the labels after `kept` gestures, keep what
  /// was cut off, and go on from there.
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

TEST(DamagedJournals, OneThatIsCutAnywhereInItsLastRecordKeepsAllBefore) {
  const Session session("cut", 6);
  const auto whole = session.bytes();
  for (auto size = session.lengths[5] + 1; size < session.lengths[6]; ++size) {
    ASSERT_NO_FATAL_FAILURE(session.expect_kept(std::span(whole).first(size), 5)) << size;
  }
}

TEST(DamagedJournals, AnyWrongByteInTheLastRecordIsFound) {
  const Session session("flipped", 6);
  const auto whole = session.bytes();
  for (auto at = session.lengths[5]; at < session.lengths[6]; ++at) {
    auto bytes = whole;
    bytes[at] ^= static_cast<unsigned char>(1 + at % 255);
    ASSERT_NO_FATAL_FAILURE(session.expect_kept(bytes, 5)) << at;
  }
}

TEST(DamagedJournals, AWrongByteInTheMiddleSetsAsideWhatFollows) {
  const Session session("middle", 6);
  auto bytes = session.bytes();
  bytes[(session.lengths[2] + session.lengths[3]) / 2] ^= 0x10;
  session.expect_kept(bytes, 2);
  EXPECT_EQ(fs::file_size(session.dir / "journal.damaged-1"), bytes.size() - session.lengths[2]);
}

TEST(DamagedJournals, ZerosAtTheEndAreDamage) {
  const Session session("zeros", 3);
  auto bytes = session.bytes();
  bytes.resize(bytes.size() + 4096);
  session.expect_kept(bytes, 3);
}

TEST(DamagedJournals, OneThatWasCutInItsFirstLineIsStartedAnew) {
  const Session session("header", 2);
  const auto whole = session.bytes();
  session.expect_kept(std::span(whole).first(5), 0);
}

TEST(DamagedJournals, EachIsSetAsideUnderANameOfItsOwn) {
  const Session session("names", 2);
  const auto bytes = session.bytes();
  for (int i = 1; i <= 3; ++i) {
    write_file_bytes(session.dir / "journal", std::span(bytes).first(bytes.size() - 1));
    LabelStore(session.dir, by("ann"));
    EXPECT_TRUE(fs::exists(session.dir / ("journal.damaged-" + std::to_string(i))));
  }
}

TEST(DamagedJournals, SavedFilesAreTakenOverWhereTheJournalLostTheirGestures) {
  const fs::path dir = fresh_dir("lost_saving");
  Random random(12);
  FrameLabels saved;
  std::uintmax_t length = 0;
  {
    LabelStore store(dir, by("ann"));
    store.open(0, blank(0));
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

TEST(DamagedJournals, OneOfALaterVersionIsRefusedAndLeftAlone) {
  const Session session("version", 1);
  auto bytes = session.bytes();
  bytes[std::string("planescope.journal/").size()] = '2';
  write_file_bytes(session.dir / "journal", bytes);
  expect_refused([&] { LabelStore(session.dir, by("ann")); }, "version 2");
  EXPECT_EQ(session.bytes(), bytes);
}

TEST(DamagedJournals, RecordsOfAnUnknownKindAreRefusedAndLeftAlone) {
  const Session session("kind", 1);
  {
    Journal journal(session.dir / "journal", Journal::Access::write,
                    [](const auto&, const auto&) { return true; });
    journal.append(std::vector<JournalBytes>{{99, 0, 0, 0}});
  }
  const auto bytes = session.bytes();
  expect_refused([&] { LabelStore(session.dir, by("ann")); }, (session.dir / "journal").string());
  EXPECT_EQ(session.bytes(), bytes);
}

TEST(DamagedJournals, NoRecordWhateverItHoldsIsReadBeyondItsEnd) {
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

}  // namespace
}  // namespace planescope::labels
