#include "app/desktop/jobs/frame_work.hpp"

#include <fmt/format.h>

#include "app/commands/inputs.hpp"
#include "app/desktop/jobs/cloud_thumbnail.hpp"
#include "core/labels/model/label_files.hpp"
#include "core/model/error.hpp"
#include "core/planes/pipeline/options_table.hpp"
#include "core/report/page/pictures.hpp"
#include "render/scenes.hpp"

namespace planescope::desktop {
namespace {

constexpr int kThumbnailWidth = 200;  // [px]

/// The options of some sections as one text.
std::string options_key(const planes::PipelineOptions& options, bool preparing) {
  std::string key;
  for (const planes::OptionInfo& info : planes::option_table()) {
    const bool segments = info.steers_segmentation() || info.section == "rivals";
    if (segments != preparing) key += info.get(options) + '|';
  }
  return key;
}

std::optional<debug::QuickScore> score_of(const debug::Run& run) {
  if (!run.subject->voxel_truth.known()) return std::nullopt;
  return debug::quick_score(run.segmentation.plane_of, run.subject->voxel_truth);
}

}  // namespace

std::shared_ptr<const planes::Classifier> Classifiers::get(const planes::PipelineOptions& options) {
  const std::lock_guard lock(mutex_);
  if (options.method != planes::Method::ours) return nullptr;
  const std::string key = fmt::format("{}|{}|{}", options.classifier, options.pca.neighbours,
                                      options.pca.max_angle_deg);
  if (key != key_) chosen_ = app::choose_classifier(options).classifier;
  key_ = key;
  return chosen_;
}

Wanted wanted_of(const Document& document, int frame) {
  const OpenRecording& open = *document.current();
  return {open.recording,
          open.label_dir,
          frame,
          document.options,
          open.picked,
          document.labels_version,
          options_key(document.options, true),
          options_key(document.options, false)};
}

Wanted with_options(Wanted wanted, const planes::PipelineOptions& options) {
  wanted.options = options;
  wanted.prepare_key = options_key(options, true);
  wanted.segment_key = options_key(options, false);
  return wanted;
}

std::shared_ptr<const debug::Subject> load_subject(const Wanted& wanted,
                                                   Classifiers& classifiers,
                                                   std::string* refused_labels) {
  const std::shared_ptr<const planes::Classifier> classifier = classifiers.get(wanted.options);
  Frame frame = wanted.recording->frame(wanted.frame);
  io::apply_picked_gravity(wanted.picked, frame);
  planes::PipelineOptions options = wanted.options;
  options.gravity.none_where_unknown = true;
  const std::string hash = wanted.recording->frame_hash(wanted.frame);
  std::optional<planes::SourceTruth> truth;
  try {
    truth = labels::frame_truth(frame, wanted.label_dir, hash);
  } catch (const Error& error) {
    if (!refused_labels) throw;
    *refused_labels = error.what();
  }
  return debug::make_subject(std::move(frame), std::move(truth), options, classifier.get());
}

std::shared_ptr<const RunView> view_run(std::shared_ptr<const debug::Run> run,
                                        const render::Camera& home) {
  auto view = std::make_shared<RunView>();
  view->histograms = debug::histograms_of(*run);
  view->score = score_of(*run);
  view->home = home;
  view->run = std::move(run);
  return view;
}

render::Camera home_of(const debug::Run& run) {
  return render::frame_camera(run.subject->prepared, run.segmentation, 4.0 / 3);
}

Thumbnail thumbnail_of(const Wanted& wanted, Classifiers& classifiers) {
  Thumbnail thumbnail;
  thumbnail.ready = true;
  try {
    const auto run = debug::make_run(load_subject(wanted, classifiers), wanted.options);
    render::StepLook look;
    look.step = run->steps();
    look.color_by = render::ColorBy::planes;
    thumbnail.image =
        run->subject->frame.depth.empty()
            ? cloud_thumbnail(*run, kThumbnailWidth)
            : report::shrink(render::image_step(*run, look, render::Backdrop::color, 0.6),
                             kThumbnailWidth);
    thumbnail.planes = static_cast<int>(run->segmentation.planes.size());
    thumbnail.score = score_of(*run);
  } catch (const std::exception& error) {
    thumbnail.refusal = error.what();
  }
  return thumbnail;
}

}  // namespace planescope::desktop
