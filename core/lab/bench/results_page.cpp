#include "core/lab/bench/results_page.hpp"

#include "core/model/error.hpp"
#include "core/report/page/charts.hpp"

extern "C" {
extern const char planescope_asset_report_css[], planescope_asset_report_css_end[];
extern const char planescope_asset_results_css[], planescope_asset_results_css_end[];
extern const char planescope_asset_results_page_mustache[],
    planescope_asset_results_page_mustache_end[];
}

namespace planescope::lab {
namespace {

using Data = kainjow::mustache::data;
using kainjow::mustache::html_escape;

Data facts_data(const std::vector<std::pair<std::string, std::string>>& facts) {
  Data rows{Data::type::list};
  for (const auto& [name, html] : facts) {
    Data row;
    row.set("name", name);
    row.set("value", html);
    rows.push_back(row);
  }
  return rows;
}

Data table_data(const Table& table) {
  Data data, columns{Data::type::list}, rows{Data::type::list};
  for (std::size_t c = 0; c < table.columns.size(); ++c) {
    Data column;
    column.set("name", table.columns[c]);
    column.set("left", c < table.names);
    columns.push_back(column);
  }
  const std::vector<std::vector<bool>> best = best_cells(table);
  for (std::size_t r = 0; r < table.rows.size(); ++r) {
    const std::vector<std::string>& row = table.rows[r];
    std::string cells;
    for (std::size_t c = 0; c < row.size(); ++c) {
      const std::string text = html_escape(row[c]);
      if (c == 0)
        cells += "<th scope=\"row\">" + text + "</th>";
      else if (c < table.names)
        cells += "<td class=\"name\">" + text + "</td>";
      else
        cells += best[r][c] ? "<td><strong>" + text + "</strong></td>" : "<td>" + text + "</td>";
    }
    Data line;
    line.set("cells", cells);
    // A line between groups of rows that begin alike.
    line.set("first", table.names > 1 && r > 0 && row[0] != table.rows[r - 1][0]);
    rows.push_back(line);
  }
  data.set("title", table.title);
  data.set("note", text_or_false(table.note));
  data.set("columns", columns);
  data.set("rows", rows);
  return data;
}

Data chapter_data(const Chapter& chapter) {
  Data data, plots{Data::type::list}, tables{Data::type::list};
  for (const Plot& plot : chapter.plots) {
    Data entry;
    entry.set("title", plot.title);
    entry.set("svg", plot.svg);
    entry.set("note", plot.note);
    plots.push_back(entry);
  }
  for (const Table& table : chapter.tables) tables.push_back(table_data(table));
  data.set("id", chapter.id);
  data.set("name", chapter.name);
  data.set("intro", text_or_false(chapter.intro));
  data.set("has_plots", !chapter.plots.empty());
  data.set("plots", plots);
  data.set("tables", tables);
  return data;
}

}  // namespace

kainjow::mustache::data section_data(const std::string& id, const std::string& name) {
  Data data;
  data.set("id", id);
  data.set("name", name);
  return data;
}

kainjow::mustache::data text_or_false(const std::string& text) {
  return text.empty() ? Data(false) : Data(text);
}

std::string results_page(const ResultsPage& page,
                         kainjow::mustache::data more,
                         const std::vector<std::pair<std::string, std::string>>& before,
                         const std::vector<std::pair<std::string, std::string>>& after) {
  std::vector<std::pair<std::string, std::string>> sections = before;
  Data chapters{Data::type::list}, entries{Data::type::list};
  for (const Chapter& chapter : page.chapters) {
    sections.emplace_back(chapter.id, chapter.name);
    chapters.push_back(chapter_data(chapter));
  }
  sections.insert(sections.end(), after.begin(), after.end());
  for (const auto& [id, name] : sections) entries.push_back(section_data(id, name));
  more.set("css", std::string(planescope_asset_report_css, planescope_asset_report_css_end) +
                      std::string(planescope_asset_results_css, planescope_asset_results_css_end) +
                      report::line_chart_style());
  more.set("title", page.title);
  more.set("brand", page.brand);
  more.set("lead", page.lead);
  more.set("version", page.version);
  more.set("footer", page.footer);
  more.set("first", sections.empty() ? "record" : sections.front().first);
  more.set("sections", entries);
  more.set("record", facts_data(page.facts));
  more.set("chapters", chapters);
  kainjow::mustache::mustache layout(std::string(planescope_asset_results_page_mustache,
                                                 planescope_asset_results_page_mustache_end));
  if (!layout.is_valid()) throw Error("results page template: " + layout.error_message());
  return layout.render(more);
}

}  // namespace planescope::lab
