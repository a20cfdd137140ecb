// Reads, hashes, locks and atomically replaces files.

#include "core/model/file_bytes.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <ctime>
#include <fstream>
#include <memory>
#include <system_error>
#include <vector>

#include "core/model/error.hpp"

namespace planescope {

namespace fs = std::filesystem;

FileDescriptor::~FileDescriptor() {
  if (is_open()) ::close(descriptor_);
}

FileDescriptor open_file(const fs::path& path, int flags) {
  int descriptor = -1;
  do {
    descriptor = ::open(path.c_str(), flags | O_CLOEXEC, 0666);
  } while (descriptor < 0 && errno == EINTR);
  return FileDescriptor(descriptor);
}

int write_fully(const FileDescriptor& file, std::span<const unsigned char> bytes, off_t offset) {
  while (!bytes.empty()) {
    const ssize_t count = ::pwrite(file.get(), bytes.data(), bytes.size(), offset);
    if (count < 0 && errno == EINTR) continue;
    if (count < 0) return errno;
    if (count == 0) return EIO;
    bytes = bytes.subspan(static_cast<std::size_t>(count));
    offset += count;
  }
  return 0;
}

std::size_t read_fully(const FileDescriptor& file, std::span<unsigned char> bytes, off_t offset) {
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t count = ::pread(file.get(), bytes.data() + done, bytes.size() - done,
                                  offset + static_cast<off_t>(done));
    if (count < 0 && errno == EINTR) continue;
    if (count <= 0) break;
    done += static_cast<std::size_t>(count);
  }
  return done;
}

int sync_folder(const fs::path& folder) {
  const FileDescriptor file =
      open_file(folder.empty() ? fs::path(".") : folder, O_RDONLY | O_DIRECTORY);
  if (!file.is_open()) return errno;
  // Some file systems cannot sync a folder, and report EINVAL.
  return ::fsync(file.get()) == 0 || errno == EINVAL ? 0 : errno;
}

fs::path path_beside(const fs::path& path, std::string_view suffix) {
  fs::path beside = path.lexically_normal();
  if (beside == "." || beside.filename() == "..") beside = fs::absolute(beside).lexically_normal();
  if (beside.filename().empty()) beside = beside.parent_path();
  beside += suffix;
  return beside;
}

fs::path unused_path(const fs::path& prefix) {
  for (int i = 1;; ++i) {
    fs::path path = prefix;
    path += std::to_string(i);
    std::error_code error;
    if (!fs::exists(path, error)) return path;
  }
}

std::string error_text(int error) { return std::generic_category().message(error); }

namespace {

/// Returns 0, or the errno of the call that failed.
int write_all(const FileDescriptor& file, std::span<const unsigned char> bytes) {
  while (!bytes.empty()) {
    const ssize_t written = ::write(file.get(), bytes.data(), bytes.size());
    if (written < 0 && errno != EINTR) return errno;
    if (written > 0) bytes = bytes.subspan(static_cast<std::size_t>(written));
  }
  return 0;
}

/// A temporary file that is deleted unless renamed to its final name.
struct Staged {
  std::filesystem::path path;
  ~Staged() {
    std::error_code ignored;
    if (std::filesystem::is_regular_file(path, ignored)) std::filesystem::remove(path, ignored);
  }
};

/// `write`: writes the complete content to the given path; returns 0 or an errno.
void replace(const std::filesystem::path& path,
             Durable durable,
             const std::function<int(const std::filesystem::path&)>& write) {
  const auto expect = [&](int error) {
    if (error != 0) throw Error(path.string() + ": cannot be written (" + error_text(error) + ")");
  };
  std::error_code ignored;
  const auto status = std::filesystem::status(path, ignored);
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status))
    return expect(write(path));
  std::filesystem::path target = path;
  if (std::filesystem::exists(status)) target = std::filesystem::canonical(path, ignored);
  Staged staged{target};
  staged.path += ".part";
  // Another writer of the same file holds a lock on its temporary file.
  const FileDescriptor lock = open_file(staged.path, O_WRONLY | O_CREAT);
  if (lock.is_open() && ::flock(lock.get(), LOCK_EX | LOCK_NB) != 0)
    staged.path.replace_extension(fmt::format(".{}.part", ::getpid()));
  expect(write(staged.path));
  if (std::filesystem::exists(status))
    std::filesystem::permissions(staged.path, status.permissions(), ignored);
  expect(std::rename(staged.path.c_str(), target.c_str()) != 0 ? errno : 0);
  if (durable == Durable::yes) expect(sync_folder(std::filesystem::absolute(target).parent_path()));
}

}  // namespace

