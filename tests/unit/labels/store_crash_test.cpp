#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <map>

#include "store_fixture.hpp"

namespace planescope::labels {
namespace {

constexpr int kFrames = 3;
constexpr int kSeed = 1000, kChoices = 19;  // the first choice is to save

/// A labeling session that goes the same way every time, and what must be there after each of its
/// steps.
class Script {
 public:
  Script() {
    for (int frame = 0; frame < kFrames; ++frame) labels_[frame] = blank(frame);
  }

  /// The next step, with a store or without.
  void step(LabelStore* store) {
    Random random(kSeed + steps_++);
    const int choice = random.integer(0, kChoices);
    const int frame = random.integer(0, kFrames - 1);
    if (choice == 0) {
      if (store) steps_ % 2 == 0 ? store->save(frame) : store->save_all();
    } else if (choice < 6 && !done_.empty()) {
      if (store) store->undo();
      revert_edit(labels_[done_.back().frame], done_.back());
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

/// Goes on with the script until it is killed, and says after each step that it is done.
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

/// How many steps were acknowledged before the kill, which comes some time after the first `steps`.
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

TEST(KilledSessions, HaveExactlyTheirAcknowledgedGesturesAfterEachOfAHundredKills) {
  const auto dir = fresh_dir("killed");
  Random random(41);
  Script script;
  int in_progress = 0;
  for (int round = 0; round < 100; ++round) {
    // Every other time while it saves, which takes longest.
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
      script.step(nullptr);  // at most the one in progress, whole
      ++in_progress;
    }
    ASSERT_TRUE(script.is_in(store)) << "round " << round << ", step " << script.steps();
  }
  std::printf("%d steps, %d of them done but not yet acknowledged at a kill\n", script.steps(),
              in_progress);
  EXPECT_GT(script.steps(), 100);
}

}  // namespace
}  // namespace planescope::labels
