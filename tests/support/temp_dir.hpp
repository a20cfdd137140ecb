#pragma once

// A temporary folder for each test process, removed at exit.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace planescope {

/// A folder for this process only, because tests run in parallel, each in its own process.
inline const std::filesystem::path& temp_dir() {
  struct Folder {
    std::filesystem::path path =
        std::filesystem::path(testing::TempDir()) / ("planescope_" + std::to_string(getpid()));
    Folder() { std::filesystem::create_directories(path); }
    ~Folder() {
      std::error_code ignored;
      std::filesystem::remove_all(path, ignored);
    }
  };
  static const Folder folder;
  return folder.path;
}

}  // namespace planescope
