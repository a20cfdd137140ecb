// Text, numbers and links of the page.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/report/page/report_html_parts.hpp"
#include "core/report/page/thumbnail.hpp"

namespace planescope::report::html {
namespace {

constexpr const char* kReplacement = "\xEF\xBF\xBD";  // U+FFFD

/// Length of the UTF-8 character at the front; 0 where there is none.
std::size_t character_at(std::string_view text) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(text[i]); };
  const unsigned first = byte(0);
  if (first < 0x80) return first >= 0x20 || first == '\n' || first == '\t' ? 1 : 0;
  const std::size_t length = first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
  if (first < 0xC2 || first > 0xF4 || text.size() < length) return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xC0) != 0x80) return 0;
  // Overlong forms, surrogates, and what is beyond Unicode.
  const unsigned second = byte(1);
  if ((first == 0xE0 && second < 0xA0) || (first == 0xED && second > 0x9F) ||
      (first == 0xF0 && second < 0x90) || (first == 0xF4 && second > 0x8F))
    return 0;
  return length;
}

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
         std::string_view("-._~/").find(c) != std::string_view::npos;
}

}  // namespace

std::string grouped(std::uint64_t value) {
  std::string digits = std::to_string(value);
  for (int at = static_cast<int>(digits.size()) - 3; at > 0; at -= 3)
    digits.insert(static_cast<std::size_t>(at), "\u202f");
  return digits;
}

std::string share(std::uint64_t part, std::uint64_t whole) {
  const double value =
      whole == 0 ? 0 : 100.0 * static_cast<double>(part) / static_cast<double>(whole);
  return fmt::format("{:.1f} %", value);
}

std::string counted(std::size_t count, std::string_view noun) {
  return fmt::format("{} {}{}", grouped(count), noun, count == 1 ? "" : "s");
}

std::string decimal(double value, int digits) {
  std::string text = fmt::format("{:.{}f}", std::abs(value), digits);
  const bool zero = text.find_first_not_of("0.") == std::string::npos;
  return value < 0 && !zero ? "\u2212" + text : text;
}

std::string change(double value, int digits) {
  const std::string text = decimal(value, digits);
  const bool zero = text.find_first_not_of("0.") == std::string::npos;
  return value > 0 && !zero ? "+" + text : text;
}

std::string escaped(const std::string& text) { return kainjow::mustache::html_escape(text); }

std::string href(const std::string& file) {
  std::string result;
  for (const char c : file.substr(std::min(file.find_first_not_of('/'), file.size())))
    result += is_plain(c)
                  ? std::string(1, c)
                  : fmt::format("%{:02X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
  return result;
}

std::string valid_text(std::string_view text) {
  std::string result;
  result.reserve(text.size());
  while (!text.empty()) {
    const std::size_t length = character_at(text);
    if (length > 0)
      result += text.substr(0, length);
    else
      result += kReplacement;
    text.remove_prefix(std::max<std::size_t>(length, 1));
  }
  return result;
}

std::string safe_color(const std::string& color) {
  const bool is_color = color.size() == 7 && color[0] == '#' &&
                        color.find_first_not_of("0123456789abcdefABCDEF", 1) == std::string::npos;
  return is_color ? color : "#888888";
}

std::string gravity_text(const Gravity& gravity) {
  switch (gravity.source) {
    case GravitySource::option:
      return "given on the command line";
    case GravitySource::sidecar:
      return "from the recording\u2019s files";
    case GravitySource::imu:
      return "from the recording\u2019s IMU";
    case GravitySource::picked:
      return "picked in the window";
    case GravitySource::estimate:
      return fmt::format("<em>estimated</em> from the scene, confidence {:.2f}",
                         gravity.confidence);
    case GravitySource::assumed:
      return "<em>assumed</em>";
    case GravitySource::none:
      break;
  }
  return "<em>not known</em>";
}

Data text_or_false(const std::string& text) { return text.empty() ? Data(false) : Data(text); }

Data list_of(const char* name, const std::vector<std::string>& values) {
  Data result{Data::type::list};
  for (const std::string& value : values) result.push_back(Data(name, value));
  return result;
}

const char* case_meaning(planes::Case c) {
  switch (c) {
    case planes::Case::I:
      return "mixed labels (fails Criterion 1): divided";
    case planes::Case::II:
      return "too few points (fails Criterion 2): left over";
    case planes::Case::III:
      return "one label but not planar (fails Criterion 3): divided";
    case planes::Case::IV:
      return "planar: a candidate, its outliers left over";
    case planes::Case::none:
      break;
  }
  return "";
}

std::string text_of(const Breach& breach) {
  const bool low = breach.value < breach.rule.at_least;
  return fmt::format("{} is {:.4g}, at {} {:.4g}", breach.rule.metric, breach.value,
                     low ? "least" : "most", low ? breach.rule.at_least : breach.rule.at_most);
}

std::string jpeg_source(const std::filesystem::path& file) {
  try {
    return "data:image/jpeg;base64," + base64(read_file_bytes(file));
  } catch (const Error&) {
    return "";  // the page links the picture instead
  }
}

Template::Template(const char* begin, const char* end) : mustache_(std::string(begin, end)) {
  if (!mustache_.is_valid()) throw Error("report template: " + mustache_.error_message());
}

void Template::write(std::ostream& out, const Data& data) {
  out << valid_text(mustache_.render(data));
}

}  // namespace planescope::report::html
