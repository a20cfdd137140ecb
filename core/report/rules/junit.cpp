// junit.xml, valid against the schema of Ant's JUnit task and within what Jenkins and GitLab read.

#include <fmt/format.h>

#include <map>

#include "core/planes/pipeline/pipeline.hpp"
#include "core/report/compare/judgement.hpp"
#include "core/report/data/report_files.hpp"
#include "core/report/page/report_html_parts.hpp"

namespace planescope::report {
namespace {

/// XML 1.0 does not allow most control characters, not even escaped.
std::string escaped(const std::string& text) {
  std::string lines;
  for (const char c : text) lines += c == '\n' ? std::string(" | ") : std::string(1, c);
  return html::escaped(html::valid_text(lines));
}

double seconds(const ReportFrame& frame) { return planes::total_ms(frame.timings) / 1000; }

struct Suite {
  std::string name, cases;
  int tests = 0, failures = 0, errors = 0;
  double seconds = 0;

  void add(const std::string& test, double time, const std::string& outcome) {
    ++tests;
    seconds += time;
    cases += fmt::format("  <testcase name=\"{}\" classname=\"{}\" time=\"{:.6f}\"", escaped(test),
                         escaped(name), time);
    cases += outcome.empty() ? "/>\n" : ">\n" + outcome + "  </testcase>\n";
  }
  std::string xml(int id, const std::string& created_utc) const {
    // ISO 8601 without a zone, as the schema has it. The report does not say which machine it ran
    // on.
    return fmt::format(
        " <testsuite id=\"{}\" name=\"{}\" package=\"planescope\" hostname=\"localhost\" "
        "timestamp=\"{}\" tests=\"{}\" failures=\"{}\" errors=\"{}\" time=\"{:.6f}\">\n"
        "  <properties/>\n{}  <system-out/>\n  <system-err/>\n </testsuite>\n",
        id, escaped(name), created_utc.substr(0, 19), tests, failures, errors, seconds, cases);
  }
};

std::string failure(const std::vector<const Breach*>& breaches, const ReportFrame* frame) {
  std::string text;
  for (const Breach* breach : breaches) text += escaped(breach->text()) + "\n";
  if (frame)
    for (const ReportPicture& picture : frame->pictures) text += escaped(picture.file) + "\n";
  text += "index.html\n";
  return fmt::format("   <failure message=\"{}\" type=\"{}\">{}</failure>\n",
                     escaped(breaches[0]->text()), escaped(breaches[0]->rule.metric), text);
}

/// Errors of one frame, or with frame -1 of the whole recording.
using Broken = std::map<std::pair<std::string, int>, std::vector<const Breach*>>;

Broken broken_by_frame(const Report& report) {
  Broken broken;
  if (report.judgement)
    for (const Breach& breach : report.judgement->breaches)
      if (breach.rule.level == RuleLevel::error)
        broken[{breach.recording, breach.frame}].push_back(&breach);
  return broken;
}

void add_frame(Suite& suite, const ReportFrame& frame, Broken& broken) {
  const auto found = broken.find({suite.name, frame.index});
  std::string outcome;
  if (!frame.refused.empty()) {
    ++suite.errors;
    outcome = fmt::format("   <error message=\"{}\" type=\"refused\"/>\n", escaped(frame.refused));
  } else if (found != broken.end()) {
    ++suite.failures;
    outcome = failure(found->second, &frame);
  }
  suite.add(fmt::format("frame {}", frame.index), seconds(frame), outcome);
  if (found != broken.end()) broken.erase(found);
}

/// What belongs to no frame of this report: rules over many frames, frames that are missing.
void add_rest(Suite& suite, Broken& broken, bool of_any) {
  for (auto at = broken.begin(); at != broken.end();) {
    if (at->first.first != suite.name && !of_any) {
      ++at;
      continue;
    }
    ++suite.failures;
    suite.add(at->first.second < 0 ? "all frames" : fmt::format("frame {}", at->first.second), 0,
              failure(at->second, nullptr));
    at = broken.erase(at);
  }
}

}  // namespace

std::string junit_xml(const Report& report) {
  Broken broken = broken_by_frame(report);
  std::string suites;
  int id = 0;
  const auto take = [&](const Suite& suite) { suites += suite.xml(id++, report.created_utc); };
  for (const ReportRecording& recording : report.recordings) {
    Suite suite;
    suite.name = recording.name;
    for (const ReportFrame& frame : recording.frames) add_frame(suite, frame, broken);
    add_rest(suite, broken, false);
    take(suite);
  }
  if (!broken.empty()) {
    Suite suite;
    suite.name = "all recordings";
    add_rest(suite, broken, true);
    take(suite);
  }
  return "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites>\n" + suites + "</testsuites>\n";
}

}  // namespace planescope::report
