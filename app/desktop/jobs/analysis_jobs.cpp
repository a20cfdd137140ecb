// Background jobs of the debugger: search for fixes, check their effects, and compute sensitivity
// curves.

#include <algorithm>

#include "app/desktop/jobs/jobs.hpp"
#include "core/debug/explain/provenance.hpp"
#include "core/labels/wand/wand.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

/// Voxels of the surface around a voxel, ascending; empty if there is no plane.
std::vector<std::uint32_t> surface_at(const debug::Run& run,
                                      const labels::LabelGrid& grid,
                                      std::uint32_t voxel) {
  const debug::Subject& subject = *run.subject;
  const auto seed = static_cast<std::uint32_t>(debug::source_of_voxel(subject, voxel));
  const auto surface = labels::grow_plane(grid, nullptr, std::span(&seed, 1), {});
  return surface ? subject.voxels_of_sources(surface->pixels) : std::vector<std::uint32_t>();
}

/// Target of the search for fixes after a click. Finds the surface with the label wand, which takes
/// about 50 ms for a depth image.
debug::FixTarget fix_target(const debug::Run& run, const PointAsked& asked) {
  if (asked.wish == debug::Wish::no_plane)
    return debug::target_of_click(run, asked.voxel, asked.wish);
  const debug::Subject& subject = *run.subject;
  const labels::LabelGrid grid = labels::make_label_grid(subject.frame, subject.prepared.gravity);
  std::vector<std::uint32_t> surface = surface_at(run, grid, asked.voxel);
  if (asked.wish == debug::Wish::joined && asked.with >= 0) {
    const auto other = surface_at(run, grid, static_cast<std::uint32_t>(asked.with));
    std::vector<std::uint32_t> both;
    std::ranges::set_union(surface, other, std::back_inserter(both));
    surface = std::move(both);
  }
  debug::FixTarget target =
      debug::target_of_click(run, asked.voxel, asked.wish, std::move(surface));
  target.with = asked.with;
  return target;
}

using View = std::shared_ptr<const RunView>;

class AnalysisJobs : public JobGroup {
 public:
  AnalysisJobs(Courier& courier, FrameTools& tools, std::function<bool()> frame_is_run)
      : tools_(tools),
        frame_is_run_(std::move(frame_is_run)),
        search_(courier),
        check_(courier),
        curves_(courier) {}

  void pursue(State& state) override {
    pursue_search(state);
    pursue_check(state);
    pursue_curves(state);
  }
  bool busy(bool background) const override {
    return search_.busy() || check_.busy() || (background && curves_.busy());
  }

 private:
  void pursue_search(State& state);
  void pursue_check(State& state);
  void pursue_curves(State& state);

  FrameTools& tools_;
  std::function<bool()> frame_is_run_;
  Request<View> search_;  // last: their threads use the members above
  Request<debug::Fix> check_;
  Request<View> curves_;
};

void refuse_fixes(State& state, const std::string& why) {
  state.results.fix = {};
  say(state, why, true);
}

void AnalysisJobs::pursue_search(State& state) {
  FixSearch& fix = state.results.fix;
  const View& view = state.results.current;
  if (fix.running && fix.begun && fix.asked && fix.of != view && !state.view.preview)
    fix.running = false;  // its results could not be shown
  if (search_.key() && !(fix.running && fix.begun)) search_.drop();
  if (!fix.running || fix.begun || !view) return;
  fix.begun = true;
  fix.of = view;
  check_.drop();
  curves_.drop();
  search_.ask(
      view,
      [target = fix.target, asked = fix.asked, view](const Turn& turn) mutable {
        if (asked) {
          const bool far = target.far;
          target = fix_target(*view->run, *asked);
          target.far = far;
          turn.deliver([target](State& s) { s.results.fix.target = target; });
        }
        const auto found =
            debug::find_fixes(*view->run, target, turn.stop,
                              [&](int done, int total, const std::vector<debug::Fix>& so_far) {
                                turn.deliver([done, total, so_far](State& s) {
                                  s.results.fix.done = done;
                                  s.results.fix.total = total;
                                  s.results.fix.fixes = so_far;
                                });
                              });
        const bool granted = found.empty() && debug::is_granted(*view->run, target);
        turn.deliver([found, granted](State& s) {
          s.results.fix.granted = granted;
          s.results.fix.running = false;
          s.results.fix.finished = true;
          s.results.fix.fixes = found;
        });
      },
      refuse_fixes);
}

/// Computes the effect of a fix on every labeled frame of the recording.
void AnalysisJobs::pursue_check(State& state) {
  FixSearch& fix = state.results.fix;
  if (check_.key() && !(fix.checked >= 0 && fix.check_begun)) check_.drop();
  if (!fix.finished || fix.checked < 0 || fix.check_begun || !state.document.current()) return;
  fix.check_begun = true;
  search_.drop();
  curves_.drop();
  const debug::Fix& chosen = fix.fixes[static_cast<std::size_t>(fix.checked)];
  check_.ask(
      chosen,
      [this, wanted = wanted_in(state, 0), chosen](const Turn& turn) mutable {
        planes::PipelineOptions after = wanted.options;
        planes::set_option(after, chosen.option, chosen.after);
        for (int i = 0; i < wanted.recording->frame_count(); ++i) {
          turn.expect_wanted();
          wanted.frame = i;
          try {
            const auto with = load_subject(wanted, tools_);
            if (!with->voxel_truth.known()) continue;
            debug::FixEffect effect =
                debug::effect_of(*debug::make_run(with, wanted.options), after);
            effect.frame = i;
            turn.deliver([effect](State& s) { s.results.fix.effects.push_back(effect); });
          } catch (const std::exception&) {
            // A frame that cannot be processed cannot be broken by a fix; the strip shows its
            // error.
          }
        }
      },
      refuse_fixes);
}

/// Computes the score as a function of each option that affects the run, for the sliders. Waits for
/// all other work.
void AnalysisJobs::pursue_curves(State& state) {
  const View& view = state.results.current;
  if (state.view.mode == Mode::labels) {  // has no sliders
    if (curves_.pending()) curves_.drop();
    return;
  }
  if (curves_.key() == view || state.view.tool_tab != "criteria") return;
  if (frame_is_run_() || search_.pending() || check_.pending()) return;
  std::vector<std::string> shown;
  if (view && view->run->is_ours())  // options of other methods take too long to sweep
    for (const planes::OptionInfo& info : planes::option_table())
      if (info.is_number() && info.steers_segmentation() &&
          !planes::is_idle(info, state.document.options, view->run->is_on_image()) &&
          !state.results.sensitivity.contains(info.name))
        shown.push_back(info.name);
  curves_.ask(view, [view, shown](const Turn& turn) {
    for (const std::string& name : shown) {
      const debug::Sensitivity sensitivity = debug::sensitivity_of(*view->run, name, turn.stop);
      turn.expect_wanted();
      turn.deliver([sensitivity, view](State& s) {
        if (s.results.current == view) s.results.sensitivity[sensitivity.option] = sensitivity;
      });
    }
  });
}

}  // namespace

std::unique_ptr<JobGroup> make_analysis_jobs(Courier& courier,
                                             FrameTools& tools,
                                             std::function<bool()> frame_is_run) {
  return std::make_unique<AnalysisJobs>(courier, tools, std::move(frame_is_run));
}

}  // namespace planescope::desktop
