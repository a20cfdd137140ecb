// Tests of folder recordings: layout, intrinsics, timestamps, color pairing and sidecars.

#include <fmt/format.h>
#include <sys/stat.h>

#include "core/io/folder/folder_files.hpp"
#include "core/io/image/png.hpp"
#include "support/jpeg_bytes.hpp"
#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

constexpr int kW = 12;
constexpr int kH = 8;
const RecordingOptions kKnown = with_intrinsics(10, 10, 6, 4);
constexpr const char* kOpen3dJson =
    R"({"width": 12, "height": 8, "intrinsic_matrix": [10, 0, 0, 0, 11, 0, 6, 4, 1]})";

void write_depth(const fs::path& path, std::uint16_t count, int width = kW, int height = kH) {
  fs::create_directories(path.parent_path());
  write_png(path, Image16(width, height, 1, count));
}

void write_color(const fs::path& path, std::uint8_t red, int width = kW, int height = kH) {
  fs::create_directories(path.parent_path());
  Image8 image(width, height, 3);
  for (std::size_t i = 0; i < image.data.size(); i += 3) image.data[i] = red;
  write_png(path, image);
}

/// depth/ and color/ with three frames 1, 2, 10, with counts 1001, 1002, 1010 and red 1, 2, 10.
fs::path sample_folder() {
  const fs::path folder = temp_folder();
  for (const int i : {1, 2, 10}) {
    write_depth(folder / "depth" / (std::to_string(i) + ".png"),
                static_cast<std::uint16_t>(1000 + i));
    write_color(folder / "color" / (std::to_string(i) + ".png"), static_cast<std::uint8_t>(i));
  }
  return folder;
}

/// Opens a folder with intrinsics.
std::unique_ptr<Recording> open_known(const fs::path& folder) {
  return open_recording(folder, kKnown);
}

/// Expects one damaged frame, reported with `parts`.
void expect_damaged(const fs::path& folder, std::initializer_list<const char*> parts) {
  const auto damaged = open_known(folder)->info().damaged;
  ASSERT_EQ(damaged.size(), 1u);
  expect_one_line_with(damaged.begin()->second, parts);
}

TEST(Folder, FramesAreInNumericOrderWithTheirColor) {
  const fs::path folder = sample_folder();
  write_text(folder / "camera_intrinsic.json", kOpen3dJson);
  const auto recording = open_recording(folder);
  ASSERT_EQ(recording->frame_count(), 3);
  int i = 0;
  for (const int number : {1, 2, 10}) {
    const Frame frame = recording->frame(i++);
    EXPECT_EQ(frame.name, std::to_string(number));
    EXPECT_EQ(frame.depth.at(3, 3), 1000 + number);
    EXPECT_EQ(frame.color.at(3, 3, 0), number);
    EXPECT_TRUE(frame.color_aligned);
    EXPECT_EQ(frame.intrinsics.fx, 10);
    EXPECT_EQ(frame.intrinsics.fy, 11);
    EXPECT_EQ(frame.intrinsics.cx, 6);
    EXPECT_EQ(frame.intrinsics.cy, 4);
  }
  EXPECT_EQ(recording->info().depth_unit_m, 0.001);
  EXPECT_EQ(recording->info().depth_unit_source, "assumed (RealSense default)");
}

TEST(Folder, WarnsAboutImplausibleCamerasAndDepthUnits) {
  const fs::path folder = sample_folder();
  const auto warnings = [&](const std::string& text, double depth_unit_m = 0.001) {
    write_text(folder / "camera.txt", text);
    RecordingOptions options;
    options.depth_unit_m = depth_unit_m;
    return open_recording(folder, options)->info().warnings;
  };
  const auto expect = [&](const std::vector<std::string>& found, const char* part) {
    ASSERT_EQ(found.size(), 1u) << part;
    EXPECT_NE(found[0].find(part), std::string::npos) << found[0];
  };
  EXPECT_TRUE(warnings("10 10 6 4").empty());
  expect(warnings("10 10 16 4"), "the principal point 16,4 is outside the 12x8 image");
  expect(warnings("1000 1000 6 4"), "a field of view of 0.688 x 0.458 degrees");
  expect(warnings("10 13 6 4"), "fx 10 and fy 13 differ by 30 %");
  expect(warnings("10 10 6 4", 1e-6), "100 % of the depth values in frame 0 are nearer than 5 cm");
  expect(warnings("10 10 6 4", 0.5), "100 % of the depth values in frame 0 are farther than 100 m");
  write_text(folder / "planescope.json",
             R"({"intrinsics": {"width": 12, "height": 8, "fx": 10, "fy": 10, "cx": 6, "cy": 4,
                 "distortion": [1e300, 0, 0, 0, 0]}})");
  expect(warnings("10 10 6 4"), "distortion moves the image corner");
}

