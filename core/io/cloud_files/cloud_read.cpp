// Reads PLY (http://paulbourke.net/dataformats/ply/) and PCD
// (https://pointclouds.org/documentation/tutorials/pcd_file_format.html). Not through Open3D: its
// readers trust the header, and a padding field of the wrong size or a short compressed block makes
// them read out of bounds.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <map>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::io {
namespace {

namespace fs = std::filesystem;
using Words = std::vector<std::string_view>;

// ---- Numbers and words ----

template <typename T>
double load_as(const std::byte* bytes, bool big_endian) {
  std::array<std::byte, sizeof(T)> raw;
  std::copy_n(bytes, sizeof(T), raw.begin());
  if (big_endian) std::ranges::reverse(raw);
  return static_cast<double>(std::bit_cast<T>(raw));
}

struct ScalarRow {
  std::string_view names[2];  // in PLY
  char kind;                  // in PCD
  std::size_t bytes;
  double (*load)(const std::byte*, bool big_endian);
};

template <typename T>
constexpr ScalarRow row_of(std::string_view name, std::string_view other) {
  const char kind = std::is_floating_point_v<T> ? 'F' : std::is_signed_v<T> ? 'I' : 'U';
  return {{name, other}, kind, sizeof(T), load_as<T>};
}

/// Indexed by Scalar.
constexpr ScalarRow kScalars[] = {
    row_of<std::int8_t>("char", "int8"),    row_of<std::uint8_t>("uchar", "uint8"),
    row_of<std::int16_t>("short", "int16"), row_of<std::uint16_t>("ushort", "uint16"),
    row_of<std::int32_t>("int", "int32"),   row_of<std::uint32_t>("uint", "uint32"),
    row_of<std::int64_t>("int64", "int64"), row_of<std::uint64_t>("uint64", "uint64"),
    row_of<float>("float", "float32"),      row_of<double>("double", "float64")};

template <typename IsIt>
std::optional<Scalar> find_scalar(const IsIt& is_it) {
  const auto row = std::ranges::find_if(kScalars, is_it);
  if (row == std::end(kScalars)) return std::nullopt;
  return static_cast<Scalar>(row - kScalars);
}

std::string_view take_word(std::string_view& text) {
  constexpr std::string_view kSpace = " \t\r\n\f\v";
  text.remove_prefix(std::min(text.find_first_not_of(kSpace), text.size()));
  const std::string_view word = text.substr(0, std::min(text.find_first_of(kSpace), text.size()));
  text.remove_prefix(word.size());
  return word;
}

std::string_view text_of(Bytes bytes) {
  return {reinterpret_cast<const char*>(bytes.data()), bytes.size()};
}

/// The lines of a text header before data that may be binary.
class HeaderLines {
 public:
  /// `what`: "PLY" or "PCD".
  HeaderLines(const fs::path& path, Bytes file, const char* what)
      : path_(path), file_(file), what_(what) {}

  /// The words of the next line. Throws Error naming the file if the header never ends.
  Words next() {
    constexpr std::size_t kMaxHeaderBytes = 1 << 16;
    const std::string_view text = text_of(file_.subspan(position_));
    const std::size_t end = text.substr(0, kMaxHeaderBytes).find('\n');
    if (end == std::string_view::npos || position_ > kMaxHeaderBytes)
      throw Error(fmt::format("{}: the header of this {}-byte point cloud is not terminated",
                              path_.string(), file_.size()));
    position_ += end + 1;
    std::string_view line = text.substr(0, end);
    Words words;
    for (auto word = take_word(line); !word.empty(); word = take_word(line)) words.push_back(word);
    return words;
  }
  std::size_t position() const { return position_; }
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(fmt::format("{}: not a readable {}: {}", path_.string(), what_, what));
  }
  [[noreturn]] void fail_line(std::string_view start) const {
    fail(fmt::format("its header has an unknown line starting with \"{}\"", start));
  }

 private:
  const fs::path& path_;
  Bytes file_;
  const char* what_;
  std::size_t position_ = 0;
};

/// Reads single numbers of the body, text or binary. Throws OutOfBytes at its end.
class Body {
 public:
  Body(Bytes bytes, bool is_text, bool big_endian = false)
      : is_text_(is_text), big_endian_(big_endian), binary_(bytes), text_(text_of(bytes)) {}

  double number(Scalar type) {
    if (!is_text_) return load(type, binary_.take(size_of(type)).data(), big_endian_);
    const std::string_view word = take_word(text_);
    const auto value = word.empty() ? std::nullopt : parse_number(word);
    if (!value) throw OutOfBytes{};
    return *value;
  }
  std::size_t left() const { return is_text_ ? text_.size() : binary_.left(); }

