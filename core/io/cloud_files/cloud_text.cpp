#include <charconv>

#include "core/io/cloud_files/cloud_formats.hpp"
#include "core/model/error.hpp"

namespace planescope::io {
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
