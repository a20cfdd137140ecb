#include "core/model/file_descriptor.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

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
  // Some file systems cannot sync a folder and say so: there is nothing more to be done there.
  return ::fsync(file.get()) == 0 || errno == EINVAL ? 0 : errno;
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

}  // namespace planescope
