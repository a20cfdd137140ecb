#include "core/lab/tuning/tuning_journal.hpp"

#include <gtest/gtest.h>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::lab {
namespace {

namespace fs = std::filesystem;

const TuningPurpose kPurpose = {{"frames or labels", "abc"}, {"weights", "def"}};
const Trial kFirst{{}, {1.0 / 3, 95.76322775203958}};
const Trial kSecond{{{"theta_coplane", "0.9"}, {"criterion4_n2", "off"}}, {50, 0}};

std::string text_of(const fs::path& file) {
  const auto bytes = read_file_bytes(file);
  return {bytes.begin(), bytes.end()};
}

class TuningJournalTest : public testing::Test {
 protected:
  void SetUp() override {
    dir_ = fs::path(testing::TempDir()) /
           testing::UnitTest::GetInstance()->current_test_info()->name();
    fs::remove_all(dir_);
    fs::create_directories(dir_);
  }
  void write_both() const {
    TuningJournal journal(dir_, kPurpose);
    journal.add(kFirst, 12.5);
    journal.add(kSecond, 7);
  }
  std::string refusal_of(const TuningPurpose& purpose = kPurpose) const {
    try {
      (void)TuningJournal(dir_, purpose);
    } catch (const Error& error) {
      return error.what();
    }
    return {};
  }
  fs::path dir_;
};

TEST_F(TuningJournalTest, ComesBackAsItWasWritten) {
  write_both();
  const TuningJournal journal(dir_, kPurpose);
  ASSERT_EQ(journal.trials().size(), 2u);
  EXPECT_EQ(journal.trials()[0].scores, kFirst.scores);
  ASSERT_TRUE(journal.find(kSecond.setting));
  EXPECT_EQ(journal.find(kSecond.setting)->scores, kSecond.scores);
  EXPECT_EQ(journal.time_of(kSecond.setting), 7);
  EXPECT_FALSE(journal.find({{"theta_coplane", "0.91"}}));
}

TEST_F(TuningJournalTest, ALineThatWasCutIsDroppedAndWrittenAgainInTheSameBytes) {
  write_both();
  const fs::path file = dir_ / "journal.jsonl";
  const std::string whole = text_of(file);
  const std::size_t second = whole.rfind('\n', whole.size() - 2) + 1;
  for (std::size_t size = second; size < whole.size(); size += 7) {
    write_file_text(file, whole.substr(0, size));
    TuningJournal journal(dir_, kPurpose);
    ASSERT_EQ(journal.trials().size(), 1u) << size;
    journal.add(kSecond, 7);
    EXPECT_EQ(text_of(file), whole) << size;
  }
}

TEST_F(TuningJournalTest, OneOfAnotherSearchIsRefusedByWhatDiffers) {
  write_both();
  EXPECT_NE(refusal_of({{"frames or labels", "abc"}, {"weights", "other"}})
                .find("is of a search with other weights"),
            std::string::npos);
  EXPECT_NE(refusal_of({{"frames or labels", "x"}, {"weights", "def"}})
                .find("is of a search with other frames or labels"),
            std::string::npos);
  EXPECT_EQ(refusal_of(), "");
}

TEST_F(TuningJournalTest, DamageIsToldWithItsLine) {
  write_both();
  const fs::path file = dir_ / "journal.jsonl";
  const std::string whole = text_of(file);
  write_file_text(file, whole + "{\"set\":{}}\n");
  EXPECT_NE(refusal_of().find("journal.jsonl, line 4"), std::string::npos) << refusal_of();
  write_file_text(file, whole + "{\"set\":{},\"scores\":[1]}\n");
  EXPECT_NE(refusal_of().find("line 4: found 1 scores, expected 2"), std::string::npos);
  write_file_text(file, "no journal\n");
  EXPECT_NE(refusal_of().find("line 1"), std::string::npos);
}

TEST_F(TuningJournalTest, WithoutTimesTheTrialsAreThereAllTheSame) {
  write_both();
  write_file_text(dir_ / "times.jsonl", "{\"trial\":1,\"ms\":3}\nrubbish\n");
  const TuningJournal journal(dir_, kPurpose);
  EXPECT_EQ(journal.trials().size(), 2u);
  EXPECT_FALSE(journal.time_of(kFirst.setting));
  EXPECT_EQ(journal.time_of(kSecond.setting), 3);
}

}  // namespace
}  // namespace planescope::lab
