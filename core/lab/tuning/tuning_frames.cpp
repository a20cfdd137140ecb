#include "core/lab/tuning/tuning_frames.hpp"

#include <time.h>

#include <algorithm>
#include <cmath>
#include <mutex>

#include "core/model/error.hpp"
#include "core/model/parallel.hpp"
#include "core/planes/pipeline/truth.hpp"

namespace planescope::lab {
namespace {

constexpr std::size_t kMostKept = 64;  // frames with labels: some 20 MB each

double thread_cpu_ms() {
  timespec time{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
  return static_cast<double>(time.tv_sec) * 1e3 + static_cast<double>(time.tv_nsec) * 1e-6;
}

/// Whether points or their labels are other ones with this setting.
bool changes_points(const Setting& setting) {
  return std::ranges::any_of(setting, [](const auto& one) {
    const std::string& section = planes::find_option(one.first).section;
    return section == "cloud" || section == "classifier";
  });
}

planes::PreparedFrame prepared(const TuningFrame& frame,
                               const planes::PipelineOptions& options,
                               const planes::Classifier* classifier) {
  std::shared_ptr<const planes::Classifier> pca;
  if (options.classifier == "pca") pca = planes::make_pca_classifier(options.pca);
  const planes::FrameTruth on_points =
      planes::truth_on_points(frame.truth.values, planes::measured_sources(frame.frame));
  return planes::prepare_frame(frame.frame, options, pca ? pca.get() : classifier, &on_points);
}

}  // namespace

struct TuningSet::Labelled {
  std::once_flag once;
  planes::PreparedFrame prepared;
  double ms = 0;
};

TuningSet::TuningSet(std::vector<TuningFrame> frames,
                     std::shared_ptr<const planes::Classifier> classifier)
    : frames_(std::move(frames)), classifier_(std::move(classifier)) {
  for (TuningFrame& frame : frames_) {
    frame.options.threads = 1;
    // Which points lie near another label takes most of a score, and says nothing about planes.
    planes::SourceTruth& planes = planes_.emplace_back(frame.truth);
    std::ranges::fill(planes.values.label, std::uint8_t{0});
  }
  for (std::size_t i = 0; i < std::min(frames_.size(), kMostKept); ++i)
    labelled_.push_back(std::make_shared<Labelled>());
}

const TuningSet::Labelled& TuningSet::labelled(std::size_t frame) const {
  Labelled& labelled = *labelled_[frame];
  std::call_once(labelled.once, [&] {
    const double begin = thread_cpu_ms();
    labelled.prepared = prepared(frames_[frame], frames_[frame].options, classifier_.get());
    labelled.ms = thread_cpu_ms() - begin;
  });
  return labelled;
}

TuningSet::Scored TuningSet::score_one(std::size_t index, const Setting& setting) const {
  const TuningFrame& frame = frames_[index];
  const planes::PipelineOptions options = with_setting(frame.options, setting);
  try {
    planes::FrameResult result;
    Scored scored;
    if (index < labelled_.size() && !changes_points(setting)) {
      const Labelled& labelled = this->labelled(index);
      static_cast<planes::PreparedFrame&>(result) = labelled.prepared;
      scored.ms = labelled.ms;
    } else {
      const double begin = thread_cpu_ms();
      static_cast<planes::PreparedFrame&>(result) = prepared(frame, options, classifier_.get());
      scored.ms = thread_cpu_ms() - begin;
    }
    const double begin = thread_cpu_ms();
    planes::FoundRegions found = planes::find_regions(frame.frame, result, options);
    scored.ms += thread_cpu_ms() - begin;
    result.segmentation = std::move(found.segmentation);
    result.plane_of = std::move(found.plane_of);
    scored.pq = planes::score_frame(result, planes_[index]).pq;
    if (!std::isfinite(scored.pq)) scored.pq = 0;
    return scored;
  } catch (const Error& error) {
    if (setting.empty()) throw Error(frame.name + ": " + error.what());
    return {};
  }
}

void TuningSet::score(std::span<const Setting> settings,
                      int threads,
                      const std::function<void(const TimedTrial&)>& take,
                      const std::function<void(int, int)>& progress) const {
  const auto frames = static_cast<int>(frames_.size());
  const int count = static_cast<int>(settings.size()) * frames;
  std::vector<Scored> scored(static_cast<std::size_t>(count));
  TimedTrial timed;
  work_in_order(
      count, threads,
      [&](int i) {
        const auto k = static_cast<std::size_t>(i);
        scored[k] = score_one(k % frames_.size(), settings[k / frames_.size()]);
      },
      [&](int i) {
        const auto k = static_cast<std::size_t>(i);
        timed.trial.scores.push_back(scored[k].pq);
        timed.ms += scored[k].ms / frames;
        if (progress) progress(i + 1, count);
        if (timed.trial.scores.size() < frames_.size()) return;
        timed.trial.setting = settings[k / frames_.size()];
        take(timed);
        timed = {};
      });
}

}  // namespace planescope::lab
