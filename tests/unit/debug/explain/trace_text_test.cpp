#include "core/debug/explain/trace_text.hpp"

#include <gtest/gtest.h>

#include "runs.hpp"

namespace planescope::debug {
namespace {

TEST(TraceText, NamesEveryStepAndIsTheSameTwice) {
  for (const planes::Profile profile :
       {planes::Profile::paper, planes::Profile::paper_closest, planes::Profile::refined}) {
    const auto run = test::run_of_stairs(planes::profile_options(profile), 0.003);
    const std::string text = trace_text(*run);
    for (std::int32_t step = 0; step <= run->steps(); ++step) {
      const std::string line = "\nstep " + std::to_string(step) + ": " + describe_event(*run, step);
      ASSERT_NE(text.find(line), std::string::npos) << line;
    }
    EXPECT_EQ(text.find("refused"), std::string::npos) << "a filter of its list is none";
    EXPECT_EQ(text, trace_text(*test::run_of_stairs(planes::profile_options(profile), 0.003)));
  }
}

TEST(TraceText, SaysWhereItPartsFromThePinnedRun) {
  const auto a = test::run_of_stairs(planes::profile_options(planes::Profile::paper), 0.003);
  const auto b = test::run_of_stairs(planes::profile_options(planes::Profile::refined), 0.003);
  EXPECT_EQ(trace_text(*a).find("first different events"), std::string::npos);
  EXPECT_NE(trace_text(*b, a.get()).find("first different events: step"), std::string::npos);
}

}  // namespace
}  // namespace planescope::debug
