#include "core/io/bag/mapped_sqlite.hpp"

#include <algorithm>
#include <atomic>
#include <string>

#include "core/io/bag/packed_file.hpp"
#include "core/model/error.hpp"
#include "core/model/read_limit.hpp"

// https://www.sqlite.org/fileformat2.html and https://www.sqlite.org/vfs.html

namespace planescope::io {
namespace {

constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};
constexpr std::size_t kDatabaseHeaderBytes = 100;
constexpr std::size_t kVersions = 18;  // where the header tells of write-ahead logging, two bytes

std::uint64_t big_endian(Bytes bytes) {
  std::uint64_t value = 0;
  for (const std::byte byte : bytes) value = value << 8 | std::to_integer<std::uint64_t>(byte);
  return value;
}

/// SQLite's view of the mapped file; it allocates this itself, as plain bytes.
struct File {
  sqlite3_file base;
  Bytes bytes;
};

int read(sqlite3_file* file, void* to, int count, sqlite3_int64 from) {
  const Bytes bytes = reinterpret_cast<File*>(file)->bytes;
  const auto at = std::min<std::size_t>(static_cast<std::size_t>(from), bytes.size());
  const Bytes part = bytes.subspan(at, std::min<std::size_t>(count, bytes.size() - at));
  auto* out = static_cast<std::byte*>(to);
  std::fill(std::copy(part.begin(), part.end(), out), out + count, std::byte{0});
  // A log of writes ahead would be a file beside: what it holds is not asked for.
  for (std::size_t i = kVersions; i < kVersions + 2; ++i) {
    if (i >= at && i < at + part.size()) out[i - at] = std::byte{1};
  }
  return part.size() == static_cast<std::size_t>(count) ? SQLITE_OK : SQLITE_IOERR_SHORT_READ;
}

int size(sqlite3_file* file, sqlite3_int64* bytes) {
  *bytes = static_cast<sqlite3_int64>(reinterpret_cast<File*>(file)->bytes.size());
  return SQLITE_OK;
}

const sqlite3_io_methods& methods() {
  static const sqlite3_io_methods table = [] {
    sqlite3_io_methods m{};
    m.iVersion = 1;
    m.xClose = [](sqlite3_file*) { return SQLITE_OK; };
    m.xRead = read;
    m.xWrite = [](sqlite3_file*, const void*, int, sqlite3_int64) { return SQLITE_READONLY; };
    m.xTruncate = [](sqlite3_file*, sqlite3_int64) { return SQLITE_READONLY; };
    m.xSync = [](sqlite3_file*, int) { return SQLITE_OK; };
    m.xFileSize = size;
    m.xLock = [](sqlite3_file*, int) { return SQLITE_OK; };
    m.xUnlock = [](sqlite3_file*, int) { return SQLITE_OK; };
    m.xCheckReservedLock = [](sqlite3_file*, int* reserved) {
      *reserved = 0;
      return SQLITE_OK;
    };
    m.xFileControl = [](sqlite3_file*, int, void*) { return SQLITE_NOTFOUND; };
    m.xSectorSize = [](sqlite3_file*) { return 4096; };
    m.xDeviceCharacteristics = [](sqlite3_file*) { return SQLITE_IOCAP_IMMUTABLE; };
    return m;
  }();
  return table;
}

}  // namespace

struct MappedSqlite::Vfs {
  std::string name;
  Bytes bytes;
  sqlite3_vfs base{};
};

void MappedSqlite::VfsDeleter::operator()(Vfs* vfs) const {
  sqlite3_vfs_unregister(&vfs->base);
  delete vfs;
}

MappedSqlite::MappedSqlite(const std::filesystem::path& path)
    : file_(map_content(path)), vfs_(new Vfs) {
  const Bytes bytes = file_.bytes();
  if (bytes.size() < kDatabaseHeaderBytes ||
      std::memcmp(bytes.data(), kSqliteMagic.data(), kSqliteMagic.size()) != 0) {
    throw Error(path.string() + ": not a SQLite file (" + std::to_string(bytes.size()) +
                " bytes that do not start with a header \"SQLite format 3\")");
  }
  page_bytes_ = big_endian(bytes.subspan(16, 2));
  if (page_bytes_ == 1) page_bytes_ = 65536;
  if (page_bytes_ < 512 || !std::has_single_bit(page_bytes_)) {
    throw Error(path.string() + ": a SQLite file with pages of " + std::to_string(page_bytes_) +
                " bytes, expected a power of two from 512 to 65536");
  }
  const bool is_kept = big_endian(bytes.subspan(24, 4)) == big_endian(bytes.subspan(92, 4));
  if (is_kept) promised_bytes_ = page_bytes_ * big_endian(bytes.subspan(28, 4));
  file_.expect_hops();

  static std::atomic<unsigned> number{0};
  vfs_->name = "planescope-" + std::to_string(++number);
  vfs_->bytes = bytes.first(bytes.size() / page_bytes_ * page_bytes_);
  sqlite3_vfs& vfs = vfs_->base;
  vfs.iVersion = 1;
  vfs.szOsFile = sizeof(File);
  vfs.mxPathname = 16;
  vfs.zName = vfs_->name.c_str();
  vfs.pAppData = vfs_.get();
  vfs.xOpen = [](sqlite3_vfs* self, const char*, sqlite3_file* file, int flags, int* flags_out) {
    file->pMethods = nullptr;
    if (!(flags & SQLITE_OPEN_MAIN_DB)) return SQLITE_CANTOPEN;
    new (file) File{{&methods()}, static_cast<Vfs*>(self->pAppData)->bytes};
    if (flags_out) *flags_out = SQLITE_OPEN_READONLY | SQLITE_OPEN_MAIN_DB;
    return SQLITE_OK;
  };
  vfs.xDelete = [](sqlite3_vfs*, const char*, int) { return SQLITE_READONLY; };
  vfs.xAccess = [](sqlite3_vfs*, const char*, int, int* exists) {
    *exists = 0;
    return SQLITE_OK;
  };
  vfs.xFullPathname = [](sqlite3_vfs*, const char* name, int room, char* out) {
    sqlite3_snprintf(room, out, "%s", name);
    return SQLITE_OK;
  };
  vfs.xRandomness = [](sqlite3_vfs*, int, char*) { return 0; };
  vfs.xSleep = [](sqlite3_vfs*, int) { return 0; };
  vfs.xCurrentTime = [](sqlite3_vfs*, double* days) {
    *days = 0;
    return SQLITE_OK;
  };
  vfs.xGetLastError = [](sqlite3_vfs*, int, char*) { return 0; };
  sqlite3_vfs_register(&vfs, 0);

  sqlite3* opened = nullptr;
  const int status = sqlite3_open_v2("mapped", &opened, SQLITE_OPEN_READONLY | SQLITE_OPEN_NOMUTEX,
                                     vfs_->name.c_str());
  database_.reset(opened);
  if (status != SQLITE_OK) {
    throw Error(path.string() + ": cannot be opened by SQLite: " + sqlite3_errstr(status));
  }
  // A schema from anybody runs nothing, and a file shorter than its header says opens all the same.
  sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
  sqlite3_limit(opened, SQLITE_LIMIT_LENGTH,
                static_cast<int>(std::min<std::uint64_t>(read_limit_bytes(), 1'000'000'000)));
}

}  // namespace planescope::io
