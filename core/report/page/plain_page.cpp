#include "core/report/page/plain_page.hpp"

#include <fmt/format.h>

#include <kainjow/mustache.hpp>

#include "core/report/page/charts.hpp"

namespace planescope::report {
namespace {

constexpr const char* kPlainStyle =
    ":root{color-scheme:light dark;--page:#f7f7f5;--ink:#1d2127;--soft:#5a626d;--line:#e2e3e1}\n"
    "@media (prefers-color-scheme:dark){"
    ":root{--page:#131519;--ink:#e5e7ea;--soft:#9aa2ad;--line:#2c3037}}\n"
    "body{margin:2.5rem auto;max-width:56rem;padding:0 1.5rem;background:var(--page);"
    "color:var(--ink);font:15px/1.55 system-ui,sans-serif;font-variant-numeric:tabular-nums}\n"
    "h1{font-size:1.7rem;line-height:1.2;overflow-wrap:anywhere}h2{font-size:1.2rem;margin:2rem 0 "
    ".6rem}\n"
    "dl{display:grid;grid-template-columns:max-content minmax(0,1fr);gap:.2rem 1.4rem}"
    "dt,.soft{color:var(--soft)}dd{margin:0;overflow-wrap:anywhere}\n"
    ".wide{overflow-x:auto}table{border-collapse:collapse;width:100%}"
    "td,th{padding:.2rem .6rem;text-align:right;border-bottom:1px solid var(--line)}"
    "th{font-weight:600;vertical-align:bottom}\n";

}  // namespace

std::string plain_page(const std::string& title, const std::string& body) {
  return fmt::format(
      "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">"
      "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">"
      "<title>{0}</title>\n<style>\n{1}{2}</style></head><body>\n<h1>{0}</h1>\n{3}"
      "</body></html>\n",
      kainjow::mustache::html_escape(title), kPlainStyle, line_chart_style(), body);
}

}  // namespace planescope::report
