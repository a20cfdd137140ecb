#include <algorithm>
#include <map>

#include "core/io/byte_reader.hpp"
#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

// Snapshots of the RealSense Viewer: headerless 16-bit little-endian counts in X.raw, what they
// are in X_metadata.csv. The picture X.png beside them is coloured, no depth.
namespace planescope::io {
namespace {

namespace fs = std::filesystem;

constexpr std::uintmax_t kMaxCsvBytes = 1 << 20;
constexpr std::string_view kCsvEnd = "_metadata.csv";

/// The `key,value` lines of the metadata.
class Metadata {
 public:
  explicit Metadata(const fs::path& path) : path_(path) {
    const auto bytes = read_file_bytes(path, kMaxCsvBytes);
    std::string_view text =
        without_byte_order_mark({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      std::string_view line = text.substr(0, end);
      text.remove_prefix(std::min(end + 1, text.size()));
      if (line.ends_with('\r')) line.remove_suffix(1);
      const std::size_t comma = line.find(',');
      if (comma == std::string_view::npos) continue;
      values_.emplace(line.substr(0, comma), line.substr(comma + 1));
    }
  }

  std::string text(const std::string& key) const {
    const auto found = values_.find(key);
    return found == values_.end() ? "" : found->second;
  }
  double number(const std::string& key) const {
    const auto value = parse_number(text(key));
    if (!value) {
      throw Error(path_.string() + ": \"" + key + "\" is \"" + text(key) + "\", expected a number");
    }
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
    if (files_.empty()) {
      throw Error(path.string() +
                  ": no depth of the RealSense Viewer: expected X.raw with X_metadata.csv of type "
                  "Depth and format Z16");
    }
    CameraFacts facts;
    for (const RawFile& file : files_) facts = check(file);
    info_.times_source = tells_times(sidecar_)     ? sidecar_.path.filename().string()
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
    Frame facts;
    facts.name = files_.at(i).raw.stem().string();
    facts.timestamp_s = time_of(files_[i]);
    apply_sidecar(sidecar_, facts);
    return facts.timestamp_s;
  }

  std::string frame_hash(int i) const override { return sha256_of_depth(read_depth(i)); }

 private:
  static double time_of(const RawFile& file) {
    return 1e-3 * parse_number(Metadata(file.csv).text("Timestamp (ms)")).value_or(0);
  }
  /// Sizes of one snapshot against each other and against the first.
  CameraFacts check(const RawFile& file) {
    const Metadata metadata(file.csv);
    const double width = metadata.number("Resolution x");
    const double height = metadata.number("Resolution y");
    std::error_code error;
    const std::uintmax_t bytes = fs::file_size(file.raw, error);
    const bool sane = width >= 1 && height >= 1 && width <= 1 << 15 && height <= 1 << 15;
    if (error || !sane || static_cast<double>(bytes) != 2 * width * height) {
      throw Error(file.raw.string() + ": " + std::to_string(bytes) + " bytes, expected " +
                  metadata.text("Resolution x") + "x" + metadata.text("Resolution y") +
                  " counts of 2 bytes as " + file.csv.filename().string() + " says");
    }
    if (info_.width == 0) {
      info_.width = static_cast<int>(width);
      info_.height = static_cast<int>(height);
    }
    if (info_.width != width || info_.height != height) {
      throw Error(file.raw.string() + ": of another size than the first snapshot in its folder");
    }
    CameraFacts facts;
    Intrinsics k{info_.width,
                 info_.height,
                 metadata.number("Fx"),
                 metadata.number("Fy"),
                 metadata.number("PPx"),
                 metadata.number("PPy"),
                 Distortion::none,
                 {}};
    facts.intrinsics = k;
    facts.intrinsics_source = file.csv.filename().string();
    return facts;
  }

  Image16 read_depth(int i) const {
    const MappedFile file(files_.at(i).raw);
    Image16 depth(info_.width, info_.height);
    if (file.bytes().size() != depth.pixels() * sizeof(std::uint16_t)) {
      throw Error(files_[i].raw.string() + ": the file has changed since it was opened");
    }
    std::memcpy(depth.data.data(), file.bytes().data(), file.bytes().size());
    file.expect_whole();
    return depth;
  }

  RecordingInfo info_;
  std::vector<RawFile> files_;
  Sidecar sidecar_;
};

fs::path csv_of(const fs::path& raw) {
  return raw.parent_path() / (raw.stem().string() + std::string(kCsvEnd));
}

}  // namespace

std::vector<RawFile> viewer_raw_files(const fs::path& path) {
  std::error_code ignored;
  std::vector<fs::path> raws;
  if (fs::is_directory(path, ignored)) {
    for (const fs::path& file : files_in(path)) {
      if (extension(file) == ".raw") raws.push_back(file);
    }
  } else if (extension(path) == ".csv") {
    const std::string name = path.filename().string();
    if (!name.ends_with(kCsvEnd)) return {};
    raws = {path.parent_path() / (name.substr(0, name.size() - kCsvEnd.size()) + ".raw")};
  } else {
    raws = {path};
  }
  std::vector<RawFile> found;
  for (const fs::path& raw : raws) {
    const fs::path csv = csv_of(raw);
    if (!fs::exists(raw, ignored) || !fs::exists(csv, ignored)) continue;
    const Metadata metadata(csv);
    if (metadata.text("Type") == "Depth" && metadata.text("Format") == "Z16") {
      found.push_back({raw, csv});
    }
  }
  return found;
}

std::unique_ptr<Recording> open_viewer_raw(const fs::path& path, const RecordingOptions& options) {
  return std::make_unique<RawRecording>(path, options);
}

}  // namespace planescope::io
