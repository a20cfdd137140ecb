#include "core/io/cloud_files/cloud_formats.hpp"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/model/error.hpp"

namespace planescope::io {
namespace {

// Beyond this a float no longer resolves hundredths of a millimetre: coordinates get an origin.
constexpr double kFar_m = 100;

template <typename T>
double load_as(const std::byte* bytes, bool big_endian) {
  std::array<std::byte, sizeof(T)> raw;
  std::copy_n(bytes, sizeof(T), raw.begin());
  if (big_endian) std::reverse(raw.begin(), raw.end());
  return static_cast<double>(std::bit_cast<T>(raw));
}

template <typename T>
T saturate(double value) {
  if (std::isnan(value)) return 0;
  constexpr auto kMin = static_cast<double>(std::numeric_limits<T>::min());
  constexpr auto kMax = static_cast<double>(std::numeric_limits<T>::max());
  return static_cast<T>(std::clamp(value, kMin, kMax));
}

/// Zero for a cloud near zero; else the middle of its bounds, rounded to metres.
Vec3d choose_origin(const std::vector<Vec3d>& points) {
  const Vec3d origin = bulk_origin(points);
  return origin.norm() <= kFar_m ? Vec3d::Zero() : origin;
}

}  // namespace

std::size_t size_of(Scalar type) {
  constexpr std::array<std::size_t, 10> kSizes = {1, 1, 2, 2, 4, 4, 8, 8, 4, 8};
  return kSizes[static_cast<std::size_t>(type)];
}

double load(Scalar type, const std::byte* bytes, bool big_endian) {
  switch (type) {
    case Scalar::i8:
      return load_as<std::int8_t>(bytes, big_endian);
    case Scalar::u8:
      return load_as<std::uint8_t>(bytes, big_endian);
    case Scalar::i16:
      return load_as<std::int16_t>(bytes, big_endian);
    case Scalar::u16:
      return load_as<std::uint16_t>(bytes, big_endian);
    case Scalar::i32:
      return load_as<std::int32_t>(bytes, big_endian);
    case Scalar::u32:
      return load_as<std::uint32_t>(bytes, big_endian);
    case Scalar::i64:
      return load_as<std::int64_t>(bytes, big_endian);
    case Scalar::u64:
      return load_as<std::uint64_t>(bytes, big_endian);
    case Scalar::f32:
      return load_as<float>(bytes, big_endian);
    case Scalar::f64:
      return load_as<double>(bytes, big_endian);
  }
  return 0;
}

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
    throw Error(path.string() + ": points have the fields \"" + names + "\", expected x, y and z");
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
    // Four bytes b g r a; a float's bits are meant, not its value.
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
    // (0, 0, 0) is "no measurement" and must stay recognisable beside an origin.
    const bool none = point.isZero(0);
    set_.points.push_back(none ? Vec3f(0, 0, 0) : Vec3f((point - set_.origin).cast<float>()));
  }
  points_.clear();
  return std::move(set_);
}

namespace {

constexpr std::string_view kSpace = " \t\r\n\f\v";
constexpr std::size_t kMaxHeaderBytes = 1 << 16;

std::string_view take_word(std::string_view& text) {
  const std::size_t start = std::min(text.find_first_not_of(kSpace), text.size());
  text.remove_prefix(start);
  const std::string_view word = text.substr(0, std::min(text.find_first_of(kSpace), text.size()));
  text.remove_prefix(word.size());
  return word;
}

}  // namespace

std::string_view WordReader::next() {
  const std::string_view word = take_word(rest_);
  if (word.empty()) throw OutOfBytes{};
  return word;
}

std::vector<std::string_view> HeaderLines::next() {
  const Bytes rest = file_.subspan(position_);
  const std::string_view text(reinterpret_cast<const char*>(rest.data()), rest.size());
  const std::size_t end = text.substr(0, kMaxHeaderBytes).find('\n');
  if (end == std::string_view::npos || position_ > kMaxHeaderBytes) {
    throw Error(path_.string() + ": " + std::to_string(file_.size()) +
                " bytes in which the header of a cloud file never ends");
  }
  position_ += end + 1;
  std::string_view line = text.substr(0, end);
  std::vector<std::string_view> words;
  for (auto word = take_word(line); !word.empty(); word = take_word(line)) words.push_back(word);
  return words;
}

std::optional<std::uint64_t> parse_count(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size()) return std::nullopt;
  return value;
}

}  // namespace planescope::io
