#include "app/desktop/jobs/analysis_jobs.hpp"

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/jobs/fix_target.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {

AnalysisJobs::AnalysisJobs(std::function<void(std::function<void(State&)>)> deliver,
                           std::function<void()> wake,
                           FrameTools& tools)
    : deliver_(std::move(deliver)),
      tools_(tools),
      worker_(std::move(wake), [this](const std::string& why) {
        deliver_([why](State& state) { say(state, why, true); });
      }) {}
AnalysisJobs::~AnalysisJobs() { worker_.cancel(); }

void AnalysisJobs::pursue(State& state, bool running) {
  pursue_fix(state);
  pursue_sensitivity(state, running);
}

bool AnalysisJobs::busy(bool background) const {
  return worker_.busy() && (background || kind_ != Kind::sensitivity);
}

void AnalysisJobs::stop() {
  worker_.cancel();
  if (kind_ == Kind::sensitivity) swept_ = nullptr;  // to be begun again
  kind_ = Kind::none;
  ++number_;
}

void AnalysisJobs::start(Kind what, std::function<void(std::stop_token, int)> work) {
  stop();
  kind_ = what;
  worker_.replace([this, work = std::move(work), number = number_](std::stop_token stop) {
    try {
      work(stop, number);
    } catch (const std::exception& error) {
      deliver(number, [why = message_of(error)](State& state) {
        state.results.fix = {};
        say(state, why, true);
      });
    }
    deliver(number, [this](State&) { kind_ = Kind::none; });
  });
}

void AnalysisJobs::deliver(int number, std::function<void(State&)> delivery) {
  deliver_([this, number, delivery = std::move(delivery)](State& state) {
    if (number == number_) delivery(state);
  });
}

void AnalysisJobs::pursue_fix(State& state) {
  FixSearch& fix = state.results.fix;
  if (fix.running && fix.begun && fix.asked && fix.of != state.results.current &&
      !state.view.preview)
    fix.running = false;  // its results could not be shown
  const bool searches = fix.running && fix.begun, checks = fix.checked >= 0 && fix.check_begun;
  if (kind_ == Kind::search && !searches) stop();
  if (kind_ == Kind::check && !checks) stop();
  if (fix.running && !fix.begun && state.results.current) {
    fix.begun = true;
    fix.of = state.results.current;
    start(Kind::search, [this, target = fix.target, asked = fix.asked,
                         view = state.results.current](std::stop_token stop, int number) mutable {
      if (asked) {
        const bool far = target.far;
        target = fix_target(*view->run, *asked);
        target.far = far;
        deliver(number, [target](State& s) { s.results.fix.target = target; });
      }
      const auto found =
          debug::find_fixes(*view->run, target, stop,
                            [&](int done, int total, const std::vector<debug::Fix>& so_far) {
                              deliver(number, [done, total, so_far](State& s) {
                                s.results.fix.done = done;
                                s.results.fix.total = total;
                                s.results.fix.fixes = so_far;
                              });
                            });
      const bool granted = found.empty() && debug::is_granted(*view->run, target);
      deliver(number, [found, granted](State& s) {
        s.results.fix.granted = granted;
        s.results.fix.running = false;
        s.results.fix.finished = true;
        s.results.fix.fixes = found;
      });
    });
  }
  if (fix.finished && fix.checked >= 0 && !fix.check_begun && state.document.current()) {
    fix.check_begun = true;
    const debug::Fix chosen = fix.fixes[static_cast<std::size_t>(fix.checked)];
    start(Kind::check, [this, wanted = wanted_in(state, 0), chosen](std::stop_token stop,
                                                                    int number) mutable {
      planes::PipelineOptions after = wanted.options;
      planes::set_option(after, chosen.option, chosen.after);
      for (int i = 0; i < wanted.recording->frame_count() && !stop.stop_requested(); ++i) {
        wanted.frame = i;
        try {
          const auto with = load_subject(wanted, tools_);
          if (!with->voxel_truth.known()) continue;
          debug::FixEffect effect = debug::effect_of(*debug::make_run(with, wanted.options), after);
          effect.frame = i;
          deliver(number, [effect](State& s) { s.results.fix.effects.push_back(effect); });
        } catch (const std::exception&) {
          // A frame that cannot be run has nothing to break; its own place in the strip says why.
        }
      }
    });
  }
}

void AnalysisJobs::pursue_sensitivity(State& state, bool running) {
  const auto& view = state.results.current;
  const bool fixing = kind_ == Kind::search || kind_ == Kind::check;
  const bool done = view == swept_;
  if (state.view.mode == Mode::labels) {  // shows no sliders
    if (kind_ == Kind::sensitivity) stop();
    return;
  }
  if (done || state.view.tool_tab != "criteria" || running || fixing) return;
  if (!view || !view->run->is_ours()) {  // what steers other methods takes too long to sweep
    stop();
    swept_ = view;
    return;
  }
  std::vector<std::string> shown;
  for (const planes::OptionInfo& info : planes::option_table())
    if (info.is_number() && info.steers_segmentation() &&
        !planes::is_idle(info, state.document.options, view->run->is_on_image()) &&
        !state.results.sensitivity.contains(info.name))
      shown.push_back(info.name);
  start(Kind::sensitivity, [this, view, shown](std::stop_token stop, int number) {
    for (const std::string& name : shown) {
      const debug::Sensitivity sensitivity = debug::sensitivity_of(*view->run, name, stop);
      if (stop.stop_requested()) return;
      deliver(number, [sensitivity, view](State& s) {
        if (s.results.current == view) s.results.sensitivity[sensitivity.option] = sensitivity;
      });
    }
  });
  swept_ = view;
}

}  // namespace planescope::desktop
