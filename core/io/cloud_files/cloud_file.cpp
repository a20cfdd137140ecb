// Recordings of point clouds, collection of points for readers, and writers.

#include "core/io/cloud_files/cloud_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstring>
#include <limits>

#include "core/io/readers.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;

PointSet read_with_instances(const fs::path& path, const std::string& field) {
  CloudExtras extras{{field}, {}};
  PointSet set = read_cloud_file(path, &extras);
  take_instances(set, extras, path.string());
  return set;
}

class CloudRecording : public Recording {
 public:
  CloudRecording(const fs::path& path, std::string instance_field)
      : instance_field_(std::move(instance_field)), sidecar_(read_sidecar(path)) {
    info_.path = path;
    info_.depth_unit_m = 1;
    info_.depth_unit_source = "meters (convention for clouds)";
    info_.color_note = "in the cloud, if it has any";
    if (has_times(sidecar_)) info_.times_source = sidecar_.path.filename().string();
    std::error_code ignored;
    const bool folder = fs::is_directory(path, ignored);
    files_ = folder ? cloud_files_under(path) : std::vector<fs::path>{path};
    info_.format = files_.size() == 1 ? "point cloud" : "folder of point clouds";
    find_damaged_frames(files_.size(), info_, [&](std::size_t i) {
      expect_regular_file(files_[i]);
      if (const CloudFormat* format = cloud_format_of(files_[i]); format && format->check)
        format->check(files_[i]);
    });
    for (const fs::path& file : files_) {
      const fs::path name = folder ? file.lexically_relative(path) : file.filename();
      names_.push_back((name.parent_path() / name.stem()).string());
    }
  }

  const RecordingInfo& info() const override { return info_; }
  int frame_count() const override { return static_cast<int>(files_.size()); }

  Frame frame(int i) const override {
    expect_undamaged(info_, i);
    Frame frame;
    frame.index = i;
    frame.name = names_.at(i);
    frame.depth_unit_m = info_.depth_unit_m;
    frame.cloud = instance_field_.empty() ? read_cloud_file(files_.at(i))
                                          : read_with_instances(files_.at(i), instance_field_);
    apply_sidecar(sidecar_, frame);
    return frame;
  }

  double timestamp_s(int i) const override { return time_of_frame(sidecar_, names_.at(i), 0); }

  std::string frame_hash(int i) const override {
    expect_undamaged(info_, i);
    return sha256_of_cloud(read_cloud_file(files_.at(i)));
  }

 private:
  RecordingInfo info_;
  std::string instance_field_;
  Sidecar sidecar_;
  std::vector<fs::path> files_;
  std::vector<std::string> names_;
};

std::vector<CloudFormat>& formats_of_clouds() {
  static std::vector<CloudFormat> formats = {{".ply", read_ply, check_ply},
                                             {".pcd", read_pcd, check_pcd}};
  return formats;
}

}  // namespace

const std::vector<CloudFormat>& cloud_formats() { return formats_of_clouds(); }
void add_cloud_format(const CloudFormat& format) { formats_of_clouds().push_back(format); }

const CloudFormat* cloud_format_of(const fs::path& path) {
  const auto format = std::ranges::find(cloud_formats(), extension(path), &CloudFormat::extension);
  return format == cloud_formats().end() ? nullptr : &*format;
}

PointSet read_cloud_file(const fs::path& path, CloudExtras* extras) {
  if (extras) extras->values.assign(extras->names.size(), {});
  const CloudFormat* format = cloud_format_of(path);
  return format ? format->read(path, extras) : read_pcd(path, extras);
}

void take_instances(PointSet& set, const CloudExtras& extras, const std::string& what) {
  const std::string& field = extras.names[0];
  const std::vector<double>& values = extras.values[0];
  if (values.size() != set.points.size())
    throw Error(
        fmt::format("{}: points have no '{}' field; expected a field with plane ids", what, field));
  set.instance.clear();
  for (const double value : values) {
    if (!(value == std::floor(value) && std::abs(value) <= 1e9))
      throw Error(fmt::format("{}: field '{}' contains {}; expected plane ids (whole numbers)",
                              what, field, value));
    set.instance.push_back(std::max(0, static_cast<std::int32_t>(value)));
  }
}

