// Background jobs of label mode: opening frames, review, audit, and carrying labels.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "app/desktop/jobs/jobs.hpp"
#include "app/desktop/labeling/review.hpp"
#include "app/desktop/labeling/work.hpp"
#include "app/desktop/tracks/map_view.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/json.hpp"
#include "core/model/text.hpp"

namespace planescope::desktop {
namespace {

/// An unreadable file counts as labels here; opening the frame reports the error.
FrameMark mark_of(const std::filesystem::path& path) {
  FrameMark mark;
  std::error_code gone;
  mark.labeled = std::filesystem::exists(path, gone);
  if (!mark.labeled) return mark;
  try {
    const auto json = read_json<nlohmann::json>(path);
    mark.reviewed = json.value("review_state", "") == "reviewed";
  } catch (const std::exception&) {
  }
  return mark;
}

/// Finds labeled frames by their label files. Long recordings have many; if stopped, returns fewer
/// marks than frames.
std::vector<FrameMark> marks_in(const std::filesystem::path& dir,
                                int frames,
                                const std::stop_token& stop) {
  std::vector<FrameMark> marks;
  for (int i = 0; i < frames && !stop.stop_requested(); ++i)
    marks.push_back(mark_of(dir / fmt::format("{:06}.json", i)));
  return marks;
}

std::shared_ptr<const LabelFrame> make_label_frame(std::shared_ptr<const io::Recording> recording,
                                                   const debug::Subject& subject) {
  auto made = std::make_shared<LabelFrame>();
  made->frame = subject.frame.index;
  made->sha256 = recording->frame_hash(made->frame);
  made->grid = labels::make_label_grid(subject.frame, subject.prepared.gravity);
  made->T_world_sensor = subject.prepared.cloud.T_world_sensor;
  if (made->grid.is_cloud())  // convert from the cloud's origin to the scene's
    made->T_world_sensor.translation() =
        made->T_world_sensor.linear() * made->grid.origin - subject.prepared.cloud.origin;
  const Eigen::Isometry3f T = made->T_world_sensor.cast<float>();
  made->world.reserve(made->grid.pixels());
  for (const Vec3f& point : made->grid.points) made->world.push_back(T * point);
  made->recording = std::move(recording);
  return made;
}

/// Shows the frame even if the store rejects its labels.
void take_in(State& state, std::shared_ptr<const LabelFrame> made) {
  const OpenRecording* open = state.document.current();
  if (!open || open->recording != made->recording || state.document.frame != made->frame) return;
  LabelResults& label = state.results.label;
  label.refusal.clear();
  try {
    if (labels::LabelStore* store = open->labels.get()) {
      const std::size_t shown = store->notices().size();
      store->open(made->frame, labels::empty_labels(made->grid, made->sha256));
      if (store->notices().size() > shown) say(state, store->notices().back(), true);
    }
    label.frame = std::move(made);
  } catch (const std::exception& error) {
    label.frame = nullptr;
    label.refusal = message_of(error);
  }
}

/// Keeps the selected finding if it still exists, otherwise selects the next one.
void take_audit(State& state,
                std::shared_ptr<const Audit> audit,
                std::vector<labels::WorkTime> work) {
  LabelResults& label = state.results.label;
  int& chosen = state.view.label.finding;
  const bool is_first = !label.audit;
  const auto same = [&, before = label.audit](const labels::Finding& one) {
    const labels::Finding& was = before->findings[static_cast<std::size_t>(chosen)];
    return one.kind == was.kind && one.plane == was.plane && one.pixel == was.pixel;
  };
  const auto count = static_cast<int>(audit->findings.size());
  if (!is_first && chosen >= 0) {
    const auto found = std::ranges::find_if(audit->findings, same);
    chosen = found == audit->findings.end() ? std::min(chosen, count) - 1
                                            : static_cast<int>(found - audit->findings.begin());
  }
  label.audit = std::move(audit);
  label.work = std::move(work);
  if (!is_first || chosen < 0) return;  // otherwise it was requested before the audit was available
  chosen = -1;
  if (state.view.label.tab == "checks") apply(state, {"check.next"});
}

/// Uses the known motion to the current frame if planes were tracked.
labels::CarryOptions carry_options(const State& state) {
  labels::CarryOptions options;
  const MapView* map = state.map();
  const world::CameraPose* from = map ? map->pose(state.results.label.carry.from) : nullptr;
  const world::CameraPose* to = map ? map->pose(state.document.frame) : nullptr;
  if (from && to && from->segment == to->segment)
    options.T_to_from = to->T_world_camera.inverse() * from->T_world_camera;
  return options;
}

/// Describes the plane with the lowest confidence if it is below the share; otherwise empty.
std::string doubt_in(const labels::CarriedLabels& carried, double least_share) {
  if (carried.planes.empty() || least_share == 0) return "";
  const labels::CarriedPlane& worst = *std::ranges::min_element(
      carried.planes, {},
      [](const labels::CarriedPlane& plane) { return plane.pixels == 0 ? 0 : plane.confidence; });
  if (worst.pixels > 0 && worst.confidence >= least_share) return "";
  if (worst.pixels == 0) return fmt::format("P{} was not found", worst.id);
  return fmt::format("P{} is {:.0f} % sure", worst.id, 100 * worst.confidence);
}

/// Commits carried labels and continues with the next frame if requested.
void take_carried(State& state,
                  const std::shared_ptr<const FrameLabels>& existing,
                  const std::shared_ptr<const labels::CarriedLabels>& carried) {
  CarryJob& carry = state.results.label.carry;
  if (!carry.running) return;
  if (state.labels() != existing) {  // labeled in the meantime: carry again around the new labels
    carry.begun = false;
    return;
  }
  const int from = carry.from;
  CarryJob plan;
  plan.left = carry.left - 1;
  plan.least_share = carry.least_share;
  plan.gone = carry.gone + 1;
  const bool goes_on =
      carry.left > 0 && from + 2 < state.document.current()->recording->frame_count();
  carry = {};
  try {
    commit_labels(state, labels::make_edit(state.document.frame,
                                           fmt::format("Carry labels from frame {}", from),
                                           *existing, carried->labels));
  } catch (const std::exception& error) {
    return say(state, message_of(error), true);
  }
  const std::string doubt = doubt_in(*carried, plan.least_share);
  if (goes_on && doubt.empty() && !state.labels()->planes.empty()) return begin_carry(state, plan);
  carry.from = from;
  carry.done = carried;
  const auto doubtful = std::ranges::count(carried->doubt, std::uint8_t{1});
  if (plan.gone > 1 || !doubt.empty())
    return say(state, fmt::format("carried over {}{}{}",
                                  counted(static_cast<std::size_t>(plan.gone), "frame"),
                                  doubt.empty() ? "" : "; doubtful: ", doubt));
  say(state, fmt::format("{} planes carried from frame {} by {}; {} doubtful pixels stay unlabeled",
                         carried->planes.size(), from, carried->method, doubtful));
}

class LabelJobs : public JobGroup {
 public:
  explicit LabelJobs(Courier& courier)
      : frames_(courier), marks_(courier), reviews_(courier), audits_(courier), carries_(courier) {}

