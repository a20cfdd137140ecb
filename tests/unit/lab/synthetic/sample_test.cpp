// Tests of writing the synthetic sample recording.

#include "core/lab/synthetic/sample.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "core/io/image/png.hpp"
#include "core/io/recording.hpp"
#include "core/lab/synthetic/render_scene.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "support/temp_dir.hpp"

namespace planescope::lab {
namespace {

namespace fs = std::filesystem;

fs::path fresh_dir(const std::string& name) {
  const fs::path dir = temp_dir() / ("sample_" + name);
  fs::remove_all(dir);
  fs::remove_all(labels::default_label_dir(dir));
  return dir;
}

SampleOptions small_sample() {
  SampleOptions options;
  options.width = 64;
  options.height = 48;
  return options;
}

std::vector<fs::path> files_under(const fs::path& dir) {
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(dir))
    if (entry.is_regular_file()) files.push_back(fs::relative(entry.path(), dir));
  std::sort(files.begin(), files.end());
  return files;
}

/// Compares pixels of PNGs instead of bytes, because compression depends on the version of zlib.
void expect_same_content(const fs::path& a, const fs::path& b) {
  if (a.extension() != ".png") {
    EXPECT_EQ(read_file_bytes(a), read_file_bytes(b)) << a;
  } else if (const io::PngInfo info = io::png_info(a); info.bit_depth == 16) {
    EXPECT_TRUE(io::read_png_16(a).data == io::read_png_16(b).data) << a;
  } else if (info.channels == 1) {
    EXPECT_TRUE(io::read_png_grey(a).data == io::read_png_grey(b).data) << a;
  } else {
    EXPECT_TRUE(io::read_png_rgb(a).data == io::read_png_rgb(b).data) << a;
  }
}

TEST(Sample, TheShippedSampleMatchesTheDefaults) {
  const fs::path shipped = fs::path(PLANESCOPE_SOURCE_DIR) / "assets/sample";
  const fs::path dir = fresh_dir("shipped");
  write_sample(dir);
  for (const auto& [ours, theirs] :
       {std::pair{dir, shipped},
        {labels::default_label_dir(dir), labels::default_label_dir(shipped)}}) {
    const auto files = files_under(ours);
    ASSERT_EQ(files, files_under(theirs));
    for (const fs::path& file : files) expect_same_content(ours / file, theirs / file);
  }
}

TEST(Sample, IsARecordingWhoseLabelsBelongToItsFrames) {
  const fs::path dir = fresh_dir("truth");
  write_sample(dir, small_sample());
  const auto recording = io::open_recording(dir);
  ASSERT_EQ(recording->frame_count(), 3);
  for (int i = 0; i < 3; ++i) {
    const Frame frame = recording->frame(i);
    EXPECT_EQ(frame.depth.width, 64);
    EXPECT_EQ(frame.color.height, 48);
    EXPECT_TRUE(frame.color_aligned);
    EXPECT_DOUBLE_EQ(frame.depth_unit_m, 0.001);
    EXPECT_DOUBLE_EQ(frame.intrinsics.fx, 38.5);
    EXPECT_FALSE(frame.gravity) << "the estimate has to find it";
    EXPECT_EQ(recording->frame_hash(i), depth_sha256(frame.depth));
    const auto truth =
        labels::read_frame_labels(labels::default_label_dir(dir), i, recording->frame_hash(i));
    ASSERT_TRUE(truth);
    EXPECT_GT(truth->planes.size(), 3u);
  }
}

TEST(Sample, AnotherSeedGivesOtherScenesAndTheSameSeedTheSame) {
  const fs::path one = fresh_dir("one"), again = fresh_dir("again"), two = fresh_dir("two");
  SampleOptions options = small_sample();
  write_sample(one, options);
  write_sample(again, options);
  options.seed = 2;
  write_sample(two, options);
  const fs::path depth = fs::path("depth") / "000000.png";
  EXPECT_EQ(read_file_bytes(one / depth), read_file_bytes(again / depth));
  EXPECT_NE(read_file_bytes(one / depth), read_file_bytes(two / depth));
  const auto truth_one = labels::read_frame_labels(labels::default_label_dir(one), 0, "");
  const auto truth_two = labels::read_frame_labels(labels::default_label_dir(two), 0, "");
  EXPECT_GT((truth_one->gravity.direction - truth_two->gravity.direction).norm(), 1e-3);
}

TEST(Sample, CanIncludeItsTrueGravity) {
  const fs::path dir = fresh_dir("stated");
  SampleOptions options = small_sample();
  options.gravity = true;
  write_sample(dir, options);
  for (int i = 0; i < 3; ++i) {
    const auto stated = io::open_recording(dir)->frame(i).gravity;
    ASSERT_TRUE(stated);
    const auto truth = labels::read_frame_labels(labels::default_label_dir(dir), i, "");
    EXPECT_LT((stated->direction - truth->gravity.direction).norm(), 1e-8);
  }
}

TEST(Sample, AnEarlierSampleIsOverwritten) {
  const fs::path dir = fresh_dir("overwrite");
  SampleOptions options = small_sample();
  write_sample(dir, options);
  options.seed = 2;
  EXPECT_NO_THROW(write_sample(dir, options));
}

TEST(Sample, AFolderWithOtherFilesIsRejectedAndNotChanged) {
  const fs::path dir = fresh_dir("foreign");
  fs::create_directories(dir);
  std::ofstream(dir / "holiday.jpg") << "mine";
  EXPECT_THROW(write_sample(dir, small_sample()), Error);
  EXPECT_EQ(files_under(dir), std::vector<fs::path>{"holiday.jpg"});

  const fs::path longer = fresh_dir("longer");
  SampleOptions options = small_sample();
  write_sample(longer, options);
  options.scenes = {"ramp"};
  EXPECT_THROW(write_sample(longer, options), Error) << "two frames of the other would remain";
}

TEST(Sample, InvalidOptionsAreRejectedBeforeAnythingIsWritten) {
  const fs::path dir = fresh_dir("bad");
  SampleOptions options = small_sample();
  options.scenes = {"stairs", "attic"};
  EXPECT_THROW(write_sample(dir, options), Error);
  options = small_sample();
  options.scenes.clear();
  EXPECT_THROW(write_sample(dir, options), Error);
  options = small_sample();
  options.width = 0;
  EXPECT_THROW(write_sample(dir, options), Error);
  options.width = 1 << 30;
  EXPECT_THROW(write_sample(dir, options), Error);
  EXPECT_FALSE(fs::exists(dir));
  const fs::path file = fresh_dir("file");
  std::ofstream(file) << "a file where the folder should be";
  EXPECT_THROW(write_sample(file / "sub", small_sample()), Error);
  EXPECT_THROW(write_sample(file, small_sample()), Error);
}

}  // namespace
}  // namespace planescope::lab
