#pragma once

// Point cloud files: PLY and PCD, read and written, and formats that programs add.

#include <array>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/io/byte_reader.hpp"
#include "core/model/frame.hpp"

namespace planescope::io {

/// Fields of a cloud file to read unchanged, besides those in PointSet.
struct CloudExtras {
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;  // by name: one per point; empty if the field is missing
};

/// Reads a .ply or .pcd cloud with its colors and its `label` / `instance` fields (any integer
/// type). The header is checked against the file's size before anything is allocated. Added formats
/// do not fill `extras`.
PointSet read_cloud_file(const std::filesystem::path& path, CloudExtras* extras = nullptr);

/// Plane ids from the only extra field; values below 1 are no plane, as in other tools' labels.
/// Throws Error that begins with `what` if the points lack this field.
void take_instances(PointSet& set, const CloudExtras& extras, const std::string& what);

/// Hash of the coordinates: Recording::frame_hash() of a cloud.
std::string sha256_of_cloud(const PointSet& set);

/// A format of cloud files; both functions throw Error naming the file.
struct CloudFormat {
  std::string extension;  // lower case, with its dot
  PointSet (*read)(const std::filesystem::path&, CloudExtras*);
  /// Checks the header against the file's size without reading anything else. Null for added
  /// formats.
  void (*check)(const std::filesystem::path&) = nullptr;
};
/// .ply and .pcd, then the added formats. open3d::install() adds them before any recording is
/// opened.
const std::vector<CloudFormat>& cloud_formats();
void add_cloud_format(const CloudFormat& format);
/// By extension; null if it is unknown.
const CloudFormat* cloud_format_of(const std::filesystem::path& path);

/// A field of type int beside those of PointSet, one value per point.
struct IntField {
  std::string name;
  std::vector<std::int32_t> values;
};

/// Binary little-endian PLY: float x y z (double if set.origin is not zero), then uchar red green
/// blue, uchar label and int instance if they are present, then `more`.
std::vector<unsigned char> ply_bytes(const PointSet& set, std::span<const IntField> more = {});
void write_ply(const std::filesystem::path& path, const PointSet& set);

/// The same fields as binary PCD, with color packed as PCL does.
std::vector<unsigned char> pcd_bytes(const PointSet& set, std::span<const IntField> more = {});

// ---- For readers ----

/// Number types of cloud files.
enum class Scalar : std::uint8_t { i8, u8, i16, u16, i32, u32, i64, u64, f32, f64 };
std::size_t size_of(Scalar type);
/// The value at `bytes`, which hold at least size_of(type).
double load(Scalar type, const std::byte* bytes, bool big_endian = false);
/// Parses a count of decimal digits only.
std::optional<std::uint64_t> parse_count(std::string_view text);

struct CloudField {
  std::string name;
  Scalar type = Scalar::f32;
};

/// Collects points from fields in any order and of any type, and keeps those of PointSet: x y z,
/// colors (red green blue, or packed rgb), label and instance.
class CloudBuilder {
 public:
  /// Throws Error naming the file if x, y or z is missing. `extras` may be null.
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
  std::vector<int> extra_;  // field of each of extras_->names, -1 if missing
  std::vector<Vec3d> points_;
  PointSet set_;
};

/// Each checks the header against the file's size without reading anything else. Throws Error.
void check_ply(const std::filesystem::path& path);
void check_pcd(const std::filesystem::path& path);
PointSet read_ply(const std::filesystem::path& path, CloudExtras* extras = nullptr);
PointSet read_pcd(const std::filesystem::path& path, CloudExtras* extras = nullptr);

}  // namespace planescope::io
