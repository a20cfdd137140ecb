#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <tuple>
#include <vector>

#include "core/model/random.hpp"
#include "core/planes/segment/pixel_reach.hpp"
#include "core/planes/segment/pixel_runs.hpp"
#include "core/planes/segment/seen_pixels.hpp"
#include "core/planes/segment/tile_depth.hpp"
#include "core/planes/segment/tile_sets.hpp"
#include "core/planes/segment/window_sums.hpp"
#include "support/wall_scene.hpp"

// What the refinements of pixels are quick by gives what the plain way gives, bit for bit.

namespace planescope::planes {
namespace {

int below(Random& random, int end) { return static_cast<int>(random.uniform(0, end)); }

std::vector<Simd> instruction_sets_here() {
  std::vector<Simd> sets;
  for (const Simd simd : {Simd::plain, Simd::avx2, Simd::avx512})
    if (simd <= best_simd()) sets.push_back(simd);
  return sets;
}

/// An image with holes, of `points` points in patches.
PixelGrid random_image(Random& random, int width, int height, int points) {
  PixelGrid pixels{width, height, 300, {}, {}};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool hole = random.uniform(0, 1) < 0.1;
      const double depth_m = random.uniform(0.3, 5);
      const Vec3d at = depth_m * Vec3d(1, (x - 20) / 300.0, (y - 15) / 300.0);
      pixels.measured.push_back(hole ? Vec3f(0, 0, 0) : Vec3f(at.cast<float>()));
      pixels.point.push_back(
          hole ? PixelGrid::kNoPoint
               : static_cast<std::uint32_t>((x / 3 + 5 * (y / 4) + below(random, 2)) % points));
    }
  return pixels;
}

NoiseModel stereo_noise() {
  NoiseModel noise;
  noise.estimated = noise.by_range = true;
  noise.growth_per_m = 0.003;
  return noise;
}

TEST(Pixels, RunsAreThePixelsThatWentIntoOnePoint) {
  Random random(1);
  const PixelGrid pixels = random_image(random, 37, 11, 9);
  const std::vector<std::uint32_t> order{8, 6, 7, 5, 3, 0, 2, 4, 1};
  const std::vector<MeasuredRun> runs = make_pixel_runs(pixels, order);
  std::size_t next = 0;
  for (std::size_t r = 0; r + 1 < runs.size(); ++r) {
    EXPECT_EQ(runs[r].begin, next);
    EXPECT_EQ(runs[r].begin / 37, (runs[r + 1].begin - 1) / 37) << "a run in two rows";
    for (; next < runs[r + 1].begin; ++next)
      EXPECT_EQ(runs[r].is_measured() ? order[runs[r].point] : PixelGrid::kNoPoint,
                pixels.point[next]);
  }
  EXPECT_EQ(next, pixels.point.size());
}

TEST(Pixels, RunsOfPlanesCoverEachPixelOfAPlaneOnce) {
  Random random(2);
  const PixelGrid pixels{45, 12, 300, {}, {}};
  for (int round = 0; round < 20; ++round) {
    std::vector<std::int32_t> planes;
    while (planes.size() < 45 * 12)
      planes.resize(std::min<std::size_t>(45 * 12, planes.size() + 1 + below(random, 40)),
                    below(random, 4) - 1);
    std::vector<std::int32_t> covered(planes.size(), -1);
    const PlaneRuns runs = runs_by_plane(pixels, planes, 3);
    for (std::size_t k = 0; k < 3; ++k)
      for (const PlaneRuns::Run& run : runs.of(k))
        for (std::uint32_t p = run.begin; p < run.end; ++p) {
          EXPECT_EQ(covered[p], -1);
          covered[p] = static_cast<std::int32_t>(k);
        }
    EXPECT_EQ(covered, planes);
  }
}

TEST(Pixels, SumsOverWindowsAreThoseOfTheirPixels) {
  Random random(3);
  WindowSums<std::int32_t> sums;
  for (int round = 0; round < 50; ++round) {
    const int width = 1 + below(random, 40), height = 1 + below(random, 40);
    const int half = below(random, 12);
    sums.start(width, height, half);
    std::vector<std::vector<std::int32_t>> values(height, std::vector<std::int32_t>(width));
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) sums.row(y)[x] = values[y][x] = below(random, 2000) - 1000;
    for (int y = below(random, 3); y < height; y += 1 + below(random, 2 * half + 4)) {
      sums.move_to(y);
      for (int x = 0; x < width; ++x) {
        std::int32_t expected = 0;
        for (int v = std::max(0, y - half); v < std::min(height, y + half + 1); ++v)
          for (int u = std::max(0, x - half); u < std::min(width, x + half + 1); ++u)
            expected += values[v][u];
        ASSERT_EQ(sums.at(x), expected) << x << ", " << y << ", half " << half;
      }
    }
  }
}

