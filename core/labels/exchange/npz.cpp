#include <zip.h>

#include <cassert>
#include <memory>
#include <optional>

#include "core/labels/exchange/formats.hpp"
#include "core/labels/exchange/npy.hpp"
#include "core/model/file_bytes.hpp"

// NumPy's savez: a zip of .npy files, stored as they are. Arrays by name, one row per point:
//   points [N, 3] float32, rgb [N, 3] uint8, label [N] uint8, instance [N] int32,
//   pixel [N, 2] uint16 (u, v); and depth_size [2] int32 (width, height)
namespace planescope::labels {
namespace {

constexpr std::uint16_t kFirstDosDate = 1 << 5 | 1;  // 1980-01-01: the same input, the same bytes

[[noreturn]] void fail(const std::string& where, zip_error_t& error) {
  const std::string reason = zip_error_strerror(&error);
  zip_error_fini(&error);
  throw Error(where + ": not a readable NPZ: " + reason);
}

struct Discard {
  void operator()(zip_t* archive) const { zip_discard(archive); }
  void operator()(zip_source_t* source) const { zip_source_free(source); }
  void operator()(zip_file_t* file) const { zip_fclose(file); }
};
using Archive = std::unique_ptr<zip_t, Discard>;
using Source = std::unique_ptr<zip_source_t, Discard>;

/// `bytes` must outlive the archive. The source is kept by the archive too.
Archive open_archive(zip_source_t* source, int flags, const std::string& where) {
  zip_error_t error;
  zip_error_init(&error);
  Archive archive(zip_open_from_source(source, flags, &error));
  if (!archive) fail(where, error);
  zip_source_keep(source);
  return archive;
}

Source make_source(const void* bytes, std::size_t count, const std::string& where) {
  zip_error_t error;
  zip_error_init(&error);
  Source source(zip_source_buffer_create(bytes, count, 0, &error));
  if (!source) fail(where, error);
  return source;
}

/// nullopt where the archive has no such member.
std::optional<FileBytes> read_member(zip_t* archive,
                                     const std::string& name,
                                     const std::string& where) {
  const zip_int64_t index = zip_name_locate(archive, name.c_str(), 0);
  if (index < 0) return std::nullopt;
  const std::string member = where + ": " + name;
  const std::unique_ptr<zip_file_t, Discard> file(
      zip_fopen_index(archive, static_cast<zip_uint64_t>(index), 0));
  if (!file) throw Error(member + " cannot be read: " + zip_strerror(archive));
  // Piece by piece: the size that the archive claims is not trusted.
  FileBytes bytes;
  constexpr std::size_t kPiece = 1 << 20;
  while (true) {
    const std::size_t before = bytes.size();
    expect_within_read_limit(static_cast<double>(before), member);
    bytes.resize(before + kPiece);
    const zip_int64_t read = zip_fread(file.get(), bytes.data() + before, kPiece);
    bytes.resize(before + static_cast<std::size_t>(std::max<zip_int64_t>(read, 0)));
    if (read < 0) throw Error(member + " is damaged");
    if (read == 0) return bytes;
  }
}

/// The values of an array, empty where there is none. `columns`: 1 is a list.
std::vector<double> read_array(zip_t* archive,
                               const std::string& name,
                               std::uint64_t columns,
                               const std::string& where) {
  const auto bytes = read_member(archive, name + ".npy", where);
  if (!bytes) return {};
  const std::string array_name = where + ": " + name;
  const NpyArray array = parse_npy(std::as_bytes(std::span(*bytes)), array_name);
  const bool fits =
      columns == 1 ? array.shape.size() == 1 : array.shape.size() == 2 && array.shape[1] == columns;
  if (!fits)
    throw Error(array_name + ": an array of " + std::to_string(array.shape.size()) +
                " dimensions, expected " +
                (columns == 1 ? "a list" : std::to_string(columns) + " values per point"));
  check_count(array.shape[0], array_name);
  expect_within_read_limit(static_cast<double>(array.size()) * sizeof(double), array_name);
  return array.values();
}

/// The archive being written: members' bytes are kept until it is closed.
class NpzWriter {
 public:
  explicit NpzWriter(const std::string& where)
      : where_(where),
        source_(make_source(nullptr, 0, where)),
        archive_(open_archive(source_.get(), ZIP_TRUNCATE, where)) {}

