#include "app/desktop/jobs/spread_jobs.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "app/desktop/actions/actions.hpp"
#include "app/desktop/tracks/map_view.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/model/text.hpp"
#include "core/world/tracks/sight.hpp"

namespace planescope::desktop {
namespace {

/// What the job reads, none of which changes meanwhile.
struct SpreadInputs {
  std::shared_ptr<const MapView> map;
  std::filesystem::path label_dir;
  std::map<int, std::shared_ptr<const FrameLabels>> at_hand;  // of frames that are open
  int from = 0, track = 0, frames = 0;
};

labels::SpreadFrame open_frame(const SpreadInputs& wanted, int index) {
  const io::Recording& recording = *wanted.map->recording;
  labels::SpreadFrame made;
  made.frame = recording.frame(index);
  if (const world::CameraPose* pose = wanted.map->pose(index))
    world::turn_to_map(made.frame, {}, *pose, wanted.map->map);
  made.grid = labels::make_label_grid(made.frame, made.frame.gravity.value_or(Gravity{}));
  if (const auto known = wanted.at_hand.find(index); known != wanted.at_hand.end()) {
    made.labels = *known->second;
    return made;
  }
  const std::string hash = recording.frame_hash(index);
  auto written = labels::read_frame_labels(wanted.label_dir, index, hash);
  made.labels = written ? std::move(*written) : labels::empty_labels(made.grid, hash);
  return made;
}

/// The highest id of the frame's labels, of those in the window or on disk; 0: it has none.
int highest_id(const SpreadInputs& wanted, int index) {
  const auto known = wanted.at_hand.find(index);
  std::optional<FrameLabels> written;
  if (known == wanted.at_hand.end())
    written = labels::read_frame_labels(wanted.label_dir, index,
                                        wanted.map->recording->frame_hash(index));
  const FrameLabels* labels = written ? &*written : nullptr;
  if (known != wanted.at_hand.end()) labels = known->second.get();
  return labels && !labels->planes.empty() ? labels->planes.back().id : 0;
}

/// The track as one plane, of an id that no frame has, where nothing is labelled yet.
std::vector<labels::Proposal> propose_track(const SpreadInputs& wanted,
                                            const std::stop_token& stop,
                                            const std::function<void(int, int)>& progress) {
  const world::Track& track = *wanted.map->track(wanted.track);
  const auto sees = [&](int frame) {
    const world::FrameOfTracks* told = wanted.map->told(frame);
    return told && told->is_in_map() && told->segment == track.segment;
  };
  labels::Paint paint{.plane = 1, .label = track.label, .origin = LabelOrigin::algorithm};
  std::vector<labels::Proposal> proposals;
  for (int i = 0; i < wanted.frames; ++i) {
    if (stop.stop_requested()) throw Cancelled();
    try {
      if (sees(i)) paint.plane = std::max(paint.plane, highest_id(wanted, i) + 1);
    } catch (const Error&) {  // a damaged frame says why where it is opened
    }
  }
  if (paint.plane >= kPlaneIgnore) throw Error("no plane id is free in all frames");
  for (int i = 0; i < wanted.frames; ++i) {
    if (stop.stop_requested()) throw Cancelled();
    progress(i + 1, wanted.frames);
    if (!sees(i)) continue;
    try {
      const labels::SpreadFrame frame = open_frame(wanted, i);
      const world::PixelsOfTrack on =
          world::pixels_of_track(track, frame.grid, wanted.map->pose(i)->T_world_camera);
      const FrameLabels labels =
          labels::painted(frame.labels, frame.grid, on.sure, paint, labels::PaintMode::add);
      labels::Proposal proposal =
          labels::proposal_of(i, fmt::format("Propose track T{}", track.id), frame.labels, labels);
      proposal.doubtful = static_cast<std::size_t>(std::ranges::count_if(
          on.doubtful, [&](std::uint32_t pixel) { return frame.labels.plane.data[pixel] == 0; }));
      if (!proposal.edit.empty()) proposals.push_back(std::move(proposal));
    } catch (const Error&) {  // likewise
    }
  }
  return proposals;
}

/// Commits what is proposed, as one step. Frames that were labelled meanwhile are left alone.
void take_proposals(State& state,
                    const SpreadInputs& wanted,
                    std::vector<labels::Proposal>& proposals) {
  const OpenRecording* open = state.document.current();
  if (!open || open->recording != wanted.map->recording || !open->labels) return;
  const io::RecordingInfo& info = open->recording->info();
  std::vector<labels::LabelEdit> edits;
  std::size_t doubtful = 0, left = 0;
  SpreadWork& spread = state.results.label.spread;
  for (labels::Proposal& proposal : proposals) {
    proposal.blank.plane = Image16(info.width, info.height);
    proposal.blank.hv = Image8(info.width, info.height, 1);
    const auto labels = open->labels->open(proposal.edit.frame, proposal.blank);
    if (!labels::can_apply(*labels, proposal.edit)) {
      ++left;
      continue;
    }
    doubtful += proposal.doubtful;
    const auto all = static_cast<double>(proposal.edit.changed_pixels() + proposal.doubtful);
    spread.doubtful.emplace_back(proposal.edit.frame, static_cast<double>(proposal.doubtful) / all);
    edits.push_back(std::move(proposal.edit));
  }
  std::ranges::stable_sort(spread.doubtful, std::greater(), &std::pair<int, double>::second);
  open->labels->commit(edits);
  std::string text = fmt::format("proposed in {}, {} doubtful pixels stay unlabeled",
                                 counted(edits.size(), "frame"), doubtful);
  if (!spread.doubtful.empty())
    text += fmt::format(", most in frame {}", spread.doubtful.front().first);
  if (left > 0) text += fmt::format("; {} labeled in the meantime", counted(left, "frame"));
  say(state, text);
}

}  // namespace

SpreadJobs::SpreadJobs(std::function<void(std::function<void(State&)>)> deliver,
                       std::function<void()> wake)
    : deliver_(std::move(deliver)), worker_(std::move(wake), [](const std::string&) {}) {}

SpreadJobs::~SpreadJobs() { worker_.cancel(); }

void SpreadJobs::finish(int number, std::function<void(State&)> with) {
  deliver_([this, number, with = std::move(with)](State& s) {
    if (number != number_) return;
    asked_ = false;
    s.results.label.spread.running = false;
    with(s);
  });
}

void SpreadJobs::pursue(State& state) {
  SpreadWork& spread = state.results.label.spread;
  if (asked_ && !spread.running) {  // called off
    worker_.cancel();
    asked_ = false;
    ++number_;
  }
  const OpenRecording* open = state.document.current();
  if (!spread.running || spread.begun || !open || !open->labels) return;
  spread.begun = asked_ = true;
  const int number = ++number_;
  SpreadInputs wanted{state.results.map.made,        open->label_dir, {}, spread.from, spread.track,
                      open->recording->frame_count()};
  for (int i = 0; i < wanted.frames; ++i)
    if (auto labels = open->labels->labels(i)) wanted.at_hand[i] = std::move(labels);
  worker_.cancel();
  worker_.replace([this, number, wanted = std::move(wanted)](std::stop_token stop) {
    labels::SpreadJob job;
    job.from = wanted.from;
    job.frames = wanted.frames;
    job.open = [&](int frame) { return open_frame(wanted, frame); };
    job.T_world_camera = [&](int frame) -> std::optional<Pose> {
      const world::CameraPose* pose = wanted.map->pose(frame);
      const world::CameraPose* first = wanted.map->pose(wanted.from);
      if (!pose || !first || pose->segment != first->segment) return std::nullopt;
      return pose->T_world_camera;
    };
    job.stop = stop;
    job.progress = [&](int done, int all) {
      deliver_([this, number, done, all](State& s) {
        if (number != number_) return;
        s.results.label.spread.done = done;
        s.results.label.spread.total = all;
      });
    };
    try {
      auto proposals = std::make_shared<std::vector<labels::Proposal>>(
          wanted.track > 0 ? propose_track(wanted, stop, job.progress)
                           : labels::spread_labels(job));
      finish(number, [wanted, proposals](State& s) {
        try {
          take_proposals(s, wanted, *proposals);
        } catch (const std::exception& error) {
          say(s, message_of(error), true);
        }
      });
    } catch (const Cancelled&) {
      // Whoever called it off has said so.
    } catch (const std::exception& error) {
      finish(number, [message = message_of(error)](State& s) { say(s, message, true); });
    }
  });
}

}  // namespace planescope::desktop