TEST(Folder, ACalibrationThatIsNotUnderstoodIsNamed) {
  const fs::path folder = sample_folder();
  write_text(folder / "Calib.yaml", "fx: 10");
  write_text(folder / "calibration.txt", "10 10 6 4");
  const auto info = open_recording(folder)->info();
  EXPECT_EQ(info.intrinsics_source, "calibration.txt");
  EXPECT_EQ(info.ignored_calibration, std::vector<std::string>{"Calib.yaml"});
  ASSERT_EQ(info.warnings.size(), 1u);
  EXPECT_TRUE(info.warnings[0].starts_with("Calib.yaml: not a supported calibration"));
  EXPECT_TRUE(open_known(folder)->info().warnings.empty()) << "the user gave intrinsics";
  fs::remove(folder / "calibration.txt");
  expect_refused(folder, {"contains no camera intrinsics (Calib.yaml: not a", "--intrinsics"});
}

TEST(Folder, ColorThatCannotBeAlignedWithDepthIsNamed) {
  const fs::path folder = sample_folder();
  for (const int i : {1, 2, 10})
    write_color(folder / "color" / (std::to_string(i) + ".png"), 7, 16, 9);
  const auto warnings = [&](const RecordingOptions& options) {
    return open_recording(folder, options)->info().warnings;
  };
  EXPECT_EQ(warnings(kKnown), std::vector<std::string>{"color cannot be aligned with depth: 16x9 "
                                                       "color without depth-to-color extrinsics"});
  RecordingOptions without_color = kKnown;
  without_color.color = false;
  EXPECT_TRUE(warnings(without_color).empty());
  // A sidecar calls it aligned, and the color camera's own file contradicts that.
  for (const int i : {1, 2, 10}) write_color(folder / "color" / (std::to_string(i) + ".png"), 7);
  write_text(folder / "planescope.json", R"({"color_aligned": true})");
  const auto camera = [&](const char* name, int f) {
    write_text(folder / name, fmt::format(R"({{"width": 12, "height": 8, "fx": {}, "fy": {},
                                               "cx": 6, "cy": 4}})",
                                          f, f));
  };
  camera("depth.json", 10);
  camera("color.json", 10);
  EXPECT_TRUE(warnings({}).empty());
  camera("color.json", 15);
  ASSERT_EQ(warnings({}).size(), 1u);
  EXPECT_TRUE(warnings({})[0].ends_with("a field of view of 43.6 degrees; depth has 61.9"));
}

TEST(Folder, AGitLfsPointerIsReported) {
  const fs::path folder = sample_folder();
  write_text(folder / "depth" / "1.png",
             "version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 12345\n");
  expect_damaged(folder, {"1.png", "a Git LFS pointer instead of the file"});
}

