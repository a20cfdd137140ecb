// Invalid input ends with one clear line and exit code 2, and writes nothing.

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <filesystem>
#include <functional>

#include "cli/program.hpp"
#include "cli/scene_files.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/io/image/png.hpp"

using namespace planescope;
using namespace planescope::testing_cli;
namespace fs = std::filesystem;

namespace {

struct BadInput {
  std::string name;
  std::function<fs::path(const fs::path&)> make;  // writes to a folder; returns the input's path
  std::vector<std::string> reported;              // words that the message must contain
  std::vector<std::string> more_args = {};
};

void PrintTo(const BadInput& bad, std::ostream* out) { *out << bad.name; }

void cut_file(const fs::path& path, double share) {
  fs::resize_file(path,
                  static_cast<std::uintmax_t>(static_cast<double>(fs::file_size(path)) * share));
}

// A bag's first record: op 3, no index, no connections, no chunks, padded to 4096 bytes.
std::string empty_bag() {
  const auto u32 = [](std::uint32_t n) {
    std::string bytes;
    for (int i = 0; i < 4; ++i) bytes += static_cast<char>(n >> (8 * i) & 255);
    return bytes;
  };
  const auto field = [&](const std::string& name, const std::string& value) {
    return u32(static_cast<std::uint32_t>(name.size() + 1 + value.size())) + name + "=" + value;
  };
  const std::string header = field("op", "\x03") + field("index_pos", std::string(8, '\0')) +
                             field("conn_count", u32(0)) + field("chunk_count", u32(0));
  const std::string padding(4096 - header.size(), ' ');
  return "#ROSBAG V2.0\n" + u32(static_cast<std::uint32_t>(header.size())) + header +
         u32(static_cast<std::uint32_t>(padding.size())) + padding;
}

// Commands that read a recording and write a folder.
const std::vector<std::string> kWritingCommands = {"segment", "report"};

/// A file with this content.
BadInput file(const std::string& test,
              const std::string& name,
              const std::string& text,
              std::vector<std::string> reported) {
  return {test,
          [=](const fs::path& dir) {
            write_text(dir / name, text);
            return dir / name;
          },
          std::move(reported)};
}

/// A folder recording changed by `spoil`.
BadInput folder(const std::string& test,
                std::vector<std::string> reported,
                const std::function<void(const fs::path& rec)>& spoil,
                int frames = 1,
                std::vector<std::string> more_args = {}) {
  return {test,
          [=](const fs::path& dir) {
            write_depth_folder(dir / "rec", floor_and_wall(), frames);
            spoil(dir / "rec");
            return dir / "rec";
          },
          std::move(reported), std::move(more_args)};
}

std::vector<BadInput> bad_inputs() {
  const auto picture = [](int channels) {
    return [=](const fs::path& rec) {
      io::write_png(rec / "depth/000000.png", Image8(160, 120, channels, 90));
    };
  };
  const auto cut = [](const char* name) {
    return [=](const fs::path& rec) { cut_file(rec / "depth" / name, 0.5); };
  };
  return {
      {"MissingPath", [](const fs::path& dir) { return dir / "nothing"; }, {"nothing"}},
      {"MissingPly", [](const fs::path& dir) { return dir / "no.ply"; }, {"no.ply"}},
      {"EmptyFolder",
       [](const fs::path& dir) {
         fs::create_directories(dir / "empty");
         return dir / "empty";
       },
       {"empty"}},
      folder("EightBitDepth", {"000000.png", "8", "16"}, picture(1)),
      folder("ThreeChannelDepth", {"000000.png", "3"}, picture(3)),
      folder("IntrinsicsOfAnotherSize", {"640x480", "160x120"},
             [](const fs::path& rec) { write_intrinsics(rec, 640, 480); }),
      folder("NoIntrinsics", {"--intrinsics"},
             [](const fs::path& rec) { fs::remove(rec / "camera_intrinsic.json"); }),
      folder("PngCutInHalf", {"000000.png"}, cut("000000.png")),
      folder("NoTruth", {"truth", "rec.labels"}, [](const fs::path&) {}, 1,
             {"--classifier", "truth"}),
      file("BagThatIsNone", "fake.bag", "this is a letter, not a bag\n", {"fake.bag"}),
      file("EmptyFile", "zero.bag", "", {"zero.bag"}),
      file("BagWithoutDepth", "empty.bag", empty_bag(), {"empty.bag", "depth"}),
      file("PlyThatPromisesTooMuch", "big.ply",
           "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\n"
           "property float y\nproperty float z\nend_header\nonly a few bytes",
           {"big.ply", "4000000000"}),
      {"PlyCutShort",
       [](const fs::path& dir) {
         io::write_ply(dir / "cut.ply", floor_and_wall_cloud());
         cut_file(dir / "cut.ply", 0.7);
         return dir / "cut.ply";
       },
       {"cut.ply"}},
      file("UnknownFormat", "notes.txt", "hello\n", {"notes.txt"}),
  };
}

class BadInputs : public testing::TestWithParam<BadInput> {};

}  // namespace

