#include "core/lab/experiments/best_cells.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

namespace planescope::lab {
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

}  // namespace planescope::lab