std::string sha256_of_cloud(const PointSet& set) {
  std::vector<std::byte> bytes(sizeof(double) * 3 + set.points.size() * sizeof(Vec3f));
  std::memcpy(bytes.data(), set.origin.data(), sizeof(double) * 3);
  if (!set.points.empty()) {
    std::memcpy(bytes.data() + sizeof(double) * 3, set.points.data()->data(),
                set.points.size() * sizeof(Vec3f));
  }
  return sha256_hex(bytes);
}

std::unique_ptr<Recording> open_clouds(const fs::path& path, const RecordingOptions& options) {
  return std::make_unique<CloudRecording>(path, options.instance_field);
}

// ---- Reading ----

namespace {

// Beyond this, a float no longer resolves hundredths of a millimeter: coordinates get an origin.
constexpr double kFar_m = 100;

template <typename T>
T saturate(double value) {
  if (std::isnan(value)) return 0;
  constexpr auto kMin = static_cast<double>(std::numeric_limits<T>::min());
  constexpr auto kMax = static_cast<double>(std::numeric_limits<T>::max());
  return static_cast<T>(std::clamp(value, kMin, kMax));
}

/// Zero for a cloud near zero; else the middle of its bounds, rounded to meters.
Vec3d choose_origin(const std::vector<Vec3d>& points) {
  const Vec3d origin = bulk_origin(points);
  return origin.norm() <= kFar_m ? Vec3d::Zero() : origin;
}

}  // namespace

CloudBuilder::CloudBuilder(const std::filesystem::path& path,
                           std::span<const CloudField> fields,
                           CloudExtras* extras)
    : fields_(fields.begin(), fields.end()), extras_(extras) {
  if (extras_) {
    extras_->values.assign(extras_->names.size(), {});
    extra_.assign(extras_->names.size(), -1);
  }
  for (int i = 0; i < static_cast<int>(fields_.size()); ++i) {
    const std::string& name = fields_[i].name;
    const auto take = [&](const char* wanted, int& slot) {
      if (name == wanted && slot < 0) slot = i;
    };
    take("x", xyz_[0]);
    take("y", xyz_[1]);
    take("z", xyz_[2]);
    for (const char* red : {"red", "diffuse_red", "r"}) take(red, rgb_[0]);
    for (const char* green : {"green", "diffuse_green", "g"}) take(green, rgb_[1]);
    for (const char* blue : {"blue", "diffuse_blue", "b"}) take(blue, rgb_[2]);
    if (size_of(fields_[i].type) == 4) {
      take("rgb", packed_);
      take("rgba", packed_);
    }
    take("label", label_);
    take("instance", instance_);
    for (std::size_t k = 0; k < extra_.size(); ++k) take(extras_->names[k].c_str(), extra_[k]);
  }
  if (std::any_of(xyz_.begin(), xyz_.end(), [](int i) { return i < 0; })) {
    std::string names;
    for (const CloudField& field : fields_) names += (names.empty() ? "" : " ") + field.name;
    throw Error(path.string() + ": points have the fields \"" + names + "\"; expected x, y, and z");
  }
  if (std::any_of(rgb_.begin(), rgb_.end(), [](int i) { return i < 0; })) rgb_.fill(-1);
}

void CloudBuilder::reserve(std::size_t points) {
  points_.reserve(points);
  if (rgb_[0] >= 0 || packed_ >= 0) set_.rgb.reserve(3 * points);
  if (label_ >= 0) set_.label.reserve(points);
  if (instance_ >= 0) set_.instance.reserve(points);
  for (std::size_t k = 0; k < extra_.size(); ++k)
    if (extra_[k] >= 0) extras_->values[k].reserve(points);
}

