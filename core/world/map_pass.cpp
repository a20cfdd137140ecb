// One pass over a recording: runs frames in parallel and adds them to the tracker in order.

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <future>
#include <memory>
#include <thread>
#include <utility>

#include "core/io/image/png.hpp"
#include "core/model/file_bytes.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/pipeline/pipeline.hpp"
#include "core/world/map_recording.hpp"
#include "core/world/tracks/tracker.hpp"

namespace planescope::world {
namespace {

/// Frame arrival at the recording's timestamps, or at 30 Hz if these do not increase.
class Arrivals {
 public:
  Arrivals(const MapJob& job, const std::vector<const CameraPose*>& pose_of) : job_(job) {
    constexpr double kRate_hz = 30;
    for (std::size_t i = 0; i < pose_of.size(); ++i)
      due_.push_back(pose_of[i] ? pose_of[i]->timestamp_s : time_of(*job.recording, job.frames[i]));
    // A damaged frame arrives with the previous one.
    const auto known = [](double time) { return !std::isnan(time); };
    const auto first_known = std::ranges::find_if(due_, known);
    const double first = first_known == due_.end() ? 0 : *first_known;
    double before = first;
    for (double& time : due_) before = time = known(time) ? time : before;
    for (double& time : due_) time -= first;
    if (!std::ranges::is_sorted(due_) || (due_.size() > 1 && due_.back() <= 0))
      for (std::size_t i = 0; i < due_.size(); ++i) due_[i] = static_cast<double>(i) / kRate_hz;
  }

  /// Waits for frame `i`, then returns the newest frame that has arrived.
  int newest(int i) const {
    constexpr double kLongest_s = 0.05;  // between checks for a stop request
    for (double wait; (wait = due_[i] - now_s()) > 0;) {
      check_stop(job_);
      std::this_thread::sleep_for(std::chrono::duration<double>(std::min(kLongest_s, wait)));
    }
    while (has_come(i + 1)) ++i;
    return i;
  }
  bool has_come(int i) const { return i < std::ssize(due_) && due_[i] <= now_s(); }
  void taken(int i) { behind_.push_back(now_s() - due_[i]); }

  Pace pace() {
    Pace pace{.frames = static_cast<int>(due_.size()), .taken = static_cast<int>(behind_.size())};
    if (pace.frames > 1) pace.rate_hz = (pace.frames - 1) / std::max(1e-9, due_.back());
    if (behind_.empty()) return pace;
    std::ranges::sort(behind_);
    pace.behind_s_median = behind_[behind_.size() / 2];
    pace.behind_s_most = behind_.back();
    return pace;
  }

 private:
  using Clock = std::chrono::steady_clock;
  double now_s() const { return std::chrono::duration<double>(Clock::now() - start_).count(); }

  const MapJob& job_;
  std::vector<double> due_;  // [s] after the first frame
  std::vector<double> behind_;
  Clock::time_point start_ = Clock::now();
};

/// A shard's file is missing or invalid: ends the run. Other errors skip only one frame.
struct PartError : Error {
  using Error::Error;
};

std::string refused_line(int frame, const Error& error) {
  return fmt::format("frame {}: {}", frame, error.what());
}

/// A frame in progress.
struct FrameAtWork {
  const CameraPose* pose = nullptr;
  Frame frame;
  planes::PipelineOptions options;
  std::vector<planes::KnownPlane> expected;  // candidates
  planes::FrameResult found;
};

FrameAtWork start_frame(const MapJob& job,
                        const planes::PipelineOptions& pipeline,
                        const UprightPoses& upright,
                        const CameraPose& pose,
                        std::span<const Track* const> known = {}) {
  FrameAtWork work{&pose, job.recording->frame(pose.frame), {}, {}, {}};
  work.options = turn_to_map(work.frame, pipeline, pose, upright);
  work.expected =
      expected_planes(known, work.frame, pose.T_world_camera, job.tracks, work.options.threads);
  return work;
}
void find_planes(const MapJob& job, FrameAtWork& work) {
  work.found =
      planes::run_frame(work.frame, work.options, job.classifier, nullptr, nullptr, work.expected);
}
ObservedFrame observation_of(FrameAtWork& work) {
  return observe(work.frame, std::move(work.found), work.options, work.pose->T_world_camera,
                 work.pose->segment);
}

/// Uses the planes found by a shard.
ObservedFrame observe_given(const MapJob& job,
                            const UprightPoses& upright,
                            const FrameAtWork& work) {
  const Image16& depth = work.frame.depth;
  try {
    ObservedFrame seen = job.observed(work.frame.index, upright);
    if (seen.plane_of.width != depth.width || seen.plane_of.height != depth.height)
      throw Error(fmt::format("frame {} was observed at {}x{}; expected {}x{}", work.frame.index,
                              seen.plane_of.width, seen.plane_of.height, depth.width,
                              depth.height));
    set_frame_fields(seen, work.frame, work.options, work.pose->T_world_camera, work.pose->segment);
    return seen;
  } catch (const Error& error) {
    throw PartError(error.what());
  }
}

planes::FrameThreads threads_of(const MapJob& job, int frames) {
  planes::PipelineOptions options = job.pipeline;
  options.threads = job.threads;
  return planes::threads_for_frames(options, frames);
}

/// Starts each frame of a job, finds and observes its planes, and adds them to the tracker.
class Passage {
 public:
  Passage(const MapJob& job,
          const UprightPoses& upright,
          Offer offer,
          const Tracker* earlier,
          const char* what,
          bool is_last)
      : job_(job),
        upright_(upright),
        offer_(offer),
        earlier_(earlier),
        what_(what),
        is_last_(is_last),
        stores_(is_last && offer != Offer::nothing),
        count_(static_cast<int>(job.frames.size())),
        one_by_one_(job.at_own_rate || offer == Offer::so_far),
        threads_(threads_of(job, one_by_one_ ? 1 : count_)),
        pose_of_(poses_by_frame(job, upright)),
        at_work_(job.frames.size()),
        pass_{Tracker(job.tracks, earlier ? earlier->tracks().size() : 0), {}, {}, 0, {}} {}

