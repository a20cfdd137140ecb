// ROS 2 recordings in SQLite: https://www.sqlite.org/fileformat2.html, with the tables of `ros2
// bag`. Opening reads only the ids and times of messages, never the blobs.

#include <fmt/format.h>
#include <sqlite3.h>

#include <algorithm>
#include <limits>
#include <mutex>

#include "core/io/bag/message_log.hpp"
#include "core/model/error.hpp"

namespace planescope::io {
namespace {

constexpr std::string_view kSqliteMagic{"SQLite format 3\0", 16};
constexpr std::size_t kDatabaseHeaderBytes = 100;

std::uint64_t big_endian(Bytes bytes) {
  std::uint64_t value = 0;
  for (const std::byte byte : bytes) value = value << 8 | std::to_integer<std::uint64_t>(byte);
  return value;
}

/// A SQLite database read from a mapped file. Nothing is ever written, locked or created beside it,
/// and truncated files open as far as their pages are complete.
class MappedSqlite {
 public:
  /// Throws Error if the file is not a SQLite file.
  explicit MappedSqlite(const std::filesystem::path& path);

  const MappedFile& file() const { return file_; }
  sqlite3* database() const { return database_.get(); }
  /// Size that the header declares; 0 if the last writer did not maintain it.
  std::uint64_t promised_bytes() const { return promised_bytes_; }
  bool is_cut() const { return promised_bytes_ > file_.bytes().size(); }
  std::size_t page_bytes() const { return page_bytes_; }

 private:
  struct Closer {
    void operator()(sqlite3* database) const { sqlite3_close(database); }
  };

