#include "core/labels/exchange/exchange.hpp"

#include <cassert>

#include "core/io/readers.hpp"
#include "core/labels/exchange/exchange_files.hpp"
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
    case LabelFormat::coco:
      need(points.width > 0 && points.pixel.size() == points.size(), stem, format,
           "pixels and the size of the depth image");
      return {{named(".json"), coco_bytes(points, stem.filename().string())}};
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
  points.width = grid.width;
  points.height = grid.height;
  points.planes = labels.planes;
  points.T_world_sensor = planes::world_from_gravity(labels.gravity.direction, true);
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

}  // namespace planescope::labels
