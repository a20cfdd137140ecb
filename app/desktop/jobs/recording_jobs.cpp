// Background jobs over a whole recording: maps, proposing labels, training and doubtful frames.

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <thread>

#include "app/desktop/jobs/jobs.hpp"
#include "app/desktop/labeling/learning.hpp"
#include "app/desktop/labeling/work.hpp"
#include "app/desktop/tracks/map_view.hpp"
#include "core/labels/edit/operations.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/labels/review/carry.hpp"
#include "core/model/text.hpp"
#include "core/world/files/map_files.hpp"
#include "core/world/tracks/tracker.hpp"

namespace planescope::desktop {
namespace {

// ---- Proposing labels of one frame in all others that see its planes ---------------------------

/// Inputs of the job, immutable while it runs.
struct SpreadInputs {
  std::shared_ptr<const MapView> map;
  std::filesystem::path label_dir;
  std::map<int, std::shared_ptr<const FrameLabels>> at_hand;  // of open frames
  int from = 0, track = 0, frames = 0;
};

/// Labels in the window or on disk; nullopt if the frame has none.
std::optional<FrameLabels> labels_of(const SpreadInputs& wanted, int index) {
  if (const auto known = wanted.at_hand.find(index); known != wanted.at_hand.end())
    return *known->second;
  return labels::read_frame_labels(wanted.label_dir, index,
                                   wanted.map->recording->frame_hash(index));
}

labels::SpreadFrame open_frame(const SpreadInputs& wanted, int index) {
  const io::Recording& recording = *wanted.map->recording;
  labels::SpreadFrame made;
  made.frame = recording.frame(index);
  if (const world::CameraPose* pose = wanted.map->pose(index))
    world::turn_to_map(made.frame, {}, *pose, wanted.map->map);
  made.grid = labels::make_label_grid(made.frame, made.frame.gravity.value_or(Gravity{}));
  auto labels = labels_of(wanted, index);
  made.labels =
      labels ? std::move(*labels) : labels::empty_labels(made.grid, recording.frame_hash(index));
  return made;
}

/// 0 if the frame has no labels.
int highest_id(const SpreadInputs& wanted, int index) {
  const std::optional<FrameLabels> labels = labels_of(wanted, index);
  return labels && !labels->planes.empty() ? labels->planes.back().id : 0;
}

/// Proposes the track as one plane with a new id, where nothing is labeled yet.
std::vector<labels::Proposal> propose_track(const SpreadInputs& wanted,
                                            const std::stop_token& stop,
                                            const std::function<void(int, int)>& progress) {
  const world::Track& track = *wanted.map->track(wanted.track);
  const auto sees = [&](int frame) {
    const world::FrameOfTracks* tracked = wanted.map->tracks_at(frame);
    return tracked && tracked->is_in_map() && tracked->segment == track.segment;
  };
  labels::Paint paint{.plane = 1, .label = track.label, .origin = LabelOrigin::algorithm};
  std::vector<labels::Proposal> proposals;
  for (int i = 0; i < wanted.frames; ++i) {
    if (stop.stop_requested()) throw Cancelled();
    try {
      if (sees(i)) paint.plane = std::max(paint.plane, highest_id(wanted, i) + 1);
    } catch (const Error&) {  // a damaged frame is reported when it is opened
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
      labels::LabelDraft draft(frame.labels);
      labels::paint(draft, frame.grid, on.sure, paint, labels::PaintMode::add);
      labels::fit_planes(draft, frame.grid);
      labels::Proposal proposal = labels::proposal_of(
          draft.edit(i, fmt::format("Propose track T{}", track.id)), frame.labels);
      proposal.doubtful = static_cast<std::size_t>(std::ranges::count_if(
          on.doubtful, [&](std::uint32_t pixel) { return frame.labels.plane.data[pixel] == 0; }));
      if (!proposal.edit.empty()) proposals.push_back(std::move(proposal));
    } catch (const Error&) {  // likewise
    }
  }
  return proposals;
}

/// Commits proposals as one step. Skips frames that were labeled in the meantime.
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
  state.view.label.finish.reset();  // belongs to the previous labels
  open->labels->commit(edits);
  std::string text = fmt::format("proposed in {}; {} doubtful pixels stay unlabeled",
                                 counted(edits.size(), "frame"), doubtful);
  if (!spread.doubtful.empty())
    text += fmt::format(", most of them in frame {}", spread.doubtful.front().first);
  if (left > 0) text += fmt::format("; skipped {} labeled in the meantime", counted(left, "frame"));
  say(state, text);
}

std::vector<labels::Proposal> propose(const SpreadInputs& wanted, const Turn& turn) {
  const auto progress = [&](int done, int all) {
    turn.progress([](State& s) -> Asked& { return s.results.label.spread; }, done, all);
  };
  if (wanted.track > 0) return propose_track(wanted, turn.stop, progress);
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
  job.stop = turn.stop;
  job.progress = progress;
  return labels::spread_labels(job);
}

// ---- Training ----------------------------------------------------------------------------------

/// Switches to the trained weights for all further runs.
void take_weights(State& state, const LearningSource& source) {
  const std::string done =
      fmt::format("classifier trained on {}", counted(source.reviewed.size(), "reviewed frame"));
  const OpenRecording* open = state.document.current();
  if (!open || open->recording != source.recording) return say(state, done);
  planes::PipelineOptions after = state.document.options;
  after.classifier = learnt_weights(source.label_dir).string();
  change_options(state, after);
  say(state, done + "; planes now use it");
}

/// Estimates doubt for unreviewed frames; `wants` is by frame.
void find_doubt(Wanted wanted,
                const std::vector<std::uint8_t>& wants,
                FrameTools& tools,
                const Turn& turn) {
  // The objective does not use a classifier for depth images.
  wanted.options.segment = planes::profile_options(planes::Profile::paper);
  for (std::size_t i = 0; i < wants.size(); ++i) {
    if (!wants[i]) continue;
    turn.expect_wanted();
    wanted.frame = static_cast<int>(i);
    std::optional<double> share;
    try {
      std::string refused_labels;
      share = doubt_of(*load_subject(wanted, tools, &refused_labels));
    } catch (const std::exception&) {
      // An unreadable frame is reported when it is opened.
    }
    turn.deliver([i, share](State& s) {
      s.results.label.learning.doubt.of_frame[i] = share;
      ++s.results.label.learning.doubt.done;
    });
  }
  turn.deliver([](State& s) {
    s.results.label.learning.doubt.running = false;
    if (s.view.mode != Mode::labels || !can_label(s)) return;
    try {
      show_doubtful_frame(s);
    } catch (const Error& error) {
      say(s, error.what(), true);
    }
  });
}

class RecordingJobs : public JobGroup {
 public:
  RecordingJobs(Courier& courier, FrameTools& tools)
      : tools_(tools),
        maps_(courier),
        spreads_(courier),
        trainings_(courier),
        measurements_(courier),
        doubts_(courier) {}