void exchange_folder(const fs::path& folder, const fs::path& place) {
  const auto expect = [&](int result) {
    if (result != 0)
      throw Error(place.string() + ": cannot be replaced (" + error_text(errno) + ")");
  };
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(place, ignored)))
    return expect(std::rename(folder.c_str(), place.c_str()));
  if (::renameat2(AT_FDCWD, folder.c_str(), AT_FDCWD, place.c_str(), RENAME_EXCHANGE) == 0) return;
  if (errno != EINVAL && errno != ENOSYS) expect(-1);
  // For file systems without exchange: nothing exists for a moment, and the old folder has a
  // temporary name.
  const fs::path aside = unused_path(place.string() + ".before-");
  expect(std::rename(place.c_str(), aside.c_str()));
  if (std::rename(folder.c_str(), place.c_str()) != 0) {
    const int error = errno;
    std::rename(aside.c_str(), place.c_str());
    errno = error;
    expect(-1);
  }
  expect(std::rename(aside.c_str(), folder.c_str()));
}

std::ifstream open_to_read(const std::filesystem::path& path) {
  std::error_code error;
  const auto status = std::filesystem::status(path, error);
  if (!std::filesystem::exists(status)) throw Error(path.string() + ": no such file");
  if (!std::filesystem::is_regular_file(status)) {
    throw Error(path.string() + ": not a regular file");
  }
  std::ifstream file(path, std::ios::binary);
  if (!file) throw Error(path.string() + ": cannot be opened for reading");
  return file;
}

std::vector<unsigned char> read_file_bytes(const std::filesystem::path& path,
                                           std::uintmax_t max_bytes) {
  std::ifstream file = open_to_read(path);
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(path, error);
  if (error) throw Error(path.string() + ": cannot be read: " + error.message());
  if (size > max_bytes) {
    throw Error(path.string() + ": " + std::to_string(size) + " bytes; expected at most " +
                std::to_string(max_bytes));
  }
  std::vector<unsigned char> bytes(size);
  file.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(size));
  if (file.gcount() != static_cast<std::streamsize>(size)) {
    throw Error(path.string() + ": read " + std::to_string(file.gcount()) + " bytes; expected " +
                std::to_string(size));
  }
  constexpr std::string_view kLfsPointer = "version https://git-lfs.github.com/spec/";
  if (std::string_view(reinterpret_cast<const char*>(bytes.data()), bytes.size())
          .starts_with(kLfsPointer))
    throw Error(path.string() + ": a Git LFS pointer instead of the file; run git lfs pull");
  return bytes;
}

void write_file_bytes(const std::filesystem::path& path,
                      std::span<const unsigned char> bytes,
                      Durable durable) {
  replace(path, durable, [&](const std::filesystem::path& place) {
    const FileDescriptor file = open_file(place, O_WRONLY | O_CREAT | O_TRUNC);
    if (!file.is_open()) return errno;
    if (const int error = write_all(file, bytes)) return error;
    return durable == Durable::yes && ::fsync(file.get()) != 0 ? errno : 0;
  });
}

void write_file_text(const std::filesystem::path& path, std::string_view text, Durable durable) {
  write_file_bytes(path, {reinterpret_cast<const unsigned char*>(text.data()), text.size()},
                   durable);
}

void write_file_stream(const std::filesystem::path& path,
                       const std::function<void(std::ostream&)>& write) {
  replace(path, Durable::no, [&](const std::filesystem::path& place) {
    errno = 0;
    std::ofstream file(place, std::ios::binary);
    if (file) write(file);
    file.close();
    if (file) return 0;
    return errno != 0 ? errno : EIO;
  });
}

namespace {

constexpr double kMiB = 1 << 20;

std::atomic<std::uint64_t> g_limit_bytes{std::uint64_t{512} << 20};

}  // namespace

std::uint64_t read_limit_bytes() { return g_limit_bytes; }
void set_read_limit_bytes(std::uint64_t bytes) { g_limit_bytes = bytes; }

void expect_within_read_limit(double bytes, const std::string& what) {
  const auto limit = static_cast<double>(read_limit_bytes());
  if (bytes > limit)
    throw Error(fmt::format(
        "{} would need {:.0f} MiB of memory; expected at most {:.0f} MiB; see --read-limit", what,
        bytes / kMiB, limit / kMiB));
}

