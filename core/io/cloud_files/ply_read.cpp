#include <algorithm>
#include <limits>

#include "core/io/cloud_files/cloud_formats.hpp"
#include "core/io/byte_reader.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

// http://paulbourke.net/dataformats/ply/
namespace planescope::io {
namespace {

enum class PlyFormat : std::uint8_t { ascii, little_endian, big_endian };

struct Property {
  std::string name;
  Scalar type = Scalar::f32;
  bool is_list = false;
  Scalar count_type = Scalar::u8;
};

struct Element {
  std::string name;
  std::uint64_t count = 0;
  std::vector<Property> properties;
};

struct PlyHeader {
  PlyFormat format = PlyFormat::ascii;
  std::vector<Element> elements;
  std::size_t bytes = 0;
};

std::optional<Scalar> parse_type(std::string_view name) {
  if (name == "char" || name == "int8") return Scalar::i8;
  if (name == "uchar" || name == "uint8") return Scalar::u8;
  if (name == "short" || name == "int16") return Scalar::i16;
  if (name == "ushort" || name == "uint16") return Scalar::u16;
  if (name == "int" || name == "int32") return Scalar::i32;
  if (name == "uint" || name == "uint32") return Scalar::u32;
  if (name == "int64") return Scalar::i64;
  if (name == "uint64") return Scalar::u64;
  if (name == "float" || name == "float32") return Scalar::f32;
  if (name == "double" || name == "float64") return Scalar::f64;
  return std::nullopt;
}

/// Reads the header line by line.
class HeaderParser {
 public:
  HeaderParser(const std::filesystem::path& path, Bytes file) : path_(path), lines_(path, file) {}

  PlyHeader parse() {
    const auto magic = lines_.next();
    if (magic.size() != 1 || magic[0] != "ply") fail("expected \"ply\" as its first line");
    while (true) {
      const auto words = lines_.next();
      if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
      if (words[0] == "end_header") break;
      if (words[0] == "format" && words.size() >= 2) {
        header_.format = format_of(words[1]);
      } else if (words[0] == "element" && words.size() == 3) {
        header_.elements.push_back({std::string(words[1]), count_of(words[2]), {}});
      } else if (words[0] == "property" && !header_.elements.empty()) {
        header_.elements.back().properties.push_back(property_of(words));
      } else {
        fail("its header has an unknown line starting with \"" + std::string(words[0]) + "\"");
      }
    }
    header_.bytes = lines_.position();
    return header_;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw Error(path_.string() + ": not a readable PLY: " + what);
  }

  PlyFormat format_of(std::string_view name) const {
    if (name == "ascii") return PlyFormat::ascii;
    if (name == "binary_little_endian") return PlyFormat::little_endian;
    if (name == "binary_big_endian") return PlyFormat::big_endian;
    fail("unknown format \"" + std::string(name) + "\"");
  }

  std::uint64_t count_of(std::string_view text) const {
    const auto count = parse_count(text);
    if (!count) fail("\"" + std::string(text) + "\" is no number of elements");
    return *count;
  }

  Property property_of(const std::vector<std::string_view>& words) const {
    Property property;
    std::size_t at = 1;
    if (words.size() == 5 && words[1] == "list") {
      property.is_list = true;
      property.count_type = type_of(words[2]);
      at = 3;
    } else if (words.size() != 3) {
      fail("its header has a damaged property line");
    }
    property.type = type_of(words[at]);
    property.name = words[at + 1];
    return property;
  }

  Scalar type_of(std::string_view name) const {
    const auto type = parse_type(name);
    if (!type) fail("unknown property type \"" + std::string(name) + "\"");
    return *type;
  }

  const std::filesystem::path& path_;
  HeaderLines lines_;
  PlyHeader header_;
};

/// Reads single numbers of the body, text or binary. Throws OutOfBytes at its end.
class Body {
 public:
  Body(Bytes bytes, PlyFormat format) : format_(format), binary_(bytes), words_(bytes) {}

