// Frames piped to standard input, as from a camera.

#include <gtest/gtest.h>
#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <nlohmann/json.hpp>
#include <thread>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/io/recording.hpp"

namespace planescope {

using namespace testing_cli;

namespace {

const std::string kHeader =
    R"({"schema": "planescope.stream/1", "width": 160, "height": 120, "format": "raw",)"
    R"( "intrinsics": {"fx": 120, "fy": 120, "cx": 80, "cy": 60}, "gravity": [0, 1, 0]})"
    "\n";

std::string frame_bytes() {
  const Image16 depth = floor_and_wall();
  return {reinterpret_cast<const char*>(depth.data.data()), 2 * depth.data.size()};
}

/// Runs the program with these bytes on standard input.
Ran run_with(const std::string& bytes, const std::vector<std::string>& args) {
  const std::filesystem::path file = scratch() / "stream";
  write_text(file, bytes);
  return run(args, [&] {
    if (!freopen(file.c_str(), "rb", stdin)) _exit(97);
  });
}

struct Pipe {
  int from = -1, to = -1;
  Pipe() {
    int ends[2];
    if (::pipe(ends) == 0) from = ends[0], to = ends[1];
  }
};

}  // namespace

TEST(Stream, EachFrameIsPrintedBeforeTheNextOneArrives) {
  const Pipe in, out;
  int lines = 0;
  std::thread camera([&] {
    const auto write_all = [&](const std::string& bytes) {
      for (std::size_t at = 0; at < bytes.size();) {
        const ssize_t wrote = ::write(in.to, bytes.data() + at, bytes.size() - at);
        if (wrote <= 0) return;
        at += static_cast<std::size_t>(wrote);
      }
    };
    write_all(kHeader);
    for (int i = 0; i < 3; ++i) {
      write_all(frame_bytes());
      std::string line;
      for (char byte = 0; byte != '\n'; line += byte) {
        pollfd wanted{out.from, POLLIN, 0};
        if (::poll(&wanted, 1, 60'000) != 1 || ::read(out.from, &byte, 1) != 1) break;
      }
      const auto json = nlohmann::json::parse(line, nullptr, false);
      if (json.is_discarded()) break;
      lines += json["frame"] == i && json["planes"] == 2 &&
               json["schema"] == "planescope.segment_frame/1";
    }
    ::close(in.to);
  });
  const Ran ran = run({"segment", "-", "--json"}, [&] {
    dup2(in.from, STDIN_FILENO);
    dup2(out.to, STDOUT_FILENO);
    for (const int end : {in.from, in.to, out.from, out.to}) ::close(end);
  });
  camera.join();
  for (const int end : {in.from, out.from, out.to}) ::close(end);
  EXPECT_EQ(ran.code, 0) << ran.err;
  EXPECT_EQ(lines, 3);
}

TEST(Stream, SegmentWritesTheSameFilesAsForARecording) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 3);
  well(run({"segment", dir / "rec", "-o", dir / "a", "--gravity", "0,1,0", "--frames", "1:3"}));
  well(run_with(kHeader + frame_bytes() + frame_bytes() + frame_bytes() + "cut",
                {"segment", "-", "-o", dir / "b", "--gravity", "0,1,0", "--frames", "1:3"}));
  EXPECT_EQ(files_below(dir / "a"), files_below(dir / "b"));
  EXPECT_EQ(read_text(dir / "a/frames/000002/planes.png"),
            read_text(dir / "b/frames/000002/planes.png"));
}

TEST(Stream, ACutStreamKeepsTheFramesBeforeTheCut) {
  const auto dir = scratch();
  const std::string cut = kHeader + frame_bytes() + frame_bytes() + "cut";
  expect_refused(run_with(cut, {"segment", "-", "-o", dir / "a"}),
                 "standard input: frame 2 is truncated: received 3 of 38400 bytes of its image");
  well(run_with(kHeader + frame_bytes() + frame_bytes(), {"segment", "-", "-o", dir / "b"}));
  EXPECT_EQ(files_below(dir / "a"), files_below(dir / "b"));
  expect_refused(run_with(cut, {"segment", "-", "-o", dir / "a.mcap"}), "frame 2 is truncated");
  EXPECT_EQ(io::open_recording(dir / "a.mcap")->frame_count(), 2);
  expect_refused(run_with(kHeader + "cut", {"segment", "-", "-o", dir / "c"}),
                 "frame 0 is truncated");
  EXPECT_FALSE(std::filesystem::exists(dir / "c"));
}

TEST(Stream, ConvertKeepsAStreamAndInfoDescribesIt) {
  const auto dir = scratch();
  const std::string bytes = kHeader + frame_bytes() + frame_bytes();
  well(run_with(bytes, {"convert", "-", "-o", dir / "rec"}));
  const auto recording = io::open_recording(dir / "rec");
  ASSERT_EQ(recording->frame_count(), 2);
  EXPECT_EQ(recording->frame(1).depth.data, floor_and_wall().data);
  ASSERT_TRUE(recording->frame(1).gravity);
  const Ran ran = well(run_with(bytes, {"info", "-"}));
  EXPECT_TRUE(has(ran.out, "stream of raw images"));
}

TEST(Stream, BadInputAndOtherCommandsAreRejectedInOneLine) {
  const std::vector<std::string> segment = {"segment", "-", "--json"};
  expect_refused(run_with(kHeader + frame_bytes() + "x", segment), "frame 1 is truncated");
  expect_refused(run_with(kHeader, segment), "no frames after the header");
  expect_refused(run_with("", segment), "no header");
  expect_refused(run_with(kHeader, {"segment", "-", "--json", "--topic", "/depth"}), "no topics");
  expect_refused(run_with(kHeader + frame_bytes(), {"segment", "-", "--json", "--frames", "-1"}),
                 "a stream cannot be indexed from its end");
  for (const char* command : {"report", "map", "eval"})
    expect_refused(run_with(kHeader, {command, "-", "-o", "unused"}), "");
  expect_refused(run_with(kHeader, {"report", "-", "-o", scratch() / "r"}),
                 "only segment, convert, and info read standard input");
}

}  // namespace planescope
