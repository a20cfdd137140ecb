// Tests of the C interface, and of the layout of public structs.

#include <gtest/gtest.h>
#include <planescope/planescope.h>

#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <planescope/io.hpp>
#include <string>
#include <vector>

namespace {

struct FreeSegmenter {
  void operator()(planescope_segmenter* p) const { planescope_segmenter_free(p); }
};
struct FreeResult {
  void operator()(planescope_result* p) const { planescope_result_free(p); }
};
using Segmenter = std::unique_ptr<planescope_segmenter, FreeSegmenter>;
using Result = std::unique_ptr<planescope_result, FreeResult>;

/// A level camera 30 cm above a floor.
struct Floor {
  std::vector<float> meters;
  std::vector<std::uint16_t> counts;
  double gravity[3] = {0, 1, 0};
  planescope_depth depth = {};

  Floor() {
    depth.camera = {160, 120, 120, 120, 79.5, 59.5, PLANESCOPE_NO_DISTORTION, {}};
    depth.gravity = gravity;
    for (int i = 0; i < 160 * 120; ++i) {
      const double down = (i / 160 - 59.5) / 120;
      counts.push_back(down > 0.25 ? static_cast<std::uint16_t>(std::lround(300 / down)) : 0);
      meters.push_back(down > 0.25 ? static_cast<float>(0.001 * counts.back()) : std::nanf(""));
    }
    depth.meters = meters.data();
  }
};

TEST(CInterface, MetersAndCountsGiveTheSamePlanes) {
  Floor floor;
  floor.meters[0] = std::numeric_limits<float>::infinity();
  floor.meters[1] = 0;
  floor.meters[2] = -1;
  const Segmenter segmenter(planescope_segmenter_create(nullptr, 0, 1));
  ASSERT_TRUE(segmenter);
  const Result of_meters(planescope_segment(segmenter.get(), &floor.depth));
  ASSERT_TRUE(of_meters) << planescope_last_error();
  floor.depth.meters = nullptr;
  floor.depth.counts = floor.counts.data();
  const Result of_counts(planescope_segment(segmenter.get(), &floor.depth));
  ASSERT_TRUE(of_counts) << planescope_last_error();
  EXPECT_STREQ(planescope_result_json(of_meters.get()), planescope_result_json(of_counts.get()));

  ASSERT_EQ(planescope_result_plane_count(of_meters.get()), 1U);
  planescope_plane plane;
  ASSERT_EQ(planescope_result_plane(of_meters.get(), 0, &plane), 0);
  EXPECT_EQ(plane.label, PLANESCOPE_HORIZONTAL);
  EXPECT_NEAR(plane.tilt_deg, 0, 0.5);
  EXPECT_NEAR(plane.offset_m, -0.30, 0.002);
  EXPECT_NEAR(plane.height_m, 0, 0.002);
  EXPECT_EQ(planescope_result_labels(of_meters.get())[119 * 160 + 80], plane.id);
  EXPECT_EQ(planescope_result_labels(of_meters.get())[0], 0);
  double pose[16];
  planescope_result_pose(of_meters.get(), pose);
  EXPECT_NEAR(pose[2 * 4 + 1], -1, 1e-9);  // the sensor's y points down in the world
  EXPECT_STREQ(planescope_version(), PLANESCOPE_VERSION);
}

extern "C" int print_planes(const std::uint16_t* counts);  // of docs/library.md

TEST(CInterface, TheProgramInTheDocumentsPrintsPlanes) {
  std::vector<std::uint16_t> counts;
  for (int i = 0; i < 640 * 480; ++i) {
    const double down = (i / 640 - 239.5) / 385;
    counts.push_back(down > 0.2 ? static_cast<std::uint16_t>(std::lround(300 / down)) : 0);
  }
  testing::internal::CaptureStdout();
  EXPECT_EQ(print_planes(counts.data()), 0);
  EXPECT_EQ(testing::internal::GetCapturedStdout().rfind("plane 1: ", 0), 0U);
}

TEST(CInterface, FailuresReturnNullAndAReasonInOneLine) {
  const auto error_of = [](auto&& change) {
    Floor floor;
    change(floor);
    const Segmenter segmenter(planescope_segmenter_create(nullptr, 0, 1));
    const Result result(planescope_segment(segmenter.get(), &floor.depth));
    return result ? std::string() : std::string(planescope_last_error());
  };
  EXPECT_EQ(error_of([](Floor& f) { f.depth.meters = nullptr; }),
            "depth image: neither counts nor meters; expected one or the other");
  EXPECT_EQ(error_of([](Floor& f) { f.depth.counts = f.counts.data(); }),
            "depth image: both counts and meters; expected one or the other");
  EXPECT_EQ(error_of([](Floor& f) { f.depth.camera.width = -1; }),
            "depth image: -1x120 pixels; expected 1 to 16384 in each direction");
  EXPECT_EQ(error_of([](Floor& f) { f.depth.row_stride = 3; }),
            "depth image: row stride 3; expected at least the width, 160");
  EXPECT_EQ(error_of([](Floor& f) { f.depth.camera.distortion = -7; }),
            "depth image: distortion -7; expected a planescope_distortion, 0 to 2");
  EXPECT_EQ(error_of([](Floor& f) { f.depth.unit_m = -1; }),
            "depth image: -1 m per count; expected more than 0 and at most 1");
  EXPECT_EQ(error_of([](Floor& f) { f.gravity[1] = 0; }),
            "gravity: 0, 0, 0; expected a nonzero direction");

  const planescope_option unknown[] = {{"theta_n_ou", "3"}}, no_value[] = {{"profile", nullptr}};
  EXPECT_EQ(planescope_segmenter_create(unknown, 1, 1), nullptr);
  EXPECT_NE(std::string(planescope_last_error()).find("theta_n_out"), std::string::npos);
  EXPECT_EQ(planescope_segmenter_create(no_value, 1, 1), nullptr);
  EXPECT_STREQ(planescope_last_error(), "option 0: NULL; expected a name and a value");
  EXPECT_EQ(planescope_segmenter_create(nullptr, 0, 0), nullptr);
  EXPECT_STREQ(planescope_last_error(), "threads: 0; expected 1 or more");
  EXPECT_EQ(planescope_segment(nullptr, nullptr), nullptr);
  planescope_segmenter_free(nullptr);
  planescope_result_free(nullptr);
}

// Programs contain the sizes of these structs. A failure here is a change of the ABI: revert it, or
// raise the minor version in CMakeLists.txt, and thereby the soname, and update the size
// (docs/library.md).
#if defined(__x86_64__) && defined(__GLIBCXX__)
static_assert(sizeof(planescope::Camera) == 88);
static_assert(sizeof(planescope::ColorImage) == 232);
static_assert(sizeof(planescope::DepthImage) == 384);
static_assert(sizeof(planescope::PointCloud) == 56);
static_assert(sizeof(planescope::Gravity) == 64);
static_assert(sizeof(planescope::Frame) == 16 && sizeof(planescope::Result) == 16);
static_assert(sizeof(planescope::Trace) == 16 && sizeof(planescope::Segmenter) == 16);
static_assert(sizeof(planescope::Options) == 8);
static_assert(sizeof(planescope::OptionInfo) == 248);
static_assert(sizeof(planescope::Outline) == 104);
static_assert(sizeof(planescope::Plane) == 296);
static_assert(sizeof(planescope::Mesh) == 48);
static_assert(sizeof(planescope::Counts) == 56 && sizeof(planescope::Timings) == 40);
static_assert(sizeof(planescope::Event) == 24 && sizeof(planescope::Node) == 232);
static_assert(sizeof(planescope::RecordingOptions) == 64);
static_assert(sizeof(planescope_camera) == 88 && sizeof(planescope_depth) == 128);
static_assert(sizeof(planescope_plane) == 104 && offsetof(planescope_plane, points) == 96);
#endif

}  // namespace
