// Recordings of single depth images: folders of PNG, and snapshots of the RealSense Viewer.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <set>

#include "core/io/byte_reader.hpp"
#include "core/io/folder/folder_files.hpp"
#include "core/io/image/photo.hpp"
#include "core/io/image/png.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

/// 16-bit counts without a header.
Image16 read_counts(const fs::path& path, int width, int height) {
  const MappedFile file(path);
  Image16 depth(width, height);
  if (file.bytes().size() != depth.pixels() * sizeof(std::uint16_t))
    throw Error(path.string() + ": the file has changed since it was opened");
  std::memcpy(depth.data.data(), file.bytes().data(), file.bytes().size());
  file.expect_whole();
  return depth;
}

/// The size in the calibration or, without one, the RealSense camera mode with this number of
/// pixels: no two modes have the same number. Throws Error if neither fits.
PngInfo dump_info(const fs::path& path, const Intrinsics& known) {
  constexpr std::pair<int, int> kModes[] = {{1280, 800}, {1280, 720}, {1024, 768}, {848, 480},
                                            {640, 480},  {640, 400},  {640, 360},  {480, 270},
                                            {424, 240},  {320, 240},  {256, 144},  {848, 100}};
  std::error_code failed;
  const std::uintmax_t bytes = fs::file_size(path, failed);
  const auto fits = [&](int width, int height) {
    return bytes > 0 &&
           bytes == sizeof(std::uint16_t) * static_cast<std::uintmax_t>(width) * height;
  };
  if (fits(known.width, known.height)) return {known.width, known.height, 1, 16};
  for (const auto& [width, height] : kModes)
    if (known.width == 0 && fits(width, height)) return {width, height, 1, 16};
  throw Error(fmt::format(
      "{}: {} bytes; expected {}", path.string(), bytes,
      known.width > 0 ? fmt::format("{}x{} pixels at 2 bytes each", known.width, known.height)
                      : "the size of a RealSense depth mode at 2 bytes per pixel, or a "
                        "calibration file with width and height"));
}

Image8 read_picture(const fs::path& path) {
  return extension(path) == ".png" ? read_png_rgb(path) : read_jpeg_rgb(path);
}

class FolderRecording : public Recording {
 public:
  FolderRecording(const fs::path& path, const RecordingOptions& options);

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(layout_.depth.size()); }
  Frame frame(int i) const override;
  double timestamp_s(int i) const override { return time_s_.at(i); }
  std::optional<Pose> T_world_camera(int i) const override;
  std::string frame_hash(int i) const override { return sha256_of_depth(read_depth(i)); }

 private:
  void find_images(const fs::path& path);
  void report_missing_depth();
  void check_depth(const fs::path& path, const Intrinsics& known);
  void check_images(const Intrinsics& known);
  CameraFiles find_camera(const fs::path& path) const;
  Image8 first_picture(fs::path& file) const;
  void settle_color(const CameraFiles& camera);
  void settle_times();
  Image16 read_depth(int i) const;

  fs::path folder_;                        // of the images and their lists; empty: a single image
  std::size_t first_ = 0, in_folder_ = 0;  // of depth images: index of the first frame; count
  FolderLayout layout_;
  std::vector<double> time_s_;  // by frame; 0 where unknown
  std::optional<Accelerometer> accelerometer_;
  RecordingInfo info_;
  Sidecar sidecar_;
  bool reads_color_ = true, color_aligned_ = false;
  Intrinsics color_intrinsics_;
  Pose T_color_depth_ = Pose::Identity();
};

FolderRecording::FolderRecording(const fs::path& path, const RecordingOptions& options)
    : sidecar_(read_sidecar(path)), reads_color_(options.color) {
  info_.path = path;
  find_images(path);
  settle_times();
  info_.warnings = layout_.warnings;
  const CameraFiles camera = find_camera(path);
  check_images(sidecar_.intrinsics.value_or(camera.depth.intrinsics.value_or(Intrinsics())));
  if (!options.intrinsics && !sidecar_.intrinsics) info_.ignored_calibration = camera.ignored;
  settle_camera(options, sidecar_, camera.depth, info_);
  settle_color(camera);
}