std::uint8_t CloudBuilder::color_value(double value, int field) const {
  switch (fields_[field].type) {
    case Scalar::f32:
    case Scalar::f64:
      return saturate<std::uint8_t>(std::round(255 * value));
    case Scalar::u16:
      return saturate<std::uint8_t>(std::round(value / 257));
    default:
      return saturate<std::uint8_t>(value);
  }
}

void CloudBuilder::add_color(std::span<const double> values) {
  if (rgb_[0] >= 0) {
    for (const int field : rgb_) set_.rgb.push_back(color_value(values[field], field));
  } else if (packed_ >= 0) {
    // Four bytes b g r a. For floats, use the bits instead of the value.
    const double value = values[packed_];
    const auto bits = fields_[packed_].type == Scalar::f32
                          ? std::bit_cast<std::uint32_t>(static_cast<float>(value))
                          : static_cast<std::uint32_t>(saturate<std::int64_t>(value));
    for (const int shift : {16, 8, 0}) {
      set_.rgb.push_back(static_cast<std::uint8_t>((bits >> shift) & 255));
    }
  }
}

void CloudBuilder::add(std::span<const double> values) {
  points_.emplace_back(values[xyz_[0]], values[xyz_[1]], values[xyz_[2]]);
  add_color(values);
  if (label_ >= 0) set_.label.push_back(saturate<std::uint8_t>(values[label_]));
  if (instance_ >= 0) set_.instance.push_back(saturate<std::int32_t>(values[instance_]));
  for (std::size_t k = 0; k < extra_.size(); ++k)
    if (extra_[k] >= 0) extras_->values[k].push_back(values[extra_[k]]);
}

PointSet CloudBuilder::finish() {
  set_.origin = choose_origin(points_);
  set_.points.reserve(points_.size());
  for (const Vec3d& point : points_) {
    // (0, 0, 0) is "no measurement" and must stay recognizable beside an origin.
    const bool none = point.isZero(0);
    set_.points.push_back(none ? Vec3f(0, 0, 0) : Vec3f((point - set_.origin).cast<float>()));
  }
  points_.clear();
  return std::move(set_);
}

// ---- Writing ----

namespace {

constexpr std::size_t kAtOnce = 256;  // points whose records stay in the cache

/// Consecutive records of some points. Written field by field, so that the fields are selected once
/// instead of for each point.
class Records {
 public:
  Records(unsigned char* at, std::size_t record_bytes, std::size_t first, std::size_t last)
      : at_(at), record_bytes_(record_bytes), first_(first), last_(last) {}

  /// Appends a field to every record.
  template <typename ValueOf>
  void append(const ValueOf& value_of) {
    unsigned char* at = at_;
    for (std::size_t i = first_; i < last_; ++i, at += record_bytes_) {
      const auto value = value_of(i);
      std::memcpy(at, &value, sizeof(value));
    }
    at_ += sizeof(value_of(first_));
  }

