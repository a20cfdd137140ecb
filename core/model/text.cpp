// Numbers, units and words as text, and line-based text files.

#include "core/model/text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"

namespace planescope {
namespace {

// Optimal string alignment distance.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1), last(b.size() + 1), now(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) last[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    now[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t replaced = last[j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1);
      now[j] = std::min({replaced, last[j] + 1, now[j - 1] + 1});
      if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
        now[j] = std::min(now[j], before[j - 2] + 1);
    }
    std::swap(before, last);
    std::swap(last, now);
  }
  return last[b.size()];
}

template <typename T>
bool parse_whole(std::string_view text, T& value) {
  const char* begin = text.data();
  const char* end = begin + text.size();
  if (end - begin > 1 && begin[0] == '+' && begin[1] != '-') ++begin;
  const auto [stopped, error] = std::from_chars(begin, end, value);
  return error == std::errc() && stopped == end && begin != end;
}

}  // namespace

std::string nearest_name(std::string_view given, const std::vector<std::string>& candidates) {
  for (const std::string& candidate : candidates)
    if (given.size() > 1 && candidate.starts_with(given)) return candidate;
  std::string best;
  std::size_t best_distance = std::numeric_limits<std::size_t>::max();
  for (const std::string& candidate : candidates) {
    const std::size_t longer = std::max(given.size(), candidate.size());
    const std::size_t least = longer - std::min(given.size(), candidate.size());
    if (least * 3 > longer) continue;  // and avoids comparing long texts letter by letter
    const std::size_t distance = edit_distance(given, candidate);
    if (distance * 3 <= longer && distance < best_distance) {
      best = candidate;
      best_distance = distance;
    }
  }
  return best;
}

std::optional<double> parse_number(std::string_view text) {
  double value = 0;
  if (!parse_whole(text, value)) return std::nullopt;
  return value;
}

double parse_number(const std::string& text, const std::string& what) {
  const std::optional<double> value = parse_number(text);
  if (!value || !std::isfinite(*value)) throw Error(what + ": '" + text + "' is not a number");
  return *value;
}

int parse_integer(const std::string& text, const std::string& what) {
  int value = 0;
  if (!parse_whole(text, value)) throw Error(what + ": '" + text + "' is not a whole number");
  return value;
}

std::vector<std::string> split(const std::string& text, char separator) {
  std::vector<std::string> parts;
  std::size_t begin = 0;
  while (true) {
    const std::size_t end = text.find(separator, begin);
    parts.push_back(text.substr(begin, end - begin));
    if (end == std::string::npos) return parts;
    begin = end + 1;
  }
}

std::vector<std::string> words_of(const std::string& text) {
  std::vector<std::string> words = split(text, ' ');
  std::erase(words, "");
  return words;
}

std::string_view without_byte_order_mark(std::string_view text) {
  constexpr std::string_view kMark = "\xEF\xBB\xBF";
  if (text.starts_with(kMark)) text.remove_prefix(kMark.size());
  return text;
}

std::string lower_case(std::string text) {
  for (char& c : text)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return text;
}

std::string minutes_text(double seconds) {
  const long whole = std::lround(seconds);
  const std::string rest = std::to_string(whole % 60);
  return std::to_string(whole / 60) + (rest.size() < 2 ? ":0" : ":") + rest;
}

namespace {

/// Replaces the middle of words of over a kilobyte, such as hostile names of topics.
void shorten_words(std::string& text) {
  constexpr std::size_t kMost = 1024, kKept = 100;
  for (std::size_t end, at = 0; at < text.size(); at = end + 1) {
    end = std::min(text.find(' ', at), text.size());
    if (end - at <= kMost) continue;
    text.replace(at + kKept, end - at - 2 * kKept, "...");
    end = at + 2 * kKept + 3;
  }
}

}  // namespace

std::string one_line(std::string text) {
  for (char& c : text) {
    if (c >= '\t' && c <= '\r') c = ' ';
    if ((c >= '\0' && c < ' ') || c == '\x7f') c = '?';
  }
  shorten_words(text);
  return text;
}

std::string length_text(double meters) {
  const double size = std::abs(meters);
  if (size < 0.001) return fmt::format("{:.2f} mm", 1000 * meters);
  if (size < 0.01) return fmt::format("{:.3g} mm", 1000 * meters);
  if (size < 1) return fmt::format("{:.3g} cm", 100 * meters);
  return size < 100 ? fmt::format("{:.3g} m", meters) : fmt::format("{:.0f} m", meters);
}

std::string area_text(double m2) {
  if (m2 < 0.1) return fmt::format("{:.0f} cm²", 1e4 * m2);
  return m2 < 10 ? fmt::format("{:.2f} m²", m2) : fmt::format("{:.0f} m²", m2);
}

std::string counted(std::size_t count, std::string_view noun) {
  std::string text = std::to_string(count);
  text.append(1, ' ').append(noun);
  return count == 1 ? text : text.append(1, 's');
}

namespace {

constexpr std::string_view kBlank = "\t\r\v\f";  // in addition to spaces

}  // namespace

std::vector<TextLine> text_lines(std::string_view text) {
  text = without_byte_order_mark(text);
  std::vector<TextLine> lines;
  for (int number = 1; !text.empty(); ++number) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    std::string_view rest = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    TextLine line{number, {}, {}};
    if (const std::size_t hash = rest.find('#'); hash != std::string_view::npos) {
      line.comment = rest.substr(hash + 1);
      rest = rest.substr(0, hash);
    }
    std::string words(rest);
    std::ranges::replace_if(
        words, [](char c) { return kBlank.find(c) != kBlank.npos; }, ' ');
    line.words = words_of(words);
    if (!line.words.empty() || !line.comment.empty()) lines.push_back(std::move(line));
  }
  return lines;
}

std::vector<TextLine> read_text_lines(const std::filesystem::path& path, std::uintmax_t max_bytes) {
  const auto bytes = read_file_bytes(path, max_bytes);
  return text_lines({reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

void fail_at(const std::filesystem::path& path, const TextLine& line, const std::string& what) {
  throw Error(fmt::format("{}, line {}: {}", path.string(), line.number, what));
}

double number_in(const std::filesystem::path& path,
                 const TextLine& line,
                 std::size_t word,
                 const std::string& expected) {
  const std::string& text = line.words.at(word);
  const std::optional<double> number = parse_number(text);
  if (!number || !std::isfinite(*number)) {
    constexpr std::size_t kMost = 40;
    fail_at(path, line,
            fmt::format("'{}' is not a number; expected {}", one_line(text.substr(0, kMost)),
                        expected));
  }
  return *number;
}

std::vector<double> numbers_in(const std::filesystem::path& path,
                               const TextLine& line,
                               std::size_t count,
                               const std::string& expected) {
  if (line.words.size() != count)
    fail_at(path, line,
            fmt::format("{}; expected {}", counted(line.words.size(), "word"), expected));
  std::vector<double> numbers;
  for (std::size_t i = 0; i < count; ++i) numbers.push_back(number_in(path, line, i, expected));
  return numbers;
}

}  // namespace planescope
