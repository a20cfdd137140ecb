// The table of formats, and conversion between labels of a frame and labeled points.

#include "core/labels/exchange/exchange.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <ranges>

#include "core/io/readers.hpp"
#include "core/labels/exchange/formats.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/cloud/cloud.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

io::Bytes as_bytes(const FileBytes& bytes) { return std::as_bytes(std::span(bytes)); }

fs::path with_extension(const fs::path& stem, const char* extension) {
  fs::path path = stem;  // not replace_extension(): a stem may contain dots
  path += extension;
  return path;
}

template <LabeledPoints (*parse)(io::Bytes, const std::string&)>
LabeledPoints read_whole(const fs::path& path) {
  return parse(as_bytes(read_file_bytes(path)), path.string());
}

LabeledPoints read_kitti(const fs::path& path) {
  fs::path stem = path;
  stem.replace_extension();
  const fs::path bin = with_extension(stem, ".bin"), label = with_extension(stem, ".label");
  const FileBytes labels = read_file_bytes(label);
  const bool has_points = fs::exists(bin);
  const FileBytes points = has_points ? read_file_bytes(bin) : FileBytes{};
  if (has_points && points.empty() && !labels.empty())
    throw Error(fmt::format("{}: is empty; expected 16 bytes for each of {} labels", bin.string(),
                            labels.size() / 4));
  return parse_kitti(as_bytes(points), as_bytes(labels), stem.string());
}

enum class Needs : std::uint8_t { ids, coordinates, pixels };

struct FileOfFormat {
  const char* extension = nullptr;
  FileBytes (*bytes)(const LabeledPoints&, const fs::path& path, double voxel_size_m) = nullptr;
};

template <FileBytes (*bytes)(const LabeledPoints&)>
FileBytes bytes_of(const LabeledPoints& points, const fs::path&, double) {
  return bytes(points);
}

FileBytes npz_file(const LabeledPoints& points, const fs::path& path, double) {
  return npz_bytes(points, path.string());
}

FileBytes coco_file(const LabeledPoints& points, const fs::path& path, double) {
  CocoWriter writer;
  writer.add(points, path.stem().string() + ".png");
  return writer.bytes();
}

FileBytes voxel_file(const LabeledPoints& points, const fs::path&, double voxel_size_m) {
  return voxel_bytes(points, voxel_size_m);
}

struct Format {
  const char* name;
  Needs needs;
  LabeledPoints (*read)(const fs::path&);  // null: write-only
  std::array<FileOfFormat, 2> files;       // one or two; the last one is opened to read
};

/// Indexed by LabelFormat.
constexpr Format kFormats[] = {
    {"evops", Needs::ids, read_whole<parse_evops>, {{{".npy", bytes_of<evops_bytes>}}}},
    {"ply", Needs::coordinates, read_labeled_cloud, {{{".ply", bytes_of<labeled_ply_bytes>}}}},
    {"pcd", Needs::coordinates, read_labeled_cloud, {{{".pcd", bytes_of<labeled_pcd_bytes>}}}},
    {"kitti",
     Needs::coordinates,
     read_kitti,
     {{{".bin", bytes_of<kitti_points_bytes>}, {".label", bytes_of<kitti_label_bytes>}}}},
    {"npz", Needs::ids, read_whole<parse_npz>, {{{".npz", npz_file}}}},
    {"coco", Needs::pixels, read_whole<parse_coco>, {{{".json", coco_file}}}},
    {"voxels", Needs::coordinates, nullptr, {{{".voxels.ply", voxel_file}}}}};

const Format& format_of(LabelFormat format) { return kFormats[static_cast<std::size_t>(format)]; }

void check_needs(const LabeledPoints& points, const Format& format, const fs::path& stem) {
  const bool has_pixels = points.width > 0 && points.pixel.size() == points.size();
  const char* lacks = nullptr;
  if (format.needs == Needs::coordinates && points.points.size() != points.size())
    lacks = "coordinates";
  if (format.needs == Needs::pixels && !has_pixels) lacks = "pixels and the depth image's size";
  if (lacks)
    throw Error(fmt::format("{}: format {} requires {}, which these labels do not contain",
                            stem.string(), format.name, lacks));
}

}  // namespace

std::vector<LabelFormat> label_formats(bool read_back) {
  std::vector<LabelFormat> formats;
  for (std::size_t i = 0; i < std::size(kFormats); ++i)
    if (kFormats[i].read || !read_back) formats.push_back(static_cast<LabelFormat>(i));
  return formats;
}

LabelFormat parse_label_format(const std::string& name) {
  std::vector<std::string> known;
  for (const LabelFormat format : label_formats(false)) {
    if (name == to_string(format)) return format;
    known.emplace_back(to_string(format));
  }
  throw Error(
      fmt::format("unknown label format '{}'; expected one of {}", name, fmt::join(known, ", ")));
}

