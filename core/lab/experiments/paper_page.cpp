// index.html of `planescope-lab bench paper`, from assets/report/results_page.mustache.

#include "core/lab/experiments/paper_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <kainjow/mustache.hpp>

#include "core/lab/bench/results_page.hpp"
#include "core/lab/experiments/paper_tables.hpp"
#include "core/report/page/pictures.hpp"

namespace planescope::lab {
namespace {

using Data = kainjow::mustache::data;
using kainjow::mustache::html_escape;
using Facts = std::vector<std::pair<std::string, std::string>>;

// ---- What was run ----

Facts record_facts(const PaperResults& results, const PaperTimings* timings) {
  Facts rows;
  const auto add = [&](const std::string& name, const std::string& html) {
    rows.emplace_back(name, html);
  };
  const report::BuildInfo& build = results.build;
  add("Command", "<pre>" + html_escape(results.command) + "</pre>");
  add("planescope", fmt::format("{}, commit <code>{}</code>{}", html_escape(build.version),
                                html_escape(build.commit), build.modified ? " with changes" : ""));
  add("Seeds", fmt::format("{} for everything printed here, {} for tuning", results.seed,
                           results.tuning_seed));
  if (!results.weights.sha256.empty())
    add("Weights of gcn",
        fmt::format("{} ({}), SHA-256 <code>{}</code>", html_escape(results.weights.file),
                    html_escape(results.weights.network), html_escape(results.weights.sha256)));
  if (timings)
    add("Timed on",
        fmt::format("{}; {} threads", html_escape(to_text(timings->machine)), timings->threads));
  if (results.quick) add("Quick", "fewer frames and cells than the full run has");
  if (results.real.empty()) add("Recordings", "none: table IV and real scenes are left out");
  if (results.count > 0) add("Frames", fmt::format("at most {} of each set", results.count));
  return rows;
}

bool is_partial(const PaperResults& results) { return results.quick || results.count > 0; }

std::string lead(const std::vector<Claim>& claims, const PaperResults& results) {
  if (claims.empty()) return "Every table and figure of the paper, measured again.";
  const auto met =
      std::count_if(claims.begin(), claims.end(), [](const Claim& c) { return c.met; });
  return fmt::format(
      "Every table and figure of the paper, measured again beside the printed numbers, and "
      "measures on which methods really differ. {} of {} bars are met with the printed seed{}.",
      met, claims.size(),
      is_partial(results) ? ", but this is not the full run that they are for" : "");
}

Data claims_data(const std::vector<Claim>& claims) {
  Data rows{Data::type::list};
  for (const Claim& claim : claims) {
    Data row;
    row.set("set", claim.set);
    row.set("measure", claim.measure);
    row.set("bar", claim.bar);
    row.set("value", fmt::format("{:.3f}", claim.value));
    row.set("tuning", std::isnan(claim.tuning) ? "-" : fmt::format("{:.3f}", claim.tuning));
    row.set("met", claim.met ? "met" : "missed");
    row.set("class", claim.met ? "met" : "missed");
    row.set("others", claim.others);
    rows.push_back(row);
  }
  return rows;
}

std::vector<Chapter> chapters(const PaperResults& results, const PaperTimings* timings) {
  std::vector<Chapter> all = {
      {"paper",
       "The paper's tables",
       "In each column the best of what was measured, with labels that were not given, is bold.",
       {},
       paper_tables(results)},
      {"noise",
       "Against noise",
       "Stairs of 8192 points, labels of the 3D-GCN.",
       noise_plots(results),
       {}},
      {"stricter", "Stricter measures", "", set_plots(results), stricter_tables(results)},
  };
  if (timings) all.push_back({"timings", "Timings", "", {}, timing_tables(*timings)});
  std::erase_if(all, [](const Chapter& chapter) { return chapter.empty(); });
  return all;
}

// ---- Pictures ----

/// The position of a name among those seen so far, from 1.
std::size_t place_in(std::vector<std::string>& names, const std::string& name) {
  const auto at = std::find(names.begin(), names.end(), name);
  if (at != names.end()) return static_cast<std::size_t>(at - names.begin()) + 1;
  names.push_back(name);
  return names.size();
}

bool any_named(const std::vector<std::string>& names) {
  return std::any_of(names.begin(), names.end(), [](const std::string& n) { return !n.empty(); });
}

Data picture_data(const PaperFigure& figure, std::size_t index) {
  const PaperPicture& picture = figure.pictures[index];
  Data data;
  data.set("anchor", fmt::format("{}-{}", figure.id, index));
  data.set("back", figure.id);
  data.set("copy", report::base64(picture.copy));
  data.set("width", std::to_string(picture.width));
  data.set("height", std::to_string(picture.height));
  data.set("caption", picture.caption);
  data.set("alt", fmt::format("{} {}: {}", picture.row, picture.column, picture.caption));
  return data;
}

/// Pictures in a grid of rows and columns, whose names stand at its edges.
Data figure_data(const PaperFigure& figure) {
  std::vector<std::string> rows, columns;
  for (const PaperPicture& picture : figure.pictures) {
    place_in(rows, picture.row);
    place_in(columns, picture.column);
  }
  const std::size_t side = any_named(rows) ? 1 : 0, top = any_named(columns) ? 1 : 0;
  const auto place = [](std::size_t row, std::size_t column) {
    return fmt::format("grid-row:{};grid-column:{}", row, column);
  };
  Data cells{Data::type::list};
  const auto add_heading = [&](const std::string& text, bool at_side, const std::string& where) {
    Data heading, cell;
    heading.set("text", text);
    heading.set("side", at_side);
    heading.set("place", where);
    cell.set("heading", heading);
    cell.set("picture", false);
    cells.push_back(cell);
  };
  for (std::size_t c = 0; top > 0 && c < columns.size(); ++c)
    add_heading(columns[c], false, place(1, c + 1 + side));
  for (std::size_t r = 0; side > 0 && r < rows.size(); ++r)
    add_heading(rows[r], true, place(r + 1 + top, 1));
  for (std::size_t i = 0; i < figure.pictures.size(); ++i) {
    const PaperPicture& picture = figure.pictures[i];
    Data data = picture_data(figure, i), cell;
    data.set("place",
             place(place_in(rows, picture.row) + top, place_in(columns, picture.column) + side));
    cell.set("heading", false);
    cell.set("picture", data);
    cells.push_back(cell);
  }
  Data data;
  data.set("id", figure.id);
  data.set("title", figure.title);
  data.set("note", text_or_false(figure.note));
  data.set("grid", fmt::format("{}repeat({},minmax(0,1fr))", side > 0 ? "minmax(90px,130px) " : "",
                               columns.size()));
  data.set("cells", cells);
  return data;
}

}  // namespace

std::string paper_page(const PaperResults& results,
                       const PaperTimings* timings,
                       std::span<const PaperFigure> figures) {
  const std::vector<Claim> all_claims = claims(results);
  Facts before, after;
  if (!all_claims.empty()) before.emplace_back("claims", "What is claimed");
  Data figure_list{Data::type::list}, more;
  for (const PaperFigure& figure : figures) {
    if (figure.pictures.empty()) continue;
    after.emplace_back(figure.id, figure.title);
    figure_list.push_back(figure_data(figure));
  }
  more.set("has_claims", !all_claims.empty());
  more.set("claims", claims_data(all_claims));
  more.set("figures", figure_list);
  const ResultsPage page = {
      .title = "The paper\u2019s experiments",
      .brand = "planescope-lab bench paper",
      .lead = lead(all_claims, results),
      .version = results.build.version,
      .footer =
          "After Sun et al. 2023, &ldquo;Multi-Resolution Planar Region Extraction for Uneven "
          "Terrains&rdquo;. The same figures stand in <code>paper.json</code> and "
          "<code>paper.md</code> beside this page, the pictures at full size as PNG.",
      .facts = record_facts(results, timings),
      .chapters = chapters(results, timings)};
  return results_page(page, more, before, after);
}

}  // namespace planescope::lab