TEST(Folder, EveryFormatOfIntrinsicsIsRead) {
  const std::pair<const char*, const char*> files[] = {
      {"intrinsic.json", R"({"intrinsic_matrix": [[10, 0, 6], [0, 11, 4], [0, 0, 1]]})"},
      {"my_camera.json", R"({"fx": 10, "fy": 11, "ppx": 6, "ppy": 4, "other": []})"},
      {"calibration.json",
       R"({"intrinsic": {"width": 12, "height": 8, "intrinsic_matrix": [10,0,0,0,11,0,6,4,1]}})"},
      {"camera.txt", "10 11 6 4\n"},
      {"camera.txt", "# fx, fy, cx, cy\n10., 11., 6., 4.\n"},
      {"intrinsics.txt",
       "\xEF\xBB\xBF"
       "10 11 6 4 0.0002 12 8\r\n"},
      {"ICL.K", "10. 0. 6.\n0. -11.0 4.\n0. 0. 1."},
      {"intrinsic_depth.txt", "10 0 6 0\n0 11 4 0\n0 0 1 0\n0 0 0 1\n"},
      {"calib.xml",
       R"(<opencv_storage><camera_matrix type_id="opencv-matrix"><rows>3</rows><cols>3</cols>
          <dt>d</dt><data>10. 0. 6. 0. 11. 4. 0. 0. 1.</data></camera_matrix></opencv_storage>)"}};
  for (const auto& [name, text] : files) {
    SCOPED_TRACE(name);
    const fs::path folder = sample_folder();
    write_text(folder / name, text);
    const RecordingInfo info = open_recording(folder)->info();
    EXPECT_EQ(info.intrinsics_source, name);
    EXPECT_EQ(info.intrinsics.fx, 10);
    EXPECT_EQ(info.intrinsics.fy, 11);
    EXPECT_EQ(info.intrinsics.cx, 6);
    EXPECT_EQ(info.intrinsics.cy, 4);
  }
}

TEST(Folder, DepthScaleIsReadInEitherConvention) {
  for (const auto& [text, unit_m] :
       {std::pair("1000.0", 0.001), std::pair("5000", 0.0002), std::pair("0.00025", 0.00025)}) {
    const fs::path folder = sample_folder();
    write_text(
        folder / "intrinsic.json",
        std::string(R"({"intrinsic_matrix": [10,0,0,0,11,0,6,4,1], "depth_scale": )") + text + "}");
    const RecordingInfo info = open_recording(folder)->info();
    EXPECT_EQ(info.depth_unit_m, unit_m);
    EXPECT_NE(info.depth_unit_source.find("intrinsic.json depth_scale"), std::string::npos);
  }
}

TEST(Folder, IntrinsicsOfSevenNumbersIncludeUnitAndImageSize) {
  const fs::path folder = sample_folder();
  write_text(folder / "intrinsics.txt", "10 11 6 4 0.0002 12 8\n");
  const RecordingInfo info = open_recording(folder)->info();
  EXPECT_EQ(info.depth_unit_m, 0.0002);
  EXPECT_EQ(info.depth_unit_source, "intrinsics.txt");
  write_text(folder / "intrinsics.txt", "10 11 6 4 0.0002 640 480\n");
  expect_refused(folder, {"12x8", "intrinsics.txt", "640x480"});
}

TEST(Folder, OptionsOverrideFiles) {
  const fs::path folder = sample_folder();
  write_text(folder / "intrinsic.json",
             R"({"intrinsic_matrix": [10,0,0,0,11,0,6,4,1], "depth_scale": 1000})");
  RecordingOptions options = with_intrinsics(20, 21, 5, 3);
  options.depth_unit_m = 0.0005;
  const RecordingInfo info = open_recording(folder, options)->info();
  EXPECT_EQ(info.intrinsics.fy, 21);
  EXPECT_EQ(info.intrinsics_source, "option --intrinsics");
  EXPECT_EQ(info.depth_unit_m, 0.0005);
}

TEST(Folder, ColorWithItsOwnIntrinsicsIsNotAligned) {
  const fs::path folder = sample_folder();
  write_text(folder / "color_intrinsics.json", R"({"fx": 20, "fy": 20, "cx": 6, "cy": 4})");
  write_text(folder / "depth_intrinsics.json", R"({"fx": 10, "fy": 11, "cx": 6, "cy": 4})");
  const auto recording = open_recording(folder);
  EXPECT_EQ(recording->info().intrinsics.fx, 10);
  EXPECT_FALSE(recording->frame(0).color_aligned);
  EXPECT_FALSE(recording->frame(0).color.empty());
}

TEST(Folder, ColorOfAnotherSizeIsOnlyDisplayed) {
  const fs::path folder = temp_folder();
  write_depth(folder / "0000_depth.png", 1000);
  write_color(folder / "0000_color.png", 7, 48, 27);
  const auto recording = open_known(folder);
  const Frame frame = recording->frame(0);
  EXPECT_EQ(frame.color.width, 48);
  EXPECT_FALSE(frame.color_aligned);
  EXPECT_EQ(frame.color_intrinsics.fx, 0);
  EXPECT_NE(recording->info().color_note.find("48x27"), std::string::npos);
}

TEST(Folder, FlatFoldersPairNamesAndIgnoreOtherPictures) {
  const fs::path folder = temp_folder();
  for (const int i : {0, 1}) {
    const std::string number = std::to_string(i);
    write_depth(folder / ("depth_" + number + ".png"), static_cast<std::uint16_t>(500 + i));
    write_color(folder / ("rgb_" + number + ".png"), static_cast<std::uint8_t>(40 + i));
  }
  write_color(folder / "result.png", 1);
  write_depth(folder / "labels.png", 3);
  const auto recording = open_known(folder);
  ASSERT_EQ(recording->frame_count(), 2);
  EXPECT_EQ(recording->frame(1).depth.at(0, 0), 501);
  EXPECT_EQ(recording->frame(1).color.at(0, 0, 0), 41);
}

TEST(Folder, ColorIsPairedByTheTimesInItsNames) {
  const fs::path folder = temp_folder();
  for (const char* name : {"1305031102.160", "1305031102.194", "1305031102.226"}) {
    write_depth(folder / "depth" / (std::string(name) + ".png"), 5000, 640, 480);
  }
  write_color(folder / "rgb" / "1305031102.158.png", 1, 640, 480);
  write_color(folder / "rgb" / "1305031102.232.png", 2, 640, 480);
  write_text(folder / "depth.txt", "# depth maps\n");
  write_text(folder / "rgb.txt", "# color images\n");
  const auto recording = open_recording(folder);
  EXPECT_EQ(recording->info().depth_unit_m, 0.0002);
  EXPECT_EQ(recording->info().intrinsics.fx, 525);
  EXPECT_EQ(recording->info().intrinsics_source, "assumed (TUM RGB-D default)");
  EXPECT_NEAR(recording->frame(1).timestamp_s, 1305031102.194, 1e-6);
  EXPECT_EQ(recording->frame(0).color.at(0, 0, 0), 1);
  EXPECT_EQ(recording->frame(1).color.at(0, 0, 0), 1);
  EXPECT_EQ(recording->frame(2).color.at(0, 0, 0), 2);
}

TEST(Folder, TimesInNamesAreConvertedToSeconds) {
  EXPECT_NEAR(*timestamp_in_name("0003_1580908153638.png"), 1580908153.638, 1e-6);
  EXPECT_NEAR(*timestamp_in_name("1305031102.160.png"), 1305031102.160, 1e-6);
  EXPECT_NEAR(*timestamp_in_name("1580908153638000000.png"), 1580908153.638, 1e-3);
  EXPECT_NEAR(*timestamp_in_name("1305031239.543802.png"), 1305031239.543802, 1e-6);
  EXPECT_FALSE(timestamp_in_name("000123.png"));
  EXPECT_FALSE(timestamp_in_name("0000000012.png"));
  EXPECT_FALSE(timestamp_in_name("depth.png"));
}

/// Times of the three frames, and their source.
std::string times_in(const fs::path& folder) {
  const auto recording = open_known(folder);
  std::string text = recording->info().times_source + ":";
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(recording->timestamp_s(i), recording->frame(i).timestamp_s);
    text += fmt::format(" {}", recording->timestamp_s(i));
  }
  return text;
}

