// Preloaded into the program: makes the N-th call of one kind fail, as a full or defective disk, a
// lack of memory or a lost driver would. Environment variables:
//
//   PLANESCOPE_FAULT_KIND    one of kKinds
//   PLANESCOPE_FAULT_AT      N, from 1; without it, calls are counted and none fails
//   PLANESCOPE_FAULT_STAYS   if set, later calls fail as well
//   PLANESCOPE_FAULT_ERRNO   errno of the failure; 0: a read or write processes half of its bytes;
//                            -1: the process is killed before the call
//   PLANESCOPE_FAULT_BELOW   folders separated by ':'; only calls for files below them count
//   PLANESCOPE_FAULT_COUNTS  a file with room for a std::uint32_t per kind, which receives the
//                            numbers of calls even if the process is killed

#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <link.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <csignal>
#include <cstdarg>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <iterator>
#include <new>

#include "faults/kinds.hpp"

extern "C" void* __libc_malloc(std::size_t);
extern "C" void* __libc_calloc(std::size_t, std::size_t);
extern "C" void* __libc_realloc(void*, std::size_t);

namespace {

using planescope::faults::kKill;
using planescope::faults::kKinds;

struct Range {
  std::uintptr_t begin = 0, end = 0;
};

// State of the whole process; set before main(), and no call fails before that.
struct Faults {
  std::atomic<std::uint32_t>* counts = nullptr;  // one per kind
  std::string_view kind;
  const char* below = "";
  std::uint32_t at = 0;
  bool stays = false;
  int error = EIO;
  Range callers[16];  // the program itself, then libraries that allocate for it
  int caller_count = 0;
} g_faults;

long number(const char* name, long otherwise) {
  const char* text = std::getenv(name);
  return text ? std::strtol(text, nullptr, 10) : otherwise;
}

const char* text_of(const char* name) {
  const char* text = std::getenv(name);
  return text ? text : "";
}

int add_caller(dl_phdr_info* info, std::size_t, void*) {
  constexpr const char* kLibraries[] = {"libpng", "libdeflate", "libzip", "libz.",
                                        "liblz4", "libjpeg",    "libbz2"};
  bool counts = g_faults.caller_count == 0;
  for (const char* name : kLibraries) counts |= std::strstr(info->dlpi_name, name) != nullptr;
  if (!counts || g_faults.caller_count == static_cast<int>(std::size(g_faults.callers))) return 0;
  Range& range = g_faults.callers[g_faults.caller_count++];
  range.begin = UINTPTR_MAX;
  for (int i = 0; i < info->dlpi_phnum; ++i) {
    if (info->dlpi_phdr[i].p_type != PT_LOAD) continue;
    const std::uintptr_t begin = info->dlpi_addr + info->dlpi_phdr[i].p_vaddr;
    if (begin < range.begin) range.begin = begin;
    if (begin + info->dlpi_phdr[i].p_memsz > range.end)
      range.end = begin + info->dlpi_phdr[i].p_memsz;
  }
  return 0;
}

__attribute__((constructor)) void set_up() {
  const char* counts = std::getenv("PLANESCOPE_FAULT_COUNTS");
  if (!counts) return;
  g_faults.kind = text_of("PLANESCOPE_FAULT_KIND");
  g_faults.below = text_of("PLANESCOPE_FAULT_BELOW");
  g_faults.at = static_cast<std::uint32_t>(number("PLANESCOPE_FAULT_AT", 0));
  g_faults.stays = std::getenv("PLANESCOPE_FAULT_STAYS") != nullptr;
  g_faults.error = static_cast<int>(number("PLANESCOPE_FAULT_ERRNO", EIO));
  dl_iterate_phdr(add_caller, nullptr);
  const int file = static_cast<int>(syscall(SYS_openat, AT_FDCWD, counts, O_RDWR | O_CLOEXEC));
  if (file < 0) std::abort();
  const long at = syscall(SYS_mmap, nullptr, kKinds.size() * sizeof(std::uint32_t),
                          PROT_READ | PROT_WRITE, MAP_SHARED, file, 0L);
  if (at < 0 && at > -4096) std::abort();
  syscall(SYS_close, file);
  g_faults.counts = reinterpret_cast<std::atomic<std::uint32_t>*>(at);
}

constexpr std::size_t index_of(std::string_view kind) {
  std::size_t index = 0;
  while (kKinds[index] != kind) ++index;
  return index;
}

/// Counts the call; returns true, with errno set, if it must fail.
bool meets_fault(std::size_t kind) {
  const std::uint32_t call = ++g_faults.counts[kind];
  if (g_faults.at == 0 || kKinds[kind] != g_faults.kind) return false;
  if (call < g_faults.at || (call > g_faults.at && !g_faults.stays)) return false;
  if (g_faults.error == kKill) raise(SIGKILL);
  errno = g_faults.error;
  return true;
}

bool is_below() { return true; }  // for calls that concern no file

bool is_below(const char* path) {
  for (const char* folder = g_faults.below; *folder;) {
    const std::size_t size = std::strcspn(folder, ":");
    if (std::strncmp(path, folder, size) == 0 && (path[size] == '/' || path[size] == 0))
      return true;
    folder += size + (folder[size] == ':');
  }
  return false;
}

bool is_below(int descriptor) {
  char link[64], path[PATH_MAX];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", descriptor);
  const long size = syscall(SYS_readlinkat, AT_FDCWD, link, path, sizeof path - 1);
  if (size <= 0) return false;
  path[size] = 0;
  return is_below(path);
}

/// Resolves names relative to a folder.
bool is_below(int folder, const char* path) {
  if (path[0] == '/') return is_below(path);
  if (folder != AT_FDCWD) return is_below(folder);
  char here[PATH_MAX];
  return syscall(SYS_getcwd, here, sizeof here) > 0 && is_below(here);
}

constexpr std::size_t kOpen = index_of("open"), kRead = index_of("read"),
                      kWrite = index_of("write"), kSync = index_of("sync"),
                      kRename = index_of("rename"), kRemove = index_of("remove"),
                      kMap = index_of("map"), kTruncate = index_of("truncate"),
                      kMkdir = index_of("mkdir"), kList = index_of("list"),
                      kThread = index_of("thread"), kMemory = index_of("memory"),
                      kEgl = index_of("egl"), kGl = index_of("gl");

template <typename... File>
bool fails(std::size_t kind, File... file) {
  if (!g_faults.counts) return false;
  const int before = errno;
  if (is_below(file...) && meets_fault(kind)) return true;
  errno = before;
  return false;
}

bool is_callers(const void* address) {
  const auto at = reinterpret_cast<std::uintptr_t>(address);
  for (int i = 0; i < g_faults.caller_count; ++i)
    if (at >= g_faults.callers[i].begin && at < g_faults.callers[i].end) return true;
  return false;
}

bool memory_fails(std::size_t bytes, const void* caller) {
  constexpr std::size_t kLeast = 65536;  // smaller requests are not counted
  return g_faults.counts && bytes >= kLeast && is_callers(caller) && meets_fault(kMemory);
}

template <typename Function>
Function* next(Function*, const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

mode_t mode_of(int flags, va_list rest) {
  return (flags & (O_CREAT | O_TMPFILE)) != 0 ? va_arg(rest, mode_t) : 0;
}

}  // namespace

#define NEXT(function) static const auto before = next(&function, #function)

extern "C" {

// ---- Files ----

#define PLANESCOPE_OPEN(function)                  \
  int function(const char* path, int flags, ...) { \
    NEXT(function);                                \
    va_list rest;                                  \
    va_start(rest, flags);                         \
    const mode_t mode = mode_of(flags, rest);      \
    va_end(rest);                                  \
    if (fails(kOpen, AT_FDCWD, path)) return -1;   \
    return before(path, flags, mode);              \
  }
PLANESCOPE_OPEN(open)
PLANESCOPE_OPEN(open64)

#define PLANESCOPE_OPENAT(function)                            \
  int function(int folder, const char* path, int flags, ...) { \
    NEXT(function);                                            \
    va_list rest;                                              \
    va_start(rest, flags);                                     \
    const mode_t mode = mode_of(flags, rest);                  \
    va_end(rest);                                              \
    if (fails(kOpen, folder, path)) return -1;                 \
    return before(folder, path, flags, mode);                  \
  }
PLANESCOPE_OPENAT(openat)
PLANESCOPE_OPENAT(openat64)

FILE* fopen(const char* path, const char* mode) {
  NEXT(fopen);
  return fails(kOpen, AT_FDCWD, path) ? nullptr : before(path, mode);
}
FILE* fopen64(const char* path, const char* mode) {
  NEXT(fopen64);
  return fails(kOpen, AT_FDCWD, path) ? nullptr : before(path, mode);
}
DIR* opendir(const char* path) {
  NEXT(opendir);
  return fails(kOpen, AT_FDCWD, path) ? nullptr : before(path);
}

/// Processes half of the bytes if requested, otherwise fails.
#define PLANESCOPE_SOME(kind, file, size)           \
  if (fails(kind, file)) {                          \
    if (g_faults.error != 0 || size < 2) return -1; \
    size /= 2;                                      \
  }

ssize_t read(int file, void* to, std::size_t size) {
  NEXT(read);
  PLANESCOPE_SOME(kRead, file, size)
  return before(file, to, size);
}
ssize_t pread(int file, void* to, std::size_t size, off_t offset) {
  NEXT(pread);
  PLANESCOPE_SOME(kRead, file, size)
  return before(file, to, size, offset);
}
ssize_t pread64(int file, void* to, std::size_t size, off64_t offset) {
  NEXT(pread64);
  PLANESCOPE_SOME(kRead, file, size)
  return before(file, to, size, offset);
}
std::size_t fread(void* to, std::size_t size, std::size_t count, FILE* file) {
  NEXT(fread);
  if (fails(kRead, fileno(file))) return 0;
  return before(to, size, count, file);
}

ssize_t write(int file, const void* from, std::size_t size) {
  NEXT(write);
  PLANESCOPE_SOME(kWrite, file, size)
  return before(file, from, size);
}
ssize_t pwrite(int file, const void* from, std::size_t size, off_t offset) {
  NEXT(pwrite);
  PLANESCOPE_SOME(kWrite, file, size)
  return before(file, from, size, offset);
}
ssize_t pwrite64(int file, const void* from, std::size_t size, off64_t offset) {
  NEXT(pwrite64);
  PLANESCOPE_SOME(kWrite, file, size)
  return before(file, from, size, offset);
}
ssize_t writev(int file, const iovec* parts, int count) {
  NEXT(writev);
  PLANESCOPE_SOME(kWrite, file, count)
  return before(file, parts, count);
}

int fsync(int file) {
  NEXT(fsync);
  return fails(kSync, file) ? -1 : before(file);
}
int fdatasync(int file) {
  NEXT(fdatasync);
  return fails(kSync, file) ? -1 : before(file);
}

int rename(const char* from, const char* to) {
  NEXT(rename);
  return fails(kRename, AT_FDCWD, to) ? -1 : before(from, to);
}
int renameat2(int from_folder, const char* from, int to_folder, const char* to, unsigned flags) {
  NEXT(renameat2);
  return fails(kRename, to_folder, to) ? -1 : before(from_folder, from, to_folder, to, flags);
}

int remove(const char* path) {
  NEXT(remove);
  return fails(kRemove, AT_FDCWD, path) ? -1 : before(path);
}
int unlink(const char* path) {
  NEXT(unlink);
  return fails(kRemove, AT_FDCWD, path) ? -1 : before(path);
}
int unlinkat(int folder, const char* path, int flags) {
  NEXT(unlinkat);
  return fails(kRemove, folder, path) ? -1 : before(folder, path, flags);
}
int rmdir(const char* path) {
  NEXT(rmdir);
  return fails(kRemove, AT_FDCWD, path) ? -1 : before(path);
}

void* mmap(void* at, std::size_t size, int protection, int flags, int file, off_t offset) {
  NEXT(mmap);
  if (file >= 0 && fails(kMap, file)) return MAP_FAILED;
  return before(at, size, protection, flags, file, offset);
}
void* mmap64(void* at, std::size_t size, int protection, int flags, int file, off64_t offset) {
  NEXT(mmap64);
  if (file >= 0 && fails(kMap, file)) return MAP_FAILED;
  return before(at, size, protection, flags, file, offset);
}

int ftruncate(int file, off_t size) {
  NEXT(ftruncate);
  return fails(kTruncate, file) ? -1 : before(file, size);
}
int ftruncate64(int file, off64_t size) {
  NEXT(ftruncate64);
  return fails(kTruncate, file) ? -1 : before(file, size);
}

int mkdir(const char* path, mode_t mode) {
  NEXT(mkdir);
  return fails(kMkdir, AT_FDCWD, path) ? -1 : before(path, mode);
}

dirent* readdir(DIR* folder) {
  NEXT(readdir);
  return fails(kList, dirfd(folder)) ? nullptr : before(folder);
}
dirent64* readdir64(DIR* folder) {
  NEXT(readdir64);
  return fails(kList, dirfd(folder)) ? nullptr : before(folder);
}

// ---- Threads and memory ----

int pthread_create(pthread_t* thread,
                   const pthread_attr_t* attributes,
                   void* (*routine)(void*),
                   void* state) {
  NEXT(pthread_create);
  // A std::thread of the program has a state whose class belongs to the program; threads of a
  // driver do not.
  const bool ours = g_faults.counts && state && is_callers(*static_cast<void**>(state));
  if (ours && meets_fault(kThread)) return EAGAIN;
  return before(thread, attributes, routine, state);
}

void* malloc(std::size_t size) {
  return memory_fails(size, __builtin_return_address(0)) ? nullptr : __libc_malloc(size);
}
void* calloc(std::size_t count, std::size_t size) {
  const bool failed = memory_fails(count * size, __builtin_return_address(0));
  return failed ? nullptr : __libc_calloc(count, size);
}
void* realloc(void* before, std::size_t size) {
  const bool failed = memory_fails(size, __builtin_return_address(0));
  return failed ? nullptr : __libc_realloc(before, size);
}

// ---- OpenGL ----

unsigned eglInitialize(void* display, std::int32_t* major, std::int32_t* minor) {
  NEXT(eglInitialize);
  if (fails(kEgl)) return 0;
  return before(display, major, minor);
}
void* eglCreateContext(void* display, void* config, void* share, const std::int32_t* attributes) {
  NEXT(eglCreateContext);
  if (fails(kEgl)) return nullptr;
  return before(display, config, share, attributes);
}
unsigned eglMakeCurrent(void* display, void* draw, void* read, void* context) {
  NEXT(eglMakeCurrent);
  if (fails(kEgl)) return 0;
  return before(display, draw, read, context);
}

// Whether a shader compiled, a program linked, or a framebuffer is complete.
void glGetShaderiv(unsigned shader, unsigned what, std::int32_t* value) {
  NEXT(glGetShaderiv);
  before(shader, what, value);
  if (what == 0x8B81 && fails(kGl)) *value = 0;  // GL_COMPILE_STATUS
}
void glGetProgramiv(unsigned program, unsigned what, std::int32_t* value) {
  NEXT(glGetProgramiv);
  before(program, what, value);
  if (what == 0x8B82 && fails(kGl)) *value = 0;  // GL_LINK_STATUS
}
unsigned glCheckFramebufferStatus(unsigned target) {
  NEXT(glCheckFramebufferStatus);
  return fails(kGl) ? 0 : before(target);
}
unsigned glGetError() {
  NEXT(glGetError);
  return fails(kGl) ? 0x0505 : before();  // GL_OUT_OF_MEMORY
}

}  // extern "C"

void* operator new(std::size_t size) {
  void* memory =
      memory_fails(size, __builtin_return_address(0)) ? nullptr : __libc_malloc(size ? size : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}
void* operator new[](std::size_t size) {
  void* memory =
      memory_fails(size, __builtin_return_address(0)) ? nullptr : __libc_malloc(size ? size : 1);
  if (!memory) throw std::bad_alloc();
  return memory;
}
