// NumPy files: an array (https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html),
// and an archive of arrays.

#include <zip.h>

#include <algorithm>
#include <memory>
#include <optional>

#include "core/labels/exchange/formats.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope::labels {
namespace {

constexpr std::string_view kMagic = "\x93NUMPY";
constexpr std::size_t kAlignment = 64;
constexpr std::size_t kMaxDimensions = 32;  // NumPy's own limit

/// The header: a Python literal {'descr': '<i4', 'fortran_order': False, 'shape': (3, 2), }.
class NpyHeader {
 public:
  NpyHeader(std::string_view text, const std::string& where) : rest_(text), where_(where) {}

  void parse(NpyArray& array) {
    bool has_type = false, has_order = false, has_shape = false;
    expect('{');
    while (!take('}')) {
      const std::string_view key = quoted();
      expect(':');
      if (key == "descr") {
        parse_type(quoted(), array);
        has_type = true;
      } else if (key == "fortran_order") {
        fortran_ = word() == "True";
        has_order = true;
      } else if (key == "shape") {
        array.shape = shape();
        has_shape = true;
      } else {
        fail("has an unknown entry, \"" + printable(key) + "\"");
      }
      if (!take(',')) {
        expect('}');
        break;
      }
    }
    if (!has_type || !has_order || !has_shape) fail("lacks descr, fortran_order, or shape");
    if (fortran_ && array.shape.size() > 1) fail("declares Fortran order; expected C order");
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(where_ + ": not a readable NPY: its header " + what);
  }

  void skip_space() {
    const std::size_t at = rest_.find_first_not_of(" \t\r\n");
    rest_.remove_prefix(std::min(at, rest_.size()));
  }
  bool take(char c) {
    skip_space();
    if (!rest_.starts_with(c)) return false;
    rest_.remove_prefix(1);
    return true;
  }
  void expect(char c) {
    if (!take(c)) fail(std::string("is damaged; expected '") + c + "'");
  }

  std::string_view quoted() {
    skip_space();
    const char quote = rest_.empty() ? ' ' : rest_.front();
    if (quote != '\'' && quote != '"') fail("is damaged; expected a string");
    const std::size_t end = rest_.find(quote, 1);
    if (end == std::string_view::npos) fail("has an unterminated string");
    const std::string_view text = rest_.substr(1, end - 1);
    rest_.remove_prefix(end + 1);
    return text;
  }

  std::string_view word() {
    skip_space();
    const std::size_t end = rest_.find_first_of(" ,})");
    const std::string_view text = rest_.substr(0, end);
    rest_.remove_prefix(text.size());
    return text;
  }

  std::vector<std::uint64_t> shape() {
    std::vector<std::uint64_t> lengths;
    expect('(');
    while (!take(')')) {
      std::string_view digits = word();
      if (digits.ends_with('L')) digits.remove_suffix(1);  // written by Python 2
      const auto length = io::parse_count(digits);
      if (!length || lengths.size() == kMaxDimensions) fail("has a damaged shape");
      lengths.push_back(*length);
      if (!take(',')) {
        expect(')');
        break;
      }
    }
    return lengths;
  }

  void parse_type(std::string_view text, NpyArray& array) const {
    static constexpr std::pair<std::string_view, io::Scalar> kTypes[] = {
        {"b1", io::Scalar::u8},  {"i1", io::Scalar::i8},  {"u1", io::Scalar::u8},
        {"i2", io::Scalar::i16}, {"u2", io::Scalar::u16}, {"i4", io::Scalar::i32},
        {"u4", io::Scalar::u32}, {"i8", io::Scalar::i64}, {"u8", io::Scalar::u64},
        {"f4", io::Scalar::f32}, {"f8", io::Scalar::f64}};
    for (const auto& [name, type] : kTypes) {
      if (text.size() != 3 || text.substr(1) != name) continue;
      if (std::string_view("<>|=").find(text[0]) == std::string_view::npos) break;
      array.type = type;
      array.big_endian = text[0] == '>';
      return;
    }
    fail("declares values of type \"" + printable(text) + "\"; expected whole numbers or floats");
  }

  std::string_view rest_;
  const std::string& where_;
  bool fortran_ = false;
};

}  // namespace

std::vector<double> NpyArray::values() const {
  std::vector<double> result(size());
  for (std::size_t i = 0; i < result.size(); ++i)
    result[i] = io::load(type, data.data() + i * io::size_of(type), big_endian);
  return result;
}