/// Finds the images of a folder, or a single depth image with its color image in the same folder.
void FolderRecording::find_images(const fs::path& path) {
  std::error_code ignored;
  if (fs::is_directory(path, ignored)) {
    info_.format = "folder of images";
    folder_ = path;
    layout_ = find_folder_layout(path);
    in_folder_ = layout_.depth.size();
    report_missing_depth();
    return;
  }
  info_.format = "depth image";
  layout_.depth = {path};
  layout_.color = {fs::path{}};
  layout_.time_s = {std::nullopt};
  const fs::path folder = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (sidecar_.path.empty()) sidecar_ = read_sidecar(folder);
  // The color image for depth/000.png is in a folder beside depth/.
  const bool in_depth_folder =
      fs::absolute(folder, ignored).lexically_normal().filename() == "depth";
  for (const fs::path& root : {in_depth_folder ? folder / ".." : folder, folder}) {
    const FolderLayout around = find_folder_layout(root);
    for (std::size_t i = 0; i < around.depth.size(); ++i) {
      if (fs::equivalent(around.depth[i], path, ignored)) {
        layout_.color = {around.color[i]};
        layout_.time_s = {around.time_s[i]};
        layout_.times_source = around.times_source;
        layout_.tum = around.tum;
        folder_ = root;
        first_ = i;
        in_folder_ = around.depth.size();
        return;
      }
    }
  }
}

void FolderRecording::report_missing_depth() {
  std::set<std::string> present;
  for (const fs::path& depth : layout_.depth) present.insert(depth.stem().string());
  std::vector<std::string> missing;
  for (const Sidecar::FrameFacts& facts : sidecar_.frames)
    if (!present.contains(facts.name)) missing.push_back(facts.name);
  if (!missing.empty())
    layout_.warnings.push_back(
        fmt::format("{} of the {} in {} have no depth image; the first is {}", missing.size(),
                    counted(sidecar_.frames.size(), "frame"), sidecar_.path.filename().string(),
                    missing.front()));
}

/// Times come from the sidecar, lists or file names, else from poses.tum; they select the
/// accelerometer samples for gravity.
void FolderRecording::settle_times() {
  const bool by_sidecar = has_times(sidecar_);
  for (std::size_t i = 0; i < layout_.depth.size(); ++i) {
    const Sidecar::FrameFacts* facts = facts_of(sidecar_, layout_.depth[i].stem().string());
    const std::optional<double> time_s =
        by_sidecar && facts ? facts->timestamp_s : std::optional<double>();
    time_s_.push_back(time_s ? *time_s : layout_.time_s[i].value_or(0));
  }
  info_.times_source =
      by_sidecar ? sidecar_.path.filename().string() : std::move(layout_.times_source);
  if (folder_.empty()) return;
  if (info_.times_source.empty()) {
    const auto times = times_of_poses(folder_, in_folder_, layout_.warnings);
    for (std::size_t i = 0; i < time_s_.size() && !times.empty(); ++i)
      time_s_[i] = times[first_ + i];
    if (!times.empty()) info_.times_source = "poses.tum";
  }
  if (file_beside_images(folder_, Accelerometer::kFile).empty()) return;
  const auto ignore = [&](const std::string& why) {
    layout_.warnings.push_back(fmt::format("{}: ignored: {}", Accelerometer::kFile, why));
  };
  if (info_.times_source.empty()) return ignore("the frames have no times");
  Accelerometer read(folder_);
  if (std::ranges::none_of(time_s_, [&](double time_s) { return read.covers(time_s); }))
    return ignore(fmt::format("no sample is within {} s of a frame", Accelerometer::kReach_s));
  accelerometer_ = std::move(read);
}