TEST(Folder, ListsOfImagesGiveFramesTheirTimes) {
  const std::pair<const char*, const char*> lists[] = {
      {"depth.txt",
       "\xEF\xBB\xBF# depth maps\r\n# timestamp filename\r\n-5 depth/1.png\r\n"
       "7 depth/10.png\r\n6.5\tdepth/2.png\r\n8 depth/11.png\r\n"},
      {"associations.txt",
       "1 color/1.png -5 depth/1.png\n2 color/2.png 6.5 depth/2.png\n3 color/10.png 7 "
       "depth/10.png\n"},
      {"associations.txt",
       "-5 depth/1.png 1 color/1.png\n6.5 depth/2.png 2 color/2.png\n7 depth/10.png 3 "
       "color/10.png\n"},
      {"rgb.txt", "-5 color/1.png\n6.5 color/2.png\n7 10.png\n"}};
  for (const auto& [name, text] : lists) {
    SCOPED_TRACE(name);
    const fs::path folder = sample_folder();
    write_text(folder / name, text);
    EXPECT_EQ(times_in(folder), std::string(name) + ": -5 6.5 7");
    EXPECT_EQ(open_known(folder / "depth" / "2.png")->timestamp_s(0), 6.5);
  }
  const fs::path folder = sample_folder();
  EXPECT_EQ(times_in(folder), ": 0 0 0");
  write_text(folder / "depth.txt", "this is no list\n");
  EXPECT_EQ(times_in(folder), ": 0 0 0");
}

TEST(Folder, ADamagedListOfImagesIsReportedWithItsLine) {
  const std::pair<const char*, const char*> cases[] = {
      {"1 depth/1.png\nstep depth/2.png\n", "line 2: 'step' is not a number"},
      {"1 depth/1.png\n2 depth/2.png 3\n", "line 2: 3 words"},
      {"1 depth/1.png\n2 depth/1.png\n", "line 2: depth/1.png is listed with a different time"}};
  for (const auto& [text, part] : cases) {
    const fs::path folder = sample_folder();
    write_text(folder / "depth.txt", text);
    expect_refused(folder, kKnown, {"depth.txt", part});
  }
  const fs::path folder = sample_folder();
  write_text(folder / "depth.txt", "1 depth/1.png\n");
  const auto some = open_known(folder);
  ASSERT_EQ(some->info().warnings.size(), 1u);
  expect_one_line_with(some->info().warnings[0], {"2 of 3 depth images have no time in depth.txt"});
  fs::remove(folder / "depth.txt");
  write_text(folder / "associations.txt", "1 1.png 2 1.png\n");
  const auto ambiguous = open_known(folder);
  EXPECT_EQ(ambiguous->info().times_source, "");
  ASSERT_EQ(ambiguous->info().warnings.size(), 1u);
  expect_one_line_with(ambiguous->info().warnings[0], {"associations.txt: ignored"});
}

TEST(Folder, PosesForEveryFrameProvideOnlyTheirTimes) {
  const fs::path folder = sample_folder();
  write_text(folder / "poses.tum", "1 0 0 0 0 0 0 1\n# a\n3 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 1\n");
  EXPECT_EQ(times_in(folder), "poses.tum: 1 3 2");
  EXPECT_EQ(times_in(folder / "depth"), "poses.tum: 1 3 2");
  EXPECT_FALSE(open_known(folder)->T_world_camera(0));
  EXPECT_EQ(open_known(folder / "depth" / "10.png")->timestamp_s(0), 2);
  write_text(folder / "depth.txt", "5 depth/1.png\n6 depth/2.png\n7 depth/10.png\n");
  EXPECT_EQ(times_in(folder), "depth.txt: 5 6 7");
  write_text(folder / "planescope.json", R"({"frames": [{"name": "2", "timestamp_s": 9}]})");
  EXPECT_EQ(times_in(folder), "planescope.json: 5 9 7");
  fs::remove(folder / "planescope.json");
  fs::remove(folder / "depth.txt");
  write_text(folder / "poses.tum", "1 0 0 0 0 0 0 1\n");
  const auto other = open_known(folder);
  EXPECT_EQ(other->info().times_source, "");
  ASSERT_EQ(other->info().warnings.size(), 1u);
  expect_one_line_with(other->info().warnings[0], {"poses.tum: 1 pose for 3 frames"});
  write_text(folder / "poses.tum", "1 0 0 0 0 0 0 1\n2 0 0 NaN 0 0 0 1\n3 0 0 0 0 0 0 1\n");
  expect_refused(folder, kKnown, {"poses.tum, line 2: 'NaN' is not a number"});
}

