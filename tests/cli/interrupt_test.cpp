// An interrupted run exits with code 130 and leaves only complete frames.

#include <gtest/gtest.h>
#include <signal.h>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"

using namespace planescope::testing_cli;

TEST(Interrupt, ALongRunEndsWithCompleteFramesAndCode130) {
  const auto dir = scratch_with_rec(2000);
  // The output folder appears with the first frame.
  const Ran ran = run_and_signal({"segment", dir / "rec", "-o", dir / "out", "--gravity", "0,1,0"},
                                 SIGINT, dir / "out");
  EXPECT_EQ(ran.code, 130);
  EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
  EXPECT_TRUE(has(ran.err, "canceled"));
  const auto files = files_below(dir / "out");
  EXPECT_GE(files.size(), 4u);
  EXPECT_LT(files.size(), 4u * 2000);
  EXPECT_EQ(files.size() % 4, 0u) << "every frame that is there is whole";
  for (const auto& file : files) EXPECT_EQ(file.rfind("frames/", 0), 0u) << file;
}
