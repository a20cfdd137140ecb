#pragma once

// Reads, writes, locks and hashes whole files, and limits the memory for unpacking them.

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

/// Reads a whole file. Throws Error naming the path if it is missing, not a regular file,
/// unreadable, or larger than `max_bytes`.
std::vector<unsigned char> read_file_bytes(const std::filesystem::path& path,
                                           std::uintmax_t max_bytes = std::uintmax_t{1} << 30);

/// Opens a file for reading in pieces. Throws Error naming the path if it is missing, not a regular
/// file (a pipe would block), or unreadable.
std::ifstream open_to_read(const std::filesystem::path& path);

enum class Durable : bool { no, yes };  // `yes`: also survives a loss of power; slower

/// Replaces a file atomically: writes the new content to a temporary file in the same folder,
/// then renames it. At any time, either the old or the new file exists, complete. Links remain
/// links; pipes and devices are written directly. Throws Error naming the path, and then the old
/// file is unchanged.
void write_file_bytes(const std::filesystem::path& path,
                      std::span<const unsigned char> bytes,
                      Durable durable = Durable::no);
void write_file_text(const std::filesystem::path& path,
                     std::string_view text,
                     Durable durable = Durable::no);
/// For content too large for memory; `write` may throw.
void write_file_stream(const std::filesystem::path& path,
                       const std::function<void(std::ostream&)>& write);

/// Exchanges two folders atomically: at any time, `place` contains one of them, complete. If
/// nothing is at `place`, moves the folder there. Both must be on the same file system. Throws
/// Error naming the place, which is then unchanged.
void exchange_folder(const std::filesystem::path& folder, const std::filesystem::path& place);

/// A POSIX file descriptor, closed on destruction.
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

/// Like open(2), but not inherited by other programs. On failure, not open and errno is set.
FileDescriptor open_file(const std::filesystem::path& path, int flags);

/// Writes all bytes at `offset`, repeating the call as needed. Returns 0, or the errno of the call
/// that failed.
int write_fully(const FileDescriptor& file, std::span<const unsigned char> bytes, off_t offset);

/// Reads bytes at `offset`: fewer if the file ends or reading fails. Returns their number.
std::size_t read_fully(const FileDescriptor& file, std::span<unsigned char> bytes, off_t offset);

/// Makes created, replaced and removed names in the folder survive a loss of power. Returns 0 or
/// an errno.
int sync_folder(const std::filesystem::path& folder);

/// A path next to a file or folder: "a/rec/" and ".labels" make "a/rec.labels".
std::filesystem::path path_beside(const std::filesystem::path& path, std::string_view suffix);

/// The first of PREFIX1, PREFIX2, ... that does not exist.
std::filesystem::path unused_path(const std::filesystem::path& prefix);

/// Text for an errno: "No space left on device".
std::string error_text(int error);

/// Memory limit for one unpacked image, chunk or table of a file, because a small file may declare
/// any size. For the whole process; 512 MiB unless set.
std::uint64_t read_limit_bytes();
void set_read_limit_bytes(std::uint64_t bytes);

/// Throws Error "WHAT would need ... MiB of memory; expected at most ..." if above the limit.
void expect_within_read_limit(double bytes, const std::string& what);

/// Lock of the single instance that may write to a folder, in DIR/lock. The lock ends with the
/// process in all cases; the file's text is only for users. Releasing the lock removes the file.
class FolderLock {
 public:
  FolderLock() = default;
  ~FolderLock() { release(); }
  FolderLock(FolderLock&& other) noexcept = default;
  FolderLock& operator=(FolderLock&& other) noexcept;

  /// Creates DIR/lock if needed, but not DIR.
  static FolderLock acquire(const std::filesystem::path& dir, const std::string& user);

  bool is_held() const { return file_.is_open(); }
  bool is_held_by_other() const { return by_other_; }
  /// Reason why it is not held: "held by ann, process 4711 on lab3 since 14:02".
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