  MappedFile file_;
  std::size_t page_bytes_ = 0;
  std::uint64_t promised_bytes_ = 0;
  std::unique_ptr<sqlite3, Closer> database_;
};

MappedSqlite::MappedSqlite(const std::filesystem::path& path) : file_(map_content(path)) {
  expect_start(file_, kDatabaseHeaderBytes, kSqliteMagic, "a SQLite file",
               "the header \"SQLite format 3\"");
  const Bytes bytes = file_.bytes();
  page_bytes_ = big_endian(bytes.subspan(16, 2));
  if (page_bytes_ == 1) page_bytes_ = 65536;
  if (page_bytes_ < 512 || !std::has_single_bit(page_bytes_))
    throw Error(
        fmt::format("{}: a SQLite file with {}-byte pages; expected a page size that is a power of "
                    "two from 512 to 65536",
                    path.string(), page_bytes_));
  const bool is_kept = big_endian(bytes.subspan(24, 4)) == big_endian(bytes.subspan(92, 4));
  if (is_kept) promised_bytes_ = page_bytes_ * big_endian(bytes.subspan(28, 4));
  // A write-ahead log would be a separate file: clear the flag that makes SQLite look for it.
  for (const std::size_t version : {18, 19})
    if (bytes[version] == std::byte{2}) file_.overwrite(version, std::byte{1});

  sqlite3* opened = nullptr;
  int status =
      sqlite3_open_v2(":memory:", &opened, SQLITE_OPEN_READWRITE | SQLITE_OPEN_NOMUTEX, nullptr);
  database_.reset(opened);
  const auto whole = static_cast<sqlite3_int64>(bytes.size() / page_bytes_ * page_bytes_);
  auto* content = reinterpret_cast<unsigned char*>(const_cast<std::byte*>(bytes.data()));
  if (status == SQLITE_OK)
    status =
        sqlite3_deserialize(opened, "main", content, whole, whole, SQLITE_DESERIALIZE_READONLY);
  if (status != SQLITE_OK)
    throw Error(path.string() + ": cannot be opened by SQLite: " + sqlite3_errstr(status));
  // Never run code from an untrusted schema, and open files shorter than their header declares.
  sqlite3_db_config(opened, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
  sqlite3_db_config(opened, SQLITE_DBCONFIG_WRITABLE_SCHEMA, 1, nullptr);
  sqlite3_limit(opened, SQLITE_LIMIT_LENGTH,
                static_cast<int>(std::min<std::uint64_t>(read_limit_bytes(), 1'000'000'000)));
}

constexpr std::uint64_t kLeastRowBytes = 8;  // minimum size of a message in the file

/// A statement, finalized with its owner.
class Rows {
 public:
  Rows(sqlite3* database, const char* sql) {
    if (sqlite3_prepare_v2(database, sql, -1, &statement_, nullptr) != SQLITE_OK)
      status_ = SQLITE_ERROR;
  }
  ~Rows() { sqlite3_finalize(statement_); }
  Rows(const Rows&) = delete;
  Rows& operator=(const Rows&) = delete;

  void bind(int at, std::int64_t value) { sqlite3_bind_int64(statement_, at, value); }
  bool next() {
    if (status_ == SQLITE_ROW) status_ = sqlite3_step(statement_);
    return status_ == SQLITE_ROW;
  }
  /// Whether next() reached the end rather than damage.
  bool is_whole() const { return status_ == SQLITE_DONE; }
  std::int64_t number(int column) const { return sqlite3_column_int64(statement_, column); }
  std::string text(int column) const {
    const auto* bytes = reinterpret_cast<const char*>(sqlite3_column_text(statement_, column));
    return bytes ? std::string(bytes,
                               static_cast<std::size_t>(sqlite3_column_bytes(statement_, column)))
                 : std::string();
  }

 private:
  sqlite3_stmt* statement_ = nullptr;
  int status_ = SQLITE_ROW;
};

class SqliteLog : public MessageLog {
 public:
  explicit SqliteLog(const std::filesystem::path& path);

  std::string kind() const override { return "ROS 2 bag (SQLite)"; }
  Message read(const MessageRef& message, std::size_t at_most) const override;
  void expect_whole() const override { file_.file().expect_whole(); }

 private:
  void read_topics();
  void read_index();
  void drop_cut_messages();
  void warn_of_loss();
  bool can_be_read(std::int64_t id, std::size_t& bytes) const;

  MappedSqlite file_;
  mutable std::mutex mutex_;  // a connection serves one thread at a time
  std::map<std::int64_t, std::string> topic_of_;
  std::uint64_t count_ = 0;
  std::string damage_;  // rows that could not be indexed, for messages
};

SqliteLog::SqliteLog(const std::filesystem::path& path) : MessageLog(path), file_(path) {
  read_topics();
  read_index();
  drop_cut_messages();
  warn_of_loss();
}

void SqliteLog::read_topics() {
  // Real tables only: a view or virtual table of these names would run code.
  Rows tables(file_.database(),
              "SELECT name FROM sqlite_master WHERE type = 'table' AND rootpage > 0 AND "
              "name IN ('topics', 'messages')");
  int found = 0;
  while (tables.next()) ++found;
  if (found < 2) {
    throw Error(path_.string() + ": a SQLite file " +
                (tables.is_whole()
                     ? "without \"topics\" and \"messages\" tables; expected a recording made by "
                       "ros2 bag or the RealSense SDK"
                     : "with a truncated or damaged list of tables"));
  }
  Rows topics(file_.database(), "SELECT id, name, type, serialization_format FROM topics");
  std::map<std::string, int> others;
  while (topics.next()) {
    if (topics.text(3) != "cdr") {
      ++others[topics.text(3)];
      continue;
    }
    topic_of_[topics.number(0)] = topics.text(1);
    topics_.emplace(topics.text(1), ros_type(topics.text(2)));
  }
  if (!topics.is_whole() && topics_.empty()) {
    throw Error(path_.string() + ": its topics table is truncated or damaged");
  }
  if (!topics.is_whole()) damage_ = "; its topics table is truncated or damaged";
  warn_of_encodings(others);
}

/// Walks the table from its start, and also from its end if it is damaged in between.
void SqliteLog::read_index() {
  const auto take = [&](const Rows& row) {
    if (++count_ > file_.file().bytes().size() / kLeastRowBytes)
      throw Error(path_.string() +
                  ": damaged: lists more messages than a file of its size can contain");
    const auto topic = topic_of_.find(row.number(1));
    if (topic == topic_of_.end()) return;
    const auto time_ns = static_cast<std::uint64_t>(std::max<std::int64_t>(row.number(2), 0));
    messages_[topic->second].push_back({time_ns, 0, 0, static_cast<std::uint64_t>(row.number(0))});
  };
  std::int64_t last = std::numeric_limits<std::int64_t>::min();
  Rows rows(file_.database(), "SELECT rowid, topic_id, timestamp FROM messages ORDER BY rowid");
  while (rows.next()) {
    take(rows);
    last = rows.number(0);
  }
  if (!rows.is_whole()) {
    Rows back(file_.database(),
              "SELECT rowid, topic_id, timestamp FROM messages ORDER BY rowid DESC");
    std::int64_t first = std::numeric_limits<std::int64_t>::max();
    while (back.next() && back.number(0) > last) {
      take(back);
      first = back.number(0);
    }
    if (!file_.is_cut()) damage_ += "; part of the messages table is damaged";
    if (first != std::numeric_limits<std::int64_t>::max() && last >= 0) {
      damage_ += "; " + std::to_string(first - last - 1) + " messages are lost";
    }
  }
  sort_messages();
}

/// The last messages before the cut may be listed although their blobs are missing.
void SqliteLog::drop_cut_messages() {
  if (!file_.is_cut()) return;
  std::vector<std::int64_t> ids;
  for (const auto& [topic, found] : messages_) {
    for (const MessageRef& message : found)
      ids.push_back(static_cast<std::int64_t>(message.offset));
  }
  std::sort(ids.begin(), ids.end());
  // A blob with pages of its own was written after all earlier ones: if it is complete,
  // so are they.
  std::vector<std::int64_t> lost;
  for (std::size_t bytes = 0; !ids.empty() && bytes <= file_.page_bytes(); ids.pop_back()) {
    if (!can_be_read(ids.back(), bytes)) lost.push_back(ids.back());
  }
  for (auto& [topic, found] : messages_) {
    count_ -= std::erase_if(found, [&](const MessageRef& message) {
      return std::ranges::count(lost, static_cast<std::int64_t>(message.offset)) > 0;
    });
  }
}

void SqliteLog::warn_of_loss() {
  std::string text;
  if (file_.is_cut()) {
    text = fmt::format("the file is truncated: it has {} bytes, but its header declares {}",
                       file_.file().bytes().size(), file_.promised_bytes());
  } else if (!damage_.empty()) {
    text = "the file is damaged";
  }
  if (!text.empty()) {
    warnings_.insert(warnings_.begin(),
                     text + damage_ + "; " + std::to_string(count_) + " messages recovered");
  }
  for (const char* suffix : {"-wal", "-journal"}) {
    std::error_code ignored;
    const std::filesystem::path beside = path_.string() + suffix;
    const auto bytes = std::filesystem::file_size(beside, ignored);
    if (ignored || bytes == 0) continue;
    warnings_.push_back(
        fmt::format("the recording was never closed: {} contains {} unmerged bytes, which are not "
                    "read; to merge them, run sqlite3 {} \"PRAGMA wal_checkpoint(TRUNCATE)\"",
                    beside.filename().string(), bytes, path_.filename().string()));
  }
}

/// A blob, closed with its owner; null if it cannot be opened.
struct BlobCloser {
  void operator()(sqlite3_blob* blob) const { sqlite3_blob_close(blob); }
};
using Blob = std::unique_ptr<sqlite3_blob, BlobCloser>;

Blob open_blob(sqlite3* database, std::int64_t id) {
  sqlite3_blob* blob = nullptr;
  const bool opened =
      sqlite3_blob_open(database, "main", "messages", "data", id, 0, &blob) == SQLITE_OK;
  return Blob(opened ? blob : nullptr);
}

bool SqliteLog::can_be_read(std::int64_t id, std::size_t& bytes) const {
  const Blob blob = open_blob(file_.database(), id);
  bytes = blob ? static_cast<std::size_t>(sqlite3_blob_bytes(blob.get())) : 0;
  char last = 0;
  const bool readable =
      blob && (bytes == 0 ||
               sqlite3_blob_read(blob.get(), &last, 1, static_cast<int>(bytes) - 1) == SQLITE_OK);
  if (!readable) bytes = 0;
  return readable;
}

Message SqliteLog::read(const MessageRef& message, std::size_t at_most) const {
  const auto id = static_cast<std::int64_t>(message.offset);
  const std::string what = path_.string() + ": message " + std::to_string(id);
  std::vector<std::byte> bytes;
  {
    const std::lock_guard lock(mutex_);
    const Blob blob = open_blob(file_.database(), id);
    if (!blob) throw Error(what + " is truncated or damaged");
    const auto size = static_cast<std::size_t>(sqlite3_blob_bytes(blob.get()));
    if (size > file_.file().bytes().size()) throw Error(what + " is damaged: longer than the file");
    const auto read_to = [&](std::size_t end) {
      const std::size_t from = bytes.size();
      bytes.resize(end);
      if (sqlite3_blob_read(blob.get(), bytes.data() + from, static_cast<int>(end - from),
                            static_cast<int>(from)) != SQLITE_OK) {
        throw Error(what + " is truncated or damaged");
      }
    };
    read_to(std::min(size, at_most));
    if (is_zstd(bytes)) read_to(size);  // a zstd frame can only be unpacked as a whole
  }
  const auto held = std::make_shared<const std::vector<std::byte>>(std::move(bytes));
  return cdr_message(held, *held, at_most, what);
}

}  // namespace

std::unique_ptr<MessageLog> open_sqlite_log(const std::filesystem::path& path) {
  return std::make_unique<SqliteLog>(path);
}

}  // namespace planescope::io
