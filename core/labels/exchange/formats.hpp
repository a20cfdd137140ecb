#pragma once

// The formats of exchanged labels, and what they share. Internal to core/labels.

#include <span>

#include "core/io/byte_reader.hpp"
#include "core/labels/exchange/exchange.hpp"
#include "core/model/error.hpp"

namespace planescope::labels {

using FileBytes = std::vector<unsigned char>;

/// More is refused before memory is asked for: twice the pixels of the largest depth cameras.
inline constexpr std::uint64_t kMaxLabelledPoints = std::uint64_t{1} << 25;
void check_count(std::uint64_t points, const std::string& where);

/// Text of a file, for a message of one line: what cannot be printed is a '?'.
std::string printable(std::string_view text);

/// Each as a whole number of low..high. Throws Error naming `where` and the first that is not.
template <typename T>
std::vector<T> whole_numbers(std::span<const double> values,
                             double low,
                             double high,
                             const std::string& where);
/// Of `instance` and `label`, with what may stand there.
std::vector<std::int32_t> instances_of(std::span<const double> values, const std::string& where);
std::vector<std::uint8_t> classes_of(std::span<const double> values, const std::string& where);

// One pair per format. `where` names the file in messages.
FileBytes evops_bytes(const LabelledPoints& points);
LabelledPoints parse_evops(io::Bytes file, const std::string& where);

FileBytes labelled_ply_bytes(const LabelledPoints& points);
FileBytes labelled_pcd_bytes(const LabelledPoints& points);
LabelledPoints read_labelled_cloud(const std::filesystem::path& path);

FileBytes kitti_points_bytes(const LabelledPoints& points);
FileBytes kitti_label_bytes(const LabelledPoints& points);
/// `bin` empty: labels without their points.
LabelledPoints parse_kitti(io::Bytes bin, io::Bytes label, const std::string& where);

FileBytes npz_bytes(const LabelledPoints& points, const std::string& where);
LabelledPoints parse_npz(io::Bytes file, const std::string& where);

/// Of one image (coco.hpp writes and reads those of several).
LabelledPoints parse_coco(io::Bytes file, const std::string& where);
/// The counts of a COCO mask that pycocotools compressed into text.
std::vector<std::uint64_t> counts_of_text(const std::string& text, const std::string& where);

FileBytes voxel_bytes(const LabelledPoints& points, double voxel_size_m);

}  // namespace planescope::labels