  void pursue(State& state) override {
    if (!state.document.current()) return;
    pursue_training(state);
    pursue_measuring(state);
    pursue_doubt(state);
    pursue_map(state);
    pursue_spread(state);
  }
  bool busy(bool) const override {
    return maps_.busy() || spreads_.busy() || trainings_.busy() || measurements_.busy() ||
           doubts_.busy();
  }

 private:
  using Of = std::shared_ptr<const io::Recording>;
  struct MeasuredKey {
    Of recording;
    std::vector<int> reviewed;
    int trainings = 0;  // finished trainings whose weights must be evaluated
    bool operator==(const MeasuredKey&) const = default;
  };

  void pursue_map(State& state);
  void pursue_spread(State& state);
  void pursue_training(State& state);
  void pursue_measuring(State& state);
  void pursue_doubt(State& state);

  FrameTools& tools_;
  int trained_ = 0;   // number of trainings; used only by the window's thread
  Request<Of> maps_;  // last: their threads use the members above
  Request<Of> spreads_;
  Request<Of> trainings_;
  Request<MeasuredKey> measurements_;
  Request<Wanted> doubts_;
};

void RecordingJobs::pursue_map(State& state) {
  if (!maps_.begins(state.results.map)) return;
  const OpenRecording& open = *state.document.current();
  maps_.ask(
      open.recording,
      [this, recording = open.recording, picked = open.picked,
       options = state.document.options](const Turn& turn) {
        const auto classifier = tools_.classifier(options);
        const auto upright = io::with_picked_gravity(recording, picked);
        world::MapJob job;
        job.recording = upright.get();
        for (int i = 0; i < recording->frame_count(); ++i) job.frames.push_back(i);
        job.pipeline = options;
        job.classifier = classifier.get();
        job.threads = std::max(1, static_cast<int>(std::thread::hardware_concurrency()) - 1);
        job.stop = turn.stop;
        job.progress = [&](const char* stage, int done, int all) {
          turn.progress([](State& s) -> Asked& { return s.results.map; }, done, all, stage);
        };
        auto made = std::make_shared<MapView>();
        made->recording = recording;
        made->picked = picked;
        made->key = run_key(options);
        job.alone = true;  // the window shows planes found in each frame alone
        made->map = world::map_recording(job);
        complete(*made);
        turn.deliver([made](State& s) {
          s.results.map.running = false;
          s.results.map.made = made;
          s.view.tracks.track = 0;
          const std::size_t planes = world::planes_of_map(made->tracker()).size();
          std::string text = fmt::format("{} tracked over {}", counted(planes, "plane"),
                                         counted(made->tracker().frames().size(), "frame"));
          for (const std::string& line : made->map.warnings) text += "; " + line;
          say(s, text);
        });
      },
      [](State& s, const std::string& why) {
        s.results.map.running = false;
        say(s, why, true);
      });
}

void RecordingJobs::pursue_spread(State& state) {
  SpreadWork& spread = state.results.label.spread;
  const OpenRecording& open = *state.document.current();
  if (!spreads_.begins(spread, open.labels != nullptr)) return;
  SpreadInputs wanted{state.results.map.made,       open.label_dir, {}, spread.from, spread.track,
                      open.recording->frame_count()};
  for (int i = 0; i < wanted.frames; ++i)
    if (auto labels = open.labels->labels(i)) wanted.at_hand[i] = std::move(labels);
  const auto fail = [](State& s, const std::string& why) {
    s.results.label.spread.running = false;
    say(s, why, true);
  };
  spreads_.ask(
      open.recording,
      [wanted = std::move(wanted), fail](const Turn& turn) {
        auto proposals = std::make_shared<std::vector<labels::Proposal>>(propose(wanted, turn));
        turn.deliver([wanted, proposals, fail](State& s) {
          s.results.label.spread.running = false;
          try {
            take_proposals(s, wanted, *proposals);
          } catch (const std::exception& error) {
            fail(s, message_of(error));
          }
        });
      },
      fail);
}

void RecordingJobs::pursue_training(State& state) {
  Learning::Training& training = state.results.label.learning.training;
  if (!trainings_.begins(training)) return;
  const LearningSource source = learning_source(state);
  trainings_.ask(
      source.recording,
      [this, source, lesson = training.lesson](const Turn& turn) {
        learn(source, lesson, [&](const char* stage, int done, int all) {
          turn.expect_wanted();
          turn.progress([](State& s) -> Asked& { return s.results.label.learning.training; }, done,
                        all, stage);
        });
        turn.deliver([this, source](State& s) {
          s.results.label.learning.training = {};
          ++trained_;
          take_weights(s, source);
        });
      },
      [](State& s, const std::string& why) {
        s.results.label.learning.training = {};
        say(s, why, true);
      });
}

void RecordingJobs::pursue_measuring(State& state) {
  if (state.view.mode != Mode::labels || state.view.label.tab != "learning") return;
  const LearningSource source = learning_source(state);
  const MeasuredKey key{source.recording, source.reviewed, trained_};
  if (measurements_.key() == key) return;
  Learning& learning = state.results.label.learning;
  if (!measurements_.key() || measurements_.key()->recording != key.recording) {
    learning.learnt = nullptr;
    learning.refusal.clear();
  }
  const auto take = [](State& s, std::shared_ptr<const Learnt> learnt, const std::string& refusal) {
    s.results.label.learning.learnt = std::move(learnt);
    s.results.label.learning.refusal = refusal;
  };
  measurements_.ask(
      key,
      [source, take](const Turn& turn) {
        const auto learnt =
            measure_learnt(source, [&](const char*, int, int) { turn.expect_wanted(); });
        turn.deliver([learnt, take](State& s) { take(s, learnt, ""); });
      },
      [take](State& s, const std::string& why) { take(s, nullptr, why); });
}

void RecordingJobs::pursue_doubt(State& state) {
  Learning::Doubt& doubt = state.results.label.learning.doubt;
  const Wanted wanted = wanted_of(state.document, 0);
  const std::optional<Wanted>& known = doubts_.key();
  if (known && (known->recording != wanted.recording || known->prepare_key != wanted.prepare_key ||
                !(known->picked == wanted.picked))) {
    const bool wants_more = doubt.running && !doubt.begun;
    doubts_.drop();  // outdated: from another classifier or recording
    doubt = {};
    doubt.running = wants_more;
  }
  if (!doubt.running || doubt.begun) return;
  doubt.begun = true;
  const auto count = static_cast<std::size_t>(wanted.recording->frame_count());
  doubt.of_frame.assign(count, std::nullopt);
  std::vector<std::uint8_t> wants(count);
  for (std::size_t i = 0; i < count; ++i)
    wants[i] = !frame_mark(state, static_cast<int>(i)).reviewed;
  doubts_.ask(wanted, [this, wanted, wants = std::move(wants)](const Turn& turn) {
    find_doubt(wanted, wants, tools_, turn);
  });
}

}  // namespace

std::unique_ptr<JobGroup> make_recording_jobs(Courier& courier, FrameTools& tools) {
  return std::make_unique<RecordingJobs>(courier, tools);
}

}  // namespace planescope::desktop
