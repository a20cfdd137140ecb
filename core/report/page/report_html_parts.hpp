#pragma once

// Inside the page's writer: what its parts share. Included by report_html*.cpp only.

#include <filesystem>
#include <kainjow/mustache.hpp>
#include <ostream>
#include <string>
#include <string_view>

#include "core/report/compare/judgement.hpp"
#include "core/report/data/report_data.hpp"

namespace planescope::report::html {

using Data = kainjow::mustache::data;

/// 12 345, with narrow spaces that do not break.
std::string grouped(std::uint64_t value);
/// "12.3 %" of the whole.
std::string share(std::uint64_t part, std::uint64_t whole);
/// "2 frames", "1 frame".
std::string counted(std::size_t count, std::string_view noun);
/// A true minus sign, and none before zeros.
std::string decimal(double value, int digits);
/// decimal() with a plus sign where it grew.
std::string change(double value, int digits);
std::string escaped(const std::string& text);
/// For a link to a file beside the page: never another scheme, host or place of this page.
std::string href(const std::string& file);
/// Bytes that are no UTF-8, and control characters, become U+FFFD.
std::string valid_text(std::string_view text);
/// "#rrggbb", or grey where it is none.
std::string safe_color(const std::string& color);
/// Where gravity comes from, as HTML; emphasised where it is a guess.
std::string gravity_text(const Gravity& gravity);
/// A section that is there only where `text` is not empty.
Data text_or_false(const std::string& text);
/// Data for a list whose entries have this one name.
Data list_of(const char* name, const std::vector<std::string>& values);
/// One phrase per case of the paper's figure.
const char* case_meaning(planes::Case c);
/// "planes_lost is 2, at most 0": as Breach::text() has it, in few digits.
std::string text_of(const Breach& breach);
/// "data:image/jpeg;base64,..." of a file; empty where it cannot be read.
std::string jpeg_source(const std::filesystem::path& file);

/// A template of assets/report, parsed once.
class Template {
 public:
  Template(const char* begin, const char* end);
  void write(std::ostream& out, const Data& data);

 private:
  kainjow::mustache::mustache mustache_;
};

}  // namespace planescope::report::html
