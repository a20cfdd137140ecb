#pragma once

// Results as one HTML page that needs nothing beside it: what was run, and chapters of plots and
// tables.

#include <kainjow/mustache.hpp>
#include <string>
#include <utility>
#include <vector>

#include "core/lab/bench/table.hpp"

namespace planescope::lab {

struct Plot {
  std::string title;
  std::string note;
  std::string svg;
};

struct Chapter {
  std::string id, name, intro;
  std::vector<Plot> plots;
  std::vector<Table> tables;

  bool empty() const { return plots.empty() && tables.empty(); }
};

struct ResultsPage {
  std::string title, brand, lead;                          // brand: the command
  std::string version;                                     // of planescope
  std::string footer;                                      // HTML
  std::vector<std::pair<std::string, std::string>> facts;  // what was run: name, HTML
  std::vector<Chapter> chapters;
};

/// An entry of the page's list of sections.
kainjow::mustache::data section_data(const std::string& id, const std::string& name);
kainjow::mustache::data text_or_false(const std::string& text);

/// `before`, `after`: more sections than the chapters, for whose bodies `more` has the template's
/// data.
std::string results_page(
    const ResultsPage& page,
    kainjow::mustache::data more = kainjow::mustache::data(kainjow::mustache::data::type::object),
    const std::vector<std::pair<std::string, std::string>>& before = {},
    const std::vector<std::pair<std::string, std::string>>& after = {});

}  // namespace planescope::lab