 private:
  unsigned char* at_;  // the next field of the first record
  std::size_t record_bytes_, first_, last_;
};

bool is_far(const PointSet& set) { return !set.origin.isZero(0); }

void check_sizes([[maybe_unused]] const PointSet& set,
                 [[maybe_unused]] std::span<const IntField> more) {
  [[maybe_unused]] const std::size_t count = set.points.size();
  assert(set.rgb.empty() || set.rgb.size() == 3 * count);
  assert(set.label.empty() || set.label.size() == count);
  assert(set.instance.empty() || set.instance.size() == count);
  for ([[maybe_unused]] const IntField& field : more) assert(field.values.size() == count);
}

// Data pointers instead of vectors: the compiler must assume that writes might change a vector's.

void append_points(Records& records, const PointSet& set) {
  using Doubles = std::array<double, 3>;
  const Vec3f* const points = set.points.data();
  if (is_far(set))
    records.append([points, o = set.origin](std::size_t i) {
      return Doubles{o[0] + points[i][0], o[1] + points[i][1], o[2] + points[i][2]};
    });
  else
    records.append([points](std::size_t i) { return points[i]; });
}

template <typename T>
void append_values(Records& records, const std::vector<T>& values) {
  records.append([at = values.data()](std::size_t i) { return at[i]; });
}

void append_labels(Records& records, const PointSet& set, std::span<const IntField> more) {
  if (!set.label.empty()) append_values(records, set.label);
  if (!set.instance.empty()) append_values(records, set.instance);
  for (const IntField& field : more) append_values(records, field.values);
}

std::string ply_header(const PointSet& set, std::span<const IntField> more) {
  const std::string scalar = is_far(set) ? "double" : "float";
  std::string header = "ply\nformat binary_little_endian 1.0\nelement vertex " +
                       std::to_string(set.points.size()) + "\n";
  for (const char* axis : {"x", "y", "z"}) header += "property " + scalar + " " + axis + "\n";
  if (!set.rgb.empty()) {
    for (const char* c : {"red", "green", "blue"})
      header += std::string("property uchar ") + c + "\n";
  }
  if (!set.label.empty()) header += "property uchar label\n";
  if (!set.instance.empty()) header += "property int instance\n";
  for (const IntField& field : more) header += "property int " + field.name + "\n";
  return header + "end_header\n";
}

std::string pcd_header(const PointSet& set, std::span<const IntField> more) {
  std::string names, sizes, types, counts;
  const auto field = [&](const std::string& name, const char* size, const char* type) {
    names += " " + name;
    sizes += std::string(" ") + size;
    types += std::string(" ") + type;
    counts += " 1";
  };
  for (const char* axis : {"x", "y", "z"}) field(axis, is_far(set) ? "8" : "4", "F");
  if (!set.rgb.empty()) field("rgb", "4", "U");
  if (!set.label.empty()) field("label", "1", "U");
  if (!set.instance.empty()) field("instance", "4", "I");
  for (const IntField& extra : more) field(extra.name, "4", "I");
  const std::string count = std::to_string(set.points.size());
  return "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS" + names + "\nSIZE" +
         sizes + "\nTYPE" + types + "\nCOUNT" + counts + "\nWIDTH " + count +
         "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " + count + "\nDATA binary\n";
}

/// `header`, followed by a record of each point. `color_of`: returns a point's color.
template <typename ColorOf>
std::vector<unsigned char> bytes_of(const std::string& header,
                                    const PointSet& set,
                                    std::span<const IntField> more,
                                    const ColorOf& color_of) {
  check_sizes(set, more);
  const std::size_t point_bytes =
      (is_far(set) ? 24 : 12) + (set.rgb.empty() ? 0 : sizeof(color_of(nullptr))) +
      (set.label.empty() ? 0 : 1) + (set.instance.empty() ? 0 : 4) + 4 * more.size();
  std::vector<unsigned char> bytes(header.size() + set.points.size() * point_bytes);
  std::memcpy(bytes.data(), header.data(), header.size());
  for (std::size_t i = 0; i < set.points.size(); i += kAtOnce) {
    Records records(bytes.data() + header.size() + i * point_bytes, point_bytes, i,
                    std::min(i + kAtOnce, set.points.size()));
    append_points(records, set);
    if (!set.rgb.empty())
      records.append([&, rgb = set.rgb.data()](std::size_t at) { return color_of(rgb + 3 * at); });
    append_labels(records, set, more);
  }
  return bytes;
}

}  // namespace

std::vector<unsigned char> ply_bytes(const PointSet& set, std::span<const IntField> more) {
  return bytes_of(ply_header(set, more), set, more, [](const std::uint8_t* rgb) {
    return std::array{rgb[0], rgb[1], rgb[2]};
  });
}

void write_ply(const std::filesystem::path& path, const PointSet& set) {
  write_file_bytes(path, ply_bytes(set));
}

std::vector<unsigned char> pcd_bytes(const PointSet& set, std::span<const IntField> more) {
  return bytes_of(pcd_header(set, more), set, more, [](const std::uint8_t* rgb) {
    return std::uint32_t{rgb[0]} << 16 | std::uint32_t{rgb[1]} << 8 | rgb[2];
  });
}

}  // namespace planescope::io
