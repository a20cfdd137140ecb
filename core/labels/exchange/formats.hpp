#pragma once

// The formats of exchanged labels, and code that they share. Internal to core/labels.

#include <fmt/format.h>

#include <cmath>
#include <span>

#include "core/io/byte_reader.hpp"
#include "core/io/cloud_files/cloud_file.hpp"
#include "core/labels/exchange/exchange.hpp"
#include "core/model/error.hpp"

namespace planescope::labels {

using FileBytes = std::vector<unsigned char>;

/// Larger files are rejected before allocation: twice the pixels of the largest depth cameras.
inline constexpr std::uint64_t kMaxLabeledPoints = std::uint64_t{1} << 25;
void check_count(std::uint64_t points, const std::string& where);

/// Text of a file for a one-line message: unprintable characters become '?'.
std::string printable(std::string_view text);

/// Values as whole numbers of low..high. Throws Error naming `where` and the first invalid one.
template <typename T>
std::vector<T> whole_numbers(std::span<const double> values,
                             double low,
                             double high,
                             const std::string& where) {
  std::vector<T> whole(values.size());
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (!(values[i] >= low && values[i] <= high) || values[i] != std::floor(values[i]))
      throw Error(fmt::format("{}: {:g} at index {}; expected a whole number from {:.0f} to {:.0f}",
                              where, values[i], i, low, high));
    whole[i] = static_cast<T>(values[i]);
  }
  return whole;
}
/// Values of `instance` and `label`, checked against their ranges.
std::vector<std::int32_t> instances_of(std::span<const double> values, const std::string& where);
std::vector<std::uint8_t> classes_of(std::span<const double> values, const std::string& where);

// One pair per format. `where` names the file in messages.
FileBytes evops_bytes(const LabeledPoints& points);
LabeledPoints parse_evops(io::Bytes file, const std::string& where);

FileBytes labeled_ply_bytes(const LabeledPoints& points);
FileBytes labeled_pcd_bytes(const LabeledPoints& points);
LabeledPoints read_labeled_cloud(const std::filesystem::path& path);

FileBytes kitti_points_bytes(const LabeledPoints& points);
FileBytes kitti_label_bytes(const LabeledPoints& points);
/// `bin` empty: labels without their points.
LabeledPoints parse_kitti(io::Bytes bin, io::Bytes label, const std::string& where);

FileBytes npz_bytes(const LabeledPoints& points, const std::string& where);
LabeledPoints parse_npz(io::Bytes file, const std::string& where);

/// A file with one image; CocoFile supports several.
LabeledPoints parse_coco(io::Bytes file, const std::string& where);
/// The counts of a COCO mask that pycocotools compressed into text; nullopt if it is damaged.
std::optional<std::vector<std::uint64_t>> counts_of_text(const std::string& text);

FileBytes voxel_bytes(const LabeledPoints& points, double voxel_size_m);

// NumPy's array files (numpy.lib.format), versions 1.0 and 2.0.

/// An array in C order, as stored in its file.
struct NpyArray {
  std::vector<std::uint64_t> shape;
  io::Scalar type = io::Scalar::u8;
  bool big_endian = false;
  io::Bytes data;  // as many values as `shape` declares

  std::size_t size() const { return data.size() / io::size_of(type); }
  std::vector<double> values() const;
};

/// Throws Error naming `where`. The header is checked against the file's size.
NpyArray parse_npy(io::Bytes file, const std::string& where);

/// Version 1.0, little-endian. `type`: "<i4", "|u1", "<f4", matching the values at `data`.
std::vector<unsigned char> npy_bytes(const std::string& type,
                                     const std::vector<std::uint64_t>& shape,
                                     io::Bytes data);

}  // namespace planescope::labels
