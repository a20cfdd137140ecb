#include "core/report/data/report_target.hpp"

#include <fmt/format.h>

#include <charconv>
#include <optional>

#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::report {
namespace {

/// The number after `letters`, where the part is nothing else.
std::optional<int> numbered(const std::string& part, const std::string& letters) {
  if (!part.starts_with(letters)) return {};
  const char* begin = part.data() + letters.size();
  const char* end = part.data() + part.size();
  int number = 0;
  if (begin == end || *begin == '-') return {};
  const auto [stop, problem] = std::from_chars(begin, end, number);
  if (problem != std::errc() || stop != end) return {};
  return number;
}

}  // namespace

ReportTarget parse_report_target(const std::string& text) {
  const std::size_t at = text.rfind('#');
  ReportTarget target;
  target.file = text.substr(0, at);
  if (at == std::string::npos) return target;
  const std::string place = text.substr(at + 1);
  const auto refuse = [&] {
    throw Error(fmt::format(
        "{}: '{}' is no place in a report, expected f<frame>, f<frame>/p<plane> or "
        "f<frame>/was<plane of the baseline>, after r<n>/ where it has several recordings",
        target.file.string(), place));
  };
  std::vector<std::string> parts = split(place, '/');
  if (const auto recording = numbered(parts[0], "r")) {
    target.recording = *recording;
    parts.erase(parts.begin());
  }
  if (parts.empty() || parts.size() > 2 || target.recording < 1) refuse();
  const auto frame = numbered(parts[0], "f");
  if (!frame) refuse();
  target.frame = *frame;
  if (parts.size() == 1) return target;
  const auto was = numbered(parts[1], "was");
  const auto plane = was ? was : numbered(parts[1], "p");
  if (!plane || *plane < 1) refuse();
  target.plane = *plane;
  target.of_baseline = was.has_value();
  return target;
}

}  // namespace planescope::report
