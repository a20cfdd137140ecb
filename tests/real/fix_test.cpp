// Sets options wrong on real frames ($PLANESCOPE_DATA), one at a time, and checks the fixes
// proposed after a click on the lost surface.

#include "core/debug/explain/fix.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "core/debug/explain/provenance.hpp"
#include "core/io/recording.hpp"
#include "core/labels/model/pixel_sets.hpp"
#include "core/labels/wand/wand.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/planes/pipeline/pipeline.hpp"

namespace planescope::debug {
namespace {

constexpr std::size_t kLost = 1000;  // pixels of a lost surface

struct RealFrame {
  const char* recording;
  int frame;
  double max_range_m;
  std::optional<std::array<double, 4>> intrinsics = {};
};
const std::array kFrames{
    RealFrame{"tum_fr1_rpy_kinect_640x480", 40, 4}, RealFrame{"felixchenfy_d4xx_640x480", 2, 2},
    RealFrame{"aims_slam_realsense_640x480", 20, 4, std::array{383.8, 383.8, 321.7, 236.8}}};

/// The center of the largest surface that is on a plane in `good` but not in `bad`.
std::optional<std::uint32_t> lost_pixel(const Run& good,
                                        const Run& bad,
                                        const labels::LabelGrid& grid) {
  labels::PixelSet lost;
  for (std::uint32_t pixel = 0; pixel < grid.pixels(); ++pixel) {
    const std::uint32_t voxel = good.subject->voxel_of_source(pixel);
    if (voxel != planes::kNoVoxel && good.segmentation.plane_of[voxel] > 0 &&
        bad.segmentation.plane_of[voxel] == 0)
      lost.push_back(pixel);
  }
  std::vector<labels::PixelSet> parts = labels::connected_parts(grid, lost, 1);
  const auto largest = std::ranges::max_element(parts, {}, &labels::PixelSet::size);
  if (largest == parts.end() || largest->size() < kLost) return {};
  return labels::deepest_pixel(*largest, grid);
}

struct Tally {
  int cases = 0, first = 0, among_three = 0;
  std::string others = {};
};

/// Sets each option to a half, twice, a third and three times its value in the profile, until a
/// surface is lost.
void set_wrong(const RealFrame& real,
               planes::PipelineOptions options,
               std::initializer_list<const char*> names,
               Tally& tally) {
  io::RecordingOptions how;
  how.intrinsics = real.intrinsics;
  const auto recording = io::open_recording(
      std::filesystem::path(std::getenv("PLANESCOPE_DATA")) / real.recording, how);
  options.cloud.max_range_m = real.max_range_m;
  options.threads = 2;
  const auto chosen = planes::make_classifier(
      options, std::filesystem::path(PLANESCOPE_SOURCE_DIR) / "assets" / "classifier.safetensors");
  const auto subject =
      make_subject(recording->frame(real.frame), {}, options, chosen.classifier.get());
  const auto good = make_run(subject, options);
  const labels::LabelGrid grid = labels::make_label_grid(subject->frame, subject->prepared.gravity);
  for (const char* name : names)
    for (const double factor : {0.5, 2.0, 1 / 3.0, 3.0}) {
      planes::PipelineOptions wrong = options;
      const planes::OptionInfo& info = planes::find_option(name);
      const double value = factor * planes::number_of(info, options);
      if (value < info.range.min || value > info.range.max) continue;
      planes::set_option(wrong, name, planes::number_text(info, value));
      const auto bad = make_run(subject, wrong);
      const std::optional<std::uint32_t> pixel = lost_pixel(*good, *bad, grid);
      if (!pixel) continue;
      std::vector<std::uint32_t> surface;
      if (const auto grown = labels::grow_plane(grid, nullptr, std::span(&*pixel, 1), {}))
        surface = subject->voxels_of_sources(grown->pixels);
      const FixTarget target =
          target_of_click(*bad, subject->voxel_of_source(*pixel), Wish::plane, std::move(surface));
      const std::vector<Fix> fixes = find_fixes(*bad, target, {});
      const auto at = std::ranges::find(fixes, name, &Fix::option);
      const auto rank = at - fixes.begin();
      ++tally.cases;
      tally.first += at != fixes.end() && rank == 0;
      tally.among_three += at != fixes.end() && rank < 3;
      if (rank > 0 || fixes.empty())
        tally.others += fmt::format("{} {}, {} x{:.2g} at pixel {}: {} of {}\n", real.recording,
                                    real.frame, name, factor, *pixel, rank + 1, fixes.size());
      break;
    }
}

void expect_proposed(const Tally& tally, int cases) {
  EXPECT_GE(tally.cases, cases) << "too few options lose a surface";
  EXPECT_GE(tally.first, 0.8 * tally.cases) << tally.others;
  EXPECT_GE(tally.among_three, 0.95 * tally.cases) << tally.others;
  testing::Test::RecordProperty("cases", tally.cases);
}

}  // namespace

TEST(RealFix, ForAnOptionOfRefinedIsProposedFirst) {
  if (!std::getenv("PLANESCOPE_DATA")) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  Tally tally;
  for (const RealFrame& real : kFrames)
    set_wrong(real, {},
              {"flat", "bow", "merge_cost", "two_planes", "filled", "lateral_px", "reach_sigma",
               "hidden_share", "worth_px"},
              tally);
  expect_proposed(tally, 10);
}

TEST(RealFix, ForACriterionOfPaperIsProposedFirst) {
  if (!std::getenv("PLANESCOPE_DATA")) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  planes::PipelineOptions options;
  options.segment = planes::profile_options(planes::Profile::paper);
  Tally tally;
  for (const RealFrame& real : kFrames)
    set_wrong(real, options,
              {"theta_n_out", "theta_r_out", "theta_n_in", "theta_e_n_m2", "theta_coplane",
               "leftover_distance_m"},
              tally);
  expect_proposed(tally, 3);
}

}  // namespace planescope::debug
