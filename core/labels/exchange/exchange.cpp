#include "core/labels/exchange/exchange.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdio>

#include "core/io/readers.hpp"
#include "core/labels/exchange/coco.hpp"
#include "core/labels/exchange/formats.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/planes/cloud/cloud.hpp"

namespace planescope::labels {
namespace {

namespace fs = std::filesystem;

constexpr const char* kFormatNames[] = {"evops", "ply", "pcd", "kitti", "npz", "coco", "voxels"};

struct WrittenFile {
  fs::path path;
  FileBytes bytes;
};

fs::path with_extension(const fs::path& stem, const char* extension) {
  fs::path path = stem;  // not replace_extension(): a stem may have dots
  path += extension;
  return path;
}

void need(bool there, const fs::path& stem, LabelFormat format, const char* what) {
  if (!there)
    throw Error(stem.string() + ": " + to_string(format) + " needs " + what +
                ", which these labels come without");
}

std::vector<WrittenFile> files_of(const fs::path& stem,
                                  LabelFormat format,
                                  const LabelledPoints& points,
                                  double voxel_size_m) {
  const auto named = [&](const char* extension) { return with_extension(stem, extension); };
  const bool with_points = points.points.size() == points.size();
  switch (format) {
    case LabelFormat::evops:
      return {{named(".npy"), evops_bytes(points)}};
    case LabelFormat::ply:
      need(with_points, stem, format, "coordinates");
      return {{named(".ply"), labelled_ply_bytes(points)}};
    case LabelFormat::pcd:
      need(with_points, stem, format, "coordinates");
      return {{named(".pcd"), labelled_pcd_bytes(points)}};
    case LabelFormat::kitti:
      need(with_points, stem, format, "coordinates");
      return {{named(".bin"), kitti_points_bytes(points)},
              {named(".label"), kitti_label_bytes(points)}};
    case LabelFormat::npz:
      return {{named(".npz"), npz_bytes(points, named(".npz").string())}};
    case LabelFormat::coco: {
      need(points.width > 0 && points.pixel.size() == points.size(), stem, format,
           "pixels and the size of the depth image");
      CocoWriter writer;
      writer.add(points, stem.filename().string() + ".png");
      return {{named(".json"), writer.bytes()}};
    }
    case LabelFormat::voxels:
      need(with_points, stem, format, "coordinates");
      return {{named(".voxels.ply"), voxel_bytes(points, voxel_size_m)}};
  }
  return {};
}

io::Bytes as_bytes(const FileBytes& bytes) { return std::as_bytes(std::span(bytes)); }

LabelledPoints read_kitti(const fs::path& path) {
  fs::path stem = path;
  stem.replace_extension();
  const fs::path bin = with_extension(stem, ".bin"), label = with_extension(stem, ".label");
  const FileBytes labels = read_file_bytes(label);
  const FileBytes points = fs::exists(bin) ? read_file_bytes(bin) : FileBytes{};
  return parse_kitti(as_bytes(points), as_bytes(labels), stem.string());
}

}  // namespace

LabelFormat parse_label_format(const std::string& name) {
  std::string known;
  for (int i = 0; i < static_cast<int>(std::size(kFormatNames)); ++i) {
    if (name == kFormatNames[i]) return static_cast<LabelFormat>(i);
    known += (i > 0 ? ", " : "") + std::string(kFormatNames[i]);
  }
  throw Error("label format '" + name + "' does not exist, expected one of " + known);
}

LabelFormat label_format_of(const fs::path& path) {
  const std::string kind = io::extension(path);
  if (kind == ".npy") return LabelFormat::evops;
  if (kind == ".ply") return LabelFormat::ply;
  if (kind == ".pcd") return LabelFormat::pcd;
  if (kind == ".bin" || kind == ".label") return LabelFormat::kitti;
  if (kind == ".npz") return LabelFormat::npz;
  if (kind == ".json") return LabelFormat::coco;
  throw Error(path.string() +
              ": expected a name that ends in .npy, .ply, .pcd, .label, .bin, .npz or .json");
}

const char* to_string(LabelFormat format) { return kFormatNames[static_cast<int>(format)]; }

LabelledPoints points_of_labels(const FrameLabels& labels, const LabelGrid& grid) {
  assert(labels.plane.pixels() == grid.pixels() && labels.hv.pixels() == grid.pixels());
  LabelledPoints points;
  points.planes = labels.planes;
  points.T_world_sensor = planes::world_from_gravity(labels.gravity.direction, !grid.is_cloud());
  if (grid.is_cloud()) {  // all of them: other tools count along with the cloud's own file
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

std::vector<fs::path> write_labelled(const fs::path& stem,
                                     LabelFormat format,
                                     const LabelledPoints& points,
                                     double voxel_size_m) {
  [[maybe_unused]] const auto fits = [&](std::size_t size, std::size_t each) {
    return size == 0 || size == each * points.size();
  };
  assert(fits(points.points.size(), 1) && fits(points.rgb.size(), 3) &&
         fits(points.label.size(), 1) && fits(points.pixel.size(), 1));
  const std::vector<WrittenFile> files = files_of(stem, format, points, voxel_size_m);
  std::vector<fs::path> paths;
  for (const WrittenFile& file : files) {
    write_file_bytes(file.path, file.bytes, Durable::yes);
    paths.push_back(file.path);
  }
  return paths;
}

LabelledPoints read_labelled(const fs::path& path, LabelFormat format) {
  switch (format) {
    case LabelFormat::evops:
      return parse_evops(as_bytes(read_file_bytes(path)), path.string());
    case LabelFormat::ply:
    case LabelFormat::pcd:
      return read_labelled_cloud(path);
    case LabelFormat::kitti:
      return read_kitti(path);
    case LabelFormat::npz:
      return parse_npz(as_bytes(read_file_bytes(path)), path.string());
    case LabelFormat::coco:
      return parse_coco(as_bytes(read_file_bytes(path)), path.string());
    case LabelFormat::voxels:
      break;
  }
  throw Error(path.string() +
              ": labels of voxels are made from labels of points and not read back");
}

// Labels of points back onto the pixels of a frame.

namespace {

// Coordinates that went through another tool are this close to what they were. Only the distance
// from the sensor is compared: a tool may well have turned the points, upright for example.
constexpr double kSameDistance_m = 0.001;
constexpr double kFloatStep = 2e-7;  // of its distance: as exact as a float is far from 0

std::string name_of(DepthPixel pixel) {
  return "pixel (" + std::to_string(pixel.u) + ", " + std::to_string(pixel.v) + ")";
}

std::string size_text(int width, int height) {
  return std::to_string(width) + "x" + std::to_string(height);
}

std::vector<std::uint32_t> pixels_by_name(const LabelledPoints& points,
                                          const LabelGrid& grid,
                                          const std::string& where) {
  std::vector<std::uint32_t> indices(points.size());
  std::vector<bool> taken(grid.pixels(), false);
  for (std::size_t i = 0; i < indices.size(); ++i) {
    const DepthPixel pixel = points.pixel[i];
    if (pixel.u >= grid.width || pixel.v >= grid.height)
      throw Error(where + ": " + name_of(pixel) + ", the frame's depth is " +
                  size_text(grid.width, grid.height));
    const auto index = static_cast<std::uint32_t>(pixel.v * grid.width + pixel.u);
    if (taken[index]) throw Error(where + ": " + name_of(pixel) + " is there twice");
    taken[index] = true;
    indices[i] = index;
  }
  return indices;
}

std::vector<std::uint32_t> pixels_in_raster_order(const LabelledPoints& points,
                                                  const LabelGrid& grid,
                                                  const std::string& where) {
  const bool all = points.size() == grid.pixels();
  if (!all && points.size() != grid.measured_count && grid.is_cloud())
    throw Error(where + ": labels of " + std::to_string(points.size()) +
                " points, the frame's cloud has " + std::to_string(grid.pixels()));
  if (!all && points.size() != grid.measured_count)
    throw Error(where + ": " + std::to_string(points.size()) + " points, expected " +
                std::to_string(grid.measured_count) + ", one per pixel with depth, or " +
                std::to_string(grid.pixels()) + ", one per pixel");
  std::vector<std::uint32_t> indices;
  indices.reserve(points.size());
  for (std::uint32_t i = 0; i < grid.pixels(); ++i)
    if (all || grid.measured[i]) indices.push_back(i);
  return indices;
}

/// Labels of another frame would fit the image just as well; their points do not fit its depth.
void check_points(const LabelledPoints& points,
                  const LabelGrid& grid,
                  std::span<const std::uint32_t> indices,
                  const std::string& where) {
  if (points.points.size() != indices.size()) return;
  for (std::size_t i = 0; i < indices.size(); ++i) {
    if (!grid.measured[indices[i]]) continue;
    const double found = (points.origin + points.points[i].cast<double>()).norm();
    const double expected = (grid.origin + grid.points[indices[i]].cast<double>()).norm();
    if (std::abs(found - expected) <= std::max(kSameDistance_m, kFloatStep * expected)) continue;
    char text[160];
    std::snprintf(text, sizeof(text),
                  ": point %zu is %.3f m from the sensor, the frame has %.3f m there: these are "
                  "labels of another frame",
                  i, found, expected);
    throw Error(where + text);
  }
}

/// The planes that the image names, with the class that most of their pixels have.
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

/// Where the format tells planes only, each takes the class of its tilt, and none where nobody
/// knows gravity.
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

FrameLabels labels_of_points(const LabelledPoints& points,
                             const LabelGrid& grid,
                             const std::string& depth_sha256,
                             const std::string& where) {
  if (grid.is_cloud() && (points.width > 0 || !points.pixel.empty()))
    throw Error(where + ": labels of the pixels of a depth image, the frame is a cloud");
  if (points.width > 0 && (points.width != grid.width || points.height != grid.height))
    throw Error(where + ": labels of a depth image of " + size_text(points.width, points.height) +
                ", the frame's is " + size_text(grid.width, grid.height));
  // A format that lists labelled pixels alone may list none: that is not raster order.
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
