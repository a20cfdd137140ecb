#pragma once

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