  void pursue(State& state) override {
    const CarryJob& carry = state.results.label.carry;
    const bool labels = state.view.mode == Mode::labels;
    if (carries_.key() && !(labels && carry.running && carry.begun)) carries_.drop();
    if (!labels || !state.document.current()) return;
    pursue_frame(state);
    pursue_marks(state);
    pursue_review(state);
    pursue_audit(state);
    pursue_carry(state);
  }
  bool busy(bool) const override {
    return frames_.busy() || marks_.busy() || reviews_.busy() || audits_.busy() || carries_.busy();
  }

 private:
  struct FrameKey {
    std::shared_ptr<const io::Recording> recording;
    int frame = -1;
    Vec3d gravity = Vec3d::Zero();  // zero: unknown
    bool operator==(const FrameKey&) const = default;
  };

  void pursue_frame(State& state);
  void pursue_marks(State& state);
  void pursue_review(State& state);
  void pursue_audit(State& state);
  void pursue_carry(State& state);

  Request<FrameKey> frames_;
  Request<std::shared_ptr<const io::Recording>> marks_;
  Request<ReviewSides> reviews_;
  Request<std::shared_ptr<const FrameLabels>> audits_;
  Request<int> carries_;  // by target frame
};

void LabelJobs::pursue_frame(State& state) {
  const RunView* view = state.run_view();
  if (!view) return;  // its error is shown
  const std::shared_ptr<const debug::Subject>& subject = view->run->subject;
  const Gravity& known = subject->prepared.gravity;
  const FrameKey key{state.document.current()->recording, state.document.frame,
                     known.known() ? known.direction : Vec3d(Vec3d::Zero())};
  if (subject->frame.index != key.frame || frames_.key() == key) return;
  state.results.label.refusal.clear();
  frames_.ask(
      key,
      [recording = key.recording, subject](const Turn& turn) {
        turn.deliver(
            [made = make_label_frame(recording, *subject)](State& s) { take_in(s, made); });
      },
      [](State& s, const std::string& why) {
        s.results.label.frame = nullptr;
        s.results.label.refusal = why;
      });
}

void LabelJobs::pursue_marks(State& state) {
  const OpenRecording& open = *state.document.current();
  if (marks_.key() == open.recording) return;
  state.results.label.marks.clear();
  marks_.ask(open.recording, [recording = open.recording, dir = open.label_dir](const Turn& turn) {
    turn.deliver([marks = marks_in(dir, recording->frame_count(), turn.stop)](State& s) {
      s.results.label.marks = marks;
    });
  });
}

void LabelJobs::pursue_review(State& state) {
  if (state.view.label.tab != "review" || !state.labels()) return;
  const LabelResults& label = state.results.label;
  ReviewSides wanted;
  wanted.frame = label.frame;
  wanted.labels = state.labels();
  wanted.folder = state.view.label.compare_with;
  wanted.smallest_cm2 = state.view.label.review_smallest_cm2;
  if (wanted.folder.empty()) {
    if (!state.results.current) return;
    wanted.run = state.results.current->run;
    if (wanted.run->subject->frame.index != state.document.frame) return;
  }
  const ReviewQueue* shown = label.review.get();
  const bool is_shown = shown && shown->labels == wanted.labels && shown->run == wanted.run &&
                        shown->smallest_cm2 == wanted.smallest_cm2 &&
                        (wanted.run || shown->other == wanted.folder.string());
  const bool is_answered = reviews_.pending() || !label.review_refusal.empty();
  if (is_shown || (reviews_.key() == wanted && is_answered)) return;
  reviews_.ask(
      wanted,
      [wanted](const Turn& turn) {
        turn.deliver([wanted, queue = make_queue(wanted)](State& s) {
          if (s.labels() == wanted.labels) take_queue(s, queue);
        });
      },
      [](State& s, const std::string& why) {
        s.results.label.review = nullptr;
        s.results.label.review_refusal = why;
      });
}

void LabelJobs::pursue_audit(State& state) {
  const std::string& tab = state.view.label.tab;
  const std::shared_ptr<const FrameLabels> labels = state.labels();
  if ((tab != "checks" && tab != "statistics") || !labels) return;
  if (audits_.key() == labels && (audits_.pending() || state.results.label.audit)) return;
  audits_.ask(labels, [labels, frame = state.results.label.frame,
                       dir = state.document.current()->labels->dir()](const Turn& turn) {
    auto audit = std::make_shared<Audit>();
    audit->findings = labels::audit_labels(*labels, frame->grid);
    std::vector<labels::WorkTime> work;
    try {
      work = labels::work_times(dir);
    } catch (const Error&) {
      // An unreadable journal is reported when the store is opened.
    }
    turn.deliver([labels, audit, work = std::move(work)](State& s) {
      if (s.labels() == labels) take_audit(s, audit, work);
    });
  });
}

void LabelJobs::pursue_carry(State& state) {
  CarryJob& carry = state.results.label.carry;
  if (!carry.running || carry.begun) return;
  const std::string& refusal =
      state.results.refusal.empty() ? state.results.label.refusal : state.results.refusal;
  if (!state.results.loading && !frames_.busy() && !refusal.empty()) {
    carry = {};
    return say_nothing_done(state, refusal, /*is_error=*/true);
  }
  if (!state.labels()) return;  // being made
  carry.begun = true;
  carries_.ask(
      state.document.frame,
      [from = carry.from_frame, labels = carry.from_labels, to = state.results.label.frame,
       options = carry_options(state), existing = state.labels()](const Turn& turn) {
        int percent = 0;
        const auto progress = [&](double share) {
          if (static_cast<int>(100 * share) <= percent) return;
          percent = static_cast<int>(100 * share);
          turn.deliver([share](State& s) { s.results.label.carry.progress = share; });
        };
        const auto carried = std::make_shared<const labels::CarriedLabels>(labels::carry_labels(
            from->recording->frame(from->frame), from->grid, *labels,
            to->recording->frame(to->frame), to->grid, *existing, options, turn.stop, progress));
        turn.deliver([existing, carried](State& s) { take_carried(s, existing, carried); });
      },
      [](State& s, const std::string& why) {
        s.results.label.carry = {};
        say_nothing_done(s, why, /*is_error=*/true);
      });
}

}  // namespace

std::unique_ptr<JobGroup> make_label_jobs(Courier& courier) {
  return std::make_unique<LabelJobs>(courier);
}

}  // namespace planescope::desktop
