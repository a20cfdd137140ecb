// Tests of truncated and damaged ROS 1 bags.

#include "unit/io/bag_writer.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

using namespace testing_bags;

class BrokenBag : public testing::Test {
 protected:
  void SetUp() override { path_ = temp_folder() / "broken.bag"; }

  std::unique_ptr<Recording> open(std::span<const unsigned char> bytes) {
    write_anew(path_, bytes);
    return open_recording(path_);
  }
  /// The readable depth frames are the first ones, and intact.
  void expect_first_frames(const Recording& recording) {
    for (int i = 0; i < recording.frame_count(); ++i) {
      const Frame frame = recording.frame(i);
      ASSERT_EQ(frame.name, std::to_string(100 + i));
      ASSERT_EQ(frame.depth.data, depth_of(100 + i).data);
      ASSERT_EQ(frame.intrinsics.fx, 20);
    }
  }
  std::filesystem::path path_;
};

TEST_F(BrokenBag, ATruncatedFileGivesTheFramesBeforeTheEndAndCountsMissingOnes) {
  SdkBag options;
  options.frames = 8;
  BagWriter bag = sdk_bag(options);
  const ByteVector bytes = bag.finish();
  const auto& ends = bag.ends_of(kSdkDepth + "/image/data");
  ASSERT_EQ(ends.size(), 8u);
  for (std::size_t cut = 13; cut < bytes.size(); cut += 97) {
    const auto whole =
        std::count_if(ends.begin(), ends.end(), [&](std::size_t e) { return e <= cut; });
    SCOPED_TRACE("cut at byte " + std::to_string(cut) + ", " + std::to_string(whole) + " frames");
    if (whole == 0) {
      expect_one_line_with(message_of([&] { open(std::span(bytes).first(cut)); }), {"broken.bag"});
      continue;
    }
    const auto recording = open(std::span(bytes).first(cut));
    ASSERT_EQ(recording->frame_count(), whole);
    expect_first_frames(*recording);
    ASSERT_EQ(recording->info().warnings.size(), 1u);
    const std::string depth = " " + std::to_string(whole) + " depth";
    expect_one_line_with(recording->info().warnings[0], {"chunks", depth.c_str()});
  }
}

TEST_F(BrokenBag, TheWarningReportsMissingBytesAndChunks) {
  const ByteVector bytes = sdk_bag({}).finish();
  const auto recording = open(std::span(bytes).first(bytes.size() / 2));
  expect_one_line_with(recording->info().warnings.at(0), {"the file is truncated: it ends at byte",
                                                          "bytes are missing", "of 3 chunks"});
}

TEST_F(BrokenBag, CompressedChunksAreRecoveredUpToTheTruncation) {
  for (const char* compression : {"lz4", "bz2"}) {
    SCOPED_TRACE(compression);
    SdkBag options;
    options.frames = 12;
    options.format.compression = compression;
    const ByteVector bytes = sdk_bag(options).finish();
    int frames = 0;
    for (std::size_t cut = 13; cut < bytes.size(); cut += 131) {
      SCOPED_TRACE("cut at byte " + std::to_string(cut));
      std::unique_ptr<Recording> recording;
      try {
        recording = open(std::span(bytes).first(cut));
      } catch (const Error&) {
        ASSERT_EQ(frames, 0) << "frames were there before";
        continue;
      }
      ASSERT_GE(recording->frame_count(), frames);
      frames = recording->frame_count();
      expect_first_frames(*recording);
      ASSERT_FALSE(recording->info().warnings.empty());
    }
    EXPECT_EQ(frames, 12);
  }
}

TEST_F(BrokenBag, AnLz4ChunkIsRecoveredBeyondItsLastCompleteBlock) {
  // One chunk with one block, truncated in the middle: about half of the frames must be recovered.
  SdkBag options;
  options.frames = 20;
  options.format = {"lz4", true, true, true, 1000};
  const ByteVector bytes = sdk_bag(options).finish();
  const auto recording = open(std::span(bytes).first(bytes.size() / 2));
  EXPECT_GE(recording->frame_count(), 6);
  expect_first_frames(*recording);
}

TEST_F(BrokenBag, ABagThatWasNeverClosedIsReadCompletely) {
  for (const char* compression : {"none", "lz4", "bz2"}) {
    for (const bool chunk_index : {true, false}) {
      for (const bool close_last_chunk : {true, false}) {
        SCOPED_TRACE(compression);
        SdkBag options;
        options.format = {compression, false, chunk_index, close_last_chunk, 5};
        const auto recording = open(sdk_bag(options).finish());
        ASSERT_EQ(recording->frame_count(), 6);
        expect_first_frames(*recording);
        ASSERT_EQ(recording->info().warnings.size(), 1u);
        expect_one_line_with(recording->info().warnings[0], {"never closed", "6 depth"});
      }
    }
  }
}

TEST_F(BrokenBag, DamageInTheMiddleIsSkipped) {
  SdkBag options;
  options.format.index = false;
  options.format.messages_per_chunk = 4;
  ByteVector bytes = sdk_bag(options).finish();
  // Length of a record in the middle: the reader loses its position and continues at the next
  // chunk.
  const std::string mark = "compression=";
  const auto first =
      std::search(bytes.begin() + bytes.size() / 2, bytes.end(), mark.begin(), mark.end());
  ASSERT_NE(first, bytes.end());
  *(first - 8) = 0xff;
  *(first - 6) = 0xff;
  const auto recording = open(bytes);
  EXPECT_EQ(recording->frame_count(), 4);
  expect_one_line_with(recording->info().warnings.at(0), {"bytes are unreadable"});
}

TEST_F(BrokenBag, ADamagedChunkLosesOnlyItsFrames) {
  SdkBag options;
  options.frames = 70;
  options.format.compression = "lz4";
  options.format.messages_per_chunk = 2;
  ByteVector bytes = sdk_bag(options).finish();
  const auto middle = bytes.begin() + bytes.size() / 2;
  std::fill(middle, middle + 200, static_cast<unsigned char>(0xff));
  const auto recording = open(bytes);
  int broken = 0;
  for (int i = 0; i < recording->frame_count(); ++i) {
    const std::string message =
        message_of([&] { EXPECT_EQ(recording->frame(i).depth.data, depth_of(100 + i).data); });
    if (message.empty()) continue;
    ++broken;
    expect_one_line_with(message, {"broken.bag", "damaged"});
  }
  EXPECT_GE(broken, 1);
  EXPECT_LE(broken, 3);
}

TEST_F(BrokenBag, AnyChangedByteNeverCrashes) {
  for (const char* compression : {"none", "lz4", "bz2"})
    for (const bool index : {true, false}) {
      SdkBag options;
      options.frames = 3;
      options.format = {compression, index, index, true, 8};
      expect_no_harm_by_damage(path_, sdk_bag(options).finish(), 250, [&] {
        const auto recording = open_recording(path_);
        for (int i = 0; i < recording->frame_count(); ++i) message_of([&] { recording->frame(i); });
      });
    }
}

}  // namespace
}  // namespace planescope::io
