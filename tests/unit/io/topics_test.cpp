// Tests of bags with several topics to choose from, with depth in meters, and with point clouds.

#include <bit>
#include <cmath>
#include <limits>
#include <set>

#include "core/planes/cloud/gravity.hpp"
#include "unit/io/bag_writer.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

using namespace testing_bags;
namespace fs = std::filesystem;

const std::string kImage = "sensor_msgs/msg/Image", kCloud = "sensor_msgs/msg/PointCloud2";
constexpr std::uint64_t kStart_ns = 1'700'000'000'000'000'000;

RecordingOptions with_topic(const std::string& topic) {
  RecordingOptions options;
  options.topic = topic;
  return options;
}

/// Calls the function with the same messages in each container.
void in_every_container(const Ros2Messages& messages,
                        const std::function<void(const fs::path&)>& check) {
  const fs::path folder = temp_folder();
  write_db3(folder / "a.db3", messages);
  write_mcap(folder / "a.mcap", messages);
  for (const char* name : {"a.db3", "a.mcap"}) {
    SCOPED_TRACE(name);
    check(folder / name);
  }
}

Ros2Messages two_cameras() {
  Ros2Messages both = realsense_ros_messages(3, "/front");
  const Ros2Messages rear = realsense_ros_messages(2, "/rear");
  both.insert(both.end(), rear.begin(), rear.end());
  std::ranges::stable_sort(both, {}, &Ros2Message::time_ns);
  return both;
}

TEST(Topics, TheFirstOfTwoCamerasIsReadWithAWarningAndTheOtherByName) {
  in_every_container(two_cameras(), [](const fs::path& path) {
    const auto first = open_recording(path);
    EXPECT_EQ(first->frame_count(), 3);
    ASSERT_EQ(first->info().warnings.size(), 1U);
    expect_one_line_with(first->info().warnings[0],
                         {"2 depth cameras; reading /front/depth/image_rect_raw", "--topic"});
    EXPECT_EQ(first->info().topics, (std::vector<std::string>{"/front/depth/image_rect_raw",
                                                              "/rear/depth/image_rect_raw"}));
    const auto second = open_recording(path, with_topic("/rear/depth/image_rect_raw"));
    EXPECT_EQ(second->frame_count(), 2);
    EXPECT_TRUE(second->info().warnings.empty());
    EXPECT_EQ(second->info().topics.front(), "/rear/depth/image_rect_raw");
    EXPECT_EQ(second->info().intrinsics_source, "bag topic /rear/depth/camera_info");
    EXPECT_TRUE(second->info().has_color);
    expect_refused(path, with_topic("/top"),
                   {"--topic /top: no image or point cloud topic has this name",
                    "found /front/depth/image_rect_raw, /rear"});
    expect_refused(path, with_topic("/rear/color/image_raw"), {"encoded as \"rgb8\"", "32FC1"});
  });
}

TEST(Topics, RecordingsWithoutTopicsAreRefused) {
  const fs::path folder = temp_folder();
  write_text(folder / "a.ply", "ply\n");
  fs::create_directories(folder / "depth");
  write_file_bytes(folder / "depth/000000.png", encode_png(depth_of(1)));
  expect_refused(
      folder / "depth", with_topic("/depth"),
      {"a folder of 16-bit depth PNGs, which has no topics", "requires a RealSense or ROS .bag"});
  expect_refused(folder / "a.ply", with_topic("/depth"), {"cloud, which has no topics"});
}

TEST(Topics, AStreamOfTheSdkIsSelectedByItsTopic) {
  SdkBag options;
  BagWriter bag = sdk_bag(options);
  const std::string other = "/device_1/sensor_0/Depth_0";
  bag.add(other + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
          camera_info_message(kWidth, kHeight, {40, 41, 12, 8}));
  bag.add(other + "/image/data", "sensor_msgs/Image", 11, image_message(depth_message(7, 5)));
  const fs::path path = temp_folder() / "two.bag";
  write_file_bytes(path, bag.finish());
  const auto recording = open_recording(path, with_topic(other + "/image/data"));
  ASSERT_EQ(recording->frame_count(), 1);
  EXPECT_EQ(recording->info().intrinsics.fx, 40);
  EXPECT_EQ(recording->frame(0).depth.data, depth_of(7).data);
  EXPECT_FALSE(recording->info().has_color);  // color belongs to the other device
}

