// Tests of frames that arrive on standard input: header, frames in both forms, and damage.

#include <fcntl.h>
#include <unistd.h>

#include <functional>
#include <thread>

#include "core/io/image/png.hpp"
#include "unit/io/bag_writer.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

using namespace testing_bags;

std::string header(const std::string& format, const std::string& more = "") {
  return R"({"schema": "planescope.stream/1", "width": 24, "height": 16, "format": ")" + format +
         R"(", "intrinsics": {"fx": 20, "fy": 21, "cx": 12, "cy": 8}, "depth_unit_m": 0.00025)" +
         more + "}\n";
}

std::string text_of(const ByteVector& bytes) { return {bytes.begin(), bytes.end()}; }
std::string raw_frame(std::uint32_t seq) { return text_of(pixels_of(depth_of(seq))); }
std::string png_frame(std::uint32_t seq) {
  return text_of(Fields().sized(encode_png(depth_of(seq))).out);
}

/// Writes bytes to a pipe and passes the stream that reads them to `use`.
void with_stream(const std::string& bytes,
                 const std::function<void(FrameStream&)>& use,
                 const RecordingOptions& options = {},
                 bool keeps_all = true) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const FileDescriptor from(ends[0]);
  std::thread writer([&bytes, to = ends[1]] {
    // Smaller than a frame, so that frames arrive in pieces.
    for (std::size_t at = 0; at < bytes.size();) {
      const ssize_t wrote =
          ::write(to, bytes.data() + at, std::min<std::size_t>(100, bytes.size() - at));
      if (wrote <= 0) break;
      at += static_cast<std::size_t>(wrote);
    }
    ::close(to);
  });
  std::string error;
  try {
    use(*open_stream(from.get(), options, keeps_all));
  } catch (const Error& thrown) {
    error = thrown.what();
  }
  char rest[4096];
  while (::read(from.get(), rest, sizeof(rest)) > 0) continue;
  writer.join();
  if (!error.empty()) throw Error(error);
}

std::string message_of_stream(const std::string& bytes, const RecordingOptions& options = {}) {
  return message_of([&] {
    with_stream(
        bytes,
        [](FrameStream& stream) {
          while (stream.wait_for_frame({})) stream.frame(stream.frame_count() - 1);
        },
        options);
  });
}

TEST(Stream, FramesAreReadAsTheyArrive) {
  for (const bool is_png : {false, true}) {
    std::string bytes = header(is_png ? "png" : "raw", R"(, "gravity": [0, 2, 0])");
    for (int i = 0; i < 3; ++i) bytes += is_png ? png_frame(i) : raw_frame(i);
    with_stream(bytes, [](FrameStream& stream) {
      EXPECT_EQ(stream.info().intrinsics.fy, 21);
      EXPECT_EQ(stream.info().width, 24);
      for (int i = 0; i < 3; ++i) {
        EXPECT_EQ(stream.frame_count(), i);
        ASSERT_TRUE(stream.wait_for_frame({}));
        const Frame frame = stream.frame(i);
        EXPECT_EQ(frame.depth.data, depth_of(i).data);
        EXPECT_EQ(frame.depth_unit_m, 0.00025);
        ASSERT_TRUE(frame.gravity);
        EXPECT_EQ(frame.gravity->direction, Vec3d(0, 1, 0));
      }
      EXPECT_FALSE(stream.wait_for_frame({}));
      EXPECT_EQ(stream.frame(0).depth.data, depth_of(0).data);  // all frames are kept
    });
  }
}

TEST(Stream, AStopEndsTheWait) {
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const FileDescriptor from(ends[0]), to(ends[1]);
  const std::string bytes = header("raw") + raw_frame(1).substr(0, 50);
  ASSERT_EQ(::write(to.get(), bytes.data(), bytes.size()), static_cast<ssize_t>(bytes.size()));
  const auto stream = open_stream(from.get(), {}, false);
  std::stop_source stop;
  stop.request_stop();
  EXPECT_FALSE(stream->wait_for_frame(stop.get_token()));
}

TEST(Stream, OptionsOverrideTheHeaderAndIntrinsicsAreRequired) {
  const std::string bare =
      R"({"schema": "planescope.stream/1", "width": 24, "height": 16, "format": "raw"})"
      "\n";
  expect_one_line_with(message_of_stream(bare + raw_frame(1)), {"standard input", "--intrinsics"});
  EXPECT_EQ(message_of_stream(bare + raw_frame(1), with_intrinsics(20, 20, 12, 8)), "");
}

TEST(Stream, DamageIsReportedWithItsFrame) {
  const std::string raw = header("raw") + raw_frame(0), png = header("png") + png_frame(0);
  const std::string wrong_size = text_of(Fields().sized(encode_png(Image16(16, 24, 1, 1000))).out);
  const std::string picture = text_of(Fields().sized(encode_png(Image8(24, 16, 3, 7))).out);
  const std::tuple<std::string, std::string, std::string> cases[] = {
      {raw + raw_frame(1).substr(0, 700), "frame 1 is truncated", "700 of 768 bytes"},
      {png + png_frame(1).substr(0, 300), "frame 1 is truncated", "296 of"},
      {png + png_frame(1).substr(0, 4), "frame 1 is truncated", "0 of"},
      {png + png_frame(1).substr(0, 2), "frame 1 is truncated", "2 of 4 bytes of its length"},
      {png + std::string("\xff\xff\xff\x7f", 4), "frame 1", "a 2147483647-byte PNG"},
      {png + std::string(4, '\0'), "frame 1", "a 0-byte PNG"},
      {png + std::string("\x05\0\0\0hello", 9), "frame 1", "PNG"},
      {png + wrong_size, "frame 1: 16x24 pixels", "expected 24x16"},
      {png + picture, "frame 1", "expected"},
      {"", "no header (0 bytes read)", "planescope.stream/1"},
      {"P5 24 16\n", "no header", "planescope.stream/1"},
      {"{\"schema\": \n", "standard input", ""},
      {"{\"schema\": \"planescope.stream/9\"}\n", "schema", "planescope.stream/1"},
      {header("jpeg"), "format", "png"},
      {header("raw", R"(, "heigth": 3)"), "heigth", ""},
      {header("raw", R"(, "gravity": [0, 0, 0])"), "gravity", "three numbers"}};
  for (const auto& [bytes, part, more] : cases) {
    SCOPED_TRACE(part);
    expect_one_line_with(message_of_stream(bytes), {"standard input", part.c_str(), more.c_str()});
  }
}

}  // namespace
}  // namespace planescope::io
