// Tests of gravity from the IMU samples of bag files.

#include "unit/io/bag_writer.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

using namespace testing_bags;

constexpr double kG = 9.80665;

std::optional<Gravity> gravity_of(BagWriter& bag, int frame = 0) {
  const auto path = temp_folder() / "imu.bag";
  write_file_bytes(path, bag.finish());
  return open_recording(path)->frame(frame).gravity;
}

void add_imu(BagWriter& bag,
             const std::string& topic,
             int count,
             const Vec3d& mean,
             std::uint64_t from_ns = 100) {
  for (int i = 0; i < count; ++i) {
    const Vec3d noise(i % 2 ? 0.3 : -0.3, i % 2 ? -0.2 : 0.2, 0);
    bag.add(topic, "sensor_msgs/Imu", from_ns + 5'000'000u * i,
            imu_message(i, 5 + 0.005 * i, mean + noise, "imu_frame"));
  }
}

void add_ros_depth(BagWriter& bag, const std::string& camera) {
  auto depth = depth_message(7, 5);
  depth.encoding = "16UC1";
  depth.frame_id = "depth_frame";
  bag.add(camera + "/depth/camera_info", "sensor_msgs/CameraInfo", 10,
          camera_info_message(kWidth, kHeight, {20, 21, 12, 8}, "plumb_bob"));
  bag.add(camera + "/depth/image_rect_raw", "sensor_msgs/Image", 20, image_message(depth));
}

TEST(ImuGravity, ALevelSdkRecordingHasGravityAlongY) {
  BagWriter bag = sdk_bag({});
  add_imu(bag, kSdkAccel + "/imu/data", 40, Vec3d(0, -kG, 0));
  const auto gravity = gravity_of(bag);
  ASSERT_TRUE(gravity);
  EXPECT_EQ(gravity->source, GravitySource::imu);
  EXPECT_NEAR(gravity->direction.y(), 1, 1e-6);
  EXPECT_EQ(gravity->confidence, 1);
  EXPECT_NE(gravity->note.find("40 accelerometer samples"), std::string::npos) << gravity->note;
}

TEST(ImuGravity, ATiltedCameraAndTheSensorsAxesAreRespected) {
  const Vec3d down = Vec3d(0.1, 0.8, 0.5).normalized();
  Pose T_accel_reference = Pose::Identity();
  T_accel_reference.linear() =
      Eigen::AngleAxisd(1.2, Vec3d(1, 2, 3).normalized()).toRotationMatrix();
  T_accel_reference.translation() = Vec3d(0.01, 0.02, 0.03);
  BagWriter bag = sdk_bag({});
  bag.add(kSdkAccel + "/tf/0", "geometry_msgs/Transform", 1, transform_message(T_accel_reference));
  add_imu(bag, kSdkAccel + "/imu/data", 40, T_accel_reference.linear() * (-kG * down));
  const auto gravity = gravity_of(bag);
  ASSERT_TRUE(gravity);
  EXPECT_NEAR((gravity->direction - down).norm(), 0, 1e-6);
}

TEST(ImuGravity, RosTopicsOfBothGenerationsAreFound) {
  for (const auto& [camera, topic] :
       {std::pair("/camera", "/camera/accel/sample"), std::pair("/camera", "/camera/imu"),
        std::pair("/camera/camera", "/camera/camera/imu")}) {
    SCOPED_TRACE(topic);
    BagWriter bag;
    add_ros_depth(bag, camera);
    add_imu(bag, topic, 20, Vec3d(0, -kG, 0));
    const auto gravity = gravity_of(bag);
    ASSERT_TRUE(gravity);
    EXPECT_NEAR(gravity->direction.y(), 1, 1e-6);
  }
}

TEST(ImuGravity, RosStaticTransformsRotateItToTheDepthFrame) {
  Pose T_link_depth = Pose::Identity();
  T_link_depth.linear() = Eigen::AngleAxisd(0.7, Vec3d::UnitX()).toRotationMatrix();
  Pose T_link_imu = Pose::Identity();
  T_link_imu.linear() = Eigen::AngleAxisd(-0.4, Vec3d::UnitZ()).toRotationMatrix();
  BagWriter bag;
  bag.add("/tf_static", "tf2_msgs/TFMessage", 1, tf_message("link", "depth_frame", T_link_depth));
  bag.add("/tf_static", "tf2_msgs/TFMessage", 1, tf_message("link", "imu_frame", T_link_imu));
  add_ros_depth(bag, "/camera");
  const Vec3d down_link(0, 0, -1);
  add_imu(bag, "/camera/imu", 20, T_link_imu.linear().transpose() * (-kG * down_link));
  const auto gravity = gravity_of(bag);
  ASSERT_TRUE(gravity);
  EXPECT_NEAR((gravity->direction - T_link_depth.linear().transpose() * down_link).norm(), 0, 1e-6);
}

TEST(ImuGravity, EachFrameUsesTheSamplesAroundIt) {
  BagWriter bag;
  add_sdk_statics(bag, {});
  for (int i = 0; i < 2; ++i) {
    const std::uint64_t time_ns = 10'000'000'000u * (i + 1);
    add_depth(bag, time_ns, depth_message(100 + i, 5 + i));
    add_imu(bag, kSdkAccel + "/imu/data", 100, i == 0 ? Vec3d(0, -kG, 0) : Vec3d(-kG, 0, 0),
            time_ns - 250'000'000u);
  }
  const auto path = temp_folder() / "imu.bag";
  write_file_bytes(path, bag.finish());
  const auto recording = open_recording(path);
  EXPECT_NEAR(recording->frame(0).gravity->direction.y(), 1, 1e-6);
  EXPECT_NEAR(recording->frame(1).gravity->direction.x(), 1, 1e-6);
}

TEST(ImuGravity, AShakingOrBrokenSensorGivesNone) {
  for (const Vec3d& mean : {Vec3d(0, -2, 0), Vec3d(0, -30, 0), Vec3d(NAN, NAN, NAN)}) {
    BagWriter bag = sdk_bag({});
    add_imu(bag, kSdkAccel + "/imu/data", 10, mean);
    EXPECT_FALSE(gravity_of(bag));
  }
  BagWriter without = sdk_bag({});
  EXPECT_FALSE(gravity_of(without));
}

TEST(ImuGravity, ASidecarOverridesIt) {
  BagWriter bag = sdk_bag({});
  add_imu(bag, kSdkAccel + "/imu/data", 10, Vec3d(0, -kG, 0));
  const auto path = temp_folder() / "imu.bag";
  write_file_bytes(path, bag.finish());
  write_text(path.string() + ".planescope.json",
             R"({"gravity": [0, 0, 2], "frames": [{"name": "101", "gravity": [1, 0, 0]}]})");
  const auto recording = open_recording(path);
  EXPECT_EQ(recording->frame(0).gravity->source, GravitySource::sidecar);
  EXPECT_NEAR(recording->frame(0).gravity->direction.z(), 1, 1e-12);
  EXPECT_NEAR(recording->frame(1).gravity->direction.x(), 1, 1e-12);
}

}  // namespace
}  // namespace planescope::io