TEST(Topics, ADepthTopicOfAnyNameIsReadIfSelected) {
  Ros2Messages messages = realsense_ros_messages(2, "/camera");
  for (Ros2Message& message : messages)
    if (message.topic.starts_with("/camera/depth/"))
      message.topic.replace(0, 14, "/camera/stereo_depth_registered/");
  in_every_container(messages, [](const fs::path& path) {
    expect_refused(path, {"no depth images", "--topic"});
    const auto recording =
        open_recording(path, with_topic("/camera/stereo_depth_registered/image_rect_raw"));
    EXPECT_EQ(recording->frame_count(), 2);
    EXPECT_TRUE(recording->info().has_color);
  });
}

// ---- Depth in meters ----

ByteVector bytes_of(const std::vector<float>& values) {
  ByteVector bytes(values.size() * sizeof(float));
  std::memcpy(bytes.data(), values.data(), bytes.size());
  return bytes;
}

/// Millimeters of depth_of(100) in meters, followed by invalid values.
std::vector<float> meters() {
  std::vector<float> values;
  for (const std::uint16_t mm : depth_of(100).data) values.push_back(0.001f * mm);
  const float infinity = std::numeric_limits<float>::infinity();
  const float odd[] = {NAN, infinity, -infinity, -1, 0, 70, 1.23457f};
  std::copy(std::begin(odd), std::end(odd), values.begin());
  return values;
}

