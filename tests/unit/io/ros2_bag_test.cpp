// Tests of ROS 2 bags, both SQLite and MCAP, intact and damaged.

#include <functional>
#include <nlohmann/json.hpp>
#include <set>

#include "core/io/image/png.hpp"
#include "core/io/readers.hpp"
#include "core/io/ros_message.hpp"
#include "support/has.hpp"
#include "support/jpeg_bytes.hpp"
#include "unit/io/bag_writer.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

using namespace testing_bags;
using Json = nlohmann::ordered_json;

class Ros2Bag : public testing::Test {
 protected:
  void SetUp() override { folder_ = temp_folder(); }

  std::unique_ptr<Recording> open_db3(const Ros2Messages& messages, int page = 4096) {
    write_db3(folder_ / "a.db3", messages, page);
    return open_recording(folder_ / "a.db3");
  }
  /// Truncates the file at every `step` bytes: each part has at least the frames of the previous
  /// one, intact, and warns with `warning` and their number. Returns the number for the last part.
  int frames_before_cuts(const std::string& name, std::size_t step, const char* warning) {
    const auto bytes = read_file_bytes(folder_ / name);
    const auto path = folder_ / ("cut_" + name);
    int last = 0;
    for (std::size_t cut = 0; cut < bytes.size(); cut += step) {
      SCOPED_TRACE("cut at byte " + std::to_string(cut));
      write_anew(path, std::span(bytes).first(cut));
      std::unique_ptr<Recording> recording;
      const std::string error = message_of([&] { recording = open_recording(path); });
      if (!recording) {
        EXPECT_EQ(last, 0) << error;
        expect_one_line_with(error, {("cut_" + name).c_str()});
        continue;
      }
      const int found = recording->frame_count();
      EXPECT_GE(found, last);
      // 24x16 pixels of 2 and 3 bytes, their metadata, and the overhead of a page or chunk.
      if (step == 700) {
        EXPECT_GE(found, static_cast<int>(cut) / 2900 - 4);
      }
      last = found;
      EXPECT_GE(recording->info().warnings.size(), 1u);
      expect_one_line_with(recording->info().warnings.at(0),
                           {warning, (" " + std::to_string(found) + " depth").c_str()});
      for (int i = 0; i < found; ++i)
        EXPECT_EQ(recording->frame(i).depth.data, depth_of(100 + i).data);
    }
    return last;
  }
  std::filesystem::path folder_;
};

void expect_sdk_frames(const Recording& recording, int frames) {
  ASSERT_EQ(recording.frame_count(), frames);
  for (int i = 0; i < frames; ++i) {
    const Frame frame = recording.frame(i);
    ASSERT_EQ(frame.name, std::to_string(100 + i));
    ASSERT_NEAR(frame.timestamp_s, 500 + i * kDepthPeriod_s, 1e-6);
    ASSERT_EQ(frame.timestamp_s, recording.timestamp_s(i));
    ASSERT_EQ(frame.depth.data, depth_of(100 + i).data);
    ASSERT_EQ(frame.depth_unit_m, 0.00025);
    ASSERT_EQ(frame.color.at(3, 2, 0), 10 + i);
  }
}

TEST_F(Ros2Bag, TheSdksStringsContainCameraUnitAndTimesOfEachFrame) {
  for (const bool is_packed : {false, true}) {
    const Ros2Messages messages = sdk_messages(4);
    const auto recording = open_db3(is_packed ? packed(messages) : messages);
    const RecordingInfo& info = recording->info();
    EXPECT_EQ(info.format, "RealSense SDK ROS 2 bag (SQLite)");
    EXPECT_EQ(info.device, "Intel RealSense D435I");
    EXPECT_EQ(info.depth_unit_m, 0.00025);
    EXPECT_EQ(info.intrinsics.fx, 20);
    EXPECT_EQ(info.intrinsics.fy, 21);
    EXPECT_EQ(info.intrinsics.cx, 12);
    EXPECT_EQ(info.intrinsics.cy, 8);
    EXPECT_EQ(info.color_note, "projected by extrinsics");
    EXPECT_TRUE(info.warnings.empty());
    expect_sdk_frames(*recording, 4);
    const Frame frame = recording->frame(0);
    EXPECT_EQ(frame.color_intrinsics.fx, 30);
    EXPECT_TRUE(frame.T_color_depth.linear().col(0).isApprox(Vec3d::UnitY()));
    EXPECT_EQ(frame.T_color_depth.translation().x(), 0.015);
  }
}

