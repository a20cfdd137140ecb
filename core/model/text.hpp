#pragma once

// Text input and output: numbers, words, units, and text files of lines and words.

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace planescope {

/// The candidate most similar to `given`, for suggestions: the first that begins with it, or the
/// one with the smallest edit distance (insert, delete, replace, swap of neighbors), if that is at
/// most a third of the longer word. Empty if there is none.
std::string nearest_name(std::string_view given, const std::vector<std::string>& candidates);

/// Parses the whole `text` as a number, independent of the locale, including "nan" and "inf";
/// nullopt if it is not a number.
std::optional<double> parse_number(std::string_view text);
/// Parses a finite number. Throws Error naming `what`.
double parse_number(const std::string& text, const std::string& what);
int parse_integer(const std::string& text, const std::string& what);

/// Splits `text` at every `separator`; returns at least one part.
std::vector<std::string> split(const std::string& text, char separator);

/// The words of a text, separated by spaces.
std::vector<std::string> words_of(const std::string& text);

/// Removes the UTF-8 byte order mark, if any.
std::string_view without_byte_order_mark(std::string_view text);

/// Converts ASCII letters only.
std::string lower_case(std::string text);

/// Minutes and seconds, "2:05".
std::string minutes_text(double seconds);

/// Makes text safe for a terminal: replaces line ends and tabs by spaces, other control characters
/// by '?', and the middle of words of over 1 KiB by "...".
std::string one_line(std::string text);

/// Three digits: "7.1 mm", "12.3 cm", "3.42 m", "231 m".
std::string length_text(double meters);
/// "12 cm²", "0.52 m²", "4470 m²".
std::string area_text(double m2);

/// "2 frames", "1 frame".
std::string counted(std::size_t count, std::string_view noun);

}  // namespace planescope

// Text files of lines and words written by users and other tools: trajectories, lists of times,
// calibrations. Byte order marks, carriage returns and tabs are accepted.

namespace planescope {

struct TextLine {
  int number = 0;                  // from 1
  std::vector<std::string> words;  // separated by spaces and tabs, up to a '#'
  std::string comment;             // text after the '#'
};

/// Lines that contain a word or a comment.
std::vector<TextLine> text_lines(std::string_view text);
/// Same for a file. Throws Error like read_file_bytes().
std::vector<TextLine> read_text_lines(const std::filesystem::path& path, std::uintmax_t max_bytes);

/// Throws Error: "PATH, line N: WHAT".
[[noreturn]] void fail_at(const std::filesystem::path& path,
                          const TextLine& line,
                          const std::string& what);

/// Parses a word of a line as a finite number. Throws Error naming the file, the line, the word and
/// `expected`, a description of the whole line.
double number_in(const std::filesystem::path& path,
                 const TextLine& line,
                 std::size_t word,
                 const std::string& expected);
/// Parses all words of a line, of which there must be exactly `count`.
std::vector<double> numbers_in(const std::filesystem::path& path,
                               const TextLine& line,
                               std::size_t count,
                               const std::string& expected);

/// `text` if `fits(text)`, else the longest prefix that fits with an ellipsis.
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