void FolderRecording::check_depth(const fs::path& path, const Intrinsics& known) {
  expect_regular_file(path);
  const bool is_dump = is_depth_dump(path);
  const PngInfo image = is_dump ? dump_info(path, known) : png_info(path);
  if (image.channels != 1 || image.bit_depth != 16)
    throw Error(
        fmt::format("{}: {}-bit PNG with {}; expected depth in a 16-bit PNG with one channel (a "
                    "colorized depth image contains no distances{})",
                    path.string(), image.bit_depth, counted(image.channels, "channel"),
                    lower_case(path.stem().string()).find("_depth_") == std::string::npos
                        ? ""
                        : "; rs-convert writes depth with -r"));
  if (!is_dump && png_is_cut(path)) throw Error(path.string() + ": the PNG is truncated");
  if (info_.width == 0) {
    info_.width = image.width;
    info_.height = image.height;
  }
  if (image.width != info_.width || image.height != info_.height)
    throw Error(
        fmt::format("{}: the depth image is {}x{}; expected {}x{}, the size of the first one",
                    path.string(), image.width, image.height, info_.width, info_.height));
}

/// Looks at the ends of every file, so that damaged frames are known before work starts.
void FolderRecording::check_images(const Intrinsics& known) {
  find_damaged_frames(layout_.depth.size(), info_, [&](std::size_t i) {
    check_depth(layout_.depth[i], known);
    const fs::path& color = layout_.color[i];
    if (!color.empty() && extension(color) == ".png" && png_is_cut(color))
      throw Error(color.string() + ": the PNG is truncated");
  });
}

/// Looks for calibration beside the images and one folder up.
CameraFiles FolderRecording::find_camera(const fs::path& path) const {
  std::vector<fs::path> folders = {path, layout_.depth.front().parent_path()};
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) folders.erase(folders.begin());
  const fs::path last = fs::absolute(folders.back(), ignored).lexically_normal();
  if (last.filename() == "depth") folders.push_back(last.parent_path());
  std::vector<std::string> not_read;
  for (const fs::path& folder : folders) {
    CameraFiles camera = find_camera_files(folder.empty() ? fs::path(".") : folder);
    for (const std::string& file : camera.ignored)
      if (std::ranges::find(not_read, file) == not_read.end()) not_read.push_back(file);
    camera.ignored = not_read;
    if (camera.depth.intrinsics) return camera;
  }
  CameraFiles camera;
  camera.ignored = std::move(not_read);
  if (layout_.tum) {
    // https://cvg.cit.tum.de/data/datasets/rgbd-dataset/file_formats
    camera.depth.intrinsics = Intrinsics{0, 0, 525, 525, 319.5, 239.5, Distortion::none, {}};
    camera.depth.intrinsics_source = "assumed (TUM RGB-D default)";
    camera.depth.depth_unit_m = 1.0 / 5000;
    camera.depth.depth_unit_source = "assumed (TUM RGB-D convention)";
  }
  return camera;
}

/// The first color image that can be read. Throws the first Error if there is none.
Image8 FolderRecording::first_picture(fs::path& file) const {
  std::optional<Error> damage;
  for (const fs::path& color : layout_.color) {
    if (color.empty()) continue;
    try {
      file = color;
      return read_picture(color);
    } catch (const Error& error) {
      if (!damage) damage = error;
    }
  }
  throw Error(*damage);
}

void FolderRecording::settle_color(const CameraFiles& camera) {
  info_.has_color = layout_.has_color();
  if (!info_.has_color) {
    info_.color_note = "none";
    return;
  }
  fs::path file;
  const Image8 color = first_picture(file);
  const bool same_size = color.width == info_.width && color.height == info_.height;
  if (sidecar_.color_aligned && *sidecar_.color_aligned) {
    if (!same_size)
      throw Error(fmt::format(
          "{}: the color image is {}x{}; expected {}x{}, because {} declares it aligned with depth",
          file.string(), color.width, color.height, info_.width, info_.height,
          sidecar_.path.filename().string()));
    color_aligned_ = true;
    info_.color_note = "aligned";
    if (camera.color && reads_color_) add_view_warning(color.width, camera.color->fx, info_);
  } else if (sidecar_.color_intrinsics || (camera.color && camera.T_color_depth)) {
    color_intrinsics_ = sidecar_.color_intrinsics.value_or(camera.color.value_or(Intrinsics()));
    color_intrinsics_.width = color.width;
    color_intrinsics_.height = color.height;
    T_color_depth_ = sidecar_.color_intrinsics ? sidecar_.T_color_depth : *camera.T_color_depth;
    info_.color_note = "projected by extrinsics";
  } else if (same_size && !camera.color && !sidecar_.color_aligned) {
    color_aligned_ = true;
    info_.color_note = "assumed aligned (same size, one set of intrinsics)";
  } else {
    info_.color_note = fmt::format("display only: {}x{} color without depth-to-color extrinsics",
                                   color.width, color.height);
  }
  if (color_aligned_) color_intrinsics_ = info_.intrinsics;
}

