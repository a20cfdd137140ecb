// planescope-lab bench outlines, with few frames: what its tables in docs/footholds.md say of many
// holds.

#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "cli/program.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
using Json = nlohmann::json;

TEST(BenchOutlines, OutlinesAreTrueFeetStandOnSurfacesAndSigmasHold) {
  const auto dir = scratch();
  const Ran ran = run({"planescope-lab", "bench", "outlines", "--seeds", "1", "--count", "6",
                       "--json", "-o", (dir / "out").string()});
  ASSERT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(files_below(dir / "out"), (std::vector<std::string>{"outlines.json", "outlines.md"}));
  EXPECT_EQ(ran.out, read_text(dir / "out/outlines.json"));
  EXPECT_EQ(ran.out.find(dir.string()), std::string::npos) << "no folders of this machine";
  const Json json = Json::parse(ran.out);
  EXPECT_EQ(json["frames"].size(), 18u);
  const Json& all = json["sets"].back();
  ASSERT_EQ(all["set"], "all");
  EXPECT_GT(all["planes"], 50);
  EXPECT_GT(all["drawn_iou_median"], 0.95);
  EXPECT_GT(all["iou_median"], 0.93);
  for (const Json& share : all["within_2_sigma"]) EXPECT_GT(share, 0.85);
  EXPECT_GT(all["with_room"], 20);
  EXPECT_EQ(all["unsound"], 0);
  EXPECT_GE(all["least_covered"], 0.95);
  EXPECT_GT(all["places"], 1000);
  EXPECT_EQ(all["off"], 0);
}

TEST(BenchOutlines, IsTheSameForAnyNumberOfThreads) {
  const auto dir = scratch();
  std::string first;
  for (const char* threads : {"1", "3"}) {
    const Ran ran = run({"planescope-lab", "bench", "outlines", "--seeds", "2", "--count", "1",
                         "--threads", threads, "--json", "-o", (dir / threads).string()});
    ASSERT_EQ(ran.code, 0) << ran.err;
    if (first.empty()) first = ran.out;
    EXPECT_TRUE(ran.out == first);
  }
}