Ros2Messages with_meters(bool big_endian = false) {
  Ros2Messages messages = realsense_ros_messages(2, "/camera");
  for (Ros2Message& message : messages) {
    if (message.topic != "/camera/depth/image_rect_raw") continue;
    ImageMessage image = depth_message(100, 1'700'000'000);
    image.frame_id = "depth_optical";
    image.encoding = "32FC1";
    image.pixels = bytes_of(meters());
    image.big_endian = big_endian;
    image.row_padding = 12;
    if (big_endian)
      for (std::size_t at = 0; at < image.pixels.size(); at += 4)
        std::reverse(&image.pixels[at], &image.pixels[at] + 4);
    message.bytes = image_message(image, testing_bags::Wire::cdr);
  }
  return messages;
}

TEST(DepthInMeters, IsRoundedByOneRule) {
  const auto rounded = [](std::vector<float> meters, std::optional<double> unit_m = {}) {
    Image16 counts(static_cast<int>(meters.size()), 1);
    const double used_m = round_meters(meters, unit_m, counts);
    return std::pair(used_m, counts.data);
  };
  using Counts = std::vector<std::uint16_t>;
  EXPECT_EQ(rounded({0.001f, NAN, 1.234f, 65.534f}), std::pair(0.001, Counts{1, 0, 1234, 65534}));
  EXPECT_EQ(rounded({1.2342f, 13.1068f}), std::pair(0.0002, Counts{6171, 65534}));
  EXPECT_EQ(rounded({1.2342f, 13.11f}), std::pair(0.001, Counts{1234, 13110}));
  EXPECT_EQ(rounded({1.2342f, 65.6f}), std::pair(0.0002, Counts{6171, 65535}));
  EXPECT_EQ(rounded({1.2342f, -1, 7}, 0.0001), std::pair(0.0001, Counts{12342, 0, 65535}));
  // Frames of a bag may have different steps.
  Ros2Messages messages = realsense_ros_messages(2, "/camera");
  float scale = 1.0001f;
  for (Ros2Message& message : messages) {
    if (message.topic != "/camera/depth/image_rect_raw") continue;
    ImageMessage image = depth_message(100, 1'700'000'000);
    const Image16 depth = depth_of(100);
    std::vector<float> values(depth.data.begin(), depth.data.end());
    for (float& value : values) value *= 0.001f * scale;
    scale = 1;
    image.encoding = "32FC1";
    image.pixels = bytes_of(values);
    message.bytes = image_message(image, testing_bags::Wire::cdr);
  }
  in_every_container(messages, [](const fs::path& path) {
    const auto recording = open_recording(path);
    EXPECT_EQ(recording->frame(0).depth_unit_m, 0.0002);
    EXPECT_EQ(recording->frame(1).depth_unit_m, 0.001);
    EXPECT_EQ(recording->frame(1).depth.data, depth_of(100).data);
  });
}

TEST(DepthInMeters, IsRoundedToAFifthOfAMillimeterAndHashedByItsBytes) {
  const std::vector<float> recorded = meters();
  const std::string hash = sha256_hex(std::as_bytes(std::span(recorded)));
  for (const bool big_endian : {false, true})
    in_every_container(with_meters(big_endian), [&](const fs::path& path) {
      const auto recording = open_recording(path);
      EXPECT_EQ(recording->info().depth_unit_m, 0.0002);
      EXPECT_TRUE(recording->info().rounded);
      expect_one_line_with(recording->info().depth_unit_source, {"32FC1", "rounding"});
      const Frame frame = recording->frame(0);
      const std::vector<std::uint16_t> odd(frame.depth.data.begin(), frame.depth.data.begin() + 7);
      // Beyond 65.5 m a pixel is invalid, as 65535 always is.
      EXPECT_EQ(odd, (std::vector<std::uint16_t>{0, 0, 0, 0, 0, 65535, 6173}));
      for (std::size_t i = 7; i < frame.depth.data.size(); ++i)
        ASSERT_EQ(frame.depth.data[i], 5 * depth_of(100).data[i]);
      EXPECT_EQ(frame.depth_unit_m, 0.0002);
      EXPECT_EQ(recording->frame_hash(0), hash);
      RecordingOptions coarse;
      coarse.depth_unit_m = 0.002;
      const auto in_steps = open_recording(path, coarse);
      EXPECT_EQ(in_steps->frame(0).depth.data[5], 35000);
      EXPECT_EQ(in_steps->frame(0).depth_unit_m, 0.002);
      EXPECT_EQ(in_steps->frame_hash(0), hash);  // labels fit, whatever the step
    });
}

TEST(DepthInMeters, OfARos1BagIsReadAndATruncatedImageIsRejected) {
  for (const std::size_t missing : {0, 4}) {
    BagWriter bag;
    ImageMessage image = depth_message(100, 1000);
    image.encoding = "32FC1";
    image.pixels = bytes_of(meters());
    image.pixels.resize(image.pixels.size() - missing * kHeight);
    bag.add("/camera/depth/camera_info", "sensor_msgs/CameraInfo", 1,
            camera_info_message(kWidth, kHeight, {20, 20, 12, 8}));
    bag.add("/camera/depth/image", "sensor_msgs/Image", 2, image_message(image));
    const fs::path path = temp_folder() / "a.bag";
    write_file_bytes(path, bag.finish());
    const auto recording = open_recording(path);
    if (missing == 0)
      EXPECT_EQ(recording->frame(0).depth.data[6], 6173);
    else
      expect_one_line_with(message_of([&] { recording->frame(0); }),
                           {"a message on /camera/depth/image is damaged"});
  }
}

// ---- Point clouds ----

struct CloudMessage {
  std::string frame_id = "camera_depth_optical_frame";
  std::size_t width = 4, height = 3;
  std::size_t padding = 8;  // bytes after each row
  std::uint32_t offset_of_z = 8;
  bool has_z = true;
};

/// Points (i, 2 i, 1 + i / 8) with a color, in realsense-ros's layout.
ByteVector cloud_message(const CloudMessage& cloud,
                         testing_bags::Wire wire = testing_bags::Wire::cdr) {
  constexpr std::uint32_t kStep = 20;
  Fields data;
  for (std::size_t row = 0; row < cloud.height; ++row) {
    for (std::size_t column = 0; column < cloud.width; ++column) {
      const auto i = static_cast<float>(row * cloud.width + column);
      data.put(i).put(2 * i).put(1 + i / 8).put_32(0).put_32(0x00102030);
    }
    data.raw(ByteVector(cloud.padding, 0xee));
  }
  Fields fields(wire);
  fields.header(3, 1'700'000'000.5, cloud.frame_id).put_32(cloud.height).put_32(cloud.width);
  fields.put_32(cloud.has_z ? 4 : 3);
  const auto field = [&](const char* name, std::uint32_t offset) {
    fields.text(name).put(offset).put(std::uint8_t{7}).put_32(1);
  };
  field("x", 0);
  field("y", 4);
  if (cloud.has_z) field("z", cloud.offset_of_z);
  field("rgb", 16);
  fields.put(std::uint8_t{0}).put(kStep).put_32(kStep * cloud.width + cloud.padding);
  return fields.sized(data.out).put(std::uint8_t{1}).out;
}

Ros2Messages clouds(const CloudMessage& cloud, int count = 2) {
  Ros2Messages messages;
  for (int i = 0; i < count; ++i)
    messages.push_back({"/camera/depth/color/points", kCloud,
                        kStart_ns + static_cast<std::uint64_t>(i) * 1'000'000,
                        cloud_message(cloud)});
  return messages;
}

TEST(CloudTopic, OrganizedAndUnorganizedCloudsKeepTheOrderOfTheirPoints) {
  for (const std::size_t height : {1, 3})
    in_every_container(clouds({.width = 12 / height, .height = height}), [](const fs::path& path) {
      const auto recording = open_recording(path);
      EXPECT_TRUE(recording->info().format.starts_with("point clouds in a ROS 2 bag"));
      EXPECT_EQ(recording->info().width, 0);
      EXPECT_TRUE(recording->info().warnings.empty());
      ASSERT_EQ(recording->frame_count(), 2);
      EXPECT_NEAR(recording->timestamp_s(1), 1'700'000'000.5, 1e-6);
      const Frame frame = recording->frame(1);
      ASSERT_TRUE(frame.is_cloud());
      ASSERT_EQ(frame.cloud->points.size(), 12U);
      EXPECT_EQ(frame.cloud->points[5], Vec3f(5, 10, 1.625f));
      EXPECT_EQ(frame.cloud->rgb[3 * 5 + 1], 0x20);
      EXPECT_EQ(recording->frame_hash(0), recording->frame_hash(1));
    });
}

TEST(CloudTopic, InAnOpticalFrameYPointsDownAndOtherwiseZPointsUp) {
  const auto gravity_of = [](const std::string& frame_id) {
    const fs::path path = temp_folder() / "a.mcap";
    write_mcap(path, clouds({.frame_id = frame_id}));
    return planes::resolve_gravity(open_recording(path)->frame(0), {});
  };
  EXPECT_EQ(gravity_of("camera_depth_optical_frame").direction, Vec3d(0, 1, 0));
  EXPECT_EQ(gravity_of("camera_depth_optical_frame").source, GravitySource::assumed);
  EXPECT_EQ(gravity_of("velodyne").direction, Vec3d(0, 0, -1));
}

TEST(CloudTopic, GravityComesFromAnAccelerometerWithTransforms) {
  Ros2Messages messages = clouds({});
  Pose T_depth_accel = Pose::Identity();
  T_depth_accel.linear() = Eigen::AngleAxisd(M_PI / 2, Vec3d::UnitX()).toRotationMatrix();
  const auto wire = testing_bags::Wire::cdr;
  messages.push_back({"/camera/imu", "sensor_msgs/msg/Imu", kStart_ns,
                      imu_message(1, 1'700'000'000, Vec3d(0, 0, 9.8), "accel_optical", wire)});
  const auto gravity = [&] {
    const fs::path path = temp_folder() / "a.mcap";
    write_mcap(path, messages);
    return open_recording(path)->frame(0).gravity;
  };
  EXPECT_FALSE(gravity());
  messages.push_back(
      {"/tf_static", "tf2_msgs/msg/TFMessage", kStart_ns,
       tf_message("camera_depth_optical_frame", "accel_optical", T_depth_accel, wire)});
  ASSERT_TRUE(gravity());
  EXPECT_TRUE(gravity()->direction.isApprox(Vec3d(0, 1, 0), 1e-9));
}

TEST(CloudTopic, DepthImagesArePreferredToCloudsUnlessSelected) {
  Ros2Messages messages = realsense_ros_messages(3, "/camera");
  const Ros2Messages more = clouds({});
  messages.insert(messages.end(), more.begin(), more.end());
  in_every_container(messages, [](const fs::path& path) {
    const auto depth = open_recording(path);
    EXPECT_EQ(depth->frame_count(), 3);
    EXPECT_TRUE(depth->info().warnings.empty());
    EXPECT_EQ(depth->info().topics.back(), "/camera/depth/color/points");
    const auto points = open_recording(path, with_topic("/camera/depth/color/points"));
    EXPECT_EQ(points->frame_count(), 2);
    EXPECT_TRUE(points->frame(0).is_cloud());
  });
}

TEST(CloudTopic, UnsupportedFieldsAndTruncatedCloudsAreRejected) {
  const fs::path path = temp_folder() / "a.mcap";
  write_mcap(path, clouds({.has_z = false}));
  expect_refused(path, {"cloud 0 on /camera/depth/color/points", "expected x, y, and z"});
  write_mcap(path, clouds({.offset_of_z = 17}));
  expect_refused(path, {"field \"z\" at byte 17 extends beyond the 20-byte point"});
  RecordingOptions options;
  options.instance_field = "plane";
  write_mcap(path, clouds({}));
  expect_one_line_with(message_of([&] { open_recording(path, options)->frame(0); }),
                       {"points have no 'plane' field"});
  const ByteVector whole = cloud_message({});
  for (std::size_t cut = 0; cut + 1 < whole.size(); cut += 3) {
    Ros2Messages messages = clouds({}, 1);
    messages[0].bytes.resize(cut);
    write_mcap(path, messages);
    expect_refused(path, {"a.mcap"});
  }
}

// ---- MCAP files with a minimal or huge summary ----

TEST(McapSummary, WithoutStatisticsTheFileIsScanned) {
  const fs::path path = temp_folder() / "a.mcap";
  for (const std::size_t in_chunk : {0, 3}) {
    McapForm form{"", in_chunk, true, "cdr"};
    form.statistics = false;
    write_mcap(path, sdk_messages(4), form);
    const auto recording = open_recording(path);
    EXPECT_EQ(recording->frame_count(), 4);
    EXPECT_TRUE(recording->info().warnings.empty());
  }
}

/// Quadratic work in the number of channels would take hours.
TEST(McapSummary, WithSixtyFiveThousandChannelsOpens) {
  const fs::path path = temp_folder() / "a.mcap";
  const Ros2Messages depth = realsense_ros_messages(1, "/camera");
  for (const std::size_t in_chunk : {0, 1000}) {
    Ros2Messages messages = depth;
    for (int i = 0; messages.size() < 65'000; ++i)
      messages.push_back(
          {"/camera_" + std::to_string(i) + (i % 2 == 0 ? "/color" : "/infra") + "/image_raw",
           kImage, kStart_ns, ByteVector(8, 0)});
    write_mcap(path, messages, {"", in_chunk, true, "cdr"});
    EXPECT_EQ(open_recording(path)->frame(0).depth.data, depth_of(100).data);
    // The error lists some of them.
    const std::string message =
        message_of([&] { open_recording(path, with_topic("/camera_7/color/image_raw")); });
    expect_one_line_with(message, {"--topic"});
    EXPECT_LT(message.size(), 1000U);
  }
}

}  // namespace
}  // namespace planescope::io
