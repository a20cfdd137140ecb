// Gravity over a real recording ($PLANESCOPE_DATA): a camera turned by hand above a desk, against
// motion capture. A third of its frames see no floor, and their own estimates are missing or wrong.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <numbers>

#include "core/io/recording.hpp"
#include "core/world/poses/sequence_gravity.hpp"
#include "core/world/poses/trajectory.hpp"

namespace planescope::world {
namespace {

TEST(RealGravity, OfADeskIsKnownToEveryFrameAndNeverFarOff) {
  const char* data = std::getenv("PLANESCOPE_DATA");
  if (!data) GTEST_SKIP() << "PLANESCOPE_DATA is not set";
  const std::filesystem::path path = std::filesystem::path(data) / "tum_fr1_rpy_kinect_640x480";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  io::RecordingOptions options;
  options.intrinsics = {517.3, 516.5, 318.6, 255.3};
  options.depth_unit_m = 0.0002;
  const std::shared_ptr<const io::Recording> recording = io::open_recording(path, options);
  const Trajectory truth = read_trajectory(path / "poses.tum");
  ASSERT_EQ(static_cast<int>(truth.poses.size()), recording->frame_count());
  const SequenceGravity gravity(recording, {});
  int carried = 0;
  double most_deg = 0;
  for (int i = 0; i < recording->frame_count(); i += 25) {
    Frame frame = recording->frame(i);
    frame.gravity.reset();
    gravity.resolve(frame);
    ASSERT_TRUE(frame.gravity) << "frame " << i;
    carried += frame.gravity->source == GravitySource::carried;
    const Vec3d down = truth.poses[i].T_world_camera.linear().transpose() * -Vec3d::UnitZ();
    most_deg = std::max(most_deg, std::atan2(frame.gravity->direction.cross(down).norm(),
                                             frame.gravity->direction.dot(down)) *
                                      180 / std::numbers::pi);
  }
  EXPECT_GE(carried, 4);
  EXPECT_LE(most_deg, 7);  // 6.3 over all 300 frames
}

}  // namespace
}  // namespace planescope::world
