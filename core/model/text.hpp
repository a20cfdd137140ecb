#pragma once

// Text for people and from people: numbers, words, units, and files of lines and words.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace planescope {

/// The candidate that a person who typed `given` most likely meant: the smallest edit distance
/// (insert, delete, replace, swap of neighbours), if that is at most a third of the longer word.
/// Empty where none is near.
std::string nearest_name(std::string_view given, const std::vector<std::string>& candidates);

/// The whole of `text` as a number, independent of the locale, "nan" and "inf" among them; nullopt
/// where it is none.
std::optional<double> parse_number(std::string_view text);
/// Likewise, and finite. Throws Error that names `what`.
double parse_number(const std::string& text, const std::string& what);
int parse_integer(const std::string& text, const std::string& what);

/// `text` cut at every `separator`; always at least one part.
std::vector<std::string> split(const std::string& text, char separator);

/// What stands between spaces.
std::vector<std::string> words_of(const std::string& text);

/// `text` after the UTF-8 byte order mark it may begin with.
std::string_view without_byte_order_mark(std::string_view text);

/// ASCII letters alone.
std::string lower_case(std::string text);

/// "2:05", minutes and seconds.
std::string minutes_text(double seconds);

/// For people, who may read it in a terminal: line ends and tabs are spaces, other control
/// characters '?'.
std::string one_line(std::string text);

/// "7.1 mm", "12.3 cm", "3.42 m", "231 m": three digits.
std::string length_text(double metres);
/// "12 cm²", "0.52 m²", "4470 m²".
std::string area_text(double m2);

/// "2 frames", "1 frame".
std::string counted(std::size_t count, std::string_view noun);

}  // namespace planescope

// Text files of lines and words, as people and other tools write them: trajectories, lists of
// times, calibrations. A byte order mark, carriage returns and tabs are fine everywhere.

namespace planescope {

struct TextLine {
  int number = 0;                  // from 1
  std::vector<std::string> words;  // between spaces and tabs, up to a '#'
  std::string comment;             // after the '#'
};

/// The lines that hold a word or a comment.
std::vector<TextLine> text_lines(std::string_view text);
/// The same of a file. Throws Error as read_file_bytes() does.
std::vector<TextLine> read_text_lines(const std::filesystem::path& path, std::uintmax_t max_bytes);

/// Throws Error: "PATH, line N: WHAT".
[[noreturn]] void fail_at(const std::filesystem::path& path,
                          const TextLine& line,
                          const std::string& what);

/// A word of a line as a finite number. Throws Error naming the file, the line, the word and
/// `expected`, which describes the whole line.
double number_in(const std::filesystem::path& path,
                 const TextLine& line,
                 std::size_t word,
                 const std::string& expected);
/// All words of a line, of which there must be `count`.
std::vector<double> numbers_in(const std::filesystem::path& path,
                               const TextLine& line,
                               std::size_t count,
                               const std::string& expected);

/// `text` where it `fits(text)`, else as much of its beginning as fits with an ellipsis behind it.
template <typename Fits>
std::string shortened(const std::string& text, const Fits& fits) {
  const auto continues = [](char c) { return (static_cast<unsigned char>(c) & 0xC0u) == 0x80u; };
  if (fits(text)) return text;
  std::string kept = text;
  while (!kept.empty()) {
    while (kept.size() > 1 && continues(kept.back())) kept.pop_back();  // UTF-8
    kept.pop_back();
    if (fits(kept + "…")) break;
  }
  return kept + "…";
}

}  // namespace planescope
