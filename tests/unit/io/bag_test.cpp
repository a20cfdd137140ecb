// Tests of ROS 1 bags: compression, streams, depth units, color pairing and errors.

#include <thread>

#include "unit/io/bag_writer.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

using namespace testing_bags;

std::unique_ptr<Recording> open_bytes(const ByteVector& bytes,
                                      const RecordingOptions& options = {}) {
  const auto path = temp_folder() / "recording.bag";
  write_file_bytes(path, bytes);
  return open_recording(path, options);
}

void expect_sample_frames(const Recording& recording, int count) {
  ASSERT_EQ(recording.frame_count(), count);
  for (int i = 0; i < count; ++i) {
    const Frame frame = recording.frame(i);
    EXPECT_EQ(frame.index, i);
    EXPECT_EQ(frame.name, std::to_string(100 + i));
    EXPECT_EQ(frame.depth.data, depth_of(100 + i).data) << "frame " << i;
    ASSERT_EQ(frame.color.width, kWidth);
    EXPECT_EQ(frame.color.at(3, 3, 0), 10 + i);
  }
}

TEST(Bag, EveryCompressionGivesTheSameFrames) {
  for (const char* compression : {"none", "lz4", "bz2"}) {
    SCOPED_TRACE(compression);
    SdkBag options;
    options.format.compression = compression;
    const auto recording = open_bytes(sdk_bag(options).finish());
    expect_sample_frames(*recording, 6);
    EXPECT_TRUE(recording->info().warnings.empty());
  }
}

TEST(Bag, SdkMetadataIsRead) {
  const auto recording = open_bytes(sdk_bag({}).finish());
  const RecordingInfo& info = recording->info();
  EXPECT_EQ(info.format, "RealSense SDK bag");
  EXPECT_EQ(info.device, "Intel RealSense D435I");
  EXPECT_EQ(info.width, kWidth);
  EXPECT_EQ(info.height, kHeight);
  EXPECT_EQ(info.intrinsics.fx, 20);
  EXPECT_EQ(info.intrinsics.cy, 8);
  EXPECT_EQ(info.intrinsics.distortion, Distortion::none);
  EXPECT_EQ(info.color_note, "projected by extrinsics");
  const Frame frame = recording->frame(2);
  EXPECT_NEAR(frame.timestamp_s, 500 + 2 * kDepthPeriod_s, 1e-8);
  EXPECT_EQ(frame.color_intrinsics.fy, 31);
  EXPECT_NEAR(frame.T_color_depth.linear()(0, 2), std::sin(0.1), 1e-12);
  EXPECT_NEAR(frame.T_color_depth.linear().determinant(), 1, 1e-12);
  EXPECT_NEAR(frame.T_color_depth.translation().x(), 0.015, 1e-12);
}

TEST(Bag, DepthUnitComesFromItsTopicUnderEitherName) {
  SdkBag options;
  options.unit_m = 0.0001f;
  const auto old_name = open_bytes(sdk_bag(options).finish());
  EXPECT_EQ(old_name->frame(0).depth_unit_m, 0.0001);
  EXPECT_EQ(old_name->info().depth_unit_source,
            "bag topic /device_0/sensor_0/option/Depth Units/value");
  options.sdk_2_49 = true;
  const auto new_name = open_bytes(sdk_bag(options).finish());
  EXPECT_EQ(new_name->frame(0).depth_unit_m, 0.0001);
  EXPECT_EQ(new_name->info().depth_unit_source,
            "bag topic /device_0/sensor_0/option/Depth_Units/value");
}

TEST(Bag, TheFourBytesAfterThePixelsAreTheFramesUnit) {
  SdkBag options;
  options.sdk_2_49 = true;
  BagWriter bag;
  add_sdk_statics(bag, options);
  for (int i = 0; i < 2; ++i) {
    auto depth = depth_message(100 + i, 1 + i);
    depth.depth_unit_m = i == 0 ? 0.001f : 0.00025f;
    add_depth(bag, 10 + i, depth);
  }
  const ByteVector bytes = bag.finish();
  const auto recording = open_bytes(bytes);
  EXPECT_EQ(recording->frame(0).depth_unit_m, 0.001);
  EXPECT_EQ(recording->frame(1).depth_unit_m, 0.00025);
  EXPECT_EQ(recording->frame(1).depth.data, depth_of(101).data);
  RecordingOptions by_hand;
  by_hand.depth_unit_m = 0.002;
  EXPECT_EQ(open_bytes(bytes, by_hand)->frame(1).depth_unit_m, 0.002);
}

