// Memory-mapped files that survive truncation while they are open.

#include "core/io/byte_reader.hpp"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <mutex>
#include <string>

#include "core/model/error.hpp"

namespace planescope::io {
namespace {

/// A mapping, for the SIGBUS handler, which may access only atomics.
struct Mapping {
  std::atomic<bool> taken{false};
  std::atomic<std::uintptr_t> begin{0}, end{0};  // 0: unused
  std::atomic<bool> cut{false};
};

constexpr std::size_t kMostMappings = 1024;
Mapping g_mappings[kMostMappings];
struct sigaction g_before;  // the previous SIGBUS action
std::uintptr_t g_page = 4096;

/// Replaces the pages from the first missing one with zeros.
void on_bus_error(int, siginfo_t* info, void*) {
  const int saved = errno;
  const auto at = reinterpret_cast<std::uintptr_t>(info->si_addr);
  for (Mapping& mapping : g_mappings) {
    const std::uintptr_t end = mapping.end;
    if (at < mapping.begin || at >= end) continue;
    auto* page = static_cast<std::byte*>(info->si_addr) - at % g_page;
    const std::uintptr_t missing = end - (at - at % g_page);
    if (::mmap(page, missing, PROT_READ, MAP_PRIVATE | MAP_ANONYMOUS | MAP_FIXED, -1, 0) ==
        MAP_FAILED)
      break;
    mapping.cut = true;
    errno = saved;
    return;
  }
  ::sigaction(SIGBUS, &g_before, nullptr);  // the access repeats and gets the previous action
}

void install_handler() {
  static std::once_flag once;
  std::call_once(once, [] {
    g_page = static_cast<std::uintptr_t>(::sysconf(_SC_PAGESIZE));
    struct sigaction action {};
    action.sa_sigaction = on_bus_error;
    action.sa_flags = SA_SIGINFO;
    ::sigaction(SIGBUS, &action, &g_before);
  });
}

/// Throws Error if too many files are open.
std::size_t take_slot(const std::filesystem::path& path) {
  for (std::size_t i = 0; i < kMostMappings; ++i)
    if (!g_mappings[i].taken.exchange(true)) return i;
  throw Error(path.string() + ": cannot be opened: too many open files; expected at most " +
              std::to_string(kMostMappings));
}

}  // namespace

// Opens without blocking, since a pipe would wait for a writer; pipes are refused.
MappedFile::MappedFile(const std::filesystem::path& path)
    : MappedFile(path, open_file(path, O_RDONLY | O_NONBLOCK)) {}

MappedFile::MappedFile(const std::filesystem::path& path, const FileDescriptor& file)
    : path_(path) {
  if (!file.is_open()) throw Error(path.string() + ": cannot be read: " + std::strerror(errno));
  struct stat status {};
  const bool regular = ::fstat(file.get(), &status) == 0 && S_ISREG(status.st_mode);
  const auto size = static_cast<std::size_t>(regular ? status.st_size : 0);
  void* address = nullptr;
  if (size > 0) address = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE, file.get(), 0);
  if (!regular) throw Error(path.string() + ": not a regular file");
  if (address == MAP_FAILED) throw Error(path.string() + ": cannot be mapped into memory");
  if (size == 0) return;
  install_handler();
  try {
    slot_ = take_slot(path);
  } catch (...) {
    ::munmap(address, size);
    throw;
  }
  bytes_ = {static_cast<const std::byte*>(address), size};
  Mapping& mapping = g_mappings[slot_];
  mapping.cut = false;
  mapping.begin = reinterpret_cast<std::uintptr_t>(address);
  mapping.end = mapping.begin + size;
}

MappedFile::~MappedFile() {
  if (bytes_.empty()) return;
  g_mappings[slot_].end = 0;
  g_mappings[slot_].begin = 0;
  ::munmap(const_cast<std::byte*>(bytes_.data()), bytes_.size());
  g_mappings[slot_].taken = false;
}

void MappedFile::expect_whole() const {
  if (!bytes_.empty() && g_mappings[slot_].cut)
    throw Error(path_.string() + ": truncated while being read; expected " +
                std::to_string(bytes_.size()) + " bytes; open it again");
}

// Both are hints: if the system ignores them, reading is slower but still correct.
void MappedFile::expect_hops() const {
  if (!bytes_.empty()) {
    ::madvise(const_cast<std::byte*>(bytes_.data()), bytes_.size(), MADV_RANDOM);
  }
}

void MappedFile::prefetch(Bytes part) const {
  if (part.empty()) return;
  const std::size_t before = reinterpret_cast<std::uintptr_t>(part.data()) % g_page;
  ::madvise(const_cast<std::byte*>(part.data()) - before, before + part.size(), MADV_WILLNEED);
}

void MappedFile::overwrite(std::size_t at, std::byte value) {
  auto* bytes = const_cast<std::byte*>(bytes_.data());
  if (::mprotect(bytes, g_page, PROT_READ | PROT_WRITE) != 0)
    throw Error(path_.string() + ": cannot be mapped into memory");
  bytes[at] = value;
}

}  // namespace planescope::io