 private:
  bool is_text_, big_endian_;
  ByteReader binary_;
  std::string_view text_;
};

// ---- PLY ----

struct Property {
  std::string name;
  Scalar type = Scalar::f32;
  std::optional<Scalar> count_type = std::nullopt;  // of lists
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct PlyHeader {
  bool is_text = true, big_endian = false;
  std::vector<Element> elements;
  std::size_t bytes = 0;

  Body body(Bytes file) const { return Body(file.subspan(bytes), is_text, big_endian); }
};

Property property_of(const Words& words, const HeaderLines& lines) {
  const auto type_of = [&](std::string_view name) {
    const auto type =
        find_scalar([&](const ScalarRow& row) { return std::ranges::count(row.names, name) > 0; });
    if (!type) lines.fail(fmt::format("unknown property type \"{}\"", name));
    return *type;
  };
  const bool is_list = words.size() == 5 && words[1] == "list";
  if (!is_list && words.size() != 3) lines.fail("its header has a damaged property line");
  const std::size_t at = is_list ? 3 : 1;
  Property property{std::string(words[at + 1])};
  if (is_list) property.count_type = type_of(words[2]);
  property.type = type_of(words[at]);
  return property;
}

PlyHeader ply_header(const fs::path& path, Bytes file) {
  HeaderLines lines(path, file, "PLY");
  const Words magic = lines.next();
  if (magic.size() != 1 || magic[0] != "ply") lines.fail("its first line is not \"ply\"");
  PlyHeader header;
  while (true) {
    const Words words = lines.next();
    if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
    if (words[0] == "end_header") break;
    if (words[0] == "format" && words.size() >= 2) {
      header.is_text = words[1] == "ascii";
      header.big_endian = words[1] == "binary_big_endian";
      if (!header.is_text && !header.big_endian && words[1] != "binary_little_endian")
        lines.fail(fmt::format("unknown format \"{}\"", words[1]));
    } else if (words[0] == "element" && words.size() == 3) {
      const auto count = parse_count(words[2]);
      if (!count) lines.fail(fmt::format("\"{}\" is not an element count", words[2]));
      header.elements.push_back({std::string(words[1]), *count, {}});
    } else if (words[0] == "property" && !header.elements.empty()) {
      header.elements.back().properties.push_back(property_of(words, lines));
    } else {
      lines.fail_line(words[0]);
    }
  }
  header.bytes = lines.position();
  return header;
}

/// Throws Error if the remaining bytes cannot hold the elements that the header declares.
void check_promise(const fs::path& path, const Element& element, bool is_text, std::size_t left) {
  std::uint64_t each = 0;  // minimum bytes per element
  for (const Property& property : element.properties)
    each += is_text ? 2 : size_of(property.count_type.value_or(property.type));
  // The last number of a text file needs no separator.
  const std::uint64_t slack = is_text ? 1 : 0;
  if (element.count > 0 && (each == 0 || element.count > (left + slack) / each))
    throw Error(
        fmt::format("{}: its header declares {} \"{}\" elements of at least {} bytes each, but "
                    "only {} bytes follow",
                    path.string(), element.count, element.name, each, left));
}

/// Reads one element's numbers; skips lists.
void read_element(Body& body, const Element& element, std::vector<double>& values) {
  values.clear();
  for (const Property& property : element.properties) {
    if (!property.count_type) {
      values.push_back(body.number(property.type));
      continue;
    }
    const double count = body.number(*property.count_type);
    if (!(count >= 0) || count > static_cast<double>(body.left())) throw OutOfBytes{};
    for (auto left = static_cast<std::uint64_t>(count); left > 0; --left)
      body.number(property.type);
  }
}

const Element& vertices_of(const fs::path& path, const PlyHeader& header) {
  const auto found = std::ranges::find(header.elements, "vertex", &Element::name);
  if (found == header.elements.end())
    throw Error(path.string() + ": its header has no \"vertex\" element; expected points");
  return *found;
}

PointSet read_ply_bytes(const fs::path& path, Bytes file, CloudExtras* extras) {
  const PlyHeader header = ply_header(path, file);
  const Element& vertices = vertices_of(path, header);
  Body body = header.body(file);
  std::vector<CloudField> fields;
  for (const Property& property : vertices.properties)
    if (!property.count_type) fields.push_back({property.name, property.type});
  CloudBuilder builder(path, fields, extras);
  std::vector<double> values;
  std::uint64_t done = 0;
  try {
    for (const Element& element : header.elements) {
      check_promise(path, element, header.is_text, body.left());
      const bool wanted = &element == &vertices;
      if (wanted) builder.reserve(element.count);
      for (done = 0; done < element.count; ++done) {
        read_element(body, element, values);
        if (wanted) builder.add(values);
      }
      if (wanted) break;
    }
  } catch (OutOfBytes) {
    throw Error(
        fmt::format("{}: truncated or damaged after {} of the {} points declared in the header",
                    path.string(), done, vertices.count));
  }
  return builder.finish();
}

// ---- PCD ----

struct PcdField {
  CloudField field;
  std::uint64_t count = 1;
  std::size_t offset = 0;  // in a point's bytes
};

struct PcdHeader {
  std::vector<PcdField> fields;
  std::uint64_t points = 0;
  std::size_t point_bytes = 0;
  std::string data;  // "ascii", "binary" or "binary_compressed"
  std::size_t bytes = 0;
};

PcdHeader pcd_header(const fs::path& path, Bytes file) {
  constexpr std::uint64_t kMaxFieldCount = 1 << 16;
  constexpr const char* kBadPoints = "its header has an invalid number of points";
  constexpr std::string_view kKeys[] = {"FIELDS", "SIZE",   "TYPE",    "COUNT",     "WIDTH",
                                        "HEIGHT", "POINTS", "VERSION", "VIEWPOINT", "DATA"};
  HeaderLines lines(path, file, "PCD");
  std::map<std::string_view, Words> all;
  while (!all.contains("DATA")) {
    const Words words = lines.next();
    if (words.empty() || words[0].starts_with('#')) continue;
    const std::string_view key = words[0] == "COLUMNS" ? "FIELDS" : words[0];
    if (std::ranges::count(kKeys, key) == 0 || (key == "DATA" && words.size() != 2))
      lines.fail_line(words[0]);
    all[key] = Words(words.begin() + 1, words.end());
  }
  const auto number = [&](const char* key) -> std::optional<std::uint64_t> {
    if (!all.contains(key)) return std::nullopt;
    const auto count = all[key].size() == 1 ? parse_count(all[key][0]) : std::nullopt;
    if (!count || *count > 0xffffffffu) lines.fail(kBadPoints);
    return count;
  };
  const auto width = number("WIDTH"), height = number("HEIGHT"), points = number("POINTS");
  const Words &names = all["FIELDS"], &sizes = all["SIZE"], &types = all["TYPE"],
              &counts = all["COUNT"];
  if (names.empty() || sizes.size() != names.size() || types.size() != names.size() ||
      (!counts.empty() && counts.size() != names.size()))
    lines.fail("FIELDS, SIZE, TYPE, and COUNT in its header do not match");
  PcdHeader header;
  for (std::size_t i = 0; i < names.size(); ++i) {
    const auto type = find_scalar([&](const ScalarRow& row) {
      return types[i] == std::string_view(&row.kind, 1) && sizes[i] == std::to_string(row.bytes);
    });
    const auto count = counts.empty() ? std::optional<std::uint64_t>(1) : parse_count(counts[i]);
    if (!type || !count || *count == 0 || *count > kMaxFieldCount)
      lines.fail(fmt::format("field \"{}\" has an unknown type, size, or count", names[i]));
    header.fields.push_back({{std::string(names[i]), *type}, *count, header.point_bytes});
    header.point_bytes += *count * size_of(*type);
  }
  if (points && (width || height) && *points != width.value_or(1) * height.value_or(1))
    lines.fail("POINTS in its header does not equal WIDTH times HEIGHT");
  header.points = points.value_or(width.value_or(0) * height.value_or(1));
  if (header.points > 0xffffffffu) lines.fail(kBadPoints);
  header.data = all["DATA"][0];
  if (header.data != "ascii" && header.data != "binary" && header.data != "binary_compressed")
    lines.fail(fmt::format("unknown DATA \"{}\"; expected ascii, binary, or binary_compressed",
                           header.data));
  header.bytes = lines.position();
  return header;
}

struct CompressedSizes {
  std::uint32_t stored = 0;
  std::uint32_t raw = 0;
};

/// Throws Error if the file cannot hold the points that the header declares.
void check_promise(const fs::path& path, const PcdHeader& header, Bytes body) {
  std::uint64_t least = header.points * header.point_bytes;
  if (header.data == "ascii") {
    std::uint64_t words = 0;
    for (const PcdField& field : header.fields) words += field.count;
    least = header.points == 0 ? 0 : 2 * words * header.points - 1;
  } else if (header.data == "binary_compressed") {
    const auto sizes = body.size() >= 8 ? ByteReader(body).read<CompressedSizes>()
                                        : CompressedSizes{0xffffffffu, 0};
    // LZF compresses at most 264 bytes into 3.
    if (sizes.raw == least && sizes.stored <= body.size() - 8 && least / 88 <= sizes.stored) return;
    throw Error(fmt::format(
        "{}: its header declares {} {}-byte points, but its {}-byte compressed block is too small",
        path.string(), header.points, header.point_bytes, body.size()));
  }
  if (least > body.size())
    throw Error(fmt::format(
        "{}: its header declares {} points, which need at least {} bytes, but only {} bytes follow",
        path.string(), header.points, least, body.size()));
}

/// LZF as written by liblzf. Throws OutOfBytes unless exactly `raw_bytes` come out.
std::vector<std::byte> unpack_lzf(Bytes stored, std::size_t raw_bytes) {
  std::vector<std::byte> out;
  out.reserve(raw_bytes);
  ByteReader in(stored);
  while (!in.done()) {
    const auto control = in.read<std::uint8_t>();
    if (control < 32) {
      std::ranges::copy(in.take(control + 1u), std::back_inserter(out));
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

/// Keeps only the first value of fields with several: none of the fields in use has more.
void read_ascii(const PcdHeader& header, Bytes bytes, CloudBuilder& builder) {
  Body body(bytes, true);
  std::vector<double> values(header.fields.size());
  for (std::uint64_t point = 0; point < header.points; ++point) {
    for (std::size_t f = 0; f < header.fields.size(); ++f) {
      values[f] = body.number({});
      for (std::uint64_t i = 1; i < header.fields[f].count; ++i) body.number({});
    }
    builder.add(values);
  }
}

/// Points one after another, or (compressed) one field after another, with all points' values.
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

PointSet read_pcd_bytes(const fs::path& path, Bytes file, CloudExtras* extras) {
  PcdHeader header = pcd_header(path, file);
  const Bytes body = file.subspan(header.bytes);
  check_promise(path, header, body);
  std::vector<CloudField> fields;
  for (PcdField& field : header.fields) {
    // A packed color is four bytes whatever its declared type: as a float, its bits may be NaN.
    const bool packed = field.field.name == "rgb" || field.field.name == "rgba";
    if (packed && header.data != "ascii" && field.field.type == Scalar::f32)
      field.field.type = Scalar::u32;
    fields.push_back(field.field);
  }
  CloudBuilder builder(path, fields, extras);
  builder.reserve(header.points);
  try {
    if (header.data == "ascii") {
      read_ascii(header, body, builder);
    } else if (header.data == "binary") {
      read_binary(header, body, false, builder);
    } else {
      ByteReader reader(body);
      const auto sizes = reader.read<CompressedSizes>();
      expect_within_read_limit(sizes.raw, path.string() + ": its points");
      const auto raw = unpack_lzf(reader.take(sizes.stored), sizes.raw);
      read_binary(header, raw, true, builder);
    }
  } catch (OutOfBytes) {
    throw Error(fmt::format("{}: point data is truncated or damaged; expected {} points",
                            path.string(), header.points));
  }
  return builder.finish();
}

}  // namespace

std::optional<std::uint64_t> parse_count(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

std::size_t size_of(Scalar type) { return kScalars[static_cast<std::size_t>(type)].bytes; }

double load(Scalar type, const std::byte* bytes, bool big_endian) {
  return kScalars[static_cast<std::size_t>(type)].load(bytes, big_endian);
}

void check_ply(const fs::path& path) {
  const MappedFile file(path);
  const PlyHeader header = ply_header(path, file.bytes());
  check_promise(path, vertices_of(path, header), header.is_text, header.body(file.bytes()).left());
}

void check_pcd(const fs::path& path) {
  const MappedFile file(path);
  const PcdHeader header = pcd_header(path, file.bytes());
  check_promise(path, header, file.bytes().subspan(header.bytes));
}

PointSet read_ply(const fs::path& path, CloudExtras* extras) {
  const MappedFile file(path);
  return guarded(file, [&] { return read_ply_bytes(path, file.bytes(), extras); });
}

PointSet read_pcd(const fs::path& path, CloudExtras* extras) {
  const MappedFile file(path);
  return guarded(file, [&] { return read_pcd_bytes(path, file.bytes(), extras); });
}

}  // namespace planescope::io