Image16 FolderRecording::read_depth(int i) const {
  expect_undamaged(info_, i);
  const fs::path& path = layout_.depth.at(i);
  if (is_depth_dump(path)) return read_counts(path, info_.width, info_.height);
  Image16 depth = read_png_16(path);
  if (depth.width != info_.width || depth.height != info_.height) {
    throw Error(layout_.depth[i].string() + ": the file has changed since it was opened");
  }
  return depth;
}

std::optional<Pose> FolderRecording::T_world_camera(int i) const {
  const Sidecar::FrameFacts* facts = facts_of(sidecar_, layout_.depth.at(i).stem().string());
  return facts ? facts->T_world_camera : std::nullopt;
}

Frame FolderRecording::frame(int i) const {
  Frame frame;
  frame.index = i;
  frame.depth = read_depth(i);
  frame.name = layout_.depth[i].stem().string();
  frame.depth_unit_m = info_.depth_unit_m;
  frame.intrinsics = info_.intrinsics;
  if (reads_color_ && !layout_.color[i].empty()) {
    frame.color = read_picture(layout_.color[i]);
    frame.color_aligned = color_aligned_ && frame.color.width == frame.depth.width &&
                          frame.color.height == frame.depth.height;
    frame.color_intrinsics = color_intrinsics_;
    frame.T_color_depth = T_color_depth_;
  }
  if (accelerometer_) frame.gravity = accelerometer_->gravity_at(time_s_[i]);
  apply_sidecar(sidecar_, frame);
  frame.timestamp_s = time_s_[i];
  return frame;
}

}  // namespace

std::unique_ptr<Recording> open_image_folder(const fs::path& path,
                                             const RecordingOptions& options) {
  return std::make_unique<FolderRecording>(path, options);
}

// ---- Snapshots of the RealSense Viewer: headerless 16-bit little-endian counts in X.raw,
// described in X_metadata.csv. The picture X.png beside them is colored, not depth ----

namespace {

constexpr std::string_view kCsvEnd = "_metadata.csv";

/// The `key,value` lines of the metadata.
class Metadata {
 public:
  explicit Metadata(const fs::path& path) : path_(path) {
    constexpr std::uintmax_t kMaxBytes = 1 << 20;
    const auto bytes = read_file_bytes(path, kMaxBytes);
    const std::string text(bytes.begin(), bytes.end());
    for (std::string& line : split(std::string(without_byte_order_mark(text)), '\n')) {
      if (line.ends_with('\r')) line.pop_back();
      if (const std::size_t comma = line.find(','); comma != std::string::npos)
        values_.emplace(line.substr(0, comma), line.substr(comma + 1));
    }
  }

  std::string text(const std::string& key) const {
    const auto found = values_.find(key);
    return found == values_.end() ? "" : found->second;
  }
  double number(const std::string& key) const {
    const auto value = parse_number(text(key));
    if (!value)
      throw Error(
          fmt::format("{}: \"{}\" is \"{}\"; expected a number", path_.string(), key, text(key)));
    return *value;
  }

