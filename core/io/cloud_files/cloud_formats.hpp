#pragma once

// Shared by the readers of cloud files. Internal to core/io.

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/byte_reader.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/model/frame.hpp"

namespace planescope::io {

/// Number types of cloud files.
enum class Scalar : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
std::size_t size_of(Scalar type);
/// The value at `bytes`, which hold at least size_of(type).
double load(Scalar type, const std::byte* bytes, bool big_endian = false);

struct CloudField {
  std::string name;
  Scalar type = Scalar::f32;
};

/// Collects points whose fields come in any order and of any type, and keeps what we use of them:
/// x y z, colours (red green blue, or packed rgb), label and instance.
class CloudBuilder {
 public:
  /// Throws Error naming the file when x, y or z is missing. `extras` may be null.
  CloudBuilder(const std::filesystem::path& path,
               std::span<const CloudField> fields,
               CloudExtras* extras = nullptr);

  void reserve(std::size_t points);
  /// One value per field.
  void add(std::span<const double> values);
  PointSet finish();

 private:
  std::uint8_t color_value(double value, int field) const;
  void add_color(std::span<const double> values);

  std::vector<CloudField> fields_;
  std::array<int, 3> xyz_{-1, -1, -1};
  std::array<int, 3> rgb_{-1, -1, -1};
  int packed_ = -1;
  int label_ = -1;
  int instance_ = -1;
  CloudExtras* extras_;
  std::vector<int> extra_;  // field of each of extras_->names, -1 where there is none
  std::vector<Vec3d> points_;
  PointSet set_;
};

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
