// Tests of PLY and PCD files, and of recordings made of clouds.

#include "core/io/cloud_files/cloud_file.hpp"

#include <algorithm>
#include <cstring>

#include "unit/io/support.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

template <typename T>
std::string raw(T value, bool big_endian = false) {
  std::string text(sizeof(T), '\0');
  std::memcpy(text.data(), &value, sizeof(T));
  if (big_endian) std::reverse(text.begin(), text.end());
  return text;
}

PointSet read_text(const std::string& name, const std::string& text) {
  const fs::path path = temp_folder() / name;
  write_text(path, text);
  return read_cloud_file(path);
}

std::string error_of_reading(const std::string& name, const std::string& text) {
  const fs::path path = temp_folder() / name;
  write_text(path, text);
  const std::string opened = message_of([&] { open_recording(path); });
  const std::string read = message_of([&] { read_cloud_file(path); });
  // Errors in the header are reported on opening.
  return opened.empty() ? read : opened;
}

TEST(Ply, WrittenCloudsAreReadBack) {
  PointSet set;
  set.points = {{1, 2, 3}, {0, 0, 0}, {NAN, 1, 2}, {-4, 5.5f, -6}};
  set.rgb = {1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 255};
  set.label = {0, 1, 2, 1};
  set.instance = {0, 1, 70000, -1};
  const fs::path path = temp_folder() / "cloud.ply";
  write_ply(path, set);
  const PointSet back = read_cloud_file(path);
  ASSERT_EQ(back.points.size(), 4u);
  EXPECT_EQ(back.points[3], set.points[3]);
  EXPECT_TRUE(std::isnan(back.points[2].x()));
  EXPECT_EQ(back.points[1], Vec3f(0, 0, 0));
  EXPECT_EQ(back.rgb, set.rgb);
  EXPECT_EQ(back.label, set.label);
  EXPECT_EQ(back.instance, set.instance);
  EXPECT_TRUE(back.origin.isZero());
}