TEST(Bag, FramesAreInTheOrderOfTheSensorsClock) {
  BagWriter bag;
  add_sdk_statics(bag, {});
  for (const int i : {3, 0, 2, 1}) {
    add_depth(bag, 100, depth_message(100 + i, 7 + i));
  }
  const auto recording = open_bytes(bag.finish());
  ASSERT_EQ(recording->frame_count(), 4);
  for (int i = 0; i < 4; ++i) EXPECT_EQ(recording->frame(i).name, std::to_string(100 + i));
}

TEST(Bag, ColorIsPairedByTheSensorsTimeNotByNumber) {
  BagWriter bag;
  add_sdk_statics(bag, {});
  // Depth at 0, 33, 66, ... ms; color at half the rate, recorded 60 ms late.
  for (int i = 0; i < 10; ++i) {
    const double stamp_s = 500 + i * kDepthPeriod_s;
    const auto time_ns = static_cast<std::uint64_t>(1e9 * i * kDepthPeriod_s) + 1000;
    add_depth(bag, time_ns, depth_message(100 + i, stamp_s));
    if (i % 2 == 0) {
      add_color(bag, time_ns + 60'000'000, color_message(50 + i, stamp_s - 0.002));
    }
  }
  const auto recording = open_bytes(bag.finish());
  for (int i = 0; i < 10; ++i) {
    // Between two color images, the later one is 4 ms nearer.
    const int nearest = i % 2 == 1 && i < 9 ? i + 1 : i / 2 * 2;
    EXPECT_EQ(recording->frame(i).color.at(0, 0, 0), 50 + nearest) << "frame " << i;
  }
}