  Pass run() {
    if (is_last_) pass_.tracker.on_left(job_.on_left);
    if (one_by_one_)
      run_one_by_one();
    else
      work_in_order(
          count_, threads_.at_once, [&](int i) { start(i), find(i), observe_found(i); },
          [&](int i) { take(i); });
    pass_.tracker.on_left({});
    return std::move(pass_);
  }

 private:
  struct AtWork {
    std::optional<FrameAtWork> frame;
    std::optional<ObservedFrame> observed;
    std::future<std::vector<unsigned char>> png;
    StoredPlanes stored;
    std::string refused;
  };

  /// While the planes of a frame are found, the previous frame is added and the next one is
  /// started, so a frame's candidates are the tracks as of two frames earlier. If the next frame
  /// has not arrived yet, a frame is added immediately.
  void run_one_by_one() {
    std::optional<Arrivals> arrivals;
    if (job_.at_own_rate) arrivals.emplace(job_, pose_of_);
    const auto start_newest = [&](int i) {
      if (arrivals) i = arrivals->newest(i);
      start(i);
      return i;
    };
    const auto has_come = [&](int i) { return !arrivals || arrivals->has_come(i); };
    const auto finish = [&](int i) {
      if (i < 0) return;
      observe_found(i);
      const bool is_observed = at_work_[i]->observed.has_value();
      take(i);
      if (arrivals && is_observed) arrivals->taken(i);
    };
    int found = -1;
    for (int i = start_newest(0), next = 0; i < count_; i = next) {
      std::future<void> finding = std::async(policy(), [this, i] { find(i); });
      finish(found);
      next = i + 1;
      const bool goes_on = next < count_ && has_come(next);
      if (goes_on) next = start_newest(next);
      finding.get();
      found = i;
      if (goes_on || next == count_) continue;
      if (!has_come(next)) finish(std::exchange(found, -1));
      next = start_newest(next);
    }
    finish(found);
    if (arrivals) pass_.pace = arrivals->pace();
  }

  /// Failed frames are skipped, and reported in order.
  void attempt(int i, const std::function<void(AtWork&)>& step) {
    AtWork& at = *at_work_[i];
    if (job_.stop.stop_requested() || !at.refused.empty()) return;
    try {
      step(at);
    } catch (const PartError&) {
      throw;
    } catch (const Error& error) {
      at.refused = refused_line(job_.frames[i], error);
    }
  }

