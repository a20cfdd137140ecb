#include "core/lab/bench/table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>
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

namespace {

/// How bad a value is: less is better. nullopt where the column's name implies no goal.
std::optional<double> badness(const std::string& column, double value) {
  const std::string measure = column.substr(0, column.find(' '));
  if (measure == "r_p") return std::abs(value - 100);
  for (const char* least : {"alpha", "r_m", "over", "under", "missed", "noise"})
    if (measure == least) return value;
  for (const char* most : {"points", "IoU", "PQ", "det", "edge", "inner"})
    if (measure == most) return -value;
  return std::nullopt;
}

std::optional<double> number(const std::string& text) {
  double value = 0;
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  if (error != std::errc() || stop != end) return std::nullopt;
  return value;
}

bool competes(const std::string& name) {
  return name.find("printed") == std::string::npos && name.find("oracle") == std::string::npos &&
         name != "truth" && !name.ends_with(" truth");
}

struct Entry {
  std::size_t row = 0, column = 0;
  double badness = 0;
};

/// Marks the values that equal the best, where there is more than one to compare.
void mark_best(const std::vector<Entry>& entries, std::vector<std::vector<bool>>& best) {
  if (entries.size() < 2) return;
  const auto least = [](const Entry& a, const Entry& b) { return a.badness < b.badness; };
  const double bound = std::min_element(entries.begin(), entries.end(), least)->badness;
  for (const Entry& entry : entries) best[entry.row][entry.column] = entry.badness == bound;
}

}  // namespace

std::vector<std::vector<bool>> best_cells(const Table& table) {
  std::vector<std::vector<bool>> best(table.rows.size(),
                                      std::vector<bool>(table.columns.size(), false));
  for (std::size_t c = table.names; c < table.columns.size(); ++c) {
    std::vector<Entry> entries;
    for (std::size_t r = 0; r < table.rows.size(); ++r) {
      const std::vector<std::string>& row = table.rows[r];
      const bool enters = std::all_of(row.begin(), row.begin() + static_cast<long>(table.names),
                                      [](const std::string& name) { return competes(name); });
      const std::optional<double> value = number(row[c]);
      const std::optional<double> bad = value ? badness(table.columns[c], *value) : std::nullopt;
      if (enters && bad) entries.push_back({r, c, *bad});
    }
    mark_best(entries, best);
  }
  if (!table.title.starts_with("Mean IoU")) return best;
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    std::vector<Entry> entries;
    for (std::size_t c = table.names; c < table.columns.size(); ++c)
      if (const auto value = number(table.rows[r][c]); value && competes(table.columns[c]))
        entries.push_back({r, c, -*value});
    mark_best(entries, best);
  }
  return best;
}

std::string joined(std::span<const Table> tables, std::string (*text)(const Table&)) {
  std::string all;
  for (const Table& table : tables) {
    if (!all.empty()) all += '\n';
    all += text(table);
  }
  return all;
}

}  // namespace planescope::lab
