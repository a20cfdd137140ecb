#include <algorithm>

#include "core/io/cloud_files/cloud_formats.hpp"
#include "core/io/byte_reader.hpp"
#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

// https://pointclouds.org/documentation/tutorials/pcd_file_format.html
// Read by our own code: Open3D's reader trusts the header (a padding field of another size than
// its namesake, or a short compressed block, makes it read outside its buffers).
namespace planescope::io {
namespace {

enum class PcdData : std::uint8_t { ascii, binary, compressed };

struct PcdField {
  CloudField field;
  std::uint64_t count = 1;
  std::size_t offset = 0;  // in a point's bytes
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;
  std::size_t point_bytes = 0;
  PcdData data = PcdData::ascii;
  std::size_t bytes = 0;
};

constexpr std::uint64_t kMaxFieldCount = 1 << 16;

std::optional<Scalar> scalar_of(std::string_view type, std::string_view size) {
  if (type == "I" && size == "1") return Scalar::i8;
  if (type == "I" && size == "2") return Scalar::i16;
  if (type == "I" && size == "4") return Scalar::i32;
  if (type == "I" && size == "8") return Scalar::i64;
  if (type == "U" && size == "1") return Scalar::u8;
  if (type == "U" && size == "2") return Scalar::u16;
  if (type == "U" && size == "4") return Scalar::u32;
  if (type == "U" && size == "8") return Scalar::u64;
  if (type == "F" && size == "4") return Scalar::f32;
  if (type == "F" && size == "8") return Scalar::f64;
  return std::nullopt;
}

class PcdHeaderParser {
 public:
  PcdHeaderParser(const std::filesystem::path& path, Bytes file)
      : path_(path), lines_(path, file) {}

  PcdHeader parse() {
    std::string_view data;
    while (data.empty()) {
      const auto words = lines_.next();
      if (words.empty() || words[0].starts_with('#')) continue;
      const std::vector<std::string_view> values(words.begin() + 1, words.end());
      if (words[0] == "FIELDS" || words[0] == "COLUMNS") {
        names_ = values;
      } else if (words[0] == "SIZE") {
        sizes_ = values;
      } else if (words[0] == "TYPE") {
        types_ = values;
      } else if (words[0] == "COUNT") {
        counts_ = values;
      } else if (words[0] == "WIDTH") {
        width_ = number(values);
      } else if (words[0] == "HEIGHT") {
        height_ = number(values);
      } else if (words[0] == "POINTS") {
        points_ = number(values);
      } else if (words[0] == "DATA" && values.size() == 1) {
        data = values[0];
      } else if (words[0] != "VERSION" && words[0] != "VIEWPOINT") {
        fail("its header has an unknown line starting with \"" + std::string(words[0]) + "\"");
      }
    }
    return finish(data);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(path_.string() + ": not a readable PCD: " + what);
  }

  std::uint64_t number(const std::vector<std::string_view>& values) const {
    const auto count = values.size() == 1 ? parse_count(values[0]) : std::nullopt;
    if (!count || *count > 0xffffffffu) fail("its header has a damaged number of points");
    return *count;
  }

  PcdHeader finish(std::string_view data) {
    if (names_.empty() || sizes_.size() != names_.size() || types_.size() != names_.size() ||
        (!counts_.empty() && counts_.size() != names_.size())) {
      fail("FIELDS, SIZE, TYPE and COUNT of its header do not go together");
    }
    PcdHeader header;
    for (std::size_t i = 0; i < names_.size(); ++i) {
      const auto type = scalar_of(types_[i], sizes_[i]);
      const auto count =
          counts_.empty() ? std::optional<std::uint64_t>(1) : parse_count(counts_[i]);
      if (!type || !count || *count == 0 || *count > kMaxFieldCount) {
        fail("field \"" + std::string(names_[i]) + "\" has an unknown type, size or count");
      }
      header.fields.push_back({{std::string(names_[i]), *type}, *count, header.point_bytes});
      header.point_bytes += *count * size_of(*type);
    }
    if (points_ && (width_ || height_) && *points_ != width_.value_or(1) * height_.value_or(1)) {
      fail("POINTS of its header is not WIDTH times HEIGHT");
    }
    header.points = points_.value_or(width_.value_or(0) * height_.value_or(1));
    if (header.points > 0xffffffffu) fail("its header has a damaged number of points");
    if (data == "ascii") {
      header.data = PcdData::ascii;
    } else if (data == "binary") {
      header.data = PcdData::binary;
    } else if (data == "binary_compressed") {
      header.data = PcdData::compressed;
    } else {
      fail("unknown DATA \"" + std::string(data) + "\"");
    }
    header.bytes = lines_.position();
    return header;
  }