TEST(Folder, TheKinectsAccelerometerProvidesGravityOfFramesWithTimes) {
  const fs::path folder = sample_folder();
  // The frames at 5 s and 6 s use the mean of a shaking sensor; that of 9 s shakes too much.
  write_text(folder / "accelerometer.txt",
             "# timestamp ax ay az\n6.0 0.2 9.8 -3\n4.9 0.5 9 -3\n5.1 -0.5 9 -3\n9 0 30 0\n");
  const auto without = open_known(folder);
  EXPECT_FALSE(without->frame(0).gravity);
  ASSERT_EQ(without->info().warnings.size(), 1u);
  expect_one_line_with(without->info().warnings[0], {"accelerometer.txt: ignored", "no times"});
  write_text(folder / "depth.txt", "5 depth/1.png\n6 depth/2.png\n9 depth/10.png\n");
  const auto timed = open_known(folder);
  const std::optional<Gravity> gravity = timed->frame(0).gravity;
  ASSERT_TRUE(gravity);
  EXPECT_EQ(gravity->source, GravitySource::imu);
  EXPECT_TRUE(gravity->direction.isApprox(Vec3d(0, 9, 3).normalized(), 1e-12));
  EXPECT_NE(gravity->note.find("accelerometer.txt"), std::string::npos) << gravity->note;
  EXPECT_TRUE(timed->frame(1).gravity);
  EXPECT_FALSE(timed->frame(2).gravity);
  write_text(folder / "depth.txt", "105 depth/1.png\n106 depth/2.png\n109 depth/10.png\n");
  expect_one_line_with(open_known(folder)->info().warnings.at(0), {"no sample is within 0.2 s"});
  write_text(folder / "accelerometer.txt", "5 0 9.8 0\n5.1 0 inf 0\n");
  expect_refused(folder, kKnown, {"accelerometer.txt, line 2: 'inf' is not a number"});
}

TEST(Folder, MissingColorImagesAreCounted) {
  const fs::path folder = sample_folder();
  fs::remove(folder / "color" / "2.png");
  const auto recording = open_known(folder);
  ASSERT_EQ(recording->info().warnings.size(), 1u);
  expect_one_line_with(recording->info().warnings[0], {"1 of 3 depth images have no color"});
  EXPECT_TRUE(recording->frame(1).color.empty());
  EXPECT_FALSE(recording->frame(2).color.empty());
}

TEST(Folder, TheSidecarContainsTheSampleWritersData) {
  const fs::path folder = sample_folder();
  write_text(folder / "planescope.json", R"({
    "schema": "planescope.recording/1",
    "intrinsics": {"width": 12, "height": 8, "fx": 10, "fy": 11, "cx": 6, "cy": 4,
                   "distortion": [0.1, 0, 0, 0, 0]},
    "depth_unit_m": 0.0005, "gravity": [0, 2, 0], "color_aligned": true,
    "frames": [{"name": "1", "timestamp_s": 1.5},
               {"name": "2", "timestamp_s": 2.5, "gravity": [0, 0, 1]}]})");
  const auto recording = open_recording(folder);
  EXPECT_EQ(recording->info().depth_unit_m, 0.0005);
  EXPECT_EQ(recording->info().depth_unit_source, "planescope.json");
  EXPECT_EQ(recording->info().intrinsics.distortion, Distortion::brown_conrady);
  EXPECT_EQ(recording->info().color_note, "aligned");
  const Frame first = recording->frame(0);
  EXPECT_EQ(first.timestamp_s, 1.5);
  ASSERT_TRUE(first.gravity);
  EXPECT_EQ(first.gravity->source, GravitySource::sidecar);
  EXPECT_EQ(first.gravity->direction, Vec3d(0, 1, 0));
  EXPECT_EQ(recording->frame(1).gravity->direction, Vec3d(0, 0, 1));
  EXPECT_EQ(recording->frame(2).gravity->direction, Vec3d(0, 1, 0));
}

TEST(Folder, AUnitVectorOfGravityIsReadExactly) {
  const fs::path folder = sample_folder();
  for (int i = 1; i < 60; ++i) {
    const Vec3d unit = Vec3d(std::sin(i), 1 + std::cos(3 * i), 0.1 * i).normalized();
    char text[200];
    std::snprintf(text, sizeof text, R"({"gravity": [%.17g, %.17g, %.17g]})", unit.x(), unit.y(),
                  unit.z());
    write_text(folder / "gravity.json", text);
    const auto recording = open_known(folder);
    EXPECT_EQ(recording->frame(0).gravity->direction, unit) << text;
  }
}

