// Tests of file replacement, folder exchange, hashes and file errors.

#include "core/model/file_bytes.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>

#include <cerrno>
#include <ostream>

#include "core/model/error.hpp"
#include "support/temp_dir.hpp"

namespace planescope {
namespace {

namespace fs = std::filesystem;

fs::path fresh_folder(const std::string& name) {
  const fs::path folder = temp_dir() / ("replace_file_" + name);
  fs::remove_all(folder);
  fs::create_directories(folder);
  return folder;
}

TEST(ReplaceFile, ReplacesTheBytesAndLeavesNoTemporaryFiles) {
  const fs::path folder = fresh_folder("new");
  const std::vector<unsigned char> first = {1, 2, 3}, second = {4};
  write_file_bytes(folder / "a", first);
  EXPECT_EQ(read_file_bytes(folder / "a"), first);
  write_file_bytes(folder / "a", second);
  EXPECT_EQ(read_file_bytes(folder / "a"), second);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

TEST(ReplaceFile, KeepsTheOldFileIfItCannotReplaceIt) {
  const fs::path folder = fresh_folder("blocked");
  fs::create_directories(folder / "a" / "in the way");
  try {
    write_file_bytes(folder / "a", std::vector<unsigned char>{1});
    FAIL() << "a folder was replaced by a file";
  } catch (const Error& error) {
    EXPECT_NE(std::string(error.what()).find((folder / "a").string()), std::string::npos);
  }
  EXPECT_TRUE(fs::exists(folder / "a" / "in the way"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

TEST(ReplaceFile, ThatFailsHalfwayKeepsTheOldFile) {
  const fs::path folder = fresh_folder("halfway");
  write_file_text(folder / "a", "old");
  EXPECT_THROW(write_file_stream(folder / "a",
                                 [](std::ostream& out) {
                                   out << "ne" << std::flush;
                                   throw Error("no more");
                                 }),
               Error);
  EXPECT_EQ(read_file_bytes(folder / "a").size(), 3u);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 1);
}

TEST(ReplaceFile, FollowsALinkAndKeepsPermissions) {
  const fs::path folder = fresh_folder("link");
  write_file_text(folder / "a", "old");
  fs::permissions(folder / "a", fs::perms::owner_read | fs::perms::owner_write);
  fs::create_symlink("a", folder / "b");
  write_file_text(folder / "b", "newer");
  EXPECT_TRUE(fs::is_symlink(folder / "b"));
  EXPECT_EQ(fs::file_size(folder / "a"), 5u);
  EXPECT_EQ(fs::status(folder / "a").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST(ReplaceFile, WritesDirectlyToADevice) {
  write_file_text("/dev/null", "gone");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  if (!fs::exists("/dev/full")) GTEST_SKIP() << "no /dev/full here";
  try {
    write_file_text("/dev/full", "no room");
    FAIL() << "a full device took it";
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "/dev/full: cannot be written (No space left on device)");
  }
}

TEST(ExchangeFolder, SwapsTheOldAndNewFolders) {
  const fs::path folder = fresh_folder("exchange");
  for (const char* name : {"new", "old"}) {
    fs::create_directories(folder / name);
    write_file_text(folder / name / name, name);
  }
  exchange_folder(folder / "new", folder / "old");
  EXPECT_TRUE(fs::exists(folder / "old" / "new"));
  EXPECT_TRUE(fs::exists(folder / "new" / "old"));
  exchange_folder(folder / "old", folder / "third");
  EXPECT_TRUE(fs::exists(folder / "third" / "new"));
  EXPECT_FALSE(fs::exists(folder / "old"));
  EXPECT_THROW(exchange_folder(folder / "none", folder / "third"), Error);
  EXPECT_TRUE(fs::exists(folder / "third" / "new")) << "what was there stays";
}

TEST(Sha256, AnUnreadableFileHasNoHash) {
  // Nothing is mapped at its start: reading there is an I/O error.
  if (!fs::is_regular_file("/proc/self/mem")) GTEST_SKIP() << "no /proc here";
  EXPECT_THROW(sha256_hex_of_file("/proc/self/mem"), Error);
}

TEST(FileDescriptors, AMissingFolderAndAFullDeviceAreReportedByErrno) {
  EXPECT_EQ(sync_folder("/nonexistent/folder"), ENOENT);
  const FileDescriptor full = open_file("/dev/full", O_WRONLY);
  if (!full.is_open()) GTEST_SKIP() << "no /dev/full here";
  EXPECT_EQ(write_fully(full, std::vector<unsigned char>{1, 2}, 0), ENOSPC);
  EXPECT_EQ(error_text(ENOSPC), "No space left on device");
}

}  // namespace
}  // namespace planescope
