// Small files that require large resources, and files that change while they are read.

#include "core/io/byte_reader.hpp"
#include "core/io/image/png.hpp"
#include "core/model/file_bytes.hpp"
#include "unit/io/bag_writer.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

using namespace testing_bags;
namespace fs = std::filesystem;

/// Lowers the limit of decompressed data for its lifetime.
struct SmallReadLimit {
  std::uint64_t before = read_limit_bytes();
  explicit SmallReadLimit(std::uint64_t bytes) { set_read_limit_bytes(bytes); }
  ~SmallReadLimit() { set_read_limit_bytes(before); }
};

TEST(HostileFile, AnImageIsRejectedBeforeExceedingTheLimit) {
  const fs::path path = temp_folder() / "large.png";
  write_png(path, Image8(600, 600, 3, 7));
  EXPECT_EQ(read_png_rgb(path).width, 600);
  const SmallReadLimit limit(1 << 20);
  expect_one_line_with(message_of([&] { read_png_rgb(path); }),
                       {"large.png", "expected at most 1", "--read-limit"});
}

TEST(HostileFile, AChunkIsRejectedBeforeDecompressingMoreThanTheLimit) {
  for (const char* compression : {"lz4", "bz2"})
    for (const bool index : {true, false}) {
      SCOPED_TRACE(compression);
      SdkBag options;
      options.format = {compression, index, index, true, 1000};
      BagWriter bag = sdk_bag(options);
      bag.add("/zeros", "std_msgs/String", 2'000'000'000, ByteVector(8 << 20, 0));
      const ByteVector bytes = bag.finish();
      const fs::path path = temp_folder() / "bomb.bag";
      write_anew(path, bytes);
      ASSERT_LT(bytes.size(), 1U << 18);
      EXPECT_EQ(open_recording(path)->frame_count(), 6);
      const SmallReadLimit limit(1 << 20);
      // With its index the chunk is rejected; without, the part before the limit is read.
      if (index)
        expect_one_line_with(message_of([&] { open_recording(path)->frame(0); }),
                             {"bomb.bag", "chunk 0", "--read-limit"});
      else
        EXPECT_EQ(open_recording(path)->frame_count(), 6);
    }
}

TEST(HostileFile, AnIndexThatRepeatsItsChunksIsRejected) {
  SdkBag options;
  options.frames = 40;
  options.format.named_times = 1000;
  const fs::path path = temp_folder() / "again.bag";
  write_anew(path, sdk_bag(options).finish());
  const auto recording = open_recording(path);
  EXPECT_EQ(recording->frame_count(), 40);
  expect_one_line_with(recording->info().warnings.at(0), {"the index is truncated or damaged"});
  EXPECT_EQ(recording->frame(39).depth.data, depth_of(139).data);
}

TEST(HostileFile, AMappingOfATruncatedFileReadsZerosAndReportsIt) {
  const fs::path path = temp_folder() / "cut.bin";
  const std::vector<unsigned char> ones(1 << 16, 1);
  write_anew(path, ones);
  const MappedFile whole(path);
  const MappedFile file(path);
  const auto sum = [&] {
    volatile int total = 0;  // volatile, so that the read is not optimized away
    for (const std::byte byte : file.bytes()) total = total + std::to_integer<int>(byte);
    return static_cast<int>(total);
  };
  EXPECT_EQ(io::guarded(file, sum), 1 << 16);
  fs::resize_file(path, 8192);
  expect_one_line_with(message_of([&] { io::guarded(file, sum); }),
                       {"cut.bin", "truncated while being read", "65536 bytes"});
  EXPECT_EQ(sum(), 8192);
  EXPECT_EQ(message_of([&] { whole.expect_whole(); }), "") << "nothing of it was looked at";
}

TEST(HostileFile, ARecordingTruncatedWhileOpenLosesOnlyItsFrames) {
  SdkBag options;
  options.frames = 400;
  const fs::path path = temp_folder() / "open.bag", other = temp_folder() / "other.bag";
  const ByteVector bytes = sdk_bag(options).finish();
  write_anew(path, bytes);
  const auto recording = open_recording(path);
  ASSERT_EQ(recording->frame_count(), 400);
  EXPECT_EQ(recording->frame(3).depth.data, depth_of(103).data);
  fs::resize_file(path, bytes.size() / 2);
  expect_one_line_with(message_of([&] { recording->frame(399); }),
                       {"open.bag", "truncated while being read"});
  write_anew(other, bytes);
  EXPECT_EQ(open_recording(other)->frame(399).depth.data, depth_of(499).data);
}

}  // namespace
}  // namespace planescope::io
