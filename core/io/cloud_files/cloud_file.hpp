#pragma once

#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "core/model/frame.hpp"

namespace planescope::io {

/// Fields of a cloud file to be read unchanged, besides those that PointSet keeps.
struct CloudExtras {
  std::vector<std::string> names;
  std::vector<std::vector<double>> values;  // by name: one per point, or empty where it has none
};

/// Reads a .ply or .pcd cloud with its colours and its `label` / `instance` fields (any integer
/// type). The header is checked against the file's size before anything is allocated. For formats
/// that were added, `extras` gets nothing.
PointSet read_cloud_file(const std::filesystem::path& path, CloudExtras* extras = nullptr);

/// A format of cloud files; both functions throw Error naming the file.
struct CloudFormat {
  std::string extension;  // lower case, with its dot
  PointSet (*read)(const std::filesystem::path&, CloudExtras*);
  /// Checks the header against the file's size, reading nothing else. Null for formats that are not
  /// io's own.
  void (*check)(const std::filesystem::path&) = nullptr;
};
/// .ply and .pcd, then those that were added, as open3d::install() does before any recording is
/// opened.
const std::vector<CloudFormat>& cloud_formats();
void add_cloud_format(const CloudFormat& format);
/// By extension; null where it is none.
const CloudFormat* cloud_format_of(const std::filesystem::path& path);

/// A field of type int beside those of PointSet, one value per point.
struct IntField {
  std::string name;
  std::vector<std::int32_t> values;
};

/// Binary little-endian PLY: float x y z (double when set.origin is not zero), then uchar red
/// green blue where set.rgb is given, uchar label and int instance where given, then `more`.
std::vector<unsigned char> ply_bytes(const PointSet& set, std::span<const IntField> more = {});
void write_ply(const std::filesystem::path& path, const PointSet& set);

/// The same fields as binary PCD, colour as PCL packs it.
std::vector<unsigned char> pcd_bytes(const PointSet& set, std::span<const IntField> more = {});

}  // namespace planescope::io