TEST(Ply, CoordinatesFarFromZeroKeepTheirMillimeters) {
  PointSet set;
  set.origin = Vec3d(4'500'000, -300'000, 120);
  set.points = {{0.001f, 0.002f, 0.003f}, {-1, 1, 0.5f}};
  const fs::path path = temp_folder() / "far.ply";
  write_ply(path, set);
  const PointSet back = read_cloud_file(path);
  for (std::size_t i = 0; i < 2; ++i) {
    const Vec3d expected = set.origin + set.points[i].cast<double>();
    EXPECT_NEAR((back.origin + back.points[i].cast<double>() - expected).norm(), 0, 1e-6);
  }
  EXPECT_GT(back.origin.norm(), 1e6);
}

TEST(Ply, LabelsOfEveryIntegerTypeAreKeptInEveryFormat) {
  for (const char* type : {"char", "uchar", "short", "ushort", "int", "uint", "int16", "uint32"}) {
    SCOPED_TRACE(type);
    const std::string header = std::string(
                                   "element vertex 2\nproperty double x\nproperty float y\n"
                                   "property float z\nproperty ") +
                               type + " label\nproperty " + type + " instance\nend_header\n";
    const std::string name = type;
    const auto number = [&](int value, bool big_endian) {
      if (name.find("char") != std::string::npos)
        return raw<std::int8_t>(static_cast<std::int8_t>(value));
      if (name.find("short") != std::string::npos || name == "int16") {
        return raw<std::int16_t>(static_cast<std::int16_t>(value), big_endian);
      }
      return raw<std::int32_t>(value, big_endian);
    };
    std::vector<PointSet> sets;
    sets.push_back(
        read_text("a.ply", "ply\nformat ascii 1.0\n" + header + "1 2 3 2 17\n4 5 6 1 99\n"));
    for (const bool big_endian : {false, true}) {
      std::string body;
      for (const auto& [x, label, instance] : {std::tuple(1, 2, 17), std::tuple(4, 1, 99)}) {
        body += raw<double>(x, big_endian) + raw<float>(static_cast<float>(x + 1), big_endian) +
                raw<float>(static_cast<float>(x + 2), big_endian) + number(label, big_endian) +
                number(instance, big_endian);
      }
      sets.push_back(read_text("b.ply", std::string("ply\nformat binary_") +
                                            (big_endian ? "big" : "little") +
                                            "_endian 1.0\ncomment made by hand\n" + header + body));
    }
    for (const PointSet& set : sets) {
      ASSERT_EQ(set.points.size(), 2u);
      EXPECT_EQ(set.points[1], Vec3f(4, 5, 6));
      EXPECT_EQ(set.label, (std::vector<std::uint8_t>{2, 1}));
      EXPECT_EQ(set.instance, (std::vector<std::int32_t>{17, 99}));
    }
  }
}

TEST(Ply, OtherElementsAndListsAreSkipped) {
  const PointSet set =
      read_text("mesh.ply",
                "ply\r\nformat ascii 1.0\r\nelement camera 1\r\n"
                "property list uchar float pose\r\nelement vertex 2\r\n"
                "property list uchar int near\r\nproperty float x\r\n"
                "property float y\r\nproperty float z\r\nproperty float red\r\n"
                "property float green\r\nproperty float blue\r\n"
                "element face 1\r\nproperty list uchar int vertex_index\r\n"
                "end_header\r\n"
                "3 0.5 0.5 0.5\r\n2 1 0 1 2 3 1 0.5 0\r\n0 4 5 nan 0 0 1\r\n3 0 1 0\r\n");
  ASSERT_EQ(set.points.size(), 2u);
  EXPECT_EQ(set.points[0], Vec3f(1, 2, 3));
  EXPECT_EQ(set.rgb, (std::vector<std::uint8_t>{255, 128, 0, 0, 0, 255}));
}

TEST(Ply, AHeaderThatPromisesMoreThanTheFileHoldsIsRefusedBeforeAllocation) {
  const std::string properties =
      "property float x\nproperty float y\nproperty float z\nend_header\n";
  for (const char* format : {"ascii", "binary_little_endian"}) {
    expect_one_line_with(error_of_reading("huge.ply", std::string("ply\nformat ") + format +
                                                          " 1.0\nelement vertex 999999999999\n" +
                                                          properties + "1 2 3\n"),
                         {"huge.ply", "declares 999999999999", "6 bytes follow"});
  }
  expect_one_line_with(error_of_reading("none.ply",
                                        "ply\nformat ascii 1.0\nelement odd 18446744073709551615\n"
                                        "element vertex 1\n" +
                                            properties + "1 2 3\n"),
                       {"none.ply", "odd"});
}

TEST(Ply, ATruncatedTextReportsHowFarItWasRead) {
  expect_one_line_with(
      error_of_reading("short.ply",
                       "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                       "y\nproperty float z\nend_header\n1.25 2.25 3.25\n4.25 5.25 6.25\n7.25"),
      {"short.ply", "2 of the 3 points"});
}

TEST(Ply, DamagedHeadersAreNamed) {
  const std::pair<const char*, const char*> cases[] = {
      {"", "header"},
      {"plyx\n", "\"ply\""},
      {"ply\nformat ascii 1.0\n", "not terminated"},
      {"ply\nformat morse 1.0\nend_header\n", "morse"},
      {"ply\nformat ascii 1.0\nelement vertex -3\nend_header\n", "-3"},
      {"ply\nformat ascii 1.0\nelement face 1\nproperty int a\nend_header\n1\n", "vertex"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty blob x\nend_header\n1\n", "blob"},
      {"ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
       "x, y, and z"}};
  for (const auto& [text, part] : cases) {
    expect_one_line_with(error_of_reading("bad.ply", text), {"bad.ply", part});
  }
}

std::string pcd_header(const std::string& fields,
                       const std::string& sizes,
                       const std::string& types,
                       const std::string& counts,
                       std::size_t points,
                       const std::string& data) {
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS " + fields + "\nSIZE " + sizes + "\nTYPE " + types +
         "\nCOUNT " + counts + "\nWIDTH " + std::to_string(points) +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + std::to_string(points) + "\nDATA " +
         data + "\n";
}

/// LZF with literals only, and a match for a run of equal bytes.
std::string lzf(const std::string& text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    std::size_t run = 1;
    while (at + run < text.size() && text[at + run] == text[at] && run < 9) ++run;
    out += '\0';
    out += text[at];
    if (run > 3) {
      out += static_cast<char>((run - 3) << 5);  // run - 1 more bytes from one byte back
      out += '\0';
      at += run;
    } else {
      ++at;
    }
  }
  return out;
}

TEST(Pcd, EveryKindOfDataGivesTheSamePoints) {
  const std::string fields = "x y z rgb label instance";
  const std::string sizes = "4 4 4 4 1 2";
  const std::string types = "F F F F U I";
  const std::string counts = "1 1 1 1 1 1";
  std::string rows;
  std::vector<std::string> columns(6);
  for (int i = 0; i < 3; ++i) {
    const std::string values[] = {raw(static_cast<float>(i)),
                                  raw(2.0f),
                                  raw(-1.5f),
                                  raw(std::uint32_t{0xff0a141e}),  // NaN as a float
                                  raw(std::uint8_t(i)),
                                  raw(std::int16_t(300 + i))};
    for (int f = 0; f < 6; ++f) {
      rows += values[f];
      columns[f] += values[f];
    }
  }
  std::string by_field;
  for (const std::string& column : columns) by_field += column;
  const std::string packed = lzf(by_field);
  const PointSet sets[] = {
      read_text("b.pcd", pcd_header(fields, sizes, types, counts, 3, "binary") + rows),
      read_text("c.pcd", pcd_header(fields, sizes, types, counts, 3, "binary_compressed") +
                             raw(static_cast<std::uint32_t>(packed.size())) +
                             raw(static_cast<std::uint32_t>(by_field.size())) + packed),
      read_text("a.pcd",
                pcd_header(fields, sizes, "F F F U U I", counts, 3, "ascii") +
                    "0 2 -1.5 4278850590 0 300\n1 2 -1.5 4278850590 1 301\n2 2 -1.5 4278850590 2 "
                    "302\n")};
  for (const PointSet& set : sets) {
    ASSERT_EQ(set.points.size(), 3u);
    EXPECT_EQ(set.points[2], Vec3f(2, 2, -1.5f));
    EXPECT_EQ(set.rgb, (std::vector<std::uint8_t>{10, 20, 30, 10, 20, 30, 10, 20, 30}));
    EXPECT_EQ(set.label, (std::vector<std::uint8_t>{0, 1, 2}));
    EXPECT_EQ(set.instance, (std::vector<std::int32_t>{300, 301, 302}));
  }
}

TEST(Pcd, PaddingFieldsAreSkipped) {
  std::string body;
  for (int i = 0; i < 2; ++i) {
    body += std::string(3, '\x7f') + raw(1.0) + raw(2.0) + raw(double(i)) + std::string(8, '\x7f');
  }
  const PointSet set =
      read_text("padded.pcd",
                pcd_header("_ x y z _", "1 8 8 8 4", "U F F F F", "3 1 1 1 2", 2, "binary") + body);
  EXPECT_EQ(set.points[1], Vec3f(1, 2, 1));
}

TEST(Pcd, AHeaderThatPromisesMoreThanTheFileHoldsIsRefusedBeforeAllocation) {
  for (const char* data : {"ascii", "binary"}) {
    expect_one_line_with(error_of_reading("huge.pcd", pcd_header("x y z", "4 4 4", "F F F", "1 1 1",
                                                                 4'000'000'000, data) +
                                                          "1 2 3\n"),
                         {"huge.pcd", "declares 4000000000 points", "6 bytes follow"});
  }
  // A compressed block that claims to expand to gigabytes.
  expect_one_line_with(
      error_of_reading(
          "huge.pcd",
          pcd_header("x y z", "4 4 4", "F F F", "1 1 1", 300'000'000, "binary_compressed") +
              raw(std::uint32_t{16}) + raw(std::uint32_t{3'600'000'000}) + std::string(16, '\0')),
      {"huge.pcd", "declares 300000000 12-byte points", "is too small"});
}

TEST(Pcd, DamagedHeadersAreNamed) {
  expect_one_line_with(error_of_reading("bad.pcd", "hello\n"), {"bad.pcd", "hello"});
  expect_one_line_with(
      error_of_reading("bad.pcd",
                       pcd_header("x y z", "4 4", "F F F", "1 1 1", 1, "ascii") + "1 2 3\n"),
      {"do not match"});
  expect_one_line_with(
      error_of_reading("bad.pcd",
                       pcd_header("x y z", "4 4 3", "F F F", "1 1 1", 1, "ascii") + "1 2 3\n"),
      {"\"z\""});
  expect_one_line_with(
      error_of_reading("bad.pcd",
                       pcd_header("x y q", "4 4 4", "F F F", "1 1 1", 1, "ascii") + "1 2 3\n"),
      {"x y q", "x, y, and z"});
}

TEST(CloudFiles, AnyChangedByteNeverCrashes) {
  PointSet set;
  for (int i = 0; i < 40; ++i) {
    set.points.emplace_back(i, 2 * i, 1);
    set.label.push_back(static_cast<std::uint8_t>(i % 3));
  }
  const fs::path folder = temp_folder();
  write_ply(folder / "good.ply", set);
  std::vector<std::pair<std::string, std::vector<unsigned char>>> seeds;
  seeds.emplace_back("x.ply", read_file_bytes(folder / "good.ply"));
  const auto add = [&](const std::string& name, const std::string& text) {
    seeds.emplace_back(name, std::vector<unsigned char>(text.begin(), text.end()));
  };
  add("x.ply",
      "ply\nformat ascii 1.0\nelement list 1\nproperty list uchar int a\nelement vertex 2\n"
      "property float x\nproperty float y\nproperty float z\nend_header\n2 1 1\n1 2 3\n4 5 6\n");
  const std::string row = raw(1.0f) + raw(2.0f) + raw(3.0f) + raw(std::uint32_t{77});
  const std::string rows = row + row + row + row;
  const std::string packed = lzf(rows);
  add("x.pcd", pcd_header("x y z rgb", "4 4 4 4", "F F F U", "1 1 1 1", 4, "binary") + rows);
  add("x.pcd", pcd_header("x y z rgb", "4 4 4 4", "F F F U", "1 1 1 1", 4, "binary_compressed") +
                   raw(static_cast<std::uint32_t>(packed.size())) +
                   raw(static_cast<std::uint32_t>(rows.size())) + packed);
  add("x.pcd", pcd_header("x y z", "4 4 4", "F F F", "1 1 1", 2, "ascii") + "1 2 3\n4 5 6\n");
  for (const auto& [name, good] : seeds)
    expect_no_harm_by_damage(folder / name, good, 600, [&] { read_cloud_file(folder / name); });
}

TEST(CloudRecording, AFolderOfCloudsIsARecording) {
  const fs::path folder = temp_folder();
  fs::create_directories(folder / "below");
  PointSet set;
  set.points = {{1, 2, 3}};
  for (const char* name : {"10.ply", "9.ply", "below/1.ply"}) write_ply(folder / name, set);
  const auto recording = open_recording(folder);
  ASSERT_EQ(recording->frame_count(), 3);
  EXPECT_EQ(recording->frame(0).name, "9");
  EXPECT_EQ(recording->frame(1).name, "10");
  EXPECT_EQ(recording->frame(2).name, "below/1");
  EXPECT_TRUE(recording->frame(0).is_cloud());
  EXPECT_EQ(recording->frame_hash(0), recording->frame_hash(1));
}

TEST(CloudRecording, ASidecarGivesGravity) {
  const fs::path folder = temp_folder();
  PointSet set;
  set.points = {{1, 2, 3}};
  write_ply(folder / "a.ply", set);
  write_text(folder / "a.ply.planescope.json", R"({"gravity": [0, -1, 0]})");
  EXPECT_EQ(open_recording(folder / "a.ply")->frame(0).gravity->direction, Vec3d(0, -1, 0));
}

}  // namespace
}  // namespace planescope::io