LabelFormat label_format_of(const fs::path& path) {
  const std::string kind = io::extension(path);
  std::string known, last;
  for (const LabelFormat format : label_formats(true))
    for (const FileOfFormat& file : format_of(format).files | std::views::reverse) {
      if (!file.extension) continue;
      if (kind == file.extension) return format;
      if (!last.empty()) known += (known.empty() ? "" : ", ") + last;
      last = file.extension;
    }
  throw Error(fmt::format("{}: unknown extension; expected a name that ends in {}, or {}",
                          path.string(), known, last));
}

const char* to_string(LabelFormat format) { return format_of(format).name; }

const char* extension_of(LabelFormat format) {
  const auto& files = format_of(format).files;
  return files[files[1].extension ? 1 : 0].extension;
}

LabeledPoints points_of_labels(const FrameLabels& labels, const LabelGrid& grid) {
  assert(labels.plane.pixels() == grid.pixels() && labels.hv.pixels() == grid.pixels());
  LabeledPoints points;
  points.planes = labels.planes;
  points.T_world_sensor = planes::world_from_gravity(labels.gravity.direction, !grid.is_cloud());
  if (grid.is_cloud()) {  // all of them: other tools match them to the cloud's own file
    points.points = grid.points;
    points.origin = grid.origin;
    points.rgb = grid.color.data;
    points.label = labels.hv.data;
    points.instance.assign(labels.plane.data.begin(), labels.plane.data.end());
    return points;
  }
  points.width = grid.width;
  points.height = grid.height;
  for (std::size_t i = 0; i < grid.pixels(); ++i) {
    if (!grid.measured[i]) continue;
    points.points.push_back(grid.points[i]);
    points.label.push_back(labels.hv.data[i]);
    points.instance.push_back(labels.plane.data[i]);
    points.pixel.push_back({static_cast<std::uint16_t>(i % static_cast<std::size_t>(grid.width)),
                            static_cast<std::uint16_t>(i / static_cast<std::size_t>(grid.width))});
    if (grid.color.empty()) continue;
    const std::uint8_t* rgb = &grid.color.data[3 * i];
    points.rgb.insert(points.rgb.end(), rgb, rgb + 3);
  }
  return points;
}

std::vector<fs::path> write_labeled(const fs::path& stem,
                                    LabelFormat format,
                                    const LabeledPoints& points,
                                    double voxel_size_m) {
  [[maybe_unused]] const auto fits = [&](std::size_t size, std::size_t each) {
    return size == 0 || size == each * points.size();
  };
  assert(fits(points.points.size(), 1) && fits(points.rgb.size(), 3) &&
         fits(points.label.size(), 1) && fits(points.pixel.size(), 1));
  check_needs(points, format_of(format), stem);
  std::vector<fs::path> paths;
  std::vector<FileBytes> bytes;  // encode all before writing any
  for (const FileOfFormat& file : format_of(format).files) {
    if (!file.extension) continue;
    paths.push_back(with_extension(stem, file.extension));
    bytes.push_back(file.bytes(points, paths.back(), voxel_size_m));
  }
  for (std::size_t i = 0; i < paths.size(); ++i) write_file_bytes(paths[i], bytes[i], Durable::yes);
  return paths;
}

LabeledPoints read_labeled(const fs::path& path, LabelFormat format) {
  if (!format_of(format).read)
    throw Error(path.string() + ": voxel labels can be written from point labels, but not read");
  return format_of(format).read(path);
}

// Transfers labels of points back to the pixels of a frame.

namespace {

// Coordinates that went through another tool are accurate to this. Only the distance from the
// sensor is compared, since a tool may have rotated the points, for example upright.
constexpr double kSameDistance_m = 0.001;
constexpr double kFloatStep = 2e-7;  // of its distance: precision of a float far from 0

std::vector<std::uint32_t> pixels_by_name(const LabeledPoints& points,
                                          const LabelGrid& grid,
                                          const std::string& where) {
  std::vector<std::uint32_t> indices(points.size());
  std::vector<bool> taken(grid.pixels(), false);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const DepthPixel pixel = points.pixel[i];
    if (pixel.u >= grid.width || pixel.v >= grid.height)
      throw Error(fmt::format("{}: pixel ({}, {}) is outside the frame's {}x{} depth image", where,
                              pixel.u, pixel.v, grid.width, grid.height));
    const auto index = static_cast<std::uint32_t>(pixel.v * grid.width + pixel.u);
    if (taken[index])
      throw Error(fmt::format("{}: pixel ({}, {}) appears twice", where, pixel.u, pixel.v));
    taken[index] = true;
    indices[i] = index;
  }
  return indices;
}

