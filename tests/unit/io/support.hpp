#pragma once

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "core/io/recording.hpp"
#include "core/model/file_bytes.hpp"
#include "support/refusal.hpp"
#include "support/temp_dir.hpp"

namespace planescope::io {

/// An empty folder of the test that is running.
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

/// Writes a file anew. Overwriting one that exists makes some file systems wait for the disk, which
/// loops over damaged files would feel.
inline void write_anew(const std::filesystem::path& path, std::span<const unsigned char> bytes) {
  std::filesystem::remove(path);
  write_file_bytes(path, bytes);
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

}  // namespace planescope::io