TEST(Folder, GravityMayBeOfAnyLength) {
  for (const char* text : {"{\"gravity\": [3e300, 4e300, 0]}", "{\"gravity\": [3e-6, 4e-6, 0]}"}) {
    const fs::path folder = sample_folder();
    write_text(folder / "gravity.json", text);
    const auto recording = open_known(folder);
    EXPECT_LT((recording->frame(0).gravity->direction - Vec3d(0.6, 0.8, 0)).norm(), 1e-12) << text;
  }
}

TEST(Folder, ADamagedSidecarIsReportedWithItsKey) {
  const std::pair<const char*, const char*> cases[] = {
      {"{\"gravity\": [0, 0, 0]}", "gravity"},
      {"{\"gravity\": [1, 2]}", "gravity"},
      {"{\"gravity\": \"down\"}", "gravity"},
      {"{\"depth_unit_m\": -1}", "depth_unit_m"},
      {"{\"intrinsics\": {\"fx\": 1}}", "\"fy\""},
      {"{\"intrinsics\": 3}", "intrinsics is 3"},
      {"{\"intrinsics\": {\"width\": 1e300}}", "width"},
      {"{\"intrinsics\": {\"height\": 8.5}}", "height"},
      {"{\"schema\": \"other/2\"}", "schema"},
      {"{\"frames\": [3]}", "frames"},
      {"{\"color_aligned\": 1}", "color_aligned"},
      {"[1, 2]", "object"},
      {"{\"gravity\"", "JSON"}};
  for (const auto& [text, part] : cases) {
    const fs::path folder = sample_folder();
    write_text(folder / "planescope.json", text);
    expect_refused(folder, kKnown, {"planescope.json", part});
  }
}

TEST(Folder, PicturesOfDepthAreDamagedFrames) {
  const fs::path eight = sample_folder();
  write_png(eight / "depth" / "2.png", Image8(kW, kH));
  expect_damaged(eight, {"2.png", "8-bit PNG with 1 channel", "16-bit"});
  const fs::path three = sample_folder();
  write_color(three / "depth" / "10.png", 1);
  expect_damaged(three, {"10.png", "8-bit PNG with 3 channels"});
}

TEST(Folder, InconsistentSizesAreRejected) {
  const fs::path folder = sample_folder();
  write_text(folder / "camera_intrinsic.json",
             R"({"width": 640, "height": 480, "intrinsic_matrix": [10,0,0,0,11,0,6,4,1]})");
  expect_refused(folder, {"12x8", "640x480", "camera_intrinsic.json"});
  const fs::path mixed = sample_folder();
  write_depth(mixed / "depth" / "2.png", 5, 14, 8);
  expect_damaged(mixed, {"2.png", "14x8", "12x8"});
}

TEST(Folder, ADamagedFrameIsKnownOnOpeningAndTheOthersKeepTheirNumbers) {
  const auto spoil = [](const fs::path& file, const std::string& how) {
    if (how == "truncated") return fs::resize_file(file, fs::file_size(file) / 2);
    fs::remove(file);
    if (how == "a link to a missing file") fs::create_symlink("nowhere.png", file);
    if (how == "a folder") fs::create_directory(file);
    if (how == "a pipe or device") mkfifo(file.c_str(), 0600);
  };
  const auto whole = open_recording(sample_folder(), kKnown);
  for (const auto& [name, how] : {std::pair("depth/2.png", "truncated"),
                                  {"color/10.png", "truncated"},
                                  {"depth/2.png", "a link to a missing file"},
                                  {"depth/2.png", "a folder"},
                                  {"depth/2.png", "a pipe or device"}}) {
    const fs::path folder = sample_folder();
    spoil(folder / name, how);
    const auto recording = open_recording(folder, kKnown);
    ASSERT_EQ(recording->frame_count(), whole->frame_count()) << how;
    ASSERT_EQ(recording->info().damaged.size(), 1u) << how;
    const auto [damaged, why] = *recording->info().damaged.begin();
    expect_one_line_with(message_of([&, i = damaged] { recording->frame(i); }),
                         {fs::path(name).filename().c_str(), how});
    for (int i = 0; i < recording->frame_count(); ++i)
      EXPECT_TRUE(i == damaged || recording->frame_hash(i) == whole->frame_hash(i)) << how;
  }
}

TEST(Folder, WithoutNamesADamagedPngKeepsItsPlaceAmongTheOthers) {
  const fs::path folder = temp_folder();
  for (const char* name : {"000.png", "001.png", "002.png"}) write_depth(folder / name, 5, 12, 8);
  write_text(folder / "001.png", "");
  const auto recording = open_recording(folder, kKnown);
  EXPECT_EQ(recording->frame_count(), 3);
  EXPECT_TRUE(recording->info().damaged.contains(1));
  EXPECT_EQ(recording->frame(2).name, "002");
}