 private:
  fs::path path_;
  std::map<std::string, std::string> values_;
};

class RawRecording : public Recording {
 public:
  RawRecording(const fs::path& path, const RecordingOptions& options)
      : files_(viewer_raw_files(path)), sidecar_(read_sidecar(path)) {
    info_.path = path;
    info_.format = "RealSense Viewer raw";
    info_.color_note = "none";
    if (files_.empty())
      throw Error(path.string() +
                  ": not RealSense Viewer depth; expected X.raw with X_metadata.csv of type "
                  "Depth and format Z16");
    CameraFacts facts;
    find_damaged_frames(files_.size(), info_, [&](std::size_t i) { facts = check(files_[i]); });
    info_.times_source = has_times(sidecar_)       ? sidecar_.path.filename().string()
                         : time_of(files_[0]) != 0 ? files_[0].csv.filename().string()
                                                   : "";
    settle_camera(options, sidecar_, facts, info_);
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(files_.size()); }
  Frame frame(int i) const override {
    Frame frame;
    frame.index = i;
    frame.name = files_.at(i).raw.stem().string();
    frame.timestamp_s = time_of(files_[i]);
    frame.depth = read_depth(i);
    frame.depth_unit_m = info_.depth_unit_m;
    frame.intrinsics = info_.intrinsics;
    apply_sidecar(sidecar_, frame);
    return frame;
  }
  double timestamp_s(int i) const override {
    return time_of_frame(sidecar_, files_.at(i).raw.stem().string(), time_of(files_[i]));
  }
  std::string frame_hash(int i) const override { return sha256_of_depth(read_depth(i)); }

 private:
  static double time_of(const RawFile& file) {
    return 1e-3 * parse_number(Metadata(file.csv).text("Timestamp (ms)")).value_or(0);
  }
  /// Checks the sizes of a snapshot against each other and against the first one.
  CameraFacts check(const RawFile& file) {
    expect_regular_file(file.raw);
    const Metadata metadata(file.csv);
    const double width = metadata.number("Resolution x"), height = metadata.number("Resolution y");
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(file.raw, error);
    const bool sane = width >= 1 && height >= 1 && width <= 1 << 15 && height <= 1 << 15;
    if (error || !sane || static_cast<double>(bytes) != 2 * width * height)
      throw Error(
          fmt::format("{}: {} bytes; expected {}x{} pixels at 2 bytes each, according to {}",
                      file.raw.string(), bytes, metadata.text("Resolution x"),
                      metadata.text("Resolution y"), file.csv.filename().string()));
    if (info_.width == 0) {
      info_.width = static_cast<int>(width);
      info_.height = static_cast<int>(height);
    }
    if (info_.width != width || info_.height != height)
      throw Error(file.raw.string() +
                  ": its size differs from that of the first snapshot in its folder");
    const auto number = [&](const char* key) { return metadata.number(key); };
    CameraFacts facts;
    facts.intrinsics = {info_.width,   info_.height,  number("Fx"),     number("Fy"),
                        number("PPx"), number("PPy"), Distortion::none, {}};
    facts.intrinsics_source = file.csv.filename().string();
    return facts;
  }

  Image16 read_depth(int i) const {
    expect_undamaged(info_, i);
    return read_counts(files_.at(i).raw, info_.width, info_.height);
  }

  RecordingInfo info_;
  std::vector<RawFile> files_;
  Sidecar sidecar_;
};

}  // namespace

std::vector<RawFile> viewer_raw_files(const fs::path& path) {
  std::error_code ignored;
  std::vector<fs::path> raws;
  if (fs::is_directory(path, ignored)) {
    for (const fs::path& file : entries_in(path))
      if (extension(file) == ".raw") raws.push_back(file);
  } else if (extension(path) == ".csv") {
    const std::string name = path.filename().string();
    if (!name.ends_with(kCsvEnd)) return {};
    raws = {path.parent_path() / (name.substr(0, name.size() - kCsvEnd.size()) + ".raw")};
  } else {
    raws = {path};
  }
  std::vector<RawFile> found;
  for (const fs::path& raw : raws) {
    const fs::path csv = raw.parent_path() / (raw.stem().string() + std::string(kCsvEnd));
    if (!fs::exists(csv, ignored)) continue;
    const Metadata metadata(csv);
    if (metadata.text("Type") == "Depth" && metadata.text("Format") == "Z16")
      found.push_back({raw, csv});
  }
  return found;
}

std::unique_ptr<Recording> open_viewer_raw(const fs::path& path, const RecordingOptions& options) {
  return std::make_unique<RawRecording>(path, options);
}

}  // namespace planescope::io
