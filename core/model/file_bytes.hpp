#pragma once

// Files: read and written whole, opened, locked, hashed, and how much of one may be unpacked.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace planescope {

/// The whole of a file. Throws Error naming the path when it is missing, no regular file, cannot
/// be read or is larger than `max_bytes` (a guard for files that are read whole).
std::vector<unsigned char> read_file_bytes(const std::filesystem::path& path,
                                           std::uintmax_t max_bytes = std::uintmax_t{1} << 30);

/// For files that are read piece by piece. Throws Error naming the path when it is missing, no
/// regular file (a pipe would be waited for), or cannot be read.
std::ifstream open_to_read(const std::filesystem::path& path);

enum class Durable : bool { no, yes };  // `yes`: survives a loss of power as well; slower

/// Replaces a file: the new content is written to a file beside it, which then takes its name. At
/// any moment, and whatever goes wrong, either the old file or the new one is there, whole. A link
/// stays a link; a pipe or a device is written to directly. Throws Error naming the path; the old
/// file then stays.
void write_file_bytes(const std::filesystem::path& path,
                      std::span<const unsigned char> bytes,
                      Durable durable = Durable::no);
void write_file_text(const std::filesystem::path& path,
                     std::string_view text,
                     Durable durable = Durable::no);
/// For content too large to be held in memory; `write` may throw.
void write_file_stream(const std::filesystem::path& path,
                       const std::function<void(std::ostream&)>& write);

/// Puts a folder in the place of another, which is left where the first one was: at any moment one
/// of the two is there, whole. Where nothing is in its place, it is moved there. Both are on one
/// file system. Throws Error naming the place; what was there then stays.
void exchange_folder(const std::filesystem::path& folder, const std::filesystem::path& place);

/// A POSIX file descriptor that is closed with its owner.
class FileDescriptor {
 public:
  FileDescriptor() = default;
  explicit FileDescriptor(int descriptor) : descriptor_(descriptor) {}
  FileDescriptor(FileDescriptor&& other) noexcept
      : descriptor_(std::exchange(other.descriptor_, -1)) {}
  FileDescriptor& operator=(FileDescriptor&& other) noexcept {
    std::swap(descriptor_, other.descriptor_);
    return *this;
  }
  ~FileDescriptor();

  int get() const { return descriptor_; }
  bool is_open() const { return descriptor_ >= 0; }

 private:
  int descriptor_ = -1;
};

/// As open(2), never inherited by other programs; not open, errno set, where that fails.
FileDescriptor open_file(const std::filesystem::path& path, int flags);

/// All bytes from `offset` on, however many calls that takes. 0, or the errno of the call that
/// failed.
int write_fully(const FileDescriptor& file, std::span<const unsigned char> bytes, off_t offset);

/// Up to all bytes from `offset` on: fewer where the file ends before, or where reading fails.
std::size_t read_fully(const FileDescriptor& file, std::span<unsigned char> bytes, off_t offset);

/// Makes names that were made, replaced or removed in the folder survive a loss of power. 0, or
/// errno.
int sync_folder(const std::filesystem::path& folder);

/// A name beside a file or folder: "a/rec/" and ".labels" make "a/rec.labels".
std::filesystem::path path_beside(const std::filesystem::path& path, std::string_view suffix);

/// The first of PREFIX1, PREFIX2, ... that does not exist.
std::filesystem::path unused_path(const std::filesystem::path& prefix);

/// What an errno says: "No space left on device".
std::string error_text(int error);

/// What one image, chunk or table of a file may take in memory, unpacked: a small file may promise
/// any size. For the whole process; 512 MiB unless set.
std::uint64_t read_limit_bytes();
void set_read_limit_bytes(std::uint64_t bytes);

/// Throws Error "WHAT would take ... MiB in memory, expected at most ..." where it is more.
void expect_within_read_limit(double bytes, const std::string& what);

/// Held by the one instance that may write into a folder, in DIR/lock. The lock ends with the
/// process, however that ends; the file's text is for people only. Releasing the lock removes the
/// file.
class FolderLock {
 public:
  FolderLock() = default;
  ~FolderLock() { release(); }
  FolderLock(FolderLock&& other) noexcept = default;
  FolderLock& operator=(FolderLock&& other) noexcept;

  /// Makes DIR/lock where needed, not DIR.
  static FolderLock take(const std::filesystem::path& dir, const std::string& user);

  bool is_held() const { return file_.is_open(); }
  bool is_held_by_other() const { return by_other_; }
  /// Why it is not held: "held by ann, process 4711 on lab3 since 14:02".
  const std::string& why_not() const { return why_not_; }

 private:
  void release();

  std::filesystem::path path_;
  FileDescriptor file_;
  bool by_other_ = false;
  std::string why_not_;
};

/// SHA-256 as 64 lower-case hex digits.
std::string sha256_hex(std::span<const std::byte> bytes);
std::string sha256_hex(std::string_view text);
/// Throws Error if the file cannot be read.
std::string sha256_hex_of_file(const std::filesystem::path& path);

}  // namespace planescope
