#pragma once

// Labels in other tools' formats (docs/labels.md describes each layout).
//
//   evops     .npy      int32 plane id per measured pixel in raster order, 0 none
//   ply, pcd            x y z [rgb] label instance u v; 1 point per measured pixel
//                       clouds (in all formats): 1 point per point, in their order; no u v
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
/// All formats, or only the readable ones.
std::vector<LabelFormat> label_formats(bool read_back);
/// Throws Error that lists the formats.
LabelFormat parse_label_format(const std::string& name);
/// By a file's extension; a .ply is `ply`, and .bin and .label are both `kitti`. Throws Error.
LabelFormat label_format_of(const std::filesystem::path& path);
const char* to_string(LabelFormat format);
const char* extension_of(LabelFormat format);  // ".npy"; of the file to read

/// Column and row in the depth image.
struct DepthPixel {
  std::uint16_t u = 0, v = 0;

  bool operator==(const DepthPixel&) const = default;
};

/// Points with labels, independent of format: the input and output of every format.
struct LabeledPoints {
  std::vector<Vec3f> points;               // sensor frame [m]; empty if the format has none
  Vec3d origin = Vec3d::Zero();            // of clouds far from 0: origin of the points
  std::vector<std::uint8_t> rgb;           // 3 per point, or empty
  std::vector<std::uint8_t> label;         // 0 unknown, 1 h, 2 v, kHvIgnore; may be empty
  std::vector<std::int32_t> instance;      // plane id, 0 none, kPlaneIgnore
  std::vector<DepthPixel> pixel;           // empty if the format has none
  int width = 0, height = 0;               // of the depth image, 0 if unknown
  std::vector<LabelPlane> planes;          // if the format contains them
  Pose T_world_sensor = Pose::Identity();  // z up; frame of `voxels`

  std::size_t size() const { return instance.size(); }
};

LabeledPoints points_of_labels(const FrameLabels& labels, const LabelGrid& grid);

/// `stem`: the path without extension. Writes one or two files, each completely or not at all, and
/// returns their paths. `voxel_size_m`: only for `voxels`.
std::vector<std::filesystem::path> write_labeled(const std::filesystem::path& stem,
                                                 LabelFormat format,
                                                 const LabeledPoints& points,
                                                 double voxel_size_m = 0.02);
/// `path`: one of the files. Throws Error naming the file, what was found and what was expected.
/// `voxels` are averages of points and cannot be read.
LabeledPoints read_labeled(const std::filesystem::path& path, LabelFormat format);

/// Transfers labels to the pixels of a frame, or to the points of a cloud: by `pixel` if the format
/// has it, otherwise one by one in raster order of measured pixels (or of all pixels, if the number
/// matches). Planes are fitted again; without `label`, planes are classified by tilt. Pixels
/// without depth get no label. Throws Error naming `where` if counts or sizes do not match, or the
/// points' distances from the sensor differ from the frame's; nothing is resized or guessed.
FrameLabels labels_of_points(const LabeledPoints& points,
                             const LabelGrid& grid,
                             const std::string& depth_sha256,
                             const std::string& where);

// COCO files: one for all frames of a recording.

/// The file of an export with all frames, and the folder with their pictures.
inline constexpr const char* kCocoFileName = "annotations.json";
inline constexpr const char* kCocoPictures = "images";

/// A parsed file with any number of images. Throws Error naming `where` if it is damaged.
class CocoFile {
 public:
  CocoFile(io::Bytes file, const std::string& where);

  const std::vector<std::string>& names() const { return names_; }  // file_name of each image
  /// The image with a file named 000123 and any extension; nullopt if there is none.
  std::optional<std::size_t> image_of_frame(int frame) const;
  LabeledPoints points(std::size_t image) const;

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

  void add(const LabeledPoints& points, const std::string& file_name);
  std::vector<unsigned char> bytes() const;

 private:
  struct Made;
  std::unique_ptr<Made> made_;
};

/// Picture under the annotations: aligned color, else depth in gray, bright for near.
Image8 coco_picture(const LabelGrid& grid);

}  // namespace planescope::labels
