#pragma once

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

}  // namespace planescope::lab