namespace {

namespace fs = std::filesystem;

std::string local_time() {
  const std::time_t now = std::time(nullptr);
  std::tm parts = {};
  localtime_r(&now, &parts);
  char text[64];
  const std::size_t size = std::strftime(text, sizeof(text), "%Y-%m-%d %H:%M", &parts);
  return {text, size};
}

std::string host_name() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

/// Parses the lock file's text: "held by ann, process 4711 on lab3 since 14:02".
std::string holder_of(const fs::path& path) {
  std::ifstream file(path);
  std::string user, process, host, since;
  if (!std::getline(file, user) || !std::getline(file, process) || !std::getline(file, host) ||
      !std::getline(file, since)) {
    return "held by another process";
  }
  const std::string today = local_time().substr(0, 11);
  if (since.starts_with(today)) since.erase(0, today.size());
  return "held by " + user + ", process " + process + " on " + host + " since " + since;
}

/// Whether the open file still has this name: its last holder may just have removed it.
bool is_named(const FileDescriptor& file, const fs::path& path) {
  struct stat opened = {}, named = {};
  return ::fstat(file.get(), &opened) == 0 && ::stat(path.c_str(), &named) == 0 &&
         opened.st_dev == named.st_dev && opened.st_ino == named.st_ino;
}

}  // namespace

FolderLock& FolderLock::operator=(FolderLock&& other) noexcept {
  if (this == &other) return *this;
  release();
  path_ = std::move(other.path_);
  file_ = std::move(other.file_);
  by_other_ = other.by_other_;
  why_not_ = std::move(other.why_not_);
  return *this;
}

void FolderLock::release() {
  // Removed while still locked, so that anyone who opened it in the meantime notices.
  if (file_.is_open()) ::unlink(path_.c_str());
  file_ = {};
}

FolderLock FolderLock::acquire(const fs::path& dir, const std::string& user) {
  FolderLock lock;
  const fs::path path = dir / "lock";
  FileDescriptor file = open_file(path, O_RDWR | O_CREAT);
  if (!file.is_open()) {
    lock.why_not_ = dir.string() + " cannot be written (" + error_text(errno) + ")";
    return lock;
  }
  if (::flock(file.get(), LOCK_EX | LOCK_NB) != 0) {
    lock.by_other_ = errno == EWOULDBLOCK;
    lock.why_not_ = lock.by_other_
                        ? holder_of(path)
                        : path.string() + " cannot be locked (" + error_text(errno) + ")";
    return lock;
  }
  if (!is_named(file, path)) return acquire(dir, user);
  const std::string text =
      user + "\n" + std::to_string(::getpid()) + "\n" + host_name() + "\n" + local_time() + "\n";
  // On a full disk the lock is still held, only without a description.
  if (::ftruncate(file.get(), 0) == 0) {
    write_fully(file, {reinterpret_cast<const unsigned char*>(text.data()), text.size()}, 0);
  }
  lock.path_ = path;
  lock.file_ = std::move(file);
  return lock;
}

namespace {

class Digest {
 public:
  Digest() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
    EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr);
  }
  void update(const void* data, std::size_t size) { EVP_DigestUpdate(context_.get(), data, size); }
  std::string hex() {
    std::array<unsigned char, EVP_MAX_MD_SIZE> digest{};
    unsigned int size = 0;
    EVP_DigestFinal_ex(context_.get(), digest.data(), &size);
    std::string text;
    for (unsigned int i = 0; i < size; ++i) {
      text += "0123456789abcdef"[digest[i] >> 4];
      text += "0123456789abcdef"[digest[i] & 15];
    }
    return text;
  }

 private:
  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_;
};

}  // namespace

std::string sha256_hex(std::span<const std::byte> bytes) {
  Digest digest;
  digest.update(bytes.data(), bytes.size());
  return digest.hex();
}

std::string sha256_hex(std::string_view text) { return sha256_hex(std::as_bytes(std::span(text))); }

std::string sha256_hex_of_file(const std::filesystem::path& path) {
  std::ifstream file = open_to_read(path);
  Digest digest;
  std::vector<char> block(1 << 16);
  while (file.read(block.data(), static_cast<std::streamsize>(block.size())) || file.gcount() > 0)
    digest.update(block.data(), static_cast<std::size_t>(file.gcount()));
  if (file.bad()) throw Error(path.string() + ": cannot be read completely");
  return digest.hex();
}

}  // namespace planescope
