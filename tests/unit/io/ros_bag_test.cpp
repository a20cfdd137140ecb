// Tests of bags from the RealSense ROS driver: topics, extrinsics and encodings.

#include "core/io/image/png.hpp"
#include "support/jpeg_bytes.hpp"
#include "unit/io/bag_writer.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

using namespace testing_bags;

std::unique_ptr<Recording> open_bag_of(BagWriter& bag) {
  const auto path = temp_folder() / "ros.bag";
  write_file_bytes(path, bag.finish());
  return open_recording(path);
}

void add_stream(BagWriter& bag,
                const std::string& folder,
                const std::string& image_name,
                ImageMessage image,
                const std::string& encoding,
                const std::string& frame_id,
                double fx) {
  image.encoding = encoding;
  image.frame_id = frame_id;
  const auto time_ns = static_cast<std::uint64_t>(1e9 * image.stamp_s);
  bag.add(folder + "/camera_info", "sensor_msgs/CameraInfo", time_ns,
          camera_info_message(kWidth, kHeight, {fx, fx, 12, 8}, "plumb_bob"));
  bag.add(folder + "/" + image_name, "sensor_msgs/Image", time_ns, image_message(image));
}

Pose some_pose() {
  Pose pose = Pose::Identity();
  pose.linear() = Eigen::AngleAxisd(0.2, Vec3d(1, 1, 0).normalized()).toRotationMatrix();
  pose.translation() = Vec3d(0.015, 0, 0);
  return pose;
}

void add_native_and_color(BagWriter& bag, const std::string& camera) {
  for (int i = 0; i < 3; ++i) {
    const double stamp_s = 1000 + 0.1 * i;
    add_stream(bag, camera + "/depth", "image_rect_raw", depth_message(i, stamp_s), "16UC1",
               "camera_depth_optical_frame", 20);
    add_stream(bag, camera + "/color", "image_raw", color_message(50 + i, stamp_s + 0.01), "rgb8",
               "camera_color_optical_frame", 30);
  }
}

TEST(RosBag, NativeDepthIsInMillimetersAndColorUsesTheExtrinsicsTopic) {
  for (const char* camera : {"/camera", "/camera/camera", "/robot/front"}) {
    SCOPED_TRACE(camera);
    BagWriter bag;
    add_native_and_color(bag, camera);
    bag.add(std::string(camera) + "/extrinsics/depth_to_color", "realsense2_camera/Extrinsics", 1,
            extrinsics_message(some_pose()));
    const auto recording = open_bag_of(bag);
    EXPECT_EQ(recording->info().format, "realsense-ros bag");
    EXPECT_EQ(recording->info().depth_unit_m, 0.001);
    EXPECT_EQ(recording->info().depth_unit_source, "ROS convention (16UC1 is in millimeters)");
    ASSERT_EQ(recording->frame_count(), 3);
    const Frame frame = recording->frame(1);
    EXPECT_EQ(frame.depth.data, depth_of(1).data);
    EXPECT_EQ(frame.intrinsics.fx, 20);
    EXPECT_EQ(frame.color.at(0, 0, 0), 51);
    EXPECT_EQ(frame.color_intrinsics.fx, 30);
    EXPECT_TRUE(frame.T_color_depth.isApprox(some_pose(), 1e-9));
  }
}

TEST(RosBag, ExtrinsicsMayComeFromStaticTransforms) {
  BagWriter bag;
  Pose T_link_color = Pose::Identity();
  T_link_color.translation() = Vec3d(0, 0.1, 0);
  T_link_color.linear() = Eigen::AngleAxisd(0.5, Vec3d::UnitZ()).toRotationMatrix();
  bag.add("/tf_static", "tf2_msgs/TFMessage", 1,
          tf_message("camera_link", "camera_color_optical_frame", T_link_color));
  bag.add("/tf_static", "tf2_msgs/TFMessage", 1,
          tf_message("camera_link", "camera_depth_optical_frame", T_link_color * some_pose()));
  add_native_and_color(bag, "/camera");
  const auto recording = open_bag_of(bag);
  EXPECT_EQ(recording->info().color_note, "projected by extrinsics");
  EXPECT_TRUE(recording->frame(0).T_color_depth.isApprox(some_pose(), 1e-9));
}

TEST(RosBag, WithoutExtrinsicsTheAlignedTopicIsUsedElseColorIsOnlyDisplayed) {
  BagWriter shown;
  add_native_and_color(shown, "/camera");
  EXPECT_EQ(open_bag_of(shown)->info().color_note,
            "display only: the bag has no depth-to-color extrinsics");
  BagWriter bag;
  add_native_and_color(bag, "/camera");
  add_stream(bag, "/camera/aligned_depth_to_color", "image_raw", depth_message(90, 1000), "16UC1",
             "camera_color_optical_frame", 30);
  const auto recording = open_bag_of(bag);
  EXPECT_EQ(recording->info().color_note, "aligned");
  ASSERT_EQ(recording->frame_count(), 1);
  EXPECT_TRUE(recording->frame(0).color_aligned);
  EXPECT_EQ(recording->frame(0).intrinsics.fx, 30);
}

TEST(RosBag, DepthInAnUnsupportedEncodingIsRejectedWithTheSupportedOnes) {
  BagWriter bag;
  add_stream(bag, "/camera/depth", "image", depth_message(1, 1000), "64FC1", "f", 20);
  expect_one_line_with(message_of([&] { open_bag_of(bag); }), {"64FC1", "16UC1", "32FC1"});
}

TEST(RosBag, CompressedDepthIsReadButTheRawTopicIsPreferred) {
  BagWriter bag;
  const std::string depth = "/camera/depth";
  for (int i = 0; i < 2; ++i) {
    const double stamp_s = 1000 + 0.1 * i;
    const auto time_ns = static_cast<std::uint64_t>(1e9 * stamp_s);
    bag.add(depth + "/camera_info", "sensor_msgs/CameraInfo", time_ns,
            camera_info_message(kWidth, kHeight, {20, 20, 12, 8}, "plumb_bob"));
    const ByteVector data = with_config(encode_png(depth_of(i)));
    bag.add(depth + "/image_rect_raw/compressedDepth", "sensor_msgs/CompressedImage", time_ns,
            compressed_image_message(stamp_s, "depth", "16UC1; compressedDepth png", data));
    const std::vector<unsigned char> jpeg = encode_jpeg(kWidth, kHeight, false);
    bag.add(depth + "/image_rect_raw/compressed", "sensor_msgs/CompressedImage", time_ns,
            compressed_image_message(stamp_s, "depth", "mono16; jpeg compressed", jpeg));
  }
  const auto recording = open_bag_of(bag);
  ASSERT_EQ(recording->frame_count(), 2);
  for (int i = 0; i < 2; ++i) EXPECT_EQ(recording->frame(i).depth.data, depth_of(i).data);
}

}  // namespace
}  // namespace planescope::io
