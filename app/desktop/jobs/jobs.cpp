// Starts and collects background jobs; loads, runs and compares frames.

#include "app/desktop/jobs/jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <utility>

#include "app/desktop/look.hpp"
#include "app/desktop/state/session.hpp"
#include "core/model/text.hpp"
#include "core/planes/evaluate/metrics.hpp"
#include "core/planes/pipeline/options_table.hpp"

namespace planescope::desktop {
namespace {

using View = std::shared_ptr<const RunView>;

/// Whether world coordinates are equal. Otherwise, after a change of gravity, the octrees differ,
/// and nodes and voxels do not correspond.
bool same_world(const debug::Subject& a, const debug::Subject& b) {
  return a.prepared.cloud.T_world_sensor.isApprox(b.prepared.cloud.T_world_sensor);
}

/// Whether a slider is being dragged that affects the run (not a foot or stairs option).
bool drags_a_run(const State& state) {
  const std::string gesture = state.undo.empty() ? "" : state.undo.back().gesture;
  return !gesture.empty() && !is_about_planes(planes::find_option(gesture));
}

/// Number of planes in `b` that overlap a plane in `a` by more than half of both.
int planes_kept(const std::vector<std::int32_t>& a, const std::vector<std::int32_t>& b) {
  const planes::TruthOverlap overlap = planes::count_truth_overlap(a, b);
  int kept = 0;
  for (int p = 1; p <= overlap.truth; ++p)
    for (int q = 1; q <= overlap.found; ++q)
      kept += 2 * overlap.at(p, q) > overlap.truth_size[p] &&
              2 * overlap.at(p, q) > overlap.found_size[q];
  return kept;
}

/// Describes the effect of changed options on a frame's planes: "merge_cost 10 → 7: planes 17 → 20
/// (+4 −1)". Empty for another frame, or if no segmentation option changed.
std::string change_text(const debug::Run& before, const debug::Run& after) {
  if (before.subject != after.subject) return {};
  std::vector<const planes::OptionInfo*> changed;
  for (const planes::OptionInfo& info : planes::option_table())
    if (info.get(before.options) != info.get(after.options)) changed.push_back(&info);
  if (changed.empty()) return {};
  std::string what = counted(changed.size(), "option");
  for (const planes::OptionInfo* info : changed)
    if (changed.size() == 1 || info->name == "profile")
      what = fmt::format("{} {} → {}", info->title, info->get(before.options),
                         info->get(after.options));
  const auto a = static_cast<int>(before.segmentation.planes.size()),
             b = static_cast<int>(after.segmentation.planes.size());
  const int kept = planes_kept(before.segmentation.plane_of, after.segmentation.plane_of);
  return fmt::format("{} · planes {} → {} (+{} −{})", what, a, b, b - kept, a - kept);
}

/// Reports only a change just made by the user, not an undo or a preview.
void report_change(State& state, const RunView* before, const RunView& now) {
  if (!before || state.view.preview || state.undo.empty()) return;
  const OptionChange& last = state.undo.back();
  if (run_key(last.before) != run_key(before->run->options) ||
      run_key(last.after) != run_key(now.run->options) || !state.view.message.empty())
    return;
  const std::string text = change_text(*before->run, *now.run);
  if (!text.empty()) say(state, text + " · Ctrl+Z");
}

/// The displayed colors of the current frame's planes: A's if pinned. Null: none yet.
std::shared_ptr<const render::ColoredPlanes> planes_shown(const State& state) {
  const Results& results = state.results;
  const RunView* view = results.pinned ? results.pinned.get() : results.current.get();
  return view ? shown_colors(state, *view).planes : nullptr;
}

void show_run(State& state, const View& view) {
  const View before = state.results.current;
  const bool other_frame = !before ||
                           before->run->subject->frame.index != view->run->subject->frame.index ||
                           state.results.loading;
  const bool other_subject = before && before->run->subject != view->run->subject;
  const bool turned = !other_frame && !same_world(*before->run->subject, *view->run->subject);
  state.results.current = view;
  state.results.loading = false;
  state.results.refusal.clear();
  state.results.sensitivity.clear();
  report_change(state, before.get(), *view);
  FixSearch& fix = state.results.fix;
  if (other_subject) {  // voxels are renumbered
    fix = {};
    state.view.preview.reset();
    state.document.marked.clear();
  } else if (fix.of && run_key(fix.of->run->options) == run_key(view->run->options)) {
    fix.of = view;  // the same run again, e.g. after a preview
  }
  std::erase_if(state.document.marked,
                [&](std::uint32_t voxel) { return voxel >= view->run->subject->voxel_count(); });
  if (other_frame) state.view.shown_steps.reset();
  if (state.view.arrival) {
    const Bookmark arrival = *std::exchange(state.view.arrival, std::nullopt);
    go_to_bookmark(state, arrival);
  } else if (other_frame || (turned && !state.view.flash)) {
    go_to_step(state, view->run->steps());
    state.view.shown_steps.reset();  // show the traversal, where the decisions are
    refresh_matches(state);
  } else if (!state.view.flash) {
    follow_run(state, *before->run);
  }
  if (const std::optional<TrackPlace>& place = state.view.tracks.place;
      place && place->frame == state.document.frame && view->map) {
    go_to_track(state, *std::exchange(state.view.tracks.place, std::nullopt));
  }
}

void show_refusal(State& state, const std::string& why) {
  state.results.current = nullptr;
  state.results.loading = false;
  state.results.refusal = why;
  state.view.selected = {};
  state.view.step = 0;
  refresh_matches(state);
}

class FrameJobs : public JobGroup {
 public:
  FrameJobs(Courier& courier, FrameTools& tools)
      : tools_(tools),
        runs_(courier, Request<Wanted>::Late::taken),  // a slider shows intermediate results
        planes_(courier),
        comparisons_(courier),
        strip_(courier) {}