TEST_F(Ros2Bag, RealsenseRosTopicsAreReadWithColorAndGravity) {
  for (const char* camera : {"/camera", "/camera/camera", "/robot1/D455_1"}) {
    const auto recording = open_db3(realsense_ros_messages(3, camera));
    EXPECT_EQ(recording->info().format, "realsense-ros ROS 2 bag (SQLite)");
    EXPECT_EQ(recording->info().depth_unit_m, 0.001);
    EXPECT_EQ(recording->info().intrinsics.fy, 21);
    EXPECT_EQ(recording->info().color_note, "projected by extrinsics");
    ASSERT_EQ(recording->frame_count(), 3);
    const Frame frame = recording->frame(2);
    EXPECT_EQ(frame.name, "2");
    EXPECT_NEAR(frame.timestamp_s, 1'700'000'000 + 2 * kDepthPeriod_s, 1e-6);
    EXPECT_EQ(frame.depth.data, depth_of(102).data);
    EXPECT_EQ(frame.color.at(0, 0, 0), 12);
    EXPECT_NEAR(frame.T_color_depth.translation().x(), -0.015, 1e-12);
    ASSERT_TRUE(frame.gravity);
    // The accelerometer's z points up, which is -y of the depth camera, so gravity is y.
    EXPECT_TRUE(frame.gravity->direction.isApprox(Vec3d(0, 1, 0), 1e-9));
  }
}

TEST_F(Ros2Bag, DepthAlignedToColorIsUsedIfThereIsNoOther) {
  Ros2Messages messages = realsense_ros_messages(2);
  for (Ros2Message& message : messages) {
    const auto at = message.topic.find("/depth/");
    if (at == std::string::npos) continue;
    message.topic.replace(at, 7, "/aligned_depth_to_color/");
  }
  const auto recording = open_db3(messages);
  EXPECT_EQ(recording->info().color_note, "aligned");
  EXPECT_TRUE(recording->frame(1).color_aligned);
}

TEST_F(Ros2Bag, MessagesOfABigEndianMachineAreRead) {
  Ros2Messages messages = realsense_ros_messages(2);
  for (Ros2Message& message : messages) {
    if (message.topic != "/camera/camera/depth/image_rect_raw") continue;
    ImageMessage image = depth_message(100, 3);
    image.encoding = "16UC1";
    message.bytes = image_message(image, testing_bags::Wire::cdr_big);
  }
  EXPECT_EQ(open_db3(messages)->frame(0).depth.data, depth_of(100).data);
}

TEST_F(Ros2Bag, AFileWithoutDepthListsItsTopics) {
  Ros2Messages messages = realsense_ros_messages(1);
  std::erase_if(messages, [](const Ros2Message& message) {
    return message.topic.find("depth") != std::string::npos;
  });
  expect_one_line_with(message_of([&] { open_db3(messages); }),
                       {"a.db3: no depth images", "/camera/camera/color/image_raw", "expected"});
}

/// realsense-ros with depth and color compressed by image_transport.
Ros2Messages transported(int frames,
                         const std::string& transport,
                         const std::function<ByteVector(const Image16&)>& pack,
                         const std::string& format,
                         const std::string& color_format = "rgb8; jpeg compressed bgr8") {
  Ros2Messages messages = realsense_ros_messages(frames);
  int number = 0;
  for (Ros2Message& message : messages) {
    const bool is_depth = message.topic.ends_with("/image_rect_raw");
    if (!is_depth && !message.topic.ends_with("/color/image_raw")) continue;
    const double stamp_s = 1'700'000'000 + number * kDepthPeriod_s;
    message.type = "sensor_msgs/msg/CompressedImage";
    message.topic += "/" + (is_depth ? transport : "compressed");
    const auto jpeg = encode_jpeg(kWidth, kHeight, true);
    message.bytes =
        is_depth ? compressed_image_message(stamp_s, "depth_optical", format,
                                            pack(depth_of(100 + number++)), testing_bags::Wire::cdr)
                 : compressed_image_message(stamp_s, "color_optical", color_format, jpeg,
                                            testing_bags::Wire::cdr);
  }
  return messages;
}

TEST_F(Ros2Bag, DepthOfEveryImageTransportIsReadExactly) {
  const auto png = [](const Image16& depth) { return encode_png(depth); };
  const auto headed = [&](const Image16& depth) { return with_config(encode_png(depth)); };
  const auto rvl = [](const Image16& depth) { return with_config(rvl_packed(depth)); };
  const Ros2Messages forms[] = {
      transported(3, "compressedDepth", headed, "16UC1; compressedDepth png"),
      transported(3, "compressedDepth", headed, "16UC1; compressedDepth"),
      transported(3, "compressedDepth", headed, "mono16; compressedDepth png"),
      transported(3, "compressedDepth", rvl, "16UC1; compressedDepth rvl"),
      transported(3, "compressed", png, "16UC1; png compressed"),
      transported(3, "compressed", png, "png"),
      transported(3, "zstd", zstd_transport, "16UC1; zstd"),
  };
  for (const Ros2Messages& messages : forms) {
    const auto recording = open_db3(messages);
    EXPECT_TRUE(recording->info().warnings.empty());
    EXPECT_EQ(recording->info().depth_unit_m, 0.001);
    EXPECT_EQ(recording->info().intrinsics.fy, 21);
    ASSERT_EQ(recording->frame_count(), 3);
    for (int i = 0; i < 3; ++i) {
      const Frame frame = recording->frame(i);
      ASSERT_EQ(frame.depth.data, depth_of(100 + i).data);
      ASSERT_EQ(frame.color.width, kWidth);
      EXPECT_NEAR(frame.color.at(3, 3, 1), 100, 4);
      EXPECT_EQ(frame.color_intrinsics.fx, 30);
      EXPECT_TRUE(frame.gravity);
    }
  }
}

TEST_F(Ros2Bag, CompressedImagesOfTheSdkAreRead) {
  Ros2Messages messages = sdk_messages(2);
  int number = 100;
  for (Ros2Message& message : messages) {
    if (message.topic != kSdkDepth + "/image/data") continue;
    message.type = "sensor_msgs/msg/CompressedImage";
    message.bytes = compressed_image_message(
        1e-9 * static_cast<double>(message.time_ns), "Depth", "16UC1; compressedDepth png",
        with_config(encode_png(depth_of(number++))), testing_bags::Wire::cdr);
  }
  expect_sdk_frames(*open_db3(messages), 2);
}

TEST_F(Ros2Bag, JpegDepthIsRejectedAndDamagedImagesAreReported) {
  const auto jpeg = [](const Image16&) { return encode_jpeg(kWidth, kHeight, true); };
  expect_one_line_with(
      message_of([&] { open_db3(transported(2, "compressed", jpeg, "mono16; jpeg compressed")); }),
      {"a.db3: depth images on", "are compressed as JPEG, which does not preserve depth",
       "expected"});
  const auto floats = [](const Image16&) { return ByteVector(40, 1); };
  expect_one_line_with(
      message_of(
          [&] { open_db3(transported(2, "compressedDepth", floats, "32FC1; compressedDepth")); }),
      {"a.db3", "floating-point depth (32FC1)"});
  expect_one_line_with(message_of([&] { open_db3(transported(2, "compressed", floats, "qoi")); }),
                       {"a.db3", "compressed as \"qoi\"", "expected"});
  const auto packs = {std::pair<const char*, std::function<ByteVector(const Image16&)>>{
                          "png", [](const Image16& depth) { return encode_png(depth); }},
                      {"rvl", rvl_packed}};
  for (const auto& [format, pack] : packs) {
    for (std::size_t keep = 0; keep < pack(depth_of(100)).size(); keep += 5) {
      const auto cut = [&](const Image16& depth) {
        ByteVector bytes = with_config(pack(depth));
        bytes.resize(12 + keep);
        return bytes;
      };
      expect_one_line_with(message_of([&] {
                             open_db3(transported(1, "compressedDepth", cut,
                                                  std::string("16UC1; compressedDepth ") + format));
                           }),
                           {"a.db3"});
    }
  }
}

TEST_F(Ros2Bag, OpeningWritesNoFilesAndDoesNotChangeTheBag) {
  write_db3(folder_ / "a.db3", sdk_messages(3));
  const auto before = read_file_bytes(folder_ / "a.db3");
  std::filesystem::permissions(
      folder_, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  const auto recording = open_recording(folder_ / "a.db3");
  EXPECT_EQ(recording->frame(2).name, "102");
  std::filesystem::permissions(folder_, std::filesystem::perms::owner_all);
  std::set<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(folder_)) {
    names.insert(entry.path().filename().string());
  }
  EXPECT_EQ(names, std::set<std::string>{"a.db3"});
  EXPECT_EQ(read_file_bytes(folder_ / "a.db3"), before);
}

TEST_F(Ros2Bag, ADatabaseWithWriteAheadLoggingOpensAndALeftoverLogIsReported) {
  write_db3(folder_ / "a.db3", sdk_messages(3));
  auto bytes = read_file_bytes(folder_ / "a.db3");
  bytes[18] = bytes[19] = 2;
  write_anew(folder_ / "a.db3", bytes);
  EXPECT_TRUE(open_recording(folder_ / "a.db3")->info().warnings.empty());
  write_text(folder_ / "a.db3-wal", "what was not taken in");
  const auto recording = open_recording(folder_ / "a.db3");
  expect_sdk_frames(*recording, 3);
  ASSERT_EQ(recording->info().warnings.size(), 1u);
  expect_one_line_with(recording->info().warnings[0],
                       {"never closed", "a.db3-wal contains 21 unmerged bytes"});
}

TEST_F(Ros2Bag, AnUnrelatedDatabaseIsRejected) {
  write_text(folder_ / "text.db3", "no database");
  expect_refused(folder_ / "text.db3", {"text.db3: not a SQLite file (11 bytes"});
  write_db3(folder_ / "a.db3", {});
  auto bytes = read_file_bytes(folder_ / "a.db3");
  const std::string name = "messages";
  for (auto at = bytes.begin();
       (at = std::search(at, bytes.end(), name.begin(), name.end())) != bytes.end(); ++at) {
    *at = 'w';
  }
  write_anew(folder_ / "a.db3", bytes);
  expect_refused(folder_ / "a.db3",
                 {"a.db3: a SQLite file without \"topics\" and \"messages\" tables"});
}

TEST_F(Ros2Bag, ATruncatedFileGivesItsFramesAndReportsMissingOnes) {
  write_db3(folder_ / "a.db3", sdk_messages(30), 512);
  EXPECT_GE(frames_before_cuts("a.db3", 700, "the file is truncated: it has"), 28);
  for (const char* compression : {"", "lz4"}) {
    SCOPED_TRACE(compression);
    write_mcap(folder_ / "a.mcap", sdk_messages(20), {compression, 7, true, "cdr"});
    const std::size_t step = std::filesystem::file_size(folder_ / "a.mcap") / 40 + 1;
    EXPECT_GE(frames_before_cuts("a.mcap", step, "has no footer"), 19);
  }
}

TEST_F(Ros2Bag, McapInEveryFormHasTheFramesOfTheDatabase) {
  const auto path = folder_ / "a.mcap";
  for (const bool is_packed : {false, true})
    for (const char* compression : {"", "lz4", "zstd"})
      for (const std::size_t in_chunk : {0, 1, 5, 1000})
        for (const bool summary : {true, false}) {
          SCOPED_TRACE(std::string(compression) + " " + std::to_string(in_chunk) +
                       (summary ? " indexed" : "") + (is_packed ? " packed" : ""));
          const Ros2Messages sdk = sdk_messages(4);
          write_mcap(path, is_packed ? packed(sdk) : sdk, {compression, in_chunk, summary, "cdr"});
          const auto recording = open_recording(path);
          EXPECT_EQ(recording->info().format, "RealSense SDK ROS 2 bag (MCAP)");
          EXPECT_TRUE(recording->info().warnings.empty());
          expect_sdk_frames(*recording, 4);
          write_mcap(path, realsense_ros_messages(3), {compression, in_chunk, summary, "cdr"});
          const auto ros = open_recording(path);
          ASSERT_EQ(ros->frame_count(), 3);
          EXPECT_EQ(ros->frame(2).depth.data, depth_of(102).data);
          EXPECT_TRUE(ros->frame(2).gravity);
        }
}

TEST_F(Ros2Bag, AFolderWithMetadataIsOneRecordingOfAllItsFiles) {
  const Ros2Messages all = sdk_messages(12);
  // so many that 2 must be sorted before 10
  const std::size_t parts = 12, size = all.size() / parts;
  for (const std::string kind : {".mcap", ".db3"}) {
    SCOPED_TRACE(kind);
    const auto dir = folder_ / kind.substr(1);
    for (std::size_t part = 0; part < parts; ++part) {
      const auto end = part + 1 == parts ? all.end() : all.begin() + (part + 1) * size;
      const Ros2Messages some(all.begin() + part * size, end);
      std::filesystem::create_directories(dir);
      const auto path = dir / ("rec_" + std::to_string(part) + kind);
      kind == ".mcap" ? write_mcap(path, some, {"zstd", 3, true, "cdr"}) : write_db3(path, some);
    }
    expect_refused(dir, {"a folder with 12 recordings; expected the path to one recording"});
    std::string list = "rosbag2_bagfile_information:\n  version: 7\n  relative_file_paths:\n";
    for (std::size_t part = 0; part < parts; ++part)
      list += "    - rec_" + std::to_string(part) + kind + "\n";
    write_text(dir / "metadata.yaml", list);
    write_text(dir / ("not_listed" + kind), "left alone");
    const auto recording = open_recording(dir);
    EXPECT_TRUE(recording->info().warnings.empty());
    EXPECT_EQ(recording->info().path, dir);
    expect_sdk_frames(*recording, 12);
    write_text(dir / ("rec_3" + kind), "not one");
    expect_refused(dir, {("rec_3" + kind).c_str()});
    std::filesystem::remove(dir / ("rec_3" + kind));
    expect_refused(dir, {"metadata.yaml: lists rec_3", "which does not exist"});
    write_text(dir / ("rec_3" + kind + ".zstd"), "packed");
    write_text(dir / "metadata.yaml",
               list.replace(list.find("rec_3" + kind), 5 + kind.size(), "rec_3" + kind + ".zstd"));
    expect_refused(dir, {("rec_3" + kind + ".zstd").c_str()});
    for (const char* outside : {"../../etc/passwd", "/etc/passwd", "a/../../rec_3"}) {
      write_text(
          dir / "metadata.yaml",
          std::string("rosbag2_bagfile_information:\n  relative_file_paths: [") + outside + "]");
      expect_refused(dir, {"metadata.yaml: relative_file_paths contains '", outside,
                           "expected relative paths inside the bag's folder"});
    }
    for (const char* text : {"{", "a: b", "rosbag2_bagfile_information: 1",
                             "rosbag2_bagfile_information:\n  relative_file_paths: []"}) {
      write_text(dir / "metadata.yaml", text);
      expect_refused(dir, {"metadata.yaml: "});
    }
  }
}

TEST_F(Ros2Bag, ACompressedFileIsReadLikeTheOriginal) {
  for (const std::string kind : {".mcap", ".db3"}) {
    SCOPED_TRACE(kind);
    const auto dir = folder_ / kind.substr(1), plain = folder_ / ("plain" + kind);
    const auto packed_file = dir / ("rec_0" + kind + ".zstd");
    std::filesystem::create_directories(dir);
    const Ros2Messages messages = sdk_messages(6);
    kind == ".mcap" ? write_mcap(plain, messages, {"", 3, true, "cdr"})
                    : write_db3(plain, messages);
    const ByteVector whole = read_file_bytes(plain);
    write_file_bytes(packed_file, zstd_packed(whole));
    write_text(
        dir / "metadata.yaml",
        "rosbag2_bagfile_information:\n  compression_format: zstd\n  compression_mode: FILE\n"
        "  relative_file_paths:\n    - rec_0" +
            kind + ".zstd\n");
    for (const auto& path : {dir, packed_file}) {
      const auto recording = open_recording(path);
      EXPECT_TRUE(recording->info().warnings.empty());
      expect_sdk_frames(*recording, 6);
      EXPECT_EQ(recording->frame_hash(2), open_recording(plain)->frame_hash(2));
    }
    // No temporary files remain, neither in their folder nor beside the file.
    EXPECT_EQ(files_in(dir).size(), 2U);
    // Frames before a truncation are read, and the truncation is reported.
    ByteVector bytes = zstd_packed(whole);
    for (std::size_t cut = 1; cut < 20; ++cut) {
      const ByteVector part(bytes.begin(), bytes.begin() + bytes.size() * cut / 20);
      write_file_bytes(packed_file, part);
      try {
        const auto recording = open_recording(packed_file);
        EXPECT_LE(recording->frame_count(), 6);
        EXPECT_FALSE(recording->info().warnings.empty());
      } catch (const Error& error) {
        expect_one_line_with(error.what(), {packed_file.filename().c_str()});
      }
    }
    bytes[0] ^= 1;
    write_file_bytes(packed_file, bytes);
    expect_refused(packed_file, {packed_file.filename().c_str()});
  }
  // Endless zeros are read only up to the limit of a recording.
  const auto bomb = folder_ / "bomb.db3.zstd";
  write_file_bytes(bomb, zstd_packed(ByteVector(std::size_t{300} << 20)));
  expect_refused(bomb, {"bomb.db3.zstd: the decompressed data is too large", "expected at most"});
}

// The seed mcap/ros_plain of the fuzzers, copied message by message with npm's @mcap/core 2.
TEST_F(Ros2Bag, McapOfAnotherWriterIsRead) {
  const auto recording = open_recording(std::filesystem::path(PLANESCOPE_SOURCE_DIR) /
                                        "tests/unit/io/data/mcap_core.mcap");
  EXPECT_TRUE(recording->info().warnings.empty());
  ASSERT_EQ(recording->frame_count(), 4);
  for (int i = 0; i < 4; ++i) {
    EXPECT_EQ(recording->frame(i).depth.data, depth_of(100).data);
    EXPECT_EQ(recording->frame(i).color.at(0, 0, 0), 10);  // all have the same time
  }
}

TEST_F(Ros2Bag, McapIsRecognizedByItsContentAndOtherFilesAreRejected) {
  write_mcap(folder_ / "a.bin", sdk_messages(2));
  EXPECT_EQ(open_recording(folder_ / "a.bin")->frame_count(), 2);
  write_text(folder_ / "text.mcap", "no container");
  expect_refused(folder_ / "text.mcap", {"text.mcap: not an MCAP file (12 bytes"});
  write_mcap(folder_ / "a.mcap", sdk_messages(2), {"", 5, true, "protobuf"});
  expect_refused(folder_ / "a.mcap", {"a.mcap", "no depth images"});
}

TEST_F(Ros2Bag, AChunkWithAWrongChecksumOrUnknownCompressionIsRejected) {
  const auto path = folder_ / "a.mcap";
  const auto changed = [&](const std::string& from, const std::string& to) {
    write_mcap(path, sdk_messages(2), {"lz4", 100, true, "cdr"});
    auto bytes = read_file_bytes(path);
    for (auto at = bytes.begin();
         (at = std::search(at, bytes.end(), from.begin(), from.end())) != bytes.end();)
      at = std::copy(to.begin(), to.end(), at);
    write_anew(path, bytes);
    return message_of([&] { open_recording(path); });
  };
  const std::string none(4, '\0'), name("\x03\0\0\0lz4", 7);
  expect_one_line_with(changed(none + name, "abcd" + name), {"a.mcap: chunk 0 is damaged"});
  expect_one_line_with(changed(name, std::string("\x03\0\0\0foo", 7)),
                       {"a.mcap: chunk 0 uses an unknown compression method"});
}

TEST_F(Ros2Bag, AFlippedPixelOfAnUncompressedMcapIsFoundByItsChecksums) {
  const auto path = folder_ / "a.mcap";
  const Ros2Messages messages = realsense_ros_messages(2);
  const auto image = std::ranges::find(messages, "sensor_msgs/msg/Image", &Ros2Message::type);
  ASSERT_NE(image, messages.end());
  for (const std::size_t in_chunk : {0, 100}) {
    SCOPED_TRACE(in_chunk);
    write_mcap(path, messages, {.compression = "", .in_chunk = in_chunk, .crc = true});
    EXPECT_TRUE(open_recording(path)->info().warnings.empty());
    EXPECT_EQ(open_recording(path)->frame(1).index, 1);
    auto bytes = read_file_bytes(path);
    const auto at =
        std::search(bytes.begin(), bytes.end(), image->bytes.begin(), image->bytes.end());
    ASSERT_NE(at, bytes.end());
    at[static_cast<std::ptrdiff_t>(image->bytes.size()) - 1] ^= 1;
    write_anew(path, bytes);
    std::vector<std::string> reported;
    const std::string error = message_of([&] {
      const auto recording = open_recording(path);
      reported = recording->info().warnings;
      recording->frame(0);
    });
    const std::string all = error + (reported.empty() ? "" : reported[0]);
    EXPECT_NE(all.find(in_chunk > 0 ? "chunk 0 is damaged: its CRC-32 is" : "the file is damaged"),
              std::string::npos)
        << all;
  }
}

TEST_F(Ros2Bag, McapWithADamagedIndexIsScannedAndDamageNeverCrashes) {
  write_mcap(folder_ / "a.mcap", sdk_messages(6), {"zstd", 5, true, "cdr"});
  const auto bytes = read_file_bytes(folder_ / "a.mcap");
  int whole = 0;
  for (std::size_t at = 8; at < bytes.size(); at += 13) {
    auto changed = bytes;
    changed[at] ^= 0xff;
    write_anew(folder_ / "damaged.mcap", changed);
    std::unique_ptr<Recording> recording;
    std::string error = message_of([&] { recording = open_recording(folder_ / "damaged.mcap"); });
    EXPECT_EQ(error.find('\n'), std::string::npos);
    for (int i = 0; recording && i < recording->frame_count(); ++i) {
      error = message_of([&] { recording->frame(i); });
      EXPECT_EQ(error.find('\n'), std::string::npos);
    }
    whole += recording && recording->frame_count() == 6;
  }
  EXPECT_GT(whole, 0);
}

TEST_F(Ros2Bag, ADamagedPageLosesOnlyItsMessages) {
  const int frames = 40;
  write_db3(folder_ / "a.db3", sdk_messages(frames), 512);
  auto bytes = read_file_bytes(folder_ / "a.db3");
  std::size_t damaged = 0, wrong = 0;
  for (std::size_t page = bytes.size() / 1024 * 512; damaged < 20; page += 512, ++damaged) {
    auto changed = bytes;
    std::fill_n(changed.begin() + static_cast<std::ptrdiff_t>(page), 512, 0xff);
    write_anew(folder_ / "damaged.db3", changed);
    const auto recording = open_recording(folder_ / "damaged.db3");
    EXPECT_GE(recording->frame_count(), frames - 3);
    for (int i = 0; i < recording->frame_count(); ++i) {
      const std::string error = message_of([&] { recording->frame(i); });
      EXPECT_EQ(error.find('\n'), std::string::npos);
      wrong += !error.empty();
    }
  }
  EXPECT_LE(wrong, damaged * 3);
}

}  // namespace
TEST(RosMessage, IsEncodedByItsDefinition) {
  const Json point = {{"x", 1.5}};  // y and z are 0
  EXPECT_EQ(ros_message("p", "geometry_msgs/msg/Point", point).cdr.size(), 4 + 3 * 8);
  const Json named = {{"name", "x"}, {"count", 1}};
  EXPECT_EQ(ros_message("f", "sensor_msgs/msg/PointField", named).cdr, std::string("\0\1\0\0"
                                                                                   "\2\0\0\0"
                                                                                   "x\0\0\0"
                                                                                   "\0\0\0\0"
                                                                                   "\0\0\0\0"
                                                                                   "\1\0\0\0",
                                                                                   24));
  EXPECT_TRUE(has(ros_definition("planescope_msgs/msg/PlaneArray"), "MSG: geometry_msgs/Point32"));
}

TEST(RosMessage, RejectsUnknownFields) {
  const auto refusal = [](const char* type, const Json& json) {
    try {
      ros_message("topic", type, json);
    } catch (const Error& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_EQ(refusal("geometry_msgs/msg/Point", {{"w", 1}}),
            "geometry_msgs/msg/Point: the message has no field w");
  EXPECT_EQ(refusal("geometry_msgs/msg/Point", {{"x", "1"}}),
            "geometry_msgs/msg/Point.x is not of type float64");
  EXPECT_EQ(refusal("sensor_msgs/msg/PointField", {{"datatype", 256}}),
            "sensor_msgs/msg/PointField.datatype is not of type uint8");
  EXPECT_EQ(refusal("sensor_msgs/msg/CameraInfo", {{"k", {1, 2}}}),
            "sensor_msgs/msg/CameraInfo.k is not of type float64");
  EXPECT_EQ(refusal("std_msgs/msg/String", {}), "std_msgs/msg/String: unsupported message type");
}

}  // namespace planescope::io
