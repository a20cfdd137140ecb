#pragma once

// Files of COCO: one for all frames of a recording.

#include <cstddef>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/io/byte_reader.hpp"
#include "core/labels/exchange/exchange.hpp"
#include "core/model/types.hpp"

namespace planescope::labels {

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
