// The table of planes.

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/debugger/plane_table.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

void sort_by(State& state, const std::string& text) {
  std::vector<std::string> names;
  for (const PlaneColumnInfo& column : kPlaneColumns) names.emplace_back(column.name);
  const auto column = static_cast<PlaneColumn>(choice_argument("planes.sort", text, names));
  PlanesView& view = state.view.planes;
  // The numbers that one looks for first are the large ones, but for the name and the margin.
  view.descending = view.sorted_by == column
                        ? !view.descending
                        : column != PlaneColumn::id && column != PlaneColumn::label &&
                              column != PlaneColumn::margin;
  view.sorted_by = column;
}

void copy(State& state, const std::string&) {
  const std::vector<PlaneRow> rows = plane_rows(state);
  state.view.to_clipboard = planes_csv(rows);
  say(state, counted(rows.size(), "plane") + " copied as CSV");
}

}  // namespace

std::vector<Action> plane_table_actions() {
  const auto known = [](const State& s) { return s.planes() != nullptr; };
  return {
      {"planes.sort",
       "Sort planes",
       "",
       "",
       "id|class|area|tilt|rms|points|support|steppable",
       sort_by,
       {},
       {}},
      {"planes.filter",
       "Filter planes",
       "",
       "",
       "[TEXT]",
       [](State& s, const std::string& text) { s.view.planes.filter = text; },
       {},
       {}},
      {"planes.copy", "Copy planes as CSV", "Select", "Ctrl+Shift+C", "", copy, known, {}},
  };
}

}  // namespace planescope::desktop