TEST_P(BadInputs, OneLineExitTwoAndNothingWritten) {
  const BadInput& bad = GetParam();
  const fs::path dir = scratch();
  const fs::path input = bad.make(dir);
  for (const std::string& command : kWritingCommands) {
    std::vector<std::string> args = {command, input, "-o", dir / "out", "--gravity", "0,1,0"};
    args.insert(args.end(), bad.more_args.begin(), bad.more_args.end());
    const Ran ran = run(args);
    expect_refused(ran);
    EXPECT_EQ(ran.out, "");
    for (const std::string& word : bad.reported)
      EXPECT_TRUE(has(ran.err, word)) << "no '" << word << "' in: " << ran.err;
    EXPECT_FALSE(fs::exists(dir / "out")) << command;
  }
}

INSTANTIATE_TEST_SUITE_P(All, BadInputs, testing::ValuesIn(bad_inputs()), [](const auto& test) {
  return test.param.name;
});

TEST(BadOutput, AFolderBelowAFileIsRejectedBeforeProcessing) {
  const auto dir = scratch_with_rec();
  write_text(dir / "file", "in the way");
  for (const std::string& command : kWritingCommands)
    for (const fs::path& out : {dir / "file", dir / "file/below", dir / "file/far/below"}) {
      expect_refused(run({command, dir / "rec", "-o", out}), "file");
      EXPECT_EQ(read_text(dir / "file"), "in the way");
    }
  expect_refused(run({"planescope-lab", "synth", "stairs", "-o", dir / "file/below"}));
}

TEST(BadOutput, AFailedRunKeepsEarlierResults) {
  const auto dir = scratch_with_rec(2);
  const std::vector<std::string> args = {"segment",   dir / "rec", "-o",
                                         dir / "out", "--gravity", "0,1,0"};
  well(run(args));
  const auto before = files_below(dir / "out");
  const std::string planes = read_text(dir / "out/frames/000000/planes.json");
  for (const char* frame : {"000000", "000001"})
    cut_file(dir / "rec/depth" / (std::string(frame) + ".png"), 0.5);
  EXPECT_EQ(run(args).code, 2);
  EXPECT_EQ(files_below(dir / "out"), before);
  EXPECT_EQ(read_text(dir / "out/frames/000000/planes.json"), planes);
}

TEST(BadPath, TheMessageHasThePathAndTheReason) {
  const auto dir = scratch_with_rec();
  const fs::path rec = dir / "rec";
  fs::create_symlink("b", dir / "a");
  fs::create_symlink("a", dir / "b");
  const std::string loop = (dir / "a").string() + ": too many levels of symbolic links";
  expect_refused(run({"labels", "export", rec, "--format", "evops", "-o", dir / "a"}), loop);
  const fs::path longest = dir / std::string(255, 'x'), too_long = dir / std::string(256, 'x');
  fs::rename(rec, longest);
  well(run({"info", longest}));
  for (const char* command : {"segment", "report"})
    well(run({command, longest, "-o", dir / command, "--gravity", "0,1,0"}));
  for (const char* command : {"segment", "report", "map", "convert"})
    expect_refused(run({command, longest, "-o", too_long}), "ile name too long");
}

