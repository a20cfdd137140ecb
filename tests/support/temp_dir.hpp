#pragma once

// A temporary folder for each test process, removed at exit.

#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

namespace planescope {

/// A folder of this process alone: tests run side by side, each a process of its own.
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