TEST(Bag, ColorTooFarInTimeIsNotPaired) {
  BagWriter bag;
  add_sdk_statics(bag, {});
  add_color(bag, 10, color_message(1, 5));
  for (int i = 0; i < 2; ++i) {
    add_depth(bag, 1'000'000'000u * (3 * i + 1), depth_message(100 + i, 5.1 + 3 * i));
  }
  const auto recording = open_bytes(bag.finish());
  EXPECT_FALSE(recording->frame(0).color.empty());
  EXPECT_TRUE(recording->frame(1).color.empty());
}

TEST(Bag, EveryColorEncodingIsConvertedToRgb) {
  const std::pair<const char*, ByteVector> encodings[] = {
      {"rgb8", {1, 2, 3}}, {"bgr8", {3, 2, 1}}, {"rgba8", {1, 2, 3, 9}}, {"bgra8", {3, 2, 1, 9}}};
  for (const auto& [encoding, pixel] : encodings) {
    SCOPED_TRACE(encoding);
    BagWriter bag;
    add_sdk_statics(bag, {});
    auto color = color_message(1, 5);
    color.encoding = encoding;
    color.row_padding = 6;
    color.pixels.clear();
    for (int i = 0; i < kWidth * kHeight; ++i) {
      color.pixels.insert(color.pixels.end(), pixel.begin(), pixel.end());
    }
    add_color(bag, 10, color);
    add_depth(bag, 11, depth_message(100, 5));
    const Frame frame = open_bytes(bag.finish())->frame(0);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(frame.color.at(kWidth - 1, kHeight - 1, c), c + 1);
  }
}

TEST(Bag, ColorOfUnknownEncodingIsSkippedWithAWarning) {
  BagWriter bag;
  add_sdk_statics(bag, {});
  auto color = color_message(1, 5);
  color.encoding = "yuv422";
  add_color(bag, 10, color);
  add_depth(bag, 11, depth_message(100, 5));
  const auto recording = open_bytes(bag.finish());
  EXPECT_TRUE(recording->frame(0).color.empty());
  ASSERT_EQ(recording->info().warnings.size(), 1u);
  expect_one_line_with(recording->info().warnings[0], {"yuv422", "rgb8"});
}

TEST(Bag, BigEndianAndPaddedDepthIsReadCorrectly) {
  BagWriter bag;
  add_sdk_statics(bag, {});
  auto depth = depth_message(100, 5);
  depth.encoding = "16UC1";
  depth.big_endian = true;
  depth.row_padding = 10;
  for (std::size_t i = 0; i < depth.pixels.size(); i += 2) {
    std::swap(depth.pixels[i], depth.pixels[i + 1]);
  }
  add_depth(bag, 11, depth);
  EXPECT_EQ(open_bytes(bag.finish())->frame(0).depth.data, depth_of(100).data);
}

TEST(Bag, SensorNumbersMayDiffer) {
  BagWriter bag;
  bag.add("/device_3/sensor_7/Depth_2/info/camera_info", "sensor_msgs/CameraInfo", 1,
          camera_info_message(kWidth, kHeight, {20, 21, 12, 8}));
  bag.add("/device_3/sensor_7/Depth_2/image/data", "sensor_msgs/Image", 11,
          image_message(depth_message(100, 5)));
  EXPECT_EQ(open_bytes(bag.finish())->frame_count(), 1);
}

TEST(Bag, TheFirstOfSeveralDepthStreamsIsReadAndTheOthersAreReported) {
  SdkBag options;
  BagWriter bag = sdk_bag(options);
  bag.add("/device_1/sensor_0/Depth_0/image/data", "sensor_msgs/Image", 11,
          image_message(depth_message(7, 5)));
  const auto recording = open_bytes(bag.finish());
  EXPECT_EQ(recording->frame_count(), 6);
  ASSERT_EQ(recording->info().warnings.size(), 1u);
  expect_one_line_with(recording->info().warnings[0],
                       {"2 depth cameras", kSdkDepth.c_str(), "--topic"});
}

TEST(Bag, DistortionIsKeptAndAnUnknownModelCausesAWarning) {
  const auto with_model = [&](const std::string& model) {
    BagWriter bag;
    bag.add(kSdkDepth + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
            camera_info_message(kWidth, kHeight, {20, 21, 12, 8}, model, {.1, .2, .3, .4, .5}));
    add_depth(bag, 11, depth_message(100, 5));
    return open_bytes(bag.finish());
  };
  EXPECT_EQ(with_model("plumb_bob")->info().intrinsics.distortion, Distortion::brown_conrady);
  EXPECT_EQ(with_model("plumb_bob")->info().intrinsics.coefficients[4], 0.5);
  EXPECT_EQ(with_model("Inverse Brown Conrady")->info().intrinsics.distortion,
            Distortion::inverse_brown_conrady);
  const auto fisheye = with_model("Kannala Brandt4");
  EXPECT_EQ(fisheye->info().intrinsics.distortion, Distortion::none);
  ASSERT_EQ(fisheye->info().warnings.size(), 1u);
  expect_one_line_with(fisheye->info().warnings[0], {"Kannala Brandt4", "not supported"});
}

TEST(Bag, ManyThreadsReadTheSameFrames) {
  SdkBag options;
  options.frames = 40;
  options.format.compression = "lz4";
  const auto recording = open_bytes(sdk_bag(options).finish());
  std::vector<std::string> expected;
  for (int i = 0; i < 40; ++i) expected.push_back(recording->frame_hash(i));
  std::vector<std::vector<std::string>> found(4);
  {
    std::vector<std::jthread> threads;
    for (int t = 0; t < 4; ++t) {
      threads.emplace_back([&, t] {
        for (int i = 0; i < 40; ++i) found[t].push_back(recording->frame_hash((i * 7) % 40));
      });
    }
  }
  for (const auto& hashes : found) {
    for (int i = 0; i < 40; ++i) EXPECT_EQ(hashes[i], expected[(i * 7) % 40]);
  }
}

TEST(Bag, FilesThatAreNotBagsAreReported) {
  const auto path = temp_folder() / "letter.bag";
  write_text(path, "Dear reader, this is not a recording.");
  expect_refused(path, {"letter.bag", "not a ROS bag"});
  write_text(path, "");
  expect_refused(path, {"letter.bag", "not a ROS bag"});
}

TEST(Bag, WithoutDepthTheFoundTopicsAreListed) {
  BagWriter bag;
  bag.add("/usb_cam/image", "sensor_msgs/Image", 10, image_message(color_message(1, 5)));
  expect_one_line_with(message_of([&] { open_bytes(bag.finish()); }),
                       {"recording.bag", "no depth images", "/usb_cam/image", "Depth_*"});
}

TEST(Bag, DepthOfTheWrongEncodingOrSizeIsRejected) {
  BagWriter wrong;
  add_sdk_statics(wrong, {});
  auto depth = depth_message(100, 5);
  depth.encoding = "8UC1";
  add_depth(wrong, 11, depth);
  expect_one_line_with(message_of([&] { open_bytes(wrong.finish()); }), {"8UC1", "mono16"});

  BagWriter resized;
  resized.add(kSdkDepth + "/info/camera_info", "sensor_msgs/CameraInfo", 1,
              camera_info_message(640, 480, {20, 21, 12, 8}));
  add_depth(resized, 11, depth_message(100, 5));
  expect_one_line_with(message_of([&] { open_bytes(resized.finish()); }), {"24x16", "640x480"});
}

TEST(Bag, WithoutIntrinsicsTheOptionIsSuggested) {
  BagWriter bag;
  add_depth(bag, 11, depth_message(100, 5));
  const ByteVector bytes = bag.finish();
  expect_one_line_with(message_of([&] { open_bytes(bytes); }), {"--intrinsics"});
  const auto recording = open_bytes(bytes, with_intrinsics(1, 2, 3, 4));
  EXPECT_EQ(recording->info().intrinsics.cy, 4);
  EXPECT_EQ(recording->info().depth_unit_source, "assumed (RealSense default)");
}

}  // namespace
}  // namespace planescope::io
