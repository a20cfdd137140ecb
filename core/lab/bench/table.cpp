#include "core/lab/bench/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <sstream>

namespace planescope::lab {
namespace {

std::vector<std::size_t> widths(const Table& table) {
  std::vector<std::size_t> widths;
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    widths.push_back(table.columns[c].size());
    for (const auto& row : table.rows) widths[c] = std::max(widths[c], row[c].size());
  }
  return widths;
}

/// Words to the left, figures to the right.
std::string padded(const Table& table,
                   const std::vector<std::string>& cells,
                   const std::string& between) {
  const std::vector<std::size_t> width = widths(table);
  std::string line;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (c > 0) line += between;
    line += c < table.names ? fmt::format("{:<{}}", cells[c], width[c])
                            : fmt::format("{:>{}}", cells[c], width[c]);
  }
  return line;
}

std::string wrapped(const std::string& text) {
  constexpr std::size_t kWidth = 100;
  std::istringstream words(text);
  std::string out;
  std::size_t column = 0;
  for (std::string word; words >> word; column += word.size() + 1) {
    if (column + word.size() > kWidth) {
      out.back() = '\n';
      column = 0;
    }
    out += word + " ";
  }
  out.back() = '\n';
  return out;
}

}  // namespace

std::string to_text(const Table& table) {
  std::string text = table.title + "\n" + padded(table, table.columns, "  ") + "\n";
  for (const auto& row : table.rows) text += padded(table, row, "  ") + "\n";
  return table.note.empty() ? text : text + wrapped(table.note);
}

std::string to_markdown(const Table& table) {
  std::string text = "### " + table.title + "\n\n| " + padded(table, table.columns, " | ") + " |\n";
  for (std::size_t c = 0; c < table.columns.size(); ++c) text += c < table.names ? "|---" : "|---:";
  text += "|\n";
  for (const auto& row : table.rows) text += "| " + padded(table, row, " | ") + " |\n";
  return table.note.empty() ? text : text + "\n" + table.note + "\n";
}

}  // namespace planescope::lab