std::vector<std::uint32_t> pixels_in_raster_order(const LabeledPoints& points,
                                                  const LabelGrid& grid,
                                                  const std::string& where) {
  const bool all = points.size() == grid.pixels();
  if (!all && points.size() != grid.measured_count && grid.is_cloud())
    throw Error(fmt::format("{}: labels for {} points, but the frame's cloud has {}", where,
                            points.size(), grid.pixels()));
  if (!all && points.size() != grid.measured_count)
    throw Error(fmt::format(
        "{}: labels for {} points; expected {} (one per pixel with depth) or {} (one per pixel)",
        where, points.size(), grid.measured_count, grid.pixels()));
  std::vector<std::uint32_t> indices;
  indices.reserve(points.size());
  for (std::uint32_t i = 0; i < grid.pixels(); ++i)
    if (all || grid.measured[i]) indices.push_back(i);
  return indices;
}

/// Labels of another frame would fit the image just as well, but their points do not fit its depth.
void check_points(const LabeledPoints& points,
                  const LabelGrid& grid,
                  std::span<const std::uint32_t> indices,
                  const std::string& where) {
  if (points.points.size() != indices.size()) return;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (!grid.measured[indices[i]]) continue;
    const double found = (points.origin + points.points[i].cast<double>()).norm();
    const double expected = (grid.origin + grid.points[indices[i]].cast<double>()).norm();
    if (std::abs(found - expected) <= std::max(kSameDistance_m, kFloatStep * expected)) continue;
    throw Error(
        fmt::format("{}: point {} is {:.3f} m from the sensor, but {:.3f} m in the frame; these "
                    "labels are for a different frame",
                    where, i, found, expected));
  }
}

/// The planes in the image, each with the class of most of its pixels.
std::vector<LabelPlane> planes_of(const FrameLabels& labels) {
  std::vector<std::array<std::size_t, 3>> votes(kPlaneIgnore);
  std::vector<bool> named(kPlaneIgnore, false);
  for (std::size_t i = 0; i < labels.plane.pixels(); ++i) {
    const std::uint16_t id = labels.plane.data[i];
    if (id == 0 || id == kPlaneIgnore) continue;
    named[id] = true;
    if (const std::uint8_t hv = labels.hv.data[i]; hv <= 2) ++votes[id][hv];
  }
  std::vector<LabelPlane> planes;
  for (int id = 1; id < kPlaneIgnore; ++id) {
    if (!named[id]) continue;
    const auto most = std::max_element(votes[id].begin(), votes[id].end());
    LabelPlane plane;
    plane.id = id;
    plane.label = static_cast<Label>(most - votes[id].begin());
    plane.origin = LabelOrigin::imported;
    planes.push_back(plane);
  }
  return planes;
}

/// Classifies each plane by its tilt if the format contains only planes. Planes without known
/// gravity get no class.
void classify_by_tilt(FrameLabels& labels) {
  std::vector<std::uint8_t> class_of(kPlaneIgnore + 1, 0);
  class_of[kPlaneIgnore] = kHvIgnore;
  for (LabelPlane& plane : labels.planes) {
    plane.label = class_of_tilt(tilt_of(plane.normal, labels.gravity));
    class_of[plane.id] = static_cast<std::uint8_t>(plane.label);
  }
  for (std::size_t i = 0; i < labels.plane.pixels(); ++i)
    labels.hv.data[i] = class_of[labels.plane.data[i]];
}

}  // namespace

FrameLabels labels_of_points(const LabeledPoints& points,
                             const LabelGrid& grid,
                             const std::string& depth_sha256,
                             const std::string& where) {
  if (grid.is_cloud() && (points.width > 0 || !points.pixel.empty()))
    throw Error(where + ": labels for a depth image, but the frame is a cloud");
  if (points.width > 0 && (points.width != grid.width || points.height != grid.height))
    throw Error(fmt::format("{}: labels for {}x{} pixels, but the frame's depth image is {}x{}",
                            where, points.width, points.height, grid.width, grid.height));
  // A format that lists only labeled pixels may list none: that is not raster order.
  const bool by_name =
      points.pixel.size() == points.size() && (points.size() > 0 || points.width > 0);
  const std::vector<std::uint32_t> indices =
      by_name ? pixels_by_name(points, grid, where) : pixels_in_raster_order(points, grid, where);
  check_points(points, grid, indices, where);

  FrameLabels labels = empty_labels(grid, depth_sha256);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (!grid.measured[indices[i]]) continue;
    labels.plane.data[indices[i]] = static_cast<std::uint16_t>(points.instance[i]);
    if (!points.label.empty()) labels.hv.data[indices[i]] = points.label[i];
  }
  labels.planes = planes_of(labels);
  refit_planes(labels, grid);
  if (points.label.empty()) classify_by_tilt(labels);
  return labels;
}

}  // namespace planescope::labels
