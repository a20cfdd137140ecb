#include "app/desktop/jobs/jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>
#include <mutex>
#include <utility>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/debugger/axes.hpp"
#include "app/desktop/debugger/change_text.hpp"
#include "app/desktop/jobs/analysis_jobs.hpp"
#include "app/desktop/jobs/frame_work.hpp"
#include "app/desktop/jobs/label_jobs.hpp"
#include "app/desktop/jobs/learn_jobs.hpp"
#include "app/desktop/jobs/map_jobs.hpp"
#include "app/desktop/jobs/plane_work.hpp"
#include "app/desktop/jobs/report_arrival.hpp"
#include "app/desktop/jobs/spread_jobs.hpp"
#include "app/desktop/jobs/worker.hpp"
#include "app/desktop/look.hpp"
#include "app/desktop/tracks/map_view.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

// Options must stay the same for this long before all frames are run with them: that must not
// compete with a slider being dragged.
constexpr std::chrono::milliseconds kStripDelay{300};

/// In a world that was turned, nodes and voxels differ: none of them can be found again.
bool same_world(const debug::Subject& a, const debug::Subject& b) {
  return a.prepared.cloud.T_world_sensor.isApprox(b.prepared.cloud.T_world_sensor);
}

/// A slider is held, and not one of a foot or of stairs.
bool drags_a_run(const State& state) {
  const std::string gesture = state.undo.empty() ? "" : state.undo.back().gesture;
  return !gesture.empty() && !is_about_planes(planes::find_option(gesture));
}

/// Only of a change that the user has just made: not of one taken back, or shown for a while.
void tell_of_change(State& state, const RunView* before, const RunView& now) {
  if (!before || state.view.preview || state.undo.empty()) return;
  const OptionChange& last = state.undo.back();
  if (run_key(last.before) != run_key(before->run->options) ||
      run_key(last.after) != run_key(now.run->options) || !state.view.message.empty())
    return;
  const std::string text = change_text(*before->run, *now.run);
  if (!text.empty()) say(state, text + " · Ctrl+Z");
}

}  // namespace

struct Jobs::Impl {
  std::function<void()> wake;
  std::mutex mutex;
  std::vector<Delivery> deliveries;
  FrameTools tools;
  ColorBook colors;

  // What was asked for last; touched by the window's thread only.
  std::optional<Wanted> run_wanted;
  std::optional<Wanted> strip_wanted;  // what the strip is filled with; nothing: it is stopped
  std::optional<Wanted> strip_next;    // what it is to be filled with when the options have rested
  std::shared_ptr<const io::Recording> strip_of;
  bool strip_plain = false;             // pictures alone, as the label mode needs them
  std::optional<Wanted> strip_ran_as;   // what the frames were run as ...
  std::vector<std::uint8_t> strip_ran;  // ... those that were
  std::chrono::steady_clock::time_point strip_due;
  bool strip_waits = false;
  int strip_number = 0;  // of the filling; what an earlier one still delivers is dropped
  std::shared_ptr<const RunView> planes_of;  // what is told of this run's planes ...
  std::string planes_by;                     // ... by these options
  std::shared_ptr<const RunView> compared_a, compared_b;
  Against compared_against = Against::nothing;

  // Touched by the run worker's thread only.
  std::optional<Wanted> loaded;
  std::shared_ptr<const debug::Subject> subject;
  render::Home home;

  // Last: their threads use the above. What one finishes may be what another waits for.
  std::function<void()> rested = [this] { wake(); };
  std::function<void(const std::string&)> failed = [this](const std::string& why) {
    deliver([why](State& state) { say(state, why, true); });
  };
  Worker runs{rested, failed}, covers{rested, failed}, compares{rested, failed},
      strip{rested, failed};
  AnalysisJobs analysis{[this](Delivery delivery) { deliver(std::move(delivery)); },
                        [this] { wake(); }, tools};
  LabelJobs labels{[this](Delivery delivery) { deliver(std::move(delivery)); }, [this] { wake(); }};
  MapJobs maps{[this](Delivery delivery) { deliver(std::move(delivery)); }, [this] { wake(); }};
  SpreadJobs spreading{[this](Delivery delivery) { deliver(std::move(delivery)); },
                       [this] { wake(); }};
  LearnJobs learning{[this](Delivery delivery) { deliver(std::move(delivery)); },
                     [this] { wake(); }};

