// Append-only journal of label edits: checksums, damage recovery and background sync.

#include "core/labels/store/journal.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <cerrno>
#include <condition_variable>
#include <mutex>
#include <string_view>
#include <thread>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kAnyVersion = "planescope.journal/";
constexpr std::string_view kHeader = "planescope.journal/1\n";
constexpr std::size_t kHead = 8;           // of a record: size and checksum, little-endian
constexpr std::size_t kChunk = 1u << 20u;  // bytes read at a time

void put_32(unsigned char* to, std::uint32_t value) {
  for (int i = 0; i < 4; ++i) to[i] = static_cast<unsigned char>(value >> (8 * i));
}

std::uint32_t get_32(const unsigned char* from) {
  std::uint32_t value = 0;
  for (int i = 0; i < 4; ++i) value |= static_cast<std::uint32_t>(from[i]) << (8 * i);
  return value;
}

/// CRC-32 of a record's size and content.
std::uint32_t checksum_of(const unsigned char* size, std::span<const unsigned char> content) {
  const uLong start = crc32(0, size, 4);
  return static_cast<std::uint32_t>(crc32_z(start, content.data(), content.size()));
}

void add_record(JournalBytes& to, std::span<const unsigned char> content) {
  unsigned char head[kHead];
  put_32(head, static_cast<std::uint32_t>(content.size()));
  put_32(head + 4, checksum_of(head, content));
  to.insert(to.end(), head, head + kHead);
  to.insert(to.end(), content.begin(), content.end());
}

/// The content of a complete record; empty if it is damaged.
std::span<const unsigned char> content_of(std::span<const unsigned char> record) {
  const auto content = record.subspan(kHead);
  if (get_32(record.data()) != content.size()) return {};
  if (get_32(record.data() + 4) != checksum_of(record.data(), content)) return {};
  return content;
}

/// The size of the file is known, so a failure is a disk error, not a damaged journal.
void read_or_throw(const fs::path& path,
                   const FileDescriptor& file,
                   std::span<unsigned char> bytes,
                   std::uint64_t offset) {
  if (read_fully(file, bytes, static_cast<off_t>(offset)) == bytes.size()) return;
  throw Error(path.string() + ": cannot be read at byte " + std::to_string(offset));
}

/// A file read from front to back in large pieces.
class FileWindow {
 public:
  FileWindow(const fs::path& path, const FileDescriptor& file, std::uint64_t size)
      : path_(path), file_(file), size_(size) {}

  /// Fewer than `count` bytes at the end of the file.
  std::span<const unsigned char> at(std::uint64_t offset, std::size_t count) {
    const std::uint64_t end = std::min<std::uint64_t>(offset + count, size_);
    if (offset < start_ || end > start_ + bytes_.size()) {
      const auto most = std::max<std::uint64_t>(count, kChunk);
      bytes_.resize(static_cast<std::size_t>(std::min(most, size_ - offset)));
      read_or_throw(path_, file_, bytes_, offset);
      start_ = offset;
    }
    return std::span(bytes_).subspan(static_cast<std::size_t>(offset - start_),
                                     static_cast<std::size_t>(end - offset));
  }

 private:
  const fs::path& path_;
  const FileDescriptor& file_;
  std::uint64_t size_ = 0, start_ = 0;
  std::vector<unsigned char> bytes_;
};

/// Throws Error if another version of planescope wrote it.
bool has_header(const fs::path& path, std::span<const unsigned char> bytes) {
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text == kHeader) return true;
  if (text.size() == kHeader.size() && text.starts_with(kAnyVersion))
    throw Error(path.string() + ": journal version " +
                std::string(text.substr(kAnyVersion.size(), 1)) +
                ", written by a later version of planescope; expected 1");
  return false;
}

}  // namespace

/// Makes written data survive a power failure, without blocking the writer.
class Journal::BackgroundSync {
 public:
  /// Duplicates the descriptor.
  explicit BackgroundSync(const FileDescriptor& file)
      : file_(::fcntl(file.get(), F_DUPFD_CLOEXEC, 0)),
        thread_([this](std::stop_token stop) { loop(stop); }) {}

  /// Syncs as soon as possible; requests that arrive in the meantime are combined.
  void request() {
    {
      const std::lock_guard lock(mutex_);
      wanted_ = true;
    }
    wake_.notify_one();
  }
  /// The errno of the first failed request, reported once, as the system does; 0: none failed.
  int take_error() { return error_.exchange(0); }

 private:
  void loop(std::stop_token stop) {
    std::unique_lock lock(mutex_);
    while (wake_.wait(lock, stop, [this] { return wanted_; })) {
      wanted_ = false;
      lock.unlock();
      if (int none = 0; ::fdatasync(file_.get()) != 0) error_.compare_exchange_strong(none, errno);
      lock.lock();
    }
  }

