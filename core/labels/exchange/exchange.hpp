#pragma once

// Labels in other tools' formats (docs/labels.md tells each one's layout).
//
//   evops     .npy      int32 plane id per measured pixel in raster order, 0 none
//   ply, pcd            x y z [rgb] label instance u v; 1 point per measured pixel
//                       of a cloud without u v; 1 point per point, in the cloud's order, as in all
//   kitti     .bin + .label   float32 x y z remission; uint32 instance << 16 | class
//   npz                 arrays points, [rgb,] label, instance, pixel, depth_size
//   coco      .json     one annotation per plane: run-length mask, box, area, plane parameters;
//                       one file may have several images
//   voxels    .voxels.ply     mean of each voxel's points, upright; majority of their labels

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/io/byte_reader.hpp"
#include "core/labels/model/grid.hpp"

namespace planescope::labels {

enum class LabelFormat : std::uint8_t { evops, ply, pcd, kitti, npz, coco, voxels };
/// All, or those that are read back alone.
std::vector<LabelFormat> label_formats(bool read_back);
/// Throws Error that lists them.
LabelFormat parse_label_format(const std::string& name);
/// By a file's extension; a .ply is `ply`, and .bin and .label are both `kitti`. Throws Error.
LabelFormat label_format_of(const std::filesystem::path& path);
const char* to_string(LabelFormat format);
const char* extension_of(LabelFormat format);  // ".npy"; of the file that it is read by

/// Column and row in the depth image.
struct DepthPixel {
  std::uint16_t u = 0, v = 0;

  bool operator==(const DepthPixel&) const = default;
};

/// Points with labels, however they are kept: what every format is read into and written from.
struct LabelledPoints {
  std::vector<Vec3f> points;           // sensor frame [m]; empty where the format has none
  Vec3d origin = Vec3d::Zero();        // of a cloud far from 0: what points are about
  std::vector<std::uint8_t> rgb;       // 3 per point, or empty
  std::vector<std::uint8_t> label;     // 0 unknown, 1 h, 2 v, kHvIgnore; empty where it has none
  std::vector<std::int32_t> instance;  // plane id, 0 none, kPlaneIgnore
  std::vector<DepthPixel> pixel;       // empty where the format has none
  int width = 0, height = 0;           // of the depth image, 0 where the format does not say
  std::vector<LabelPlane> planes;      // where the format carries them
  Pose T_world_sensor = Pose::Identity();  // z up; what `voxels` are written in

  std::size_t size() const { return instance.size(); }
};

LabelledPoints points_of_labels(const FrameLabels& labels, const LabelGrid& grid);

/// `stem`: the path without extension; one or two files are written, each whole or not at all.
/// Returns their paths. `voxel_size_m`: of `voxels` only.
std::vector<std::filesystem::path> write_labelled(const std::filesystem::path& stem,
                                                  LabelFormat format,
                                                  const LabelledPoints& points,
                                                  double voxel_size_m = 0.02);
/// `path`: one of the files. Throws Error naming the file, what was found and what was expected;
/// `voxels`, which were points once, are not read.
LabelledPoints read_labelled(const std::filesystem::path& path, LabelFormat format);

/// Onto the pixels of a frame, or one by one onto the points of a cloud: by `pixel` where the
/// format has it, otherwise one by one in raster order of measured pixels (or of all pixels, where
/// there are as many). Planes are fitted anew; without `label` a plane's class is that of its tilt.
/// Pixels without depth keep no label. Throws Error naming `where` when counts or sizes do not
/// match, or the points are not as far from the sensor as the frame's; nothing is resized or
/// guessed.
FrameLabels labels_of_points(const LabelledPoints& points,
                             const LabelGrid& grid,
                             const std::string& depth_sha256,
                             const std::string& where);

// Files of COCO: one for all frames of a recording.

/// The file of an export with all frames, and the folder with their pictures.
inline constexpr const char* kCocoFileName = "annotations.json";
inline constexpr const char* kCocoPictures = "images";

/// A file that was read, of any number of images. Throws Error naming `where` when it is damaged.
class CocoFile {
 public:
  CocoFile(io::Bytes file, const std::string& where);

  const std::vector<std::string>& names() const { return names_; }  // file_name of each image
  /// The image whose file is named 000123 and any ending; nullopt where there is none.
  std::optional<std::size_t> image_of_frame(int frame) const;
  LabelledPoints points(std::size_t image) const;

 private:
  struct Parsed;
  std::shared_ptr<const Parsed> parsed_;
  std::vector<std::string> names_;
};
CocoFile read_coco(const std::filesystem::path& path);

/// Images and annotations are numbered from 1 in the order of add().
class CocoWriter {
 public:
  CocoWriter();
  ~CocoWriter();

  void add(const LabelledPoints& points, const std::string& file_name);
  std::vector<unsigned char> bytes() const;

 private:
  struct Made;
  std::unique_ptr<Made> made_;
};

/// What annotations are drawn on: aligned color, else depth in gray, near is bright.
Image8 coco_picture(const LabelGrid& grid);

}  // namespace planescope::labels
