#include "core/lab/bench/speed_page.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <nlohmann/json.hpp>

namespace planescope::lab {
namespace {

/// One row of everything.
ChainSpeed speed() {
  ChainSpeed all;
  all.command = "planescope-lab bench speed -o <out>";
  all.build = {"1.2.3", "abc", false};
  all.weights = {"w.safetensors", "00ff", "tiny, 7 parameters", ""};
  all.machine = {"Some CPU", 4, Simd::plain};
  all.peaks = {2e10, 1e11};
  all.rounds = 3;
  all.subjects = {{"room", 2, 640, 480}};
  all.stages = {{"room", "cloud", {2, 1, 3}, {2e6, 17e6}, floor_of({2e6, 17e6}, all.peaks), 11.8}};
  all.duels = {{"room", "voxel grid", "theirs", {1, 1, 1}, {4, 4, 4}, 4}};
  all.methods = {{"room", "region-growing", {10, 9, 11}, 1, 5},
                 {"room", "ours, refined, gcn", {30, 29, 31}, 3, 6}};
  all.scaling = {{.id = "points",
                  .title = "Points",
                  .x_name = "points",
                  .note = "",
                  .x = {1, 10},
                  .curves = {{"octree", {1, 10}, 1.0},
                             {"new", {1, 1}, std::numeric_limits<double>::quiet_NaN()}}}};
  all.stage_memory = {{.recording = "room", .stage = "cloud", .allocations = Allocations{1234, 5}}};
  all.method_memory = {{.recording = "room", .method = "ransac"}};
  all.commands = {{"planescope --version", {50, 40, 60}, {20, 20, 20}, 30}};
  return all;
}

TEST(SpeedJson, HasEveryPart) {
  const auto json = nlohmann::json::parse(speed_json(speed()));
  EXPECT_EQ(json["schema"], "planescope.bench.speed/1");
  EXPECT_EQ(json["machine"]["cores"], 4);
  EXPECT_EQ(json["bytes_per_s"], 2e10);
  EXPECT_EQ(json["stages"][0]["ms"]["median"], 2);
  EXPECT_EQ(json["stages"][0]["bound_by"], "flops");
  EXPECT_DOUBLE_EQ(json["stages"][0]["floor_ms"], 0.17);
  EXPECT_EQ(json["stage_rivals"][0]["ratio"], 4);
  EXPECT_EQ(json["frames"][1]["method"], "ours, refined, gcn");
  EXPECT_EQ(json["scaling"][0]["curves"][0]["exponent"], 1);
  EXPECT_TRUE(json["scaling"][0]["curves"][1]["exponent"].is_null());
  EXPECT_EQ(json["stage_memory"][0]["allocations"]["calls"], 1234);
  EXPECT_TRUE(json["frame_memory"][0]["allocations"].is_null());
  EXPECT_EQ(json["commands"][0]["wall_ms"]["least"], 40);
}

TEST(SpeedTables, SayWhatWasMeasuredAndWhatWasNot) {
  const std::vector<Table> tables = speed_tables(speed());
  std::string text;
  for (const Table& table : tables) text += to_text(table);
  for (const char* part : {"1,234", "11.8x", "3.00x", "exponent", "planescope --version"})
    EXPECT_NE(text.find(part), std::string::npos) << part;
  EXPECT_TRUE(speed_tables({}).empty());
}

TEST(SpeedPage, EscapesWhatWasTypedAndDrawsOnLogarithmicAxes) {
  const std::string page = speed_page(speed());
  EXPECT_EQ(page.find("<out>"), std::string::npos);
  EXPECT_NE(page.find("30.0 ms"), std::string::npos) << "the lead";
  EXPECT_NE(page.find("Both axes are logarithmic"), std::string::npos);
  EXPECT_EQ(page.find("nan"), std::string::npos);
}

}  // namespace
}  // namespace planescope::lab