  double number(Scalar type) {
    if (format_ != PlyFormat::ascii) {
      return load(type, binary_.take(size_of(type)).data(), format_ == PlyFormat::big_endian);
    }
    const auto value = parse_number(words_.next());
    if (!value) throw OutOfBytes{};
    return *value;
  }

  std::size_t left() const { return format_ == PlyFormat::ascii ? words_.left() : binary_.left(); }

 private:
  PlyFormat format_;
  ByteReader binary_;
  WordReader words_;
};

/// The fewest bytes that one element can take: what its header promises is checked against it.
std::uint64_t least_bytes(const Element& element, PlyFormat format) {
  std::uint64_t bytes = 0;
  for (const Property& property : element.properties) {
    const Scalar type = property.is_list ? property.count_type : property.type;
    bytes += format == PlyFormat::ascii ? 2 : size_of(type);  // a digit and what ends it
  }
  return bytes;
}

void check_promise(const std::filesystem::path& path,
                   const Element& element,
                   PlyFormat format,
                   std::size_t left) {
  const std::uint64_t each = least_bytes(element, format);
  // The last number of a text file needs nothing after it.
  const std::uint64_t slack = format == PlyFormat::ascii ? 1 : 0;
  if (element.count == 0) return;
  if (each == 0 || element.count > (left + slack) / each) {
    throw Error(path.string() + ": its header promises " + std::to_string(element.count) + " \"" +
                element.name + "\" of at least " + std::to_string(each) + " bytes, but only " +
                std::to_string(left) + " bytes follow");
  }
}

/// Reads one element's numbers; lists are read past.
void read_element(Body& body, const Element& element, std::vector<double>& values) {
  values.clear();
  for (const Property& property : element.properties) {
    if (!property.is_list) {
      values.push_back(body.number(property.type));
      continue;
    }
    const double count = body.number(property.count_type);
    if (!(count >= 0) || count > static_cast<double>(body.left())) throw OutOfBytes{};
    for (auto left = static_cast<std::uint64_t>(count); left > 0; --left) {
      body.number(property.type);
    }
  }
}

/// Checks every element up to the vertices against the file, as far as sizes are fixed.
const Element& find_vertices(const std::filesystem::path& path, const PlyHeader& header) {
  for (const Element& element : header.elements) {
    if (element.name == "vertex") return element;
  }
  throw Error(path.string() + ": its header has no \"vertex\" element, expected points");
}

}  // namespace

void check_ply(const std::filesystem::path& path) {
  const MappedFile file(path);
  const PlyHeader header = HeaderParser(path, file.bytes()).parse();
  check_promise(path, find_vertices(path, header), header.format,
                file.bytes().size() - header.bytes);
}

namespace {

PointSet read_ply_bytes(const std::filesystem::path& path, Bytes file, CloudExtras* extras) {
  const PlyHeader header = HeaderParser(path, file).parse();
  const Element& vertices = find_vertices(path, header);
  Body body(file.subspan(header.bytes), header.format);
  std::vector<CloudField> fields;
  for (const Property& property : vertices.properties) {
    if (!property.is_list) fields.push_back({property.name, property.type});
  }
  CloudBuilder builder(path, fields, extras);
  std::vector<double> values;
  std::uint64_t done = 0;
  try {
    for (const Element& element : header.elements) {
      check_promise(path, element, header.format, body.left());
      const bool wanted = &element == &vertices;
      if (wanted) builder.reserve(element.count);
      for (done = 0; done < element.count; ++done) {
        read_element(body, element, values);
        if (wanted) builder.add(values);
      }
      if (wanted) break;
    }
  } catch (OutOfBytes) {
    throw Error(path.string() + ": cut or damaged after " + std::to_string(done) + " of " +
                std::to_string(vertices.count) + " points that its header promises");
  }
  return builder.finish();
}

}  // namespace

PointSet read_ply(const std::filesystem::path& path, CloudExtras* extras) {
  const MappedFile file(path);
  return guarded(file, [&] { return read_ply_bytes(path, file.bytes(), extras); });
}

}  // namespace planescope::io