  const std::filesystem::path& path_;
  HeaderLines lines_;
  std::vector<std::string_view> names_, sizes_, types_, counts_;
  std::optional<std::uint64_t> width_, height_, points_;
};

struct CompressedSizes {
  std::uint32_t stored = 0;
  std::uint32_t raw = 0;
};

/// Throws Error when the points that the header promises cannot be in the file.
void check_promise(const std::filesystem::path& path, const PcdHeader& header, Bytes body) {
  std::uint64_t least = header.points * header.point_bytes;
  if (header.data == PcdData::ascii) {
    std::uint64_t words = 0;
    for (const PcdField& field : header.fields) words += field.count;
    least = header.points == 0 ? 0 : 2 * words * header.points - 1;
  } else if (header.data == PcdData::compressed) {
    const auto sizes = body.size() >= 8 ? ByteReader(body).read<CompressedSizes>()
                                        : CompressedSizes{0xffffffffu, 0};
    // LZF packs at most 264 bytes into 3.
    if (sizes.raw == least && sizes.stored <= body.size() - 8 && least / 88 <= sizes.stored) return;
    least = std::max<std::uint64_t>(least, std::uint64_t{8} + sizes.stored);
    throw Error(path.string() + ": its header promises " + std::to_string(header.points) +
                " points of " + std::to_string(header.point_bytes) +
                " bytes, but its compressed block of " + std::to_string(body.size()) +
                " bytes does not hold them");
  }
  if (least > body.size()) {
    throw Error(path.string() + ": its header promises " + std::to_string(header.points) +
                " points in at least " + std::to_string(least) + " bytes, but only " +
                std::to_string(body.size()) + " bytes follow");
  }
}

/// LZF as liblzf writes it. Throws OutOfBytes unless exactly `raw_bytes` come out.
std::vector<std::byte> unpack_lzf(Bytes stored, std::size_t raw_bytes) {
  std::vector<std::byte> out;
  out.reserve(raw_bytes);
  ByteReader in(stored);
  while (!in.done()) {
    const auto control = in.read<std::uint8_t>();
    if (control < 32) {
      const Bytes literal = in.take(control + 1u);
      out.insert(out.end(), literal.begin(), literal.end());
    } else {
      std::size_t length = control >> 5;
      if (length == 7) length += in.read<std::uint8_t>();
      const std::size_t distance = ((control & 31u) << 8) + in.read<std::uint8_t>() + 1u;
      if (distance > out.size()) throw OutOfBytes{};
      for (std::size_t i = 0; i < length + 2; ++i) out.push_back(out[out.size() - distance]);
    }
    if (out.size() > raw_bytes) throw OutOfBytes{};
  }
  if (out.size() != raw_bytes) throw OutOfBytes{};
  return out;
}

/// Only the first value of a field with several is kept: none of ours has more.
void read_ascii(const PcdHeader& header, Bytes body, CloudBuilder& builder) {
  WordReader words(body);
  std::vector<double> values(header.fields.size());
  for (std::uint64_t point = 0; point < header.points; ++point) {
    for (std::size_t f = 0; f < header.fields.size(); ++f) {
      for (std::uint64_t i = 0; i < header.fields[f].count; ++i) {
        const auto value = parse_number(words.next());
        if (!value) throw OutOfBytes{};
        if (i == 0) values[f] = *value;
      }
    }
    builder.add(values);
  }
}

/// Points one after the other, or (compressed) all points' values of a field after the other.
void read_binary(const PcdHeader& header, Bytes body, bool by_field, CloudBuilder& builder) {
  std::vector<double> values(header.fields.size());
  for (std::uint64_t point = 0; point < header.points; ++point) {
    for (std::size_t f = 0; f < header.fields.size(); ++f) {
      const PcdField& field = header.fields[f];
      const std::size_t bytes = field.count * size_of(field.field.type);
      const std::size_t at = by_field ? field.offset * header.points + point * bytes
                                      : point * header.point_bytes + field.offset;
      values[f] = load(field.field.type, body.data() + at);
    }
    builder.add(values);
  }
}

}  // namespace

void check_pcd(const std::filesystem::path& path) {
  const MappedFile file(path);
  const PcdHeader header = PcdHeaderParser(path, file.bytes()).parse();
  check_promise(path, header, file.bytes().subspan(header.bytes));
}

namespace {

PointSet read_pcd_bytes(const std::filesystem::path& path, Bytes file, CloudExtras* extras) {
  PcdHeader header = PcdHeaderParser(path, file).parse();
  const Bytes body = file.subspan(header.bytes);
  check_promise(path, header, body);
  std::vector<CloudField> fields;
  for (PcdField& field : header.fields) {
    // A packed colour is four bytes whatever it is called: as float its bits may be no number.
    const bool packed = field.field.name == "rgb" || field.field.name == "rgba";
    if (packed && header.data != PcdData::ascii && field.field.type == Scalar::f32) {
      field.field.type = Scalar::u32;
    }
    fields.push_back(field.field);
  }
  CloudBuilder builder(path, fields, extras);
  builder.reserve(header.points);
  try {
    if (header.data == PcdData::ascii) {
      read_ascii(header, body, builder);
    } else if (header.data == PcdData::binary) {
      read_binary(header, body, false, builder);
    } else {
      ByteReader reader(body);
      const auto sizes = reader.read<CompressedSizes>();
      expect_within_read_limit(sizes.raw, path.string() + ": its points");
      const auto raw = unpack_lzf(reader.take(sizes.stored), sizes.raw);
      read_binary(header, raw, true, builder);
    }
  } catch (OutOfBytes) {
    throw Error(path.string() + ": its points are cut or damaged, expected " +
                std::to_string(header.points) + " of them");
  }
  return builder.finish();
}

}  // namespace

PointSet read_pcd(const std::filesystem::path& path, CloudExtras* extras) {
  const MappedFile file(path);
  return guarded(file, [&] { return read_pcd_bytes(path, file.bytes(), extras); });
}

}  // namespace planescope::io