TEST(Folder, UnusableIntrinsicsAreRejected) {
  expect_one_line_with(
      message_of([&] { open_recording(sample_folder(), with_intrinsics(0, 10, 6, 4)); }), {"fx 0"});
  const fs::path folder = sample_folder();
  for (const char* matrix : {"[10, 0, 0]", "3", R"({"a": 10, "b": [0, 0, 0, 11, 0, 6, 4, 1]})"}) {
    write_text(folder / "intrinsic.json", "{\"intrinsic_matrix\": " + std::string(matrix) + "}");
    expect_refused(folder, {"intrinsic.json", "expected 9"});
  }
  write_text(folder / "intrinsic.json", "{\"intrinsic_matrix\": [10,");
  expect_refused(folder, {"intrinsic.json", "JSON"});
}

TEST(Folder, ASingleDepthImageOpensWithIntrinsicsAndColor) {
  const fs::path folder = sample_folder();
  const auto recording = open_recording(folder / "depth" / "10.png", with_intrinsics(9, 9, 6, 4));
  ASSERT_EQ(recording->frame_count(), 1);
  EXPECT_EQ(recording->frame(0).depth.at(0, 0), 1010);
  EXPECT_EQ(recording->frame(0).color.at(0, 0, 0), 10);
  expect_refused(folder / "depth" / "10.png", {"10.png", "--intrinsics"});
}

TEST(Folder, HashesAreOfTheCounts) {
  const fs::path folder = temp_folder();
  write_depth(folder / "depth" / "a.png", 0x0201, 2, 1);
  const auto recording = open_recording(folder, with_intrinsics(9, 9, 1, 0));
  // SHA-256 of the bytes 01 02 01 02.
  EXPECT_EQ(recording->frame_hash(0),
            "30ace33963fd17c4816fce834fd7f47ea5ffb8235734f58e2ed78422bb24436f");
}

TEST(Open, OtherFilesAreRejectedInOneLineWithTheirKind) {
  const fs::path folder = temp_folder();
  expect_refused(folder / "nothing", {"nothing", "no such file or folder"});
  expect_refused(folder,
                 {folder.c_str(), "no files", "expected a RealSense or ROS .bag, .db3, or .mcap"});
  write_text(folder / "notes.txt", "hello");
  write_text(folder / "more.txt", "hello");
  expect_refused(folder, {"2 .txt"});
  expect_refused(folder / "notes.txt", {"notes.txt", "not a supported recording"});
  fs::create_directories(folder / "depth");
  expect_refused(folder, {"no recording"});
}

TEST(ViewerRaw, SizesAreComparedWithTheMetadata) {
  const fs::path folder = temp_folder();
  const std::string csv =
      "Frame Info: \nType,Depth\nFormat,Z16\nFrame Number,531\nTimestamp (ms),1000.5\n"
      "Resolution x,4\nResolution y,2\nBytes per pixel,2\n\nIntrinsic:,\nFx,10\nFy,11\nPPx,2\n"
      "PPy,1\nDistorsion,Brown Conrady\n";
  write_text(folder / "a_metadata.csv", csv);
  write_text(folder / "a.raw", std::string("\x01\x00\x02\x01", 4) + std::string(12, '\0'));
  const auto recording = open_recording(folder);
  const Frame frame = recording->frame(0);
  EXPECT_EQ(frame.depth.at(0, 0), 1);
  EXPECT_EQ(frame.depth.at(1, 0), 0x0102);
  EXPECT_EQ(frame.timestamp_s, 1.0005);
  EXPECT_EQ(recording->info().intrinsics.fy, 11);
  write_text(folder / "a.raw", std::string(15, '\0'));
  expect_refused(folder, {"a.raw", "15 bytes", "4x2"});
  write_text(folder / "a_metadata.csv", "Type,Depth\nFormat,Z16\nResolution x,wide\n");
  expect_refused(folder, {"Resolution x", "wide"});
  fs::remove(folder / "a_metadata.csv");
  expect_refused(folder / "a.raw", {"a.raw", "_metadata.csv"});
}

// ---- Output of other tools ----

void write_dump(const fs::path& path, std::uint16_t count, std::size_t pixels) {
  std::string bytes;
  for (std::size_t i = 0; i < pixels; ++i) {
    bytes += static_cast<char>(count & 255);
    bytes += static_cast<char>(count >> 8);
  }
  write_text(path, bytes);
}