  void pursue(State& state) override {
    pursue_run(state);
    pursue_planes(state);
    pursue_comparison(state);
    pursue_strip(state);
  }
  bool busy(bool background) const override {
    return runs_.busy() || planes_.busy() || comparisons_.busy() ||
           (background && (strip_waits_ || strip_.busy()));
  }

 private:
  struct PlanesKey {
    View of;
    std::string options;
    bool operator==(const PlanesKey&) const = default;
  };
  struct ComparisonKey {
    Against against = Against::nothing;
    View a, b;  // `a` null: the ground truth
    bool operator==(const ComparisonKey&) const = default;
  };
  struct StripKey {
    Wanted wanted;
    bool plain = false;  // only pictures, for label mode
    bool operator==(const StripKey&) const = default;
  };
  using Like = const render::ColoredPlanes*;  // as in ColorBook::colors()

  void pursue_run(State& state);
  void pursue_planes(State& state);
  void pursue_comparison(State& state);
  void pursue_strip(State& state);
  View view_of(const Wanted& wanted, Like like, std::string& refused_labels);
  View run_a(const Turn& turn, const Wanted& wanted, Like like, std::string& problems);
  void run_frame(const Turn& turn,
                 const Wanted& wanted,
                 Like like,
                 const std::shared_ptr<const ReportPlace>& place);

  FrameTools& tools_;
  ColorBook colors_;
  // Used only by the thread of runs.
  std::optional<Wanted> loaded_;
  std::shared_ptr<const debug::Subject> subject_;
  render::Home home_;
  // State of the strip, used only by the window's thread.
  std::optional<StripKey> strip_next_;  // pending strip, started once options have settled
  std::chrono::steady_clock::time_point strip_due_;
  bool strip_waits_ = false;
  std::shared_ptr<const io::Recording> strip_of_;
  std::optional<Wanted> strip_ran_as_;   // settings of the processed frames ...
  std::vector<std::uint8_t> strip_ran_;  // ... and which frames were processed

