#pragma once

#include <fmt/format.h>

#include <span>
#include <string>
#include <vector>

namespace planescope::lab {

/// A table for people. Its first `names` columns are words, the others figures.
struct Table {
  std::string title;
  std::string note;  // what the columns are, how it was measured
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  // as long as `columns`
  std::size_t names = 1;
};

std::string to_text(const Table& table);      // aligned, for a terminal
std::string to_markdown(const Table& table);  // a heading of the third level, the table, the note

/// By row and column, whether a method is best there: in its column, which says by its name whether
/// the least, the most or the nearest to 100 is good; or in its row, where methods are columns (a
/// table of mean IoU). Printed numbers, the oracle and true labels do not compete; of other tables
/// nothing is best.
std::vector<std::vector<bool>> best_cells(const Table& table);

/// Tables one after the other, each by itself.
std::string joined(std::span<const Table> tables, std::string (*text)(const Table&));

// Figures as cells have them.

inline std::string fixed(double value, int digits) { return fmt::format("{:.{}f}", value, digits); }

/// Frames a second; a dash where there was nothing to do.
inline std::string speed_text(double fps) { return fps > 0 ? fixed(fps, 1) : "-"; }

inline double percent(int part, int whole) { return whole > 0 ? 100.0 * part / whole : 0; }

}  // namespace planescope::lab
