#pragma once

// Helpers of the reader tests: temporary files, damaged inputs and expected errors.

#include <gtest/gtest.h>

#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "core/io/recording.hpp"
#include "core/model/file_bytes.hpp"
#include "support/refusal.hpp"
#include "support/temp_dir.hpp"

namespace planescope::io {

/// An empty folder for the running test.
inline std::filesystem::path temp_folder() {
  const auto* test = testing::UnitTest::GetInstance()->current_test_info();
  const auto folder = temp_dir() / "planescope_recording" /
                      (std::string(test->test_suite_name()) + "_" + test->name());
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

inline void write_text(const std::filesystem::path& path, const std::string& text) {
  std::filesystem::create_directories(path.parent_path());
  write_file_bytes(path, {reinterpret_cast<const unsigned char*>(text.data()), text.size()});
}

/// Writes a new file. Overwriting an existing file makes some file systems wait for the disk, which
/// slows down loops over damaged files.
inline void write_anew(const std::filesystem::path& path, std::span<const unsigned char> bytes) {
  std::filesystem::remove(path);
  write_file_bytes(path, bytes);
}

/// Reads copies of a file with a few changed bytes, some of them truncated: each is either read or
/// rejected by an Error of one line.
template <typename Read>
void expect_no_harm_by_damage(const std::filesystem::path& path,
                              const std::vector<unsigned char>& good,
                              int trials,
                              const Read& read) {
  std::mt19937 random(5);
  for (int trial = 0; trial < trials; ++trial) {
    auto bytes = good;
    for (unsigned changes = 1 + random() % 4; changes > 0; --changes) {
      const unsigned char values[] = {0,    1,    '9',  '-',  ' ',
                                      '\n', 0x7f, 0x80, 0xff, static_cast<unsigned char>(random())};
      bytes[random() % bytes.size()] = values[random() % std::size(values)];
    }
    if (random() % 4 == 0) bytes.resize(random() % bytes.size());
    write_anew(path, bytes);
    const std::string message = message_of(read);
    EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  }
}

inline RecordingOptions with_intrinsics(double fx, double fy, double cx, double cy) {
  RecordingOptions options;
  options.intrinsics = {fx, fy, cx, cy};
  return options;
}

inline void expect_one_line_with(const std::string& message,
                                 std::initializer_list<const char*> parts) {
  EXPECT_FALSE(message.empty());
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
  for (const char* part : parts) {
    EXPECT_NE(message.find(part), std::string::npos) << "\"" << part << "\" is not in: " << message;
  }
}

inline void expect_refused(const std::filesystem::path& path,
                           const RecordingOptions& options,
                           std::initializer_list<const char*> parts) {
  expect_one_line_with(message_of([&] { open_recording(path, options); }), parts);
}
inline void expect_refused(const std::filesystem::path& path,
                           std::initializer_list<const char*> parts) {
  expect_refused(path, {}, parts);
}

}  // namespace planescope::io