TEST(Pixels, RaysAndReachAreTheSameWithEveryInstructionSet) {
  Random random(4);
  const PixelGrid pixels = random_image(random, 53, 31, 60);  // no whole number of groups
  const Vec3d sensor(-0.1, 0.2, 0.7);
  std::vector<std::uint32_t> order(60);
  for (std::uint32_t i = 0; i < 60; ++i) order[i] = i;
  const std::vector<MeasuredRun> runs = make_pixel_runs(pixels, order);
  NoiseModel constant = stereo_noise();
  constant.by_range = false;
  constant.constant_m = 0.004;
  for (const NoiseModel& noise : {stereo_noise(), constant, NoiseModel{}})
    for (const Simd simd : instruction_sets_here()) {
      SCOPED_TRACE(to_string(simd));
      const PixelReach reach = measure_pixel_reach(pixels, runs, sensor, noise, 0.012, simd);
      SeenPixels rays(pixels, sensor, simd);
      std::size_t next = 5;
      rays.visit(5, pixels.point.size(), [&](std::size_t i, const PixelGrid::Seen& seen) {
        ASSERT_EQ(i, next++);
        const PixelGrid::Seen expected = pixels.seen(i, sensor);
        ASSERT_EQ(seen.ray, expected.ray);
        ASSERT_EQ(seen.w, expected.w);
        const Vec3d to = pixels.measured[i].cast<double>() - sensor;
        const double range = to.norm();
        ASSERT_EQ(reach.tau_m[i], pixels.has(i) ? noise.tau(range) : -1);
        ASSERT_EQ(reach.reach_px[i],
                  pixels.has(i) ? static_cast<int>(std::clamp(0.012 * 300 / range, 1.0, 20.0)) : 0);
      });
      EXPECT_EQ(next, pixels.point.size());
    }
}

TEST(Pixels, ATileIsLaidOnAPlaneTheSameWithEveryInstructionSet) {
  Random random(5);
  const PixelGrid pixels = random_image(random, 61, 40, 60);
  std::vector<std::uint32_t> order(60);
  for (std::uint32_t i = 0; i < 60; ++i) order[i] = i;
  const PixelReach reach = measure_pixel_reach(pixels, make_pixel_runs(pixels, order),
                                               Vec3d::Zero(), stereo_noise(), 0.012);
  std::vector<std::int32_t> plane;
  for (std::size_t i = 0; i < pixels.point.size(); ++i) plane.push_back(below(random, 3) - 1);
  PlaneFit fit;
  fit.normal = Vec3d(-16 / 300.0, 1, 0.01).normalized();  // along the rays of the tile's middle
  fit.centroid = Vec3d(1, 16 / 300.0, 0);
  TileDepth depth;
  const Rect tile{24, 0, 48, 24}, around = pixels.around(tile, 4);
  depth.load(pixels, reach, plane, tile, 4);
  for (const Simd simd : instruction_sets_here()) {
    SCOPED_TRACE(to_string(simd));
    int on_it = 0;
    for (int y = around.y0; y < around.y1; ++y) {
      std::vector<std::int32_t> off_um(64), counts(64);
      depth_kernels(simd).lay_on(depth.row(around.x0, y), around.width(),
                                 {{fit.normal.x(), fit.normal.y(), fit.normal.z()},
                                  {fit.centroid.x(), fit.centroid.y(), fit.centroid.z()},
                                  1},
                                 off_um.data(), counts.data());
      for (int x = around.x0; x < around.x1; ++x) {
        const std::size_t i = pixels.at(x, y);
        const double tau_m = reach.tau_m[i];
        const double off_m = fit.distance_m(pixels.measured[i].cast<double>());
        const bool on = pixels.has(i) && std::abs(off_m) <= 2 * tau_m;
        on_it += on;
        ASSERT_EQ(off_um[x - around.x0],
                  on ? static_cast<std::int32_t>(std::clamp(off_m, -tau_m, tau_m) * 1e6) : 0);
        ASSERT_EQ(counts[x - around.x0], (on ? 1 : 0) + (plane[i] == 1 ? kOwnPixel : 0));
      }
    }
    EXPECT_GT(on_it, 20);
  }
  for (int y = tile.y0; y < tile.y1; ++y)
    for (int x = tile.x0; x < tile.x1; ++x) {
      int measured = 0;
      const Rect window = pixels.around({x, y, x + 1, y + 1}, 4);
      for (int v = window.y0; v < window.y1; ++v)
        for (int u = window.x0; u < window.x1; ++u) measured += pixels.has(pixels.at(u, v)) ? 1 : 0;
      ASSERT_EQ(depth.measured_in_window(x, y), measured);
    }
}

using Decision = std::tuple<EventType, Stage, std::int32_t, std::int32_t, std::int32_t, float>;
std::vector<Decision> decisions_in(const Trace& trace) {
  std::vector<Decision> all;
  for (const TraceEvent& e : trace.events)
    all.emplace_back(e.type, e.stage, e.plane, e.other, e.point, e.value);
  return all;
}

TEST(Pixels, AreGivenTheSamePlanesByAnyNumberOfThreads) {
  const Frame floor_and_wall = test::floor_and_wall();
  // Upright edges of far boxes side by side.
  const Frame box_edges = test::depth_frame(
      [](double x, double y) {
        for (const double middle : {-0.3, -0.1, 0.1, 0.3}) {
          const double z = 2.8 / (1 - std::abs(x - middle));
          if (std::abs((x - middle) * z) < 0.08 && std::abs(y * z) < 0.15) return z;
        }
        return 0.0;
      },
      0.003);
  const std::tuple<const Frame*, Stage, int> cases[] = {
      {&floor_and_wall, Stage::r11_pixel_borders, 1}, {&box_edges, Stage::r12_part_corners, 4}};
  for (const auto& [frame, stage, least] : cases) {
    const auto [expected, once] = test::traced_result_of(*frame);
    ASSERT_GE(std::ranges::count(once.events, stage, &TraceEvent::stage), least);
    for (const int threads : {2, 5}) {
      const auto [result, trace] = test::traced_result_of(*frame, threads);
      EXPECT_EQ(decisions_in(trace), decisions_in(once));
      EXPECT_EQ(result.segmentation.plane_of, expected.segmentation.plane_of);
      EXPECT_EQ(result.segmentation.plane_of_pixel, expected.segmentation.plane_of_pixel);
    }
  }
}

}  // namespace
}  // namespace planescope::planes