TEST(BadWords, TheMessageHasWhatWasFoundAndWhatIsExpected) {
  const auto dir = scratch_with_rec();
  const auto refused = [&](std::vector<std::string> args, const std::string& part) {
    args.insert(args.begin() + 1, dir / "rec");
    args.insert(args.end(), {"-o", dir / "out"});
    expect_refused(run(args), part);
  };
  refused({"segment", "--foot", "10cm"}, "'10cm' is not a size; expected RADIUS or LENGTHxWIDTH");
  write_text(dir / "bad.json", "hello");
  refused({"report", "--baseline", dir / "bad.json"}, "bad.json: not valid JSON");
  write_text(dir / "bad.json", R"({"a": 1})");
  refused({"report", "--baseline", dir / "bad.json"},
          "has no \"schema\"; expected planescope.report/");
  write_text(dir / "bad.json", "[1]");
  refused({"report", "--baseline", dir / "bad.json"}, "is [1]; expected an object");
  expect_refused(run({"synth", "foo"}), "unknown command 'foo'; expected sample or sequence");
  expect_refused(run({"completions", "tcsh"}),
                 "'tcsh' is not a supported shell; expected one of bash, zsh");
}

TEST(Doubts, AnOptionThatTheRunDoesNotUseIsWarnedOf) {
  const auto dir = scratch_with_rec();
  const auto with = [&](std::vector<std::string> options) {
    std::vector<std::string> args = {"segment", dir / "rec", "-o", dir / "out", "--gravity"};
    args.insert(args.end(), {"0,1,0", "--set", "worth_px=900"});
    args.insert(args.end(), options.begin(), options.end());
    return run(args);
  };
  EXPECT_FALSE(has(well(with({})).err, "no effect"));
  EXPECT_TRUE(has(well(with({"--profile", "paper", "--set", "worth_px=10"})).err,
                  "warning: worth_px: no effect with method ours and profile paper; see"));
  EXPECT_TRUE(has(well(with({"--method", "region-growing"})).err, "region-growing and profile"));
}

TEST(Doubts, AVoxelLargerThanTheSceneAndARunWithoutPlanesAreWarnedOf) {
  const auto dir = scratch_with_rec();
  const auto args = [&](const char* command, std::vector<std::string> more) {
    more.insert(more.begin(), {command, dir / "rec", "-o", dir / command, "--gravity", "0,1,0"});
    return more;
  };
  const std::string voxels = "10 m voxels are larger than the scene";
  EXPECT_TRUE(has(well(run(args("segment", {"--voxel", "10"}))).err, "warning: "));
  well(run(args("report", {"--voxel", "10", "--no-pictures"})));
  EXPECT_TRUE(has(read_text(dir / "report/report.json"), voxels));
  EXPECT_TRUE(has(read_text(dir / "report/index.html"), voxels));
  expect_refused(run(args("segment", {"--voxel", "10", "--warnings-as-errors"})), voxels);

  Image16 noise = floor_and_wall();  // otherwise each of its planes is worth any number of pixels
  std::uint32_t random = 1;
  for (std::uint16_t& count : noise.data) {
    random = random * 1664525u + 1013904223u;
    count = static_cast<std::uint16_t>(count + (random >> 16) % 60);
  }
  io::write_png(dir / "rec/depth/000000.png", noise);
  EXPECT_TRUE(has(well(run(args("segment", {"--set", "worth_px=1e9"}))).err,
                  "0 planes in 1 frame; are the depth unit"));
  EXPECT_EQ(
      run(args("report", {"--set", "worth_px=1e9", "--no-pictures", "--warnings-as-errors"})).code,
      2);
  EXPECT_TRUE(has(read_text(dir / "report/report.json"), "0 planes in 1 frame"));
}

TEST(Memory, ThatRunsOutIsReportedWithItsFrame) {
  const auto dir = scratch();
  write_depth_folder(dir / "rec", Image16(4000, 3000, 1, 1000));
  const auto little = [] {
    const rlimit both{400'000'000, 400'000'000};
    setrlimit(RLIMIT_AS, &both);
  };
  if (run({"--version"}, little).code != 0) GTEST_SKIP() << "a sanitizer reserves memory";
  const Ran ran = run({"segment", dir / "rec", "-o", dir / "out", "--gravity", "0,1,0",
                       "--intrinsics", "3000,3000,2000,1500"},
                      little);
  if (ran.code == 0) GTEST_SKIP() << "this build needs less memory";
  expect_refused(ran, "rec, frame 0 (4000x3000): out of memory");
}
