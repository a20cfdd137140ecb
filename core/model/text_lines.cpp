#include "core/model/text_lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/model/error.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/text.hpp"

namespace planescope {
namespace {

constexpr std::string_view kBlank = "\t\r\v\f";  // beside spaces

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
