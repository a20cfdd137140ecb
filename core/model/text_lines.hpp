#pragma once

// Text files of lines and words, as people and other tools write them: trajectories, lists of
// times, calibrations. A byte order mark, carriage returns and tabs are fine everywhere.

#include <cstddef>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

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

}  // namespace planescope