  void deliver(Delivery delivery) {
    {
      const std::lock_guard lock(mutex);
      deliveries.push_back(std::move(delivery));
    }
    wake();
  }

  std::shared_ptr<const RunView> view_of(const Wanted& wanted,
                                         const render::ColoredPlanes* like,
                                         std::string& refused_labels);
  void run_frame(const Wanted& wanted,
                 const render::ColoredPlanes* like,
                 const std::shared_ptr<const ReportPlace>& place);
  std::shared_ptr<const RunView> run_a(const Wanted& wanted,
                                       const render::ColoredPlanes* like,
                                       std::string& problems);
  void show_run(State& state, const std::shared_ptr<const RunView>& view);
  void stop_strip();
  void pursue_run(State& state);
  void pursue_planes(State& state);
  void pursue_comparison(State& state);
  void pursue_strip(State& state);
};

/// The colors in which the frame shown has its planes: A's where there is one. Null: none yet.
std::shared_ptr<const render::ColoredPlanes> planes_shown(const State& state) {
  const Results& results = state.results;
  const RunView* view = results.pinned ? results.pinned.get() : results.current.get();
  return view ? shown_colors(state, *view).planes : nullptr;
}

/// `like`: as in ColorBook::colors().
std::shared_ptr<const RunView> Jobs::Impl::view_of(const Wanted& wanted,
                                                   const render::ColoredPlanes* like,
                                                   std::string& refused_labels) {
  const bool fresh = !subject || !loaded || !loaded->same_subject(wanted);
  if (fresh) {
    subject = nullptr;
    subject = load_subject(wanted, tools, &refused_labels);
    loaded = wanted;
  }
  auto run = debug::make_run(subject, wanted.options);
  if (fresh) home = home_of(*run);
  FrameColors of_planes = colors.colors(wanted, *run, like);
  return view_run(std::move(run), home, wanted, std::move(of_planes));
}

/// Null where the frame cannot be run with these options, and `problems` says why; B is shown all
/// the same.
std::shared_ptr<const RunView> Jobs::Impl::run_a(const Wanted& wanted,
                                                 const render::ColoredPlanes* like,
                                                 std::string& problems) {
  try {
    auto view = view_of(wanted, like, problems);
    deliver([wanted, view](State& state) {
      if (!wanted.is_shown(state.document)) return;
      state.results.pinned = view;
      state.results.pinned_colors = view->colors;
    });
    return view;
  } catch (const std::exception& error) {
    problems = fmt::format("no A: {}", message_of(error));
    return nullptr;
  }
}

/// `like`: as in ColorBook::colors(). `place`: where the window is to stand then, null to leave
/// that to the view.
void Jobs::Impl::run_frame(const Wanted& wanted,
                           const render::ColoredPlanes* like,
                           const std::shared_ptr<const ReportPlace>& place) {
  try {
    std::string problems;
    std::shared_ptr<const RunView> a;
    if (place && place->options_a)
      a = run_a(with_options(wanted, *place->options_a), like, problems);
    const auto view = view_of(wanted, a ? a->colors.planes.get() : like, problems);
    std::optional<RunArrival> arrival;
    if (place) arrival = arrival_at(*place, a ? a->run.get() : nullptr, *view->run);
    deliver([this, wanted, view, arrival, problems](State& state) {
      if (!wanted.is_shown(state.document)) return;
      show_run(state, view);
      if (arrival) show_arrival(state, *arrival);
      const bool both = arrival && !problems.empty() && !arrival->message.empty();
      if (!problems.empty()) say(state, both ? problems + "; " + arrival->message : problems, true);
    });
  } catch (const std::exception& error) {
    deliver([wanted, message = message_of(error)](State& state) {
      if (!wanted.is_shown(state.document)) return;
      state.results.current = nullptr;
      state.results.loading = false;
      state.results.refusal = message;
      state.view.selected = {};
      state.view.step = 0;
      refresh_matches(state);
    });
  }
}

