#include "core/model/folder_lock.hpp"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <ctime>
#include <fstream>

namespace planescope {
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

/// "held by ann, process 4711 on lab3 since 14:02", from what its holder wrote.
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

/// Whether the open file is still the one of that name: its last holder may just have removed it.
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
  // Removed while it is still held: whoever opened it meanwhile sees that its name is gone.
  if (file_.is_open()) ::unlink(path_.c_str());
  file_ = {};
}

FolderLock FolderLock::take(const fs::path& dir, const std::string& user) {
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
  if (!is_named(file, path)) return take(dir, user);
  const std::string text =
      user + "\n" + std::to_string(::getpid()) + "\n" + host_name() + "\n" + local_time() + "\n";
  // On a full disk the lock holds all the same, only without a name.
  if (::ftruncate(file.get(), 0) == 0) {
    write_fully(file, {reinterpret_cast<const unsigned char*>(text.data()), text.size()}, 0);
  }
  lock.path_ = path;
  lock.file_ = std::move(file);
  return lock;
}

}  // namespace planescope