  Request<Wanted> runs_;  // last: their threads use the members above
  Request<PlanesKey> planes_;
  Request<ComparisonKey> comparisons_;
  Request<StripKey> strip_;
};

// ---- Runs --------------------------------------------------------------------------------------

View FrameJobs::view_of(const Wanted& wanted, Like like, std::string& refused_labels) {
  const bool fresh = !subject_ || !loaded_ || !loaded_->same_subject(wanted);
  if (fresh) {
    subject_ = nullptr;
    subject_ = load_subject(wanted, tools_, &refused_labels);
    loaded_ = wanted;
  }
  auto run = debug::make_run(subject_, wanted.options);
  if (fresh) home_ = home_of(*run);
  FrameColors of_planes = colors_.colors(wanted, *run, like);
  return view_run(std::move(run), home_, wanted, std::move(of_planes));
}

/// Null if the frame cannot be processed with these options, with the reason in `problems`; B is
/// still shown.
View FrameJobs::run_a(const Turn& turn, const Wanted& wanted, Like like, std::string& problems) {
  try {
    const View view = view_of(wanted, like, problems);
    turn.deliver([wanted, view](State& state) {
      if (!wanted.is_shown(state.document)) return;
      state.results.pinned = view;
      state.results.pinned_colors = view->colors;
    });
    return view;
  } catch (const std::exception& error) {
    problems = fmt::format("A is not available: {}", message_of(error));
    return nullptr;
  }
}

/// `place` is the location to show afterwards; null keeps the view.
void FrameJobs::run_frame(const Turn& turn,
                          const Wanted& wanted,
                          Like like,
                          const std::shared_ptr<const ReportPlace>& place) {
  std::string problems;
  View a;
  if (place && place->options_a)
    a = run_a(turn, with_options(wanted, *place->options_a), like, problems);
  const View view = view_of(wanted, a ? a->colors.planes.get() : like, problems);
  std::optional<RunArrival> arrival;
  if (place) arrival = arrival_at(*place, a ? a->run.get() : nullptr, *view->run);
  turn.deliver([wanted, view, arrival, problems](State& state) {
    if (!wanted.is_shown(state.document)) return;
    show_run(state, view);
    if (arrival) show_arrival(state, *arrival);
    const bool both = arrival && !problems.empty() && !arrival->message.empty();
    if (!problems.empty()) say(state, both ? problems + "; " + arrival->message : problems, true);
  });
}

void FrameJobs::pursue_run(State& state) {
  if (!state.document.current()) return;
  Wanted wanted = wanted_in(state, state.document.frame);
  if (const auto& preview = state.view.preview) {
    planes::PipelineOptions options = wanted.options;
    planes::set_option(options, preview->option, preview->value);
    wanted = with_options(std::move(wanted), options);
  }
  const std::optional<Wanted>& before = runs_.key();
  if (before == wanted) return;
  if (!before || before->recording != wanted.recording || before->frame != wanted.frame) {
    state.results.loading = true;
    state.results.current = nullptr;
  }
  runs_.ask(
      wanted,
      [this, wanted, like = planes_shown(state),
       place = std::exchange(state.view.report_place, nullptr)](const Turn& turn) {
        run_frame(turn, wanted, like.get(), place);
      },
      [wanted](State& s, const std::string& why) {
        if (wanted.is_shown(s.document)) show_refusal(s, why);
      });
}

// ---- Planes and comparisons --------------------------------------------------------------------

/// Waits while a frame is or may soon be processed, so that dragging a slider has the machine to
/// itself.
void FrameJobs::pursue_planes(State& state) {
  Results& results = state.results;
  std::erase_if(results.planes, [&](const auto& planes) {
    return planes->of != results.current && planes->of != results.pinned;
  });
  const View& view = state.view.flash && results.pinned ? results.pinned : results.current;
  if (!view || runs_.busy() || drags_a_run(state)) return;
  const PlanesKey key{view, planes_key(state.document.options)};
  const RunPlanes* known = state.planes();
  if (planes_.key() == key || (known && known->key == key.options)) return;
  planes_.ask(key, [view, options = state.document.options](const Turn& turn) {
    turn.deliver([planes = planes_of_run(view, options)](State& s) {
      std::erase_if(s.results.planes, [&](const auto& other) { return other->of == planes->of; });
      s.results.planes.push_back(planes);
    });
  });
}

void FrameJobs::pursue_comparison(State& state) {
  const Against against = state.view.against;
  const ComparisonKey key{against, against == Against::pinned ? state.results.pinned : nullptr,
                          against == Against::nothing ? nullptr : state.results.current};
  if (comparisons_.key() == key) return;
  const bool comparable = key.b && (against != Against::pinned || key.a);
  if (!comparable) state.results.comparison = nullptr;
  comparisons_.ask(key, [key, comparable](const Turn& turn) {
    if (!comparable) return;
    const auto comparison = std::make_shared<const debug::Comparison>(
        key.a ? debug::compare_runs(*key.a->run, *key.b->run)
              : debug::compare_with_truth(*key.b->run));
    turn.deliver([key, comparison](State& s) {
      s.results.comparison = comparison;
      s.results.compared_a = key.a;
      s.results.compared_b = key.b;
    });
  });
}

// ---- Strip -------------------------------------------------------------------------------------

void FrameJobs::pursue_strip(State& state) {
  using Clock = std::chrono::steady_clock;
  // Wait until options have been stable for this long before processing all frames with them, so
  // that this does not compete with a slider being dragged.
  constexpr std::chrono::milliseconds kDelay{300};
  strip_waits_ = false;
  if (!state.document.current() || state.results.loading || runs_.busy()) return;
  StripKey key{wanted_in(state, 0)};
  key.plain = state.view.mode == Mode::labels || !key.wanted.recording->info().knows_camera();
  const auto count = static_cast<std::size_t>(key.wanted.recording->frame_count());
  const bool same_recording =
      strip_of_ == key.wanted.recording && state.results.strip.size() == count;
  if (same_recording && strip_next_ == key) {
    if (strip_.key() && state.view.strip_stopped) strip_.stop();
    if (strip_.key()) return;
  } else {
    strip_.drop();
    strip_next_ = key;
    strip_due_ = Clock::now() + kDelay;
  }
  strip_waits_ = same_recording && Clock::now() < strip_due_;
  if (strip_waits_) return;
  strip_of_ = key.wanted.recording;
  state.view.strip_stopped = false;
  if (!same_recording) state.results.strip.assign(count, {});
  if (!key.plain && (!same_recording || strip_ran_as_ != key.wanted)) {
    strip_ran_as_ = key.wanted;
    strip_ran_.assign(count, 0);
  }
  if (!same_recording && key.plain) strip_ran_as_.reset();
  std::vector<std::uint8_t> has = strip_ran_;  // frames to skip
  if (key.plain) {
    has.clear();
    for (const Thumbnail& thumbnail : state.results.strip) has.push_back(thumbnail.ready);
  }
  state.results.strip_done = static_cast<int>(std::ranges::count(has, std::uint8_t{1}));
  strip_.ask(key, [this, key, first = static_cast<std::size_t>(state.document.frame), count,
                   like = planes_shown(state), has = std::move(has)](const Turn& turn) {
    // From the current frame to the last, then backwards to the first, so that a neighbor of each
    // frame already has its colors.
    for (std::size_t i = 0; i < count; ++i) {
      const std::size_t index = i < count - first ? first + i : count - 1 - i;
      if (has[index]) continue;
      turn.expect_wanted();
      Wanted wanted = key.wanted;
      wanted.frame = static_cast<int>(index);
      Thumbnail thumbnail =
          key.plain ? picture_of(wanted)
                    : thumbnail_of(wanted, tools_, colors_, i == 0 ? like.get() : nullptr);
      turn.expect_wanted();
      turn.deliver([this, thumbnail = std::move(thumbnail), index, plain = key.plain](State& s) {
        if (index >= s.results.strip.size()) return;
        s.results.strip[index] = thumbnail;
        if (!plain) strip_ran_[index] = 1;
        ++s.results.strip_done;
      });
    }
  });
}

}  // namespace

std::unique_ptr<JobGroup> make_frame_jobs(Courier& courier, FrameTools& tools) {
  return std::make_unique<FrameJobs>(courier, tools);
}

Jobs::Jobs(std::function<void()> wake) : courier_(std::move(wake)) {
  groups_.push_back(make_frame_jobs(courier_, tools_));
  groups_.push_back(make_analysis_jobs(
      courier_, tools_, [frames = groups_.front().get()] { return frames->busy(false); }));
  groups_.push_back(make_label_jobs(courier_));
  groups_.push_back(make_recording_jobs(courier_, tools_));
}

void Jobs::pursue(State& state) {
  for (const auto& group : groups_) group->pursue(state);
}

bool Jobs::collect(State& state) {
  const std::vector<Delivery> deliveries = courier_.take();
  for (const Delivery& delivery : deliveries) delivery(state);
  return !deliveries.empty();
}

bool Jobs::busy(bool background) const {
  return std::ranges::any_of(groups_, [&](const auto& one) { return one->busy(background); }) ||
         !courier_.empty();
}

}  // namespace planescope::desktop
