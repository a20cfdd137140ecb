// Runs each main command with the N-th call of one kind failing: one N per kind, or as many as
// PLANESCOPE_FAULTS.

#include <gtest/gtest.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <set>

#include "core/model/random.hpp"
#include "faults/commands.hpp"
#include "faults/fault.hpp"

namespace planescope::faults {
namespace {

namespace fs = std::filesystem;
using testing_cli::Ran;

/// Maximum number of failing calls per kind, one per run.
std::uint32_t most_calls() {
  const char* wanted = std::getenv("PLANESCOPE_FAULTS");
  return wanted ? static_cast<std::uint32_t>(std::atoi(wanted)) : 1;
}

/// Lines on stderr that do not begin with the program's name.
std::string foreign_lines(const std::string& err) {
  std::string foreign;
  for (std::size_t at = 0; at < err.size();) {
    const std::size_t end = std::min(err.find('\n', at), err.size());
    const std::string line = err.substr(at, end - at);
    if (!line.starts_with("planescope: ")) foreign += line + "\n";
    at = end + 1;
  }
  return foreign;
}

std::string last_line(std::string text) {
  if (text.ends_with('\n')) text.pop_back();
  return text.substr(text.rfind('\n') + 1);
}

class Calls : public testing::TestWithParam<Command> {
 protected:
  void SetUp() override {
    if (!can_preload()) GTEST_SKIP() << "nothing can be preloaded in this build";
    unsetenv("DISPLAY");
    unsetenv("WAYLAND_DISPLAY");
    setenv("XDG_STATE_HOME", (dir / "state").c_str(), 1);
    fs::create_directories(work);
    GetParam().prepare(work);
    ASSERT_FALSE(testing::Test::HasFatalFailure());
    fs::copy(work, start, fs::copy_options::recursive);
    before = snapshot(work);
    good = run_counted(words(), work);
    ASSERT_EQ(good.ran.code, 0) << good.ran.err;
    wanted = snapshot(work);
  }
  void TearDown() override { fs::remove_all(dir); }

  Words words() const { return GetParam().words(work); }
  void begin_anew() {
    fs::remove_all(work);
    fs::copy(start, work, fs::copy_options::recursive);
  }

  /// Removes files that may be in an intermediate state.
  Snapshot settled(Snapshot files) const {
    std::erase_if(files, [](const auto& file) {
      return std::ranges::any_of(
          GetParam().varies, [&](const std::string& name) { return file.first.starts_with(name); });
    });
    return files;
  }

  /// A window stays open and displays failures of its jobs.
  static Snapshot without_window(Snapshot files) {
    files.erase(GetParam().window);
    return files;
  }

  void meet(const Fault& fault) {
    SCOPED_TRACE(GetParam().name + ": " + fault.kind + " " + std::to_string(fault.at) +
                 (fault.stays ? " and all after it" : "") + ", error " +
                 std::to_string(fault.error));
    const int before_it = failures();
    begin_anew();
    try_it(fault);
    wrong += failures() > before_it;
  }

  static int failures() {
    const auto* result = testing::UnitTest::GetInstance()->current_test_info()->result();
    int count = 0;
    for (int i = 0; i < result->total_part_count(); ++i)
      count += result->GetTestPartResult(i).failed();
    return count;
  }

  void try_it(const Fault& fault) {
    const Ran ran = run_faulted(words(), work, fault).ran;
    ++runs;
    reported += ran.code != 0;
    ASSERT_TRUE(ran.code == 0 || ran.code == 2 || ran.code == 3) << ran.code << "\n" << ran.err;
    EXPECT_TRUE(good.ran.err.starts_with(foreign_lines(ran.err))) << ran.err;
    const Snapshot found = snapshot(work);
    if (ran.code == 0) {
      // Files that could not be removed do not matter if the next run removes them.
      EXPECT_EQ(differences(without_window(without_unfinished_work(found)), without_window(wanted)),
                "")
          << ran.err;
      if (found.size() == wanted.size()) return;
    } else {
      expect_nothing_lost(ran, found);
    }
    Words again = words();
    if (fs::exists(work / "out.checkpoint")) again.push_back("--resume");
    const Ran next = testing_cli::run(again);
    EXPECT_EQ(next.code, 0) << "after " << ran.err << "the next run: " << next.err;
    EXPECT_EQ(differences(settled(snapshot(work)), settled(wanted)), "") << "after " << ran.err;
  }

  void expect_nothing_lost(const Ran& ran, const Snapshot& found) {
    EXPECT_TRUE(last_line(ran.err).starts_with("planescope: ")) << ran.err;
    // A report with unreadable or undrawn frames is complete and lists them.
    const bool lacks_frames =
        ran.code == 3 || ran.err.find("planescope: error: frame ") != std::string::npos;
    if (!lacks_frames) {
      EXPECT_EQ(damage(settled(found), settled(before), settled(wanted)), "") << ran.err;
    }
  }

  const fs::path dir = testing_cli::scratch(), work = dir / "work", start = dir / "start";
  Snapshot before, wanted;
  Met good;
  int runs = 0, reported = 0, wrong = 0;
};

/// Selects which of `count` calls fail.
std::set<std::uint32_t> chosen(std::uint32_t count, std::uint32_t most, Random& random) {
  std::set<std::uint32_t> calls;
  for (std::uint32_t n = 1; count <= most && n <= count; ++n) calls.insert(n);
  while (calls.size() < std::min(count, most))
    calls.insert(1 + static_cast<std::uint32_t>(random.uniform() * count));
  return calls;
}

/// How calls of a kind fail. After EINTR, or 0 (half of the bytes), the program must continue.
std::vector<int> errors_of(const std::string& kind) {
  if (kind == "read") return {EIO, EINTR, 0};
  if (kind == "write") return {ENOSPC, EIO, EINTR, 0};
  if (kind == "open") return {EMFILE, EACCES, EIO};
  if (kind == "mkdir" || kind == "truncate") return {ENOSPC, EACCES};
  if (kind == "rename" || kind == "remove") return {EACCES, EIO};
  if (kind == "map" || kind == "memory") return {ENOMEM};
  return {EIO};
}

Fault fault_of(const std::string& kind, std::uint32_t call, Random& random) {
  const std::vector<int> errors = errors_of(kind);
  const int error =
      errors[static_cast<std::size_t>(random.uniform() * static_cast<double>(errors.size()))];
  const bool may_stay = kind == "write" || kind == "open" || kind == "egl";
  return {kind, call, error, may_stay && error != 0 && error != EINTR && random.uniform() < 0.5};
}

TEST_P(Calls, ThatFailAreReportedInOneLineAndLoseNothing) {
  const char* seed = std::getenv("PLANESCOPE_SEED");
  Random random(seed ? std::strtoull(seed, nullptr, 10) : 1);
  const std::vector<std::string>& few = GetParam().few;
  for (const auto& [kind, count] : good.calls)
    if (most_calls() > 1 || few.empty() || std::ranges::find(few, kind) != few.end())
      for (const std::uint32_t call : chosen(count, most_calls(), random))
        meet(fault_of(kind, call, random));
  EXPECT_GT(runs, 0) << "the layer saw no calls";
  std::printf("| calls of %s fail | %d | %d told, %d gone on after | %d |\n",
              GetParam().name.c_str(), runs, reported, runs - reported, wrong);
}

INSTANTIATE_TEST_SUITE_P(Each, Calls, testing::ValuesIn(main_commands()), [](const auto& each) {
  return each.param.name;
});

}  // namespace
}  // namespace planescope::faults
