// What a user can get wrong ends with one clear line, exit code 2 and nothing written.

#include <gtest/gtest.h>

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
  std::function<fs::path(const fs::path&)> make;  // into a folder; returns the input's path
  std::vector<std::string> told;                  // words the message must hold
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

std::vector<BadInput> bad_inputs() {
  std::vector<BadInput> cases;
  cases.push_back(
      {"MissingPath", [](const fs::path& dir) { return dir / "nothing"; }, {"nothing"}});
  cases.push_back({"MissingPly", [](const fs::path& dir) { return dir / "no.ply"; }, {"no.ply"}});
  cases.push_back({"EmptyFolder",
                   [](const fs::path& dir) {
                     fs::create_directories(dir / "empty");
                     return dir / "empty";
                   },
                   {"empty"}});
  cases.push_back({"EightBitDepth",
                   [](const fs::path& dir) {
                     write_depth_folder(dir / "rec", floor_and_wall());
                     io::write_png(dir / "rec/depth/000000.png", Image8(160, 120, 1, 90));
                     return dir / "rec";
                   },
                   {"000000.png", "8", "16"}});
  cases.push_back({"ThreeChannelDepth",
                   [](const fs::path& dir) {
                     write_depth_folder(dir / "rec", floor_and_wall());
                     io::write_png(dir / "rec/depth/000000.png", Image8(160, 120, 3, 90));
                     return dir / "rec";
                   },
                   {"000000.png", "3"}});
  cases.push_back({"IntrinsicsOfAnotherSize",
                   [](const fs::path& dir) {
                     write_depth_folder(dir / "rec", floor_and_wall());
                     write_intrinsics(dir / "rec", 640, 480);
                     return dir / "rec";
                   },
                   {"640x480", "160x120"}});
  cases.push_back({"NoIntrinsics",
                   [](const fs::path& dir) {
                     write_depth_folder(dir / "rec", floor_and_wall());
                     fs::remove(dir / "rec/camera_intrinsic.json");
                     return dir / "rec";
                   },
                   {"--intrinsics"}});
  cases.push_back({"PngCutInHalf",
                   [](const fs::path& dir) {
                     write_depth_folder(dir / "rec", floor_and_wall());
                     cut_file(dir / "rec/depth/000000.png", 0.5);
                     return dir / "rec";
                   },
                   {"000000.png"}});
  cases.push_back({"LaterPngCutInHalf",
                   [](const fs::path& dir) {
                     write_depth_folder(dir / "rec", floor_and_wall(), 3);
                     cut_file(dir / "rec/depth/000002.png", 0.5);
                     return dir / "rec";
                   },
                   {"000002.png"}});
  cases.push_back({"BagThatIsNone",
                   [](const fs::path& dir) {
                     write_text(dir / "fake.bag", "this is a letter, not a bag\n");
                     return dir / "fake.bag";
                   },
                   {"fake.bag"}});
  cases.push_back({"EmptyFile",
                   [](const fs::path& dir) {
                     write_text(dir / "zero.bag", "");
                     return dir / "zero.bag";
                   },
                   {"zero.bag"}});
  cases.push_back({"BagWithoutDepth",
                   [](const fs::path& dir) {
                     write_text(dir / "empty.bag", empty_bag());
                     return dir / "empty.bag";
                   },
                   {"empty.bag", "depth"}});
  cases.push_back({"PlyThatPromisesTooMuch",
                   [](const fs::path& dir) {
                     write_text(dir / "big.ply",
                                "ply\nformat binary_little_endian 1.0\nelement vertex "
                                "4000000000\nproperty float x\nproperty float y\nproperty float "
                                "z\nend_header\nonly a few bytes");
                     return dir / "big.ply";
                   },
                   {"big.ply", "4000000000"}});
  cases.push_back({"PlyCutShort",
                   [](const fs::path& dir) {
                     io::write_ply(dir / "cut.ply", floor_and_wall_cloud());
                     cut_file(dir / "cut.ply", 0.7);
                     return dir / "cut.ply";
                   },
                   {"cut.ply"}});
  cases.push_back({"UnknownFormat",
                   [](const fs::path& dir) {
                     write_text(dir / "notes.txt", "hello\n");
                     return dir / "notes.txt";
                   },
                   {"notes.txt"}});
  cases.push_back({"NoTruth",
                   [](const fs::path& dir) {
                     write_depth_folder(dir / "rec", floor_and_wall());
                     return dir / "rec";
                   },
                   {"truth", "rec.labels"},
                   {"--classifier", "truth"}});
  return cases;
}

class BadInputs : public testing::TestWithParam<BadInput> {};

}  // namespace

TEST_P(BadInputs, OneLineExitTwoAndNothingWritten) {
  const BadInput& bad = GetParam();
  const fs::path dir = scratch();
  const fs::path input = bad.make(dir);
  for (const std::string& command : kWritingCommands) {
    // A report tells of the damaged frame and has the others (report_test.cpp).
    if (command == "report" && bad.name == "LaterPngCutInHalf") continue;
    std::vector<std::string> args = {command,     input.string(), "-o", (dir / "out").string(),
                                     "--gravity", "0,1,0"};
    args.insert(args.end(), bad.more_args.begin(), bad.more_args.end());
    const Ran ran = run(args);
    EXPECT_EQ(ran.code, 2) << command;
    EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
    EXPECT_EQ(ran.out, "");
    for (const std::string& word : bad.told)
      EXPECT_NE(ran.err.find(word), std::string::npos) << "no '" << word << "' in: " << ran.err;
    EXPECT_FALSE(fs::exists(dir / "out")) << command;
  }
}

INSTANTIATE_TEST_SUITE_P(All, BadInputs, testing::ValuesIn(bad_inputs()), [](const auto& test) {
  return test.param.name;
});

TEST(BadOutput, AFolderBelowAFileIsRefusedBeforeTheWork) {
  const fs::path dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall());
  write_text(dir / "file", "in the way");
  for (const std::string& command : kWritingCommands)
    for (const fs::path& out : {dir / "file", dir / "file/below", dir / "file/far/below"}) {
      const Ran ran = run({command, (dir / "rec").string(), "-o", out.string()});
      EXPECT_EQ(ran.code, 2);
      EXPECT_TRUE(is_one_line(ran.err)) << ran.err;
      EXPECT_NE(ran.err.find("file"), std::string::npos) << ran.err;
      EXPECT_EQ(read_text(dir / "file"), "in the way");
    }
  const Ran stairs =
      run({"planescope-lab", "synth", "stairs", "-o", (dir / "file/below").string()});
  EXPECT_EQ(stairs.code, 2);
  EXPECT_TRUE(is_one_line(stairs.err)) << stairs.err;
}

TEST(BadOutput, AFailedRunLeavesAnEarlierResultAlone) {
  const fs::path dir = scratch();
  write_depth_folder(dir / "rec", floor_and_wall(), 2);
  const std::vector<std::string> args = {
      "segment", (dir / "rec").string(), "-o", (dir / "out").string(), "--gravity", "0,1,0"};
  ASSERT_EQ(run(args).code, 0);
  const auto before = files_below(dir / "out");
  const std::string planes = read_text(dir / "out/frames/000000/planes.json");
  cut_file(dir / "rec/depth/000001.png", 0.5);
  EXPECT_EQ(run(args).code, 2);
  EXPECT_EQ(files_below(dir / "out"), before);
  EXPECT_EQ(read_text(dir / "out/frames/000000/planes.json"), planes);
}