TEST(RsConvert, RawDepthIsReadWithItsColorPictures) {
  const fs::path folder = temp_folder();
  for (const int i : {0, 1, 2}) {
    const auto time_ms = [&](double offset) {
      return fmt::format("{:.14f}", 1.6e12 + 33.3 * i + offset);
    };
    write_dump(folder / ("walk_Depth_" + time_ms(0) + ".raw"), static_cast<std::uint16_t>(900 + i),
               424 * 240);
    // -p writes pictures of depth, which are not depth images.
    write_color(folder / ("walk_Depth_" + time_ms(0) + ".png"), 99, 424, 240);
    write_color(folder / ("walk_Color_" + time_ms(4) + ".png"), static_cast<std::uint8_t>(i), 640,
                480);
    write_text(folder / ("walk_Depth_metadata_" + time_ms(0) + ".txt"), "Stream: Depth\n");
  }
  expect_refused(folder, {"--intrinsics"});
  const auto recording = open_recording(folder, with_intrinsics(212, 212, 211.5, 119.5));
  EXPECT_EQ(recording->info().width, 424);
  EXPECT_EQ(recording->info().times_source, "file names");
  ASSERT_EQ(recording->frame_count(), 3);
  EXPECT_EQ(recording->frame(2).depth.at(423, 239), 902);
  EXPECT_EQ(recording->frame(2).color.at(0, 0, 0), 2);
  EXPECT_NEAR(recording->timestamp_s(1), 1.6e9 + 0.0333, 1e-5);
  const fs::path one = folder / fmt::format("walk_Depth_{:.14f}.raw", 1.6e12 + 33.3);
  const auto single = open_recording(one, with_intrinsics(212, 212, 211.5, 119.5));
  ASSERT_EQ(single->frame_count(), 1);
  EXPECT_EQ(single->frame(0).depth.at(0, 0), 901);
  EXPECT_EQ(single->frame(0).color.at(0, 0, 0), 1);
}

TEST(RsConvert, AnUnusualSizeIsReadFromTheCalibration) {
  const fs::path folder = temp_folder();
  write_dump(folder / "a_Depth_1600000000000.5.raw", 1001, kW * kH);
  expect_refused(folder, kKnown, {"192 bytes", "RealSense depth mode", "calibration"});
  write_text(folder / "intrinsics.txt", "10 11 6 4 0.0002 12 8\n");
  EXPECT_EQ(open_recording(folder)->frame(0).depth.at(11, 7), 1001);
  write_text(folder / "intrinsics.txt", "10 11 6 4 0.0002 12 9\n");
  expect_refused(folder, {"a_Depth_1600000000000.5.raw: 192 bytes", "12x9"});
}

TEST(RsConvert, OnlyPicturesOfDepthAreRejectedWithTheOptionThatWritesDepth) {
  const fs::path folder = temp_folder();
  write_color(folder / "a_Depth_1600000000000.50000000000000.png", 9);
  expect_refused(folder, kKnown, {"colorized depth image contains no distances", "-r"});
}

TEST(Open3dRecorders, AllFoldersAreReadWithCameraAndColor) {
  // azure_kinect_mkv_reader, realsense_recorder, RGBDVideoReader::SaveFrames.
  const std::tuple<const char*, const char*, const char*> recorders[] = {
      {"{:05}", "intrinsic.json",
       R"({"color_mode": "MJPG_720P", "depth_mode": "WFOV_2X2BINNED", "height": 8, "width": 12,
           "intrinsic_matrix": [10.0, 0.0, 0.0, 0.0, 11.0, 0.0, 6.0, 4.0, 1.0],
           "serial_number_": "000123", "stream_length_usec": 4000000})"},
      {"{:06}", "camera_intrinsic.json", kOpen3dJson},
      {"{:05}", "intrinsic.json",
       R"({"class_name": "", "color_channels": 3, "depth_scale": 4000.0, "device_name": "D455",
           "fps": 30.0, "height": 8, "width": 12, "serial_number": "1",
           "intrinsic_matrix": [10.0, 0.0, 0.0, 0.0, 11.0, 0.0, 6.0, 4.0, 1.0]})"}};
  for (const auto& [name, file, json] : recorders) {
    SCOPED_TRACE(json);
    const fs::path folder = temp_folder();
    for (int i = 0; i < 11; ++i) {
      const std::string stem = fmt::format(fmt::runtime(name), i);
      write_depth(folder / "depth" / (stem + ".png"), static_cast<std::uint16_t>(1000 + i));
      fs::create_directories(folder / "color");
      write_file_bytes(folder / "color" / (stem + ".jpg"), encode_jpeg(kW, kH, true));
    }
    write_text(folder / file, json);
    write_text(folder / "config.json",
               R"({"path_dataset": "x", "path_intrinsic": "x/intrinsic.json",
                                           "depth_scale": 1000.0, "max_depth": 3.0})");
    const auto recording = open_recording(folder);
    ASSERT_EQ(recording->frame_count(), 11);
    EXPECT_EQ(recording->info().intrinsics_source, file);
    EXPECT_EQ(recording->info().depth_unit_m,
              std::string(json).find("4000.0,") == std::string::npos ? 0.001 : 0.00025);
    EXPECT_EQ(recording->frame(10).depth.at(0, 0), 1010);
    EXPECT_TRUE(recording->frame(10).color_aligned);
    EXPECT_EQ(recording->frame(10).intrinsics.fy, 11);
  }
}

}  // namespace
}  // namespace planescope::io
