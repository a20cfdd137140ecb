#pragma once

#include <filesystem>
#include <optional>
#include <string_view>
#include <vector>

#include "core/io/byte_reader.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/model/frame.hpp"

// Shared by the readers of cloud files. Internal to core/io.

namespace planescope::io {

/// Each checks the header against the file's size, reading nothing else. Throws Error.
void check_ply(const std::filesystem::path& path);
void check_pcd(const std::filesystem::path& path);
PointSet read_ply(const std::filesystem::path& path, CloudExtras* extras = nullptr);
PointSet read_pcd(const std::filesystem::path& path, CloudExtras* extras = nullptr);

/// Words of a text, separated by white space.
class WordReader {
 public:
  explicit WordReader(Bytes text)
      : rest_(reinterpret_cast<const char*>(text.data()), text.size()) {}
  /// Throws OutOfBytes at the end.
  std::string_view next();
  std::size_t left() const { return rest_.size(); }

 private:
  std::string_view rest_;
};

/// The lines of a text header in front of data that may be binary.
class HeaderLines {
 public:
  HeaderLines(const std::filesystem::path& path, Bytes file) : path_(path), file_(file) {}
  /// The words of the next line. Throws Error naming the file where the header never ends.
  std::vector<std::string_view> next();
  std::size_t position() const { return position_; }

 private:
  const std::filesystem::path& path_;
  Bytes file_;
  std::size_t position_ = 0;
};

/// A count as decimal digits only.
std::optional<std::uint64_t> parse_count(std::string_view text);

}  // namespace planescope::io
