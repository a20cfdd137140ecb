#include "core/labels/exchange/npy.hpp"

#include <algorithm>

#include "core/io/cloud_files/cloud_file.hpp"
#include "core/labels/exchange/formats.hpp"

// https://numpy.org/doc/stable/reference/generated/numpy.lib.format.html
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
        fail("has the unknown entry \"" + printable(key) + "\"");
      }
      if (!take(',')) {
        expect('}');
        break;
      }
    }
    if (!has_type || !has_order || !has_shape) fail("lacks descr, fortran_order or shape");
    if (fortran_ && array.shape.size() > 1) fail("says Fortran order, expected C order");
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
    if (!take(c)) fail(std::string("is damaged, expected '") + c + "'");
  }

  std::string_view quoted() {
    skip_space();
    const char quote = rest_.empty() ? ' ' : rest_.front();
    if (quote != '\'' && quote != '"') fail("is damaged, expected a string");
    const std::size_t end = rest_.find(quote, 1);
    if (end == std::string_view::npos) fail("has a string without an end");
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
      if (digits.ends_with('L')) digits.remove_suffix(1);  // as Python 2 wrote them
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
    fail("says values of type \"" + printable(text) + "\", expected whole numbers or floats");
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
      throw Error(where + ": not an NPY file, expected it to begin with \"\\x93NUMPY\"");
    const int major = reader.read<std::uint8_t>(), minor = reader.read<std::uint8_t>();
    if (major != 1 && major != 2)
      throw Error(where + ": NPY version " + std::to_string(major) + "." + std::to_string(minor) +
                  ", expected 1.0 or 2.0");
    const std::uint32_t length =
        major == 1 ? reader.read<std::uint16_t>() : reader.read<std::uint32_t>();
    const io::Bytes header = reader.take(length);
    text = {reinterpret_cast<const char*>(header.data()), header.size()};
  } catch (io::OutOfBytes) {
    throw Error(where + ": not a readable NPY: cut within its header");
  }
  NpyHeader(text, where).parse(array);
  std::uint64_t bytes = io::size_of(array.type);
  bool too_large = false;
  for (const std::uint64_t length : array.shape)
    too_large = __builtin_mul_overflow(bytes, length, &bytes) || too_large;
  if (too_large || bytes != reader.left())
    throw Error(where + ": its header promises " +
                (too_large ? "more bytes than there are numbers for"
                           : std::to_string(bytes) + " bytes of values") +
                ", " + std::to_string(reader.left()) + " follow");
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

}  // namespace planescope::labels