void Jobs::Impl::show_run(State& state, const std::shared_ptr<const RunView>& view) {
  const std::shared_ptr<const RunView> before = state.results.current;
  const bool other_frame = !before ||
                           before->run->subject->frame.index != view->run->subject->frame.index ||
                           state.results.loading;
  const bool turned = !other_frame && !same_world(*before->run->subject, *view->run->subject);
  state.results.current = view;
  state.results.loading = false;
  state.results.refusal.clear();
  state.results.sensitivity.clear();
  tell_of_change(state, before.get(), *view);
  FixSearch& fix = state.results.fix;
  if (before && before->run->subject != view->run->subject) {
    fix = {};  // its voxels are another subject's
    state.view.preview.reset();
  } else if (fix.of && run_key(fix.of->run->options) == run_key(view->run->options)) {
    fix.of = view;  // the same again, as after a preview
  }
  // Voxels are numbered anew with every subject.
  if (before && before->run->subject != view->run->subject) state.document.marked.clear();
  std::erase_if(state.document.marked,
                [&](std::uint32_t voxel) { return voxel >= view->run->subject->voxel_count(); });
  if (other_frame) state.view.shown_steps.reset();
  if (state.view.arrival) {
    const Bookmark arrival = *state.view.arrival;
    state.view.arrival.reset();
    go_to_bookmark(state, arrival);
  } else if (other_frame || (turned && !state.view.flash)) {
    go_to_step(state, view->run->steps());
    state.view.shown_steps.reset();  // on the traversal: there are the decisions to look for
    refresh_matches(state);
  } else if (!state.view.flash) {
    follow_run(state, *before->run);
  }
  if (const std::optional<TrackPlace>& place = state.view.tracks.place;
      place && place->frame == state.document.frame && view->map) {
    go_to_track(state, *std::exchange(state.view.tracks.place, std::nullopt));
  }
}

void Jobs::Impl::pursue_run(State& state) {
  if (!state.document.current()) return;
  Wanted wanted = wanted_in(state, state.document.frame);
  if (const auto& preview = state.view.preview) {
    planes::PipelineOptions options = wanted.options;
    planes::set_option(options, preview->option, preview->value);
    wanted = with_options(std::move(wanted), options);
  }
  if (run_wanted && *run_wanted == wanted) return;
  if (!run_wanted || run_wanted->recording != wanted.recording ||
      run_wanted->frame != wanted.frame) {
    state.results.loading = true;
    state.results.current = nullptr;
  }
  run_wanted = wanted;
  runs.replace([this, wanted, like = planes_shown(state),
                place = std::exchange(state.view.report_place, nullptr)](std::stop_token) {
    run_frame(wanted, like.get(), place);
  });
}

/// Not while a frame is run, or may be run again at once: a slider that is dragged has the machine
/// for itself.
void Jobs::Impl::pursue_planes(State& state) {
  Results& results = state.results;
  std::erase_if(results.planes, [&](const auto& planes) {
    return planes->of != results.current && planes->of != results.pinned;
  });
  const auto& view = state.view.flash && results.pinned ? results.pinned : results.current;
  if (!view || runs.busy() || drags_a_run(state)) return;
  const std::string key = planes_key(state.document.options);
  if (view == planes_of && key == planes_by) return;
  planes_of = view;
  planes_by = key;
  const RunPlanes* known = state.planes();
  if (known && known->key == key) return;
  covers.replace([this, view, options = state.document.options](std::stop_token) {
    deliver([this, planes = planes_of_run(view, options)](State& s) {
      if (planes->key != planes_by) return;  // what is asked for by now may have been known before
      std::erase_if(s.results.planes, [&](const auto& other) { return other->of == planes->of; });
      s.results.planes.push_back(planes);
    });
  });
}

void Jobs::Impl::pursue_comparison(State& state) {
  const Against against = state.view.against;
  const auto a = against == Against::pinned ? state.results.pinned : nullptr;
  const auto b = against == Against::nothing ? nullptr : state.results.current;
  if (a == compared_a && b == compared_b && against == compared_against) return;
  compared_a = a;
  compared_b = b;
  compared_against = against;
  if (!b || (against == Against::pinned && !a)) {
    state.results.comparison = nullptr;
    return;
  }
  compares.replace([this, a, b, against](std::stop_token) {
    const auto comparison = std::make_shared<const debug::Comparison>(
        a ? debug::compare_runs(*a->run, *b->run) : debug::compare_with_truth(*b->run));
    deliver([this, a, b, against, comparison](State& s) {
      if (a != compared_a || b != compared_b || against != compared_against) return;
      s.results.comparison = comparison;
      s.results.compared_a = a;
      s.results.compared_b = b;
    });
  });
}

