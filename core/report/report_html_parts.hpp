#pragma once

// Inside the page's writer: what its parts share. Included by report_html*.cpp only.

#include <kainjow/mustache.hpp>
#include <string>

#include "core/report/report_data.hpp"

namespace planescope::html {

using Data = kainjow::mustache::data;
using kainjow::mustache::list;

/// 12 345, with narrow spaces that do not break.
std::string grouped(std::uint64_t value);
/// "12.3 %" of the whole.
std::string share(std::uint64_t part, std::uint64_t whole);
std::string escaped(const std::string& text);
/// Where gravity comes from, as HTML; emphasised where it is a guess.
std::string gravity_text(const Gravity& gravity);
/// A section that is there only where `text` is not empty.
Data text_or_false(const std::string& text);

std::string frame_anchor(std::size_t recording, const ReportFrame& frame);
/// Data of assets/report/report_frame.mustache.
Data frame_data(const Report& report, std::size_t recording, const ReportFrame& frame, bool open);
/// One phrase per case of the paper's figure.
const char* case_meaning(Case c);

}  // namespace planescope::html
