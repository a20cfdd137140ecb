#include "core/io/bag/message_log.hpp"

#include "core/io/bag/packed_file.hpp"
#include "core/io/bag/rosbag1.hpp"
#include "core/io/bag/rosbag2_mcap.hpp"
#include "core/io/bag/rosbag2_metadata.hpp"
#include "core/io/bag/rosbag2_sqlite.hpp"
#include "core/io/bag/split_log.hpp"
#include "core/io/readers.hpp"

namespace planescope::io {

std::unique_ptr<MessageLog> open_message_log(const std::filesystem::path& path) {
  if (std::filesystem::is_directory(path))
    return std::make_unique<SplitLog>(path, rosbag2::files_of_metadata(path));
  const std::string magic = first_bytes_within(path, 8);
  const std::string kind = extension(name_within(path));
  if (magic == "SQLite f" || kind == ".db3") return std::make_unique<rosbag2::SqliteLog>(path);
  if (magic == rosbag2::kMcapMagic || kind == ".mcap")
    return std::make_unique<rosbag2::McapLog>(path);
  return std::make_unique<rosbag1::Bag>(path);
}

}  // namespace planescope::io