void Jobs::Impl::stop_strip() {
  strip.cancel();
  strip_wanted.reset();
  ++strip_number;
}

void Jobs::Impl::pursue_strip(State& state) {
  strip_waits = false;
  if (!state.document.current() || state.results.loading || runs.busy()) return;
  Wanted wanted = wanted_in(state, 0);
  const auto count = static_cast<std::size_t>(wanted.recording->frame_count());
  const bool same_recording = strip_of == wanted.recording && state.results.strip.size() == count;
  const bool plain = state.view.mode == Mode::labels || !wanted.recording->info().knows_camera();
  if (same_recording && strip_next && *strip_next == wanted && strip_plain == plain) {
    if (strip_wanted && state.view.strip_stopped) strip.cancel();
    if (strip_wanted) return;
  } else {
    stop_strip();
    strip_next = wanted;
    strip_plain = plain;
    strip_due = std::chrono::steady_clock::now() + kStripDelay;
  }
  strip_waits = same_recording && std::chrono::steady_clock::now() < strip_due;
  if (strip_waits) return;
  strip_wanted = wanted;
  strip_of = wanted.recording;
  state.view.strip_stopped = false;
  if (!same_recording) state.results.strip.assign(count, {});
  if (!plain && (!same_recording || strip_ran_as != wanted)) {
    strip_ran_as = wanted;
    strip_ran.assign(count, 0);
  }
  if (!same_recording && plain) strip_ran_as.reset();
  std::vector<std::uint8_t> has = strip_ran;  // what need not be made
  if (plain) {
    has.clear();
    for (const Thumbnail& thumbnail : state.results.strip) has.push_back(thumbnail.ready);
  }
  state.results.strip_done = static_cast<int>(std::ranges::count_if(has, std::identity()));
  const int first = state.document.frame, number = ++strip_number;
  strip.replace([this, wanted, first, count, number, plain, like = planes_shown(state),
                 has = std::move(has)](std::stop_token stop) mutable {
    // From the frame shown to the last, then backwards to the first: the neighbor of each has its
    // colors by then.
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t before = static_cast<std::size_t>(first), after = count - before;
      const std::size_t index = i < after ? before + i : count - 1 - i;
      if (has[index]) continue;
      wanted.frame = static_cast<int>(index);
      if (stop.stop_requested()) return;
      Thumbnail thumbnail =
          plain ? picture_of(wanted)
                : thumbnail_of(wanted, tools, colors, i == 0 ? like.get() : nullptr);
      if (stop.stop_requested()) return;
      deliver([this, thumbnail = std::move(thumbnail), index, number, plain](State& s) {
        if (number != strip_number || index >= s.results.strip.size()) return;
        s.results.strip[index] = thumbnail;
        if (!plain) strip_ran[index] = 1;
        ++s.results.strip_done;
      });
    }
  });
}

Jobs::Jobs(std::function<void()> wake) : impl_(std::make_unique<Impl>()) {
  impl_->wake = std::move(wake);
}
Jobs::~Jobs() {
  for (Worker* worker : {&impl_->runs, &impl_->covers, &impl_->compares, &impl_->strip})
    worker->cancel();
}

void Jobs::pursue(State& state) {
  impl_->pursue_run(state);
  impl_->pursue_planes(state);
  impl_->pursue_comparison(state);
  impl_->pursue_strip(state);
  impl_->analysis.pursue(state, impl_->runs.busy());
  impl_->labels.pursue(state);
  impl_->learning.pursue(state);
  impl_->maps.pursue(state);
  impl_->spreading.pursue(state);
}

bool Jobs::collect(State& state) {
  std::vector<Delivery> deliveries;
  {
    const std::lock_guard lock(impl_->mutex);
    deliveries.swap(impl_->deliveries);
  }
  for (const Delivery& delivery : deliveries) delivery(state);
  return !deliveries.empty();
}

bool Jobs::busy(bool background) const {
  if (impl_->runs.busy() || impl_->covers.busy() || impl_->compares.busy()) return true;
  if (background && (impl_->strip_waits || impl_->strip.busy())) return true;
  if (impl_->analysis.busy(background)) return true;
  if (impl_->labels.busy() || impl_->learning.busy() || impl_->maps.busy() ||
      impl_->spreading.busy())
    return true;
  const std::lock_guard lock(impl_->mutex);
  return !impl_->deliveries.empty();
}

}  // namespace planescope::desktop