  void start(int i) {
    at_work_[i] = std::make_unique<AtWork>();
    attempt(i, [&](AtWork& at) {
      if (!pose_of_[i]) {
        // Throws if the frame is unreadable, which explains the missing pose.
        if (upright_.poses.estimated) job_.recording->frame(job_.frames[i]);
        return;
      }
      std::vector<const Track*> known;
      if (offer_ == Offer::so_far)
        known = sure_tracks(pass_.tracker, pass_.tracker.segment_of(pose_of_[i]->segment));
      if (offer_ == Offer::all) known = sure_tracks(*earlier_, earlier_->frames()[i].segment);
      at.frame = start_frame(job_, threads_.pipeline, upright_, *pose_of_[i], known);
    });
  }
  void find(int i) {
    attempt(i, [&](AtWork& at) {
      if (at.frame && !is_given()) find_planes(job_, *at.frame);
    });
  }
  void observe_found(int i) {
    attempt(i, [&](AtWork& at) {
      if (!at.frame) return;
      at.observed =
          is_given() ? observe_given(job_, upright_, *at.frame) : observation_of(*at.frame);
      at.frame.reset();
      if (!stores_) return;
      for (const ObservedPlane& plane : at.observed->planes)
        at.stored.margins.push_back(plane.margin);
      at.png =
          std::async(policy(), [&image = at.observed->plane_of] { return io::encode_png(image); });
    });
  }
  void take(int i) {
    check_stop(job_);
    AtWork& at = *at_work_[i];
    if (at.observed) {
      const FrameOfTracks& matched = pass_.tracker.add(*at.observed);
      if (job_.on_frame && is_last_) job_.on_frame(*at.observed, matched);
      if (stores_) {
        const std::vector<unsigned char> png = at.png.get();
        at.stored.sha256 = sha256_hex(std::as_bytes(std::span(png)));
        if (job_.on_planes) job_.on_planes(job_.frames[i], png);
        pass_.stored[job_.frames[i]] = std::move(at.stored);
      }
    } else {
      pass_.tracker.skip(job_.frames[i], pose_of_[i] ? pose_of_[i]->timestamp_s : 0);
      pass_.without_pose += !pose_of_[i] && at.refused.empty();
    }
    if (!at.refused.empty()) pass_.refused.push_back(std::move(at.refused));
    at_work_[i].reset();
    report_progress(job_, what_, i + 1, count_);
  }
  /// Runs on another thread if the job has more than one and the system can start it.
  std::launch policy() const {
    return job_.threads > 1 ? std::launch::async | std::launch::deferred : std::launch::deferred;
  }
  /// Whether a shard found the planes.
  bool is_given() const { return job_.observed && offer_ == Offer::nothing; }

  const MapJob& job_;
  const UprightPoses& upright_;
  const Offer offer_;
  const Tracker* const earlier_;
  const char* const what_;
  const bool is_last_, stores_;
  const int count_;
  const bool one_by_one_;
  const planes::FrameThreads threads_;
  const std::vector<const CameraPose*> pose_of_;
  std::vector<std::unique_ptr<AtWork>> at_work_;  // by position in the job; null: not in progress
  Pass pass_;
};

}  // namespace

std::vector<const Track*> sure_tracks(const Tracker& tracker, int segment) {
  std::vector<const Track*> sure;
  for (const Track& track : tracker.tracks())
    if (track.segment == segment && track.is_sure(tracker.options())) sure.push_back(&track);
  return sure;
}

std::vector<const CameraPose*> poses_by_frame(const MapJob& job, const UprightPoses& upright) {
  std::vector<const CameraPose*> poses;
  for (const int frame : job.frames) poses.push_back(pose_of(upright.poses, frame));
  return poses;
}

Pass pass_through(const MapJob& job,
                  const UprightPoses& upright,
                  Offer offer,
                  const Tracker* earlier,
                  const char* what,
                  bool is_last) {
  return Passage(job, upright, offer, earlier, what, is_last).run();
}

std::vector<std::string> observe_each(const MapJob& job,
                                      const UprightPoses& upright,
                                      const std::vector<const CameraPose*>& poses,
                                      const std::function<void(const ObservedFrame&)>& take) {
  const planes::FrameThreads threads = threads_of(job, static_cast<int>(job.frames.size()));
  const auto count = static_cast<int>(poses.size());
  std::vector<std::unique_ptr<const ObservedFrame>> observed(poses.size());
  std::vector<std::string> why(poses.size()), refused;
  work_in_order(
      count, threads.at_once,
      [&](int i) {
        if (job.stop.stop_requested()) return;
        try {
          FrameAtWork work = start_frame(job, threads.pipeline, upright, *poses[i]);
          find_planes(job, work);
          observed[i] = std::make_unique<const ObservedFrame>(observation_of(work));
        } catch (const Error& error) {
          why[i] = refused_line(poses[i]->frame, error);
        }
      },
      [&](int i) {
        check_stop(job);
        if (observed[i]) take(*observed[i]);
        observed[i].reset();
        if (!why[i].empty()) refused.push_back(std::move(why[i]));
        report_progress(job, "frames", i + 1, count);
      });
  return refused;
}

}  // namespace planescope::world