  template <typename T>
  void add(const std::string& name,
           const std::string& type,
           const std::vector<std::uint64_t>& shape,
           std::span<const T> values) {
    members_.push_back(std::make_unique<FileBytes>(npy_bytes(type, shape, std::as_bytes(values))));
    Source source = make_source(members_.back()->data(), members_.back()->size(), where_);
    const zip_int64_t index =
        zip_file_add(archive_.get(), (name + ".npy").c_str(), source.get(), ZIP_FL_ENC_UTF_8);
    if (index < 0) fail(where_, *zip_get_error(archive_.get()));
    (void)source.release();  // the archive's now
    const auto at = static_cast<zip_uint64_t>(index);
    if (zip_set_file_compression(archive_.get(), at, ZIP_CM_STORE, 0) < 0 ||
        zip_file_set_dostime(archive_.get(), at, 0, kFirstDosDate, 0) < 0)
      fail(where_, *zip_get_error(archive_.get()));
  }

  FileBytes finish() {
    if (zip_close(archive_.get()) < 0) fail(where_, *zip_get_error(archive_.get()));
    (void)archive_.release();
    zip_source_t* source = source_.get();
    zip_stat_t facts;
    FileBytes bytes;
    if (zip_source_open(source) < 0 || zip_source_stat(source, &facts) < 0)
      fail(where_, *zip_source_error(source));
    bytes.resize(facts.size);
    const zip_int64_t read = zip_source_read(source, bytes.data(), bytes.size());
    zip_source_close(source);
    if (read != static_cast<zip_int64_t>(bytes.size())) fail(where_, *zip_source_error(source));
    return bytes;
  }

 private:
  const std::string& where_;
  std::vector<std::unique_ptr<FileBytes>> members_;
  Source source_;
  Archive archive_;
};

}  // namespace

FileBytes npz_bytes(const LabelledPoints& points, const std::string& where) {
  const std::uint64_t count = points.size();
  NpzWriter writer(where);
  std::vector<Vec3f> places;
  for (const Vec3f& point : points.points)
    places.push_back((points.origin + point.cast<double>()).cast<float>());
  if (!places.empty())
    writer.add("points", "<f4", {count, 3},
               std::span<const float>(places.front().data(), 3 * count));
  if (!points.rgb.empty())
    writer.add("rgb", "|u1", {count, 3}, std::span<const std::uint8_t>(points.rgb));
  if (!points.label.empty())
    writer.add("label", "|u1", {count}, std::span<const std::uint8_t>(points.label));
  writer.add("instance", "<i4", {count}, std::span<const std::int32_t>(points.instance));
  if (!points.pixel.empty())
    writer.add("pixel", "<u2", {count, 2}, std::span<const DepthPixel>(points.pixel));
  const std::int32_t size[] = {points.width, points.height};
  if (points.width > 0) writer.add("depth_size", "<i4", {2}, std::span<const std::int32_t>(size));
  return writer.finish();
}

LabelledPoints parse_npz(io::Bytes file, const std::string& where) {
  const Source source = make_source(file.data(), file.size(), where);
  const Archive archive = open_archive(source.get(), ZIP_RDONLY, where);
  LabelledPoints points;
  const auto instance = read_array(archive.get(), "instance", 1, where);
  if (instance.empty() && zip_name_locate(archive.get(), "instance.npy", 0) < 0)
    throw Error(where + ": it has no array \"instance\", expected plane ids there");
  points.instance = instances_of(instance, where + ": instance");
  const std::size_t count = points.size();
  const auto read = [&](const char* name, std::uint64_t columns) {
    auto values = read_array(archive.get(), name, columns, where);
    if (!values.empty() && values.size() != columns * count)
      throw Error(where + ": " + name + " has " + std::to_string(values.size() / columns) +
                  " rows, instance has " + std::to_string(count));
    return values;
  };
  points.label = classes_of(read("label", 1), where + ": label");
  points.rgb = whole_numbers<std::uint8_t>(read("rgb", 3), 0, 255, where + ": rgb");
  const auto coordinates = read("points", 3);
  for (std::size_t i = 0; i < coordinates.size(); i += 3)
    points.points.push_back(
        Vec3d(coordinates[i], coordinates[i + 1], coordinates[i + 2]).cast<float>());
  const auto pixel = whole_numbers<std::uint16_t>(read("pixel", 2), 0, 65535, where + ": pixel");
  for (std::size_t i = 0; i < pixel.size(); i += 2)
    points.pixel.push_back({pixel[i], pixel[i + 1]});
  const auto size = whole_numbers<std::int32_t>(read_array(archive.get(), "depth_size", 1, where),
                                                1, 65536, where + ": depth_size");
  if (!size.empty() && size.size() != 2)
    throw Error(where + ": depth_size has " + std::to_string(size.size()) +
                " values, expected width and height");
  if (!size.empty()) {
    points.width = size[0];
    points.height = size[1];
  }
  return points;
}

}  // namespace planescope::labels