  FileDescriptor file_;
  std::mutex mutex_;
  std::condition_variable_any wake_;
  bool wanted_ = false;
  std::atomic<int> error_ = 0;
  std::jthread thread_;  // last: it uses all of the above
};

Journal::~Journal() = default;

Journal::Journal(fs::path path, Access access, const Visitor& visit) : path_(std::move(path)) {
  file_ = open_file(path_, access == Access::write ? O_RDWR : O_RDONLY);
  if (!file_.is_open()) {
    if (errno == ENOENT || errno == ENOTDIR) return;
    throw Error(path_.string() + ": cannot be opened (" + error_text(errno) + ")");
  }
  struct stat status = {};
  if (::fstat(file_.get(), &status) != 0 || !S_ISREG(status.st_mode))
    throw Error(path_.string() + ": not a regular file; expected a label journal");
  size_ = static_cast<std::uint64_t>(status.st_size);
  scan(visit);
}

void Journal::scan(const Visitor& visit) {
  FileWindow window(path_, file_, size_);
  if (!has_header(path_, window.at(0, kHeader.size()))) return;
  end_ = kHeader.size();
  while (true) {
    const auto head = window.at(end_, kHead);
    if (head.size() < kHead) return;
    const std::uint32_t bytes = get_32(head.data());
    if (bytes == 0 || bytes > size_ - end_ - kHead) return;
    const auto record = window.at(end_, kHead + bytes);
    if (record.size() < kHead + bytes) return;
    const auto content = content_of(record);
    if (content.empty()) return;
    try {
      if (!visit({end_, bytes}, content)) return;
    } catch (const Error& error) {
      // Its checksum is correct, so the content is as written.
      throw Error(path_.string() + ": cannot be read at byte " + std::to_string(end_) + ": " +
                  error.what() + "; was it written by a later version of planescope?");
    }
    end_ += kHead + bytes;
  }
}

fs::path Journal::set_damaged_aside() {
  std::vector<unsigned char> rest(static_cast<std::size_t>(damaged()));
  read_or_throw(path_, file_, rest, end_);
  fs::path aside = unused_path(path_.string() + ".damaged-");
  write_file_bytes(aside, rest, Durable::yes);
  if (::ftruncate(file_.get(), static_cast<off_t>(end_)) != 0 || ::fsync(file_.get()) != 0)
    throw Error(path_.string() + ": cannot be truncated to its undamaged part (" +
                error_text(errno) + ")");
  size_ = end_;
  return aside;
}

std::vector<JournalPlace> Journal::append(std::span<const JournalBytes> records) {
  assert(damaged() == 0);
  JournalBytes bytes;
  std::vector<JournalPlace> places;
  if (end_ == 0) bytes.assign(kHeader.begin(), kHeader.end());
  for (const JournalBytes& record : records) {
    places.push_back({end_ + bytes.size(), static_cast<std::uint32_t>(record.size())});
    add_record(bytes, record);
  }
  const auto fail = [&](int error) {
    throw Error(path_.string() + ": cannot be written (" + error_text(error) + ")");
  };
  if (!file_.is_open()) {
    file_ = open_file(path_, O_RDWR | O_CREAT | O_EXCL);
    if (!file_.is_open()) fail(errno);
    created_ = true;
  }
  if (const int error = write_fully(file_, bytes, static_cast<off_t>(end_))) {
    // If this failed as well, the next append would overwrite the remainder.
    if (::ftruncate(file_.get(), static_cast<off_t>(end_)) != 0) fail(errno);
    fail(error);
  }
  end_ += bytes.size();
  size_ = end_;
  unsynced_ = true;
  if (!background_) background_ = std::make_unique<BackgroundSync>(file_);
  background_->request();
  return places;
}

void Journal::sync() {
  int error = background_ ? background_->take_error() : 0;
  if (!error && unsynced_ && ::fdatasync(file_.get()) != 0) error = errno;
  if (!error && created_) error = sync_folder(path_.parent_path());
  if (error) throw Error(path_.string() + ": cannot be synced to disk (" + error_text(error) + ")");
  unsynced_ = created_ = false;
}

JournalBytes Journal::read(const JournalPlace& place) const {
  JournalBytes record(kHead + place.bytes);
  read_or_throw(path_, file_, record, place.offset);
  if (content_of(record).empty())
    throw Error(path_.string() + ": the record at byte " + std::to_string(place.offset) +
                " is damaged");
  record.erase(record.begin(), record.begin() + kHead);
  return record;
}

}  // namespace planescope::labels
