// Wishes for a surface, by a click on a depth image: only option changes that fulfill them.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "core/debug/explain/fix.hpp"
#include "core/debug/explain/score.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "runs.hpp"
#include "support/box_scene.hpp"

namespace planescope::debug {
namespace {

std::uint32_t voxel_at(int u, int v) {
  return test::box_run()->subject->voxel_of_source(static_cast<std::size_t>(v) * 640 + u);
}

std::vector<std::uint32_t> truth(std::initializer_list<std::int32_t> planes) {
  std::vector<std::uint32_t> voxels;
  const std::vector<std::int32_t>& of = test::box_run()->subject->voxel_truth.plane;
  for (std::uint32_t i = 0; i < of.size(); ++i)
    if (std::ranges::count(planes, of[i]) > 0) voxels.push_back(i);
  return voxels;
}

std::vector<std::int32_t> with(const Run& run, const Fix& fix) {
  planes::PipelineOptions options = run.options;
  planes::set_option(options, fix.option, fix.after);
  return planes_with(run, options);
}

const Fix* fix_by(const std::vector<Fix>& fixes, const std::string& option) {
  const auto at = std::ranges::find(fixes, option, &Fix::option);
  return at == fixes.end() ? nullptr : &*at;
}

}  // namespace

TEST(Wish, ForALostSurfaceIsFulfilledByTheProfilesValueFirst) {
  const auto& run = *test::box_run();
  const auto voxel = static_cast<std::uint32_t>(run.subject->voxel_of_source(test::kSmallBoxPixel));
  const FixTarget target = target_of_click(run, voxel, Wish::plane, truth({test::kSmallBox}));
  EXPECT_FALSE(is_granted(run, target));
  int reports = 0, first_found = -1;
  const std::vector<Fix> fixes =
      find_fixes(run, target, {}, [&](int done, int, const std::vector<Fix>& so_far) {
        if (first_found < 0 && !so_far.empty()) first_found = done;
        ++reports;
      });
  ASSERT_FALSE(fixes.empty());
  EXPECT_EQ(first_found, 0) << "found before anything else is tried";
  EXPECT_GT(reports, 5);
  EXPECT_EQ(fixes[0].option, "worth_px");
  EXPECT_EQ(fixes[0].after, "1000");
  EXPECT_TRUE(fixes[0].restores);
  EXPECT_EQ(fixes[0].planes_before, static_cast<int>(run.segmentation.planes.size()));
  EXPECT_GT(fixes[0].planes_after, fixes[0].planes_before);
  EXPECT_EQ(run.event_at(fixes[0].step)->type, planes::EventType::refine);
  EXPECT_EQ(run.event_at(fixes[0].step)->stage, planes::Stage::list);
  for (const Fix& fix : fixes) {
    const std::vector<std::int32_t> planes = with(run, fix);
    EXPECT_GT(planes[voxel], 0) << fix.option;
    EXPECT_GT(fix.gained, 0) << fix.option;
    std::int32_t gained = 0;
    for (const std::uint32_t i : target.voxels) gained += planes[i] == planes[voxel];
    EXPECT_EQ(fix.gained, gained) << fix.option;
  }
}

TEST(Wish, WithoutASurfaceConcernsTheSurfaceLostWithTheVoxel) {
  const auto& run = *test::box_run();
  const auto voxel = static_cast<std::uint32_t>(run.subject->voxel_of_source(test::kSmallBoxPixel));
  const FixTarget target = target_of_click(run, voxel, Wish::plane);
  std::size_t on_box = 0;
  const std::vector<std::uint32_t> box = truth({test::kSmallBox});
  for (const std::uint32_t i : target.voxels) on_box += std::ranges::binary_search(box, i);
  EXPECT_GT(on_box, 0.9 * static_cast<double>(target.voxels.size()));
  EXPECT_GT(on_box, 0.9 * static_cast<double>(box.size()));
}

TEST(Wish, ForASeparatePlaneSplitsJoinedSurfaces) {
  planes::SegmentOptions options = planes::profile_options(planes::Profile::paper);
  options.theta_coplane = 0.3;
  int parted = 0, restored = 0;
  for (int index = 0; index < 8; ++index) {
    const auto run = test::run_of_stairs(options, 0.001, index);
    const VoxelTruth& truth = run->subject->voxel_truth;
    for (std::int32_t own = 1; own <= truth.plane_count; ++own) {
      const std::vector<std::uint32_t> surface = target_of_truth(*run, own).voxels;
      const std::uint32_t click = surface[surface.size() / 2];
      if (run->segmentation.plane_of[click] == 0) continue;
      const FixTarget target = target_of_click(*run, click, Wish::own_plane, surface);
      if (is_granted(*run, target)) continue;
      const std::vector<Fix> fixes = find_fixes(*run, target, {});
      if (fixes.empty()) continue;
      SCOPED_TRACE(fmt::format("stairs {}, true plane {}", index, own));
      ++parted;
      restored += fixes[0].option == "theta_coplane" && fixes[0].after == "0.85";
      for (const Fix& fix : fixes) {
        const std::vector<std::int32_t> planes = with(*run, fix);
        std::size_t beyond = 0;
        for (std::size_t i = 0; i < planes.size(); ++i)
          beyond += planes[i] == planes[click] && truth.plane[i] != own;
        EXPECT_GT(planes[click], 0) << fix.option;
        EXPECT_LE(beyond, 0.25 * static_cast<double>(std::ranges::count(planes, planes[click])))
            << fix.option;
      }
    }
  }
  EXPECT_GT(parted, 2);
  EXPECT_GE(restored, 0.6 * parted);
}

TEST(Wish, ToBeOnePlaneOrNoneIsFulfilledToo) {
  const auto& run = *test::box_run();
  const std::uint32_t front = voxel_at(260, 370), top = voxel_at(260, 305);
  ASSERT_NE(run.segmentation.plane_of[front], run.segmentation.plane_of[top]);
  FixTarget joined =
      target_of_click(run, front, Wish::joined, truth({test::kStepFront, test::kStepTop}));
  joined.with = top;
  for (const Fix& fix : find_fixes(run, joined, {})) {
    const std::vector<std::int32_t> planes = with(run, fix);
    EXPECT_GT(planes[front], 0) << fix.option;
    EXPECT_EQ(planes[front], planes[top]) << fix.option;
  }
  // Surfaces on separate planes need no change to be split; surfaces on one plane do.
  FixTarget apart = target_of_click(run, front, Wish::own_plane, truth({test::kStepFront}));
  apart.with = top;
  EXPECT_TRUE(is_granted(run, apart));
  apart.with = front;
  EXPECT_FALSE(is_granted(run, apart));
  FixTarget none = target_of_click(run, front, Wish::no_plane);
  none.far = true;
  EXPECT_EQ(none.voxels.size(), static_cast<std::size_t>(std::ranges::count(
                                    run.segmentation.plane_of, run.segmentation.plane_of[front])));
  const std::vector<Fix> gone = find_fixes(run, none, {});
  ASSERT_TRUE(fix_by(gone, "worth_px"));
  for (const Fix& fix : gone) EXPECT_EQ(with(run, fix)[front], 0) << fix.option;
}

TEST(Wish, ChangesOptionsAtMostThreefoldByDefault) {
  const auto& run = *test::box_run();
  const auto voxel = static_cast<std::uint32_t>(run.subject->voxel_of_source(test::kSmallBoxPixel));
  for (const Fix& fix :
       find_fixes(run, target_of_click(run, voxel, Wish::plane, truth({test::kSmallBox})), {}))
    EXPECT_TRUE(fix.restores || fix.change <= std::log(3) + 1e-3) << fix.option;
}

}  // namespace planescope::debug