NpyArray parse_npy(io::Bytes file, const std::string& where) {
  NpyArray array;
  io::ByteReader reader(file);
  std::string_view text;
  try {
    const io::Bytes magic = reader.take(kMagic.size());
    if (!std::equal(magic.begin(), magic.end(), reinterpret_cast<const std::byte*>(kMagic.data())))
      throw Error(where + ": not an NPY file; expected it to begin with \"\\x93NUMPY\"");
    const int major = reader.read<std::uint8_t>(), minor = reader.read<std::uint8_t>();
    if (major != 1 && major != 2)
      throw Error(where + ": NPY version " + std::to_string(major) + "." + std::to_string(minor) +
                  "; expected 1.0 or 2.0");
    const std::uint32_t length =
        major == 1 ? reader.read<std::uint16_t>() : reader.read<std::uint32_t>();
    const io::Bytes header = reader.take(length);
    text = {reinterpret_cast<const char*>(header.data()), header.size()};
  } catch (io::OutOfBytes) {
    throw Error(where + ": not a readable NPY: truncated within its header");
  }
  NpyHeader(text, where).parse(array);
  std::uint64_t bytes = io::size_of(array.type);
  bool too_large = false;
  for (const std::uint64_t length : array.shape)
    too_large = __builtin_mul_overflow(bytes, length, &bytes) || too_large;
  if (too_large || bytes != reader.left())
    throw Error(where + ": its header declares " +
                (too_large ? "too many bytes" : std::to_string(bytes) + " bytes of values") +
                ", but " + std::to_string(reader.left()) + " follow");
  array.data = reader.take(bytes);
  return array;
}

std::vector<unsigned char> npy_bytes(const std::string& type,
                                     const std::vector<std::uint64_t>& shape,
                                     io::Bytes data) {
  std::string lengths;  // as NumPy writes a tuple: (3,) and (3, 2)
  for (const std::uint64_t length : shape) {
    if (!lengths.empty()) lengths += ", ";
    lengths += std::to_string(length);
  }
  if (shape.size() == 1) lengths += ",";
  std::string header =
      "{'descr': '" + type + "', 'fortran_order': False, 'shape': (" + lengths + "), }";
  const std::size_t before = kMagic.size() + 4;  // version and length
  header.append(kAlignment - 1 - (before + header.size()) % kAlignment, ' ');
  header += '\n';
  std::vector<unsigned char> out(kMagic.begin(), kMagic.end());
  out.push_back(1);
  out.push_back(0);
  out.push_back(static_cast<unsigned char>(header.size() & 255));
  out.push_back(static_cast<unsigned char>(header.size() >> 8));
  out.insert(out.end(), header.begin(), header.end());
  const auto* values = reinterpret_cast<const unsigned char*>(data.data());
  out.insert(out.end(), values, values + data.size());
  return out;
}

// NumPy's savez: a zip of .npy files, stored as they are. Arrays by name, one row per point:
//   points [N, 3] float32, rgb [N, 3] uint8, label [N] uint8, instance [N] int32,
//   pixel [N, 2] uint16 (u, v); and depth_size [2] int32 (width, height)

namespace {

constexpr std::uint16_t kFirstDosDate = 1 << 5 | 1;  // 1980-01-01: same input, same bytes

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

/// `bytes` must outlive the archive. The archive also keeps the source.
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

/// nullopt if the archive has no such member.
std::optional<FileBytes> read_member(zip_t* archive,
                                     const std::string& name,
                                     const std::string& where) {
  const zip_int64_t index = zip_name_locate(archive, name.c_str(), 0);
  if (index < 0) return std::nullopt;
  const std::string member = where + ": " + name;
  const std::unique_ptr<zip_file_t, Discard> file(
      zip_fopen_index(archive, static_cast<zip_uint64_t>(index), 0));
  if (!file) throw Error(member + " cannot be read: " + zip_strerror(archive));
  // Read in pieces: the archive's declared size is not trusted.
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

/// The values of an array; empty if it is missing. `columns`: 1 for a list.
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
    throw Error(
        array_name + ": an array with " + counted(array.shape.size(), "dimension") + "; expected " +
        (columns == 1 ? "one value per point" : std::to_string(columns) + " values per point"));
  check_count(array.shape[0], array_name);
  expect_within_read_limit(static_cast<double>(array.size()) * sizeof(double), array_name);
  return array.values();
}

/// Writes an archive; keeps the members' bytes until it is closed.
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
    (void)source.release();  // the archive owns it now
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

FileBytes npz_bytes(const LabeledPoints& points, const std::string& where) {
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

LabeledPoints parse_npz(io::Bytes file, const std::string& where) {
  const Source source = make_source(file.data(), file.size(), where);
  const Archive archive = open_archive(source.get(), ZIP_RDONLY, where);
  LabeledPoints points;
  const auto instance = read_array(archive.get(), "instance", 1, where);
  if (instance.empty() && zip_name_locate(archive.get(), "instance.npy", 0) < 0)
    throw Error(where + ": no \"instance\" array; expected an array of plane ids");
  points.instance = instances_of(instance, where + ": instance");
  const std::size_t count = points.size();
  const auto read = [&](const char* name, std::uint64_t columns) {
    auto values = read_array(archive.get(), name, columns, where);
    if (!values.empty() && values.size() != columns * count)
      throw Error(where + ": " + name + " has " + std::to_string(values.size() / columns) +
                  " rows, but instance has " + std::to_string(count));
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
                " values; expected width and height");
  if (!size.empty()) {
    points.width = size[0];
    points.height = size[1];
  }
  return points;
}

}  // namespace planescope::labels
