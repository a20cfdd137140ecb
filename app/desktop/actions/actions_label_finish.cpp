// Gestures that finish the active plane: each shows what it would change, Enter does it in one step
// of undo. And the view by which one sees what to trim.

#include <fmt/format.h>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/labeling/work.hpp"
#include "core/labels/wand/finish.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

/// The wand's tolerance holds, its lasso does not.
labels::WandOptions options_of(const State& state) { return state.view.label.wand_options; }

void show(State& state,
          int plane,
          const std::string& title,
          const std::string& nothing,
          labels::Finish finish) {
  LabelView& view = state.view.label;
  let_go(view);
  view.plane = plane;
  view.paints = Paints::plane;
  if (finish.empty()) return say_nothing_done(state, fmt::format("P{} {}", plane, nothing));
  const char* const sample = sample_name(*state.label_frame());
  std::string what;
  if (!finish.adds.empty()) what = counted(finish.adds.size(), sample) + " more";
  if (!finish.takes.empty())
    what += (what.empty() ? "" : ", ") + counted(finish.takes.size(), sample) + " less";
  say_hint(state, fmt::format("{}: {}; Enter accepts, Esc cancels", title, what),
           [](const State& s) { return !s.view.label.finish; });
  view.finish = FinishPreview{plane, title, std::move(finish)};
}

using Finishing = labels::Finish (*)(const FrameLabels&,
                                     const labels::LabelGrid&,
                                     int,
                                     const labels::WandOptions&);

/// `verb`: "Fill the holes of"; `nothing`: what the plane is told not to have.
Action finishing(const char* name,
                 const char* title,
                 const char* key,
                 const char* verb,
                 const char* nothing,
                 Finishing finish) {
  const auto run = [=](State& s, const std::string& text) {
    const LabelWork work = label_work(s);
    const int plane = plane_argument(s, name, text);
    show(s, plane, fmt::format("{} P{}", verb, plane), nothing,
         finish(*work.labels, work.frame.grid, plane, options_of(s)));
  };
  return {name, title, "Planes", key, "[PLANE]", run, can_label, {}};
}

void drop_specks(State& state, const std::string& text) {
  const LabelWork work = label_work(state);
  const int plane = plane_argument(state, "label.specks", "");
  const double least_cm2 = text.empty() ? 1e4 * labels::AuditOptions{}.min_area_m2
                                        : number_argument("label.specks", text);
  if (!(least_cm2 > 0))
    throw Error(fmt::format("action label.specks: {} cm2 is not a valid speck size", text));
  show(state, plane, fmt::format("Drop the specks of P{} below {:g} cm²", plane, least_cm2),
       fmt::format("has no specks below {:g} cm²", least_cm2),
       labels::drop_specks(*work.labels, work.frame.grid, plane, 1e-4 * least_cm2));
}

}  // namespace

std::vector<Action> label_finish_actions() {
  return {
      finishing("label.fill", "Fill the holes", "Shift+H", "Fill the holes of",
                "has no holes to fill", labels::fill_holes),
      finishing("label.smooth", "Smooth the border", "Shift+E", "Smooth the border of",
                "already has a smooth border", labels::smooth_border),
      finishing("label.grow", "Grow to the border of the surface", "Shift+R", "Grow",
                "already reaches the border of its surface", labels::grow_to_border),
      {"label.specks", "Drop specks", "Planes", "Shift+C", "[CM2]", drop_specks, can_label, {}},
      {"label.residual",
       "Distance to the active plane",
       "Tools",
       "Shift+V",
       "",
       [](State& s, const std::string&) {
         s.view.label.show_residual = !s.view.label.show_residual;
       },
       {},
       [](const State& s) { return s.view.label.show_residual; }},
  };
}

}  // namespace planescope::desktop
